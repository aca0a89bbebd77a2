"""Parts of an inverse against the dense inverse, and against the displacements of a body."""

from __future__ import annotations

import gc
import mmap
from pathlib import Path

import numpy as np
import pytest
from contact_models import STEEL
from factorised_whole import restricted_inverse
from scipy.sparse import csc_matrix, diags, identity, kron

import meshes
from fem_seal.contact.model import condense


@pytest.fixture
def laplacian():
    """Five-point Laplacian of a square grid with 12 x 9 points, ill-ordered on purpose."""
    rows, columns = (
        diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(size, size), format="csc") for size in (12, 9)
    )
    matrix = kron(rows, identity(9)) + kron(identity(12), columns)
    mixed = np.random.default_rng(3).permutation(12 * 9)
    return csc_matrix(matrix.tocsc()[mixed][:, mixed])


def test_inverse_between_places(laplacian):
    places = [40, 3, 77, 12, 100]
    inverse, _ = restricted_inverse(laplacian, places)
    dense = np.linalg.inv(laplacian.toarray())
    # condition number 1e2: round-off of some 1e-14
    np.testing.assert_allclose(inverse, dense[np.ix_(places, places)], rtol=1e-12)
    np.testing.assert_array_equal(inverse, inverse.T)


def test_solver_of_the_same_factor(laplacian):
    _, solve = restricted_inverse(laplacian, [5, 6])
    right = np.random.default_rng(1).normal(size=(108, 3))
    np.testing.assert_allclose(laplacian @ solve(right), right, atol=1e-12)
    np.testing.assert_allclose(laplacian @ solve(right[:, 0]), right[:, 0], atol=1e-12)


def test_singular_matrix():
    with pytest.raises(RuntimeError):
        restricted_inverse(csc_matrix(diags([1.0, 0.0, 1.0])), [0])


@pytest.mark.skipif(
    not Path("/proc/self/statm").exists(), reason="the memory in use is read from Linux's /proc"
)
def test_condensed_bodies_leave_no_memory_behind(made_anew):
    """Factors are freed: every geometry of a study would cost 20 MB for good."""
    ball = meshes.Ball(0.02)
    built = meshes.build(
        ball,
        meshes.ConicalSeat.around(np.radians(45), ball),
        meshes.Sizing(2e-5, 5e-4, (-1e-3, 1e-3), 0.1, 0.2, 2e-3),
    )

    def held_megabytes() -> float:
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * mmap.PAGESIZE / 1e6

    def condensed() -> None:
        condense(built, {"closure": STEEL, "seat": STEEL})

    condensed()
    before = held_megabytes()
    for _ in range(5):
        condensed()
    # one pair of factors is 15 MB; the allocator may keep a few for the next
    assert held_megabytes() - before < 30
