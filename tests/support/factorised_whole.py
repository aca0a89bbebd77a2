"""A stiffness factorised as a whole by SuperLU: what a body in parts is compared with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg.lapack import dpotri
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spilu, splu

from fem_seal.arrays import FloatArray
from fem_seal.bodies.constrained_body import ConstrainedBody

_SYMMETRIC = {"SymmetricMode": True}


def _elimination_order(matrix: csc_matrix, places: NDArray[np.intp]) -> NDArray[np.intp]:
    """Order that eliminates a symmetric matrix with little fill, some places last; the pattern alone matters."""
    # SuperLU tells its fill-reducing order only after a factorisation; one that drops nearly everything is cheap.
    factors = spilu(
        matrix,
        drop_tol=1e9,
        fill_factor=1.0,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options=_SYMMETRIC,
    )
    order = np.argsort(factors.perm_c)
    is_last = np.zeros(len(order), dtype=bool)
    is_last[places] = True
    return np.concatenate([order[~is_last[order]], places])


def restricted_inverse(
    matrix: csc_matrix, places: ArrayLike
) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """(A^-1) between some places of a symmetric positive definite matrix, and a solver for any right-hand side.

    The places are eliminated last: the last block of L U is then the Schur complement of all other unknowns, and its
    inverse the part of A^-1 that is asked for.

    Parameters
    ----------
    matrix : csc_matrix, shape (n, n)
        A.
    places : array_like of int, shape (m,)
        All different.

    Returns
    -------
    inverse : ndarray, shape (m, m)
        In the order of `places`.
    solve : callable
        Takes b, shape (n,) or (n, k), to A^-1 b.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    places = np.asarray(places, dtype=np.intp)
    order = _elimination_order(matrix, places)
    factor = splu(
        matrix[order][:, order].tocsc(),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options=_SYMMETRIC,
    )
    count = len(order) - len(places)
    last_rows = factor.U[count:, count:].toarray()
    pivots = np.diagonal(last_rows)
    # without a pivot off the diagonal, which a positive definite matrix never needs
    if not (np.array_equal(factor.perm_r, np.arange(len(order))) and np.all(pivots > 0)):
        raise RuntimeError("the matrix is not positive definite")
    # Schur complement U^T diag(U)^-1 U, by symmetry; with its Cholesky factor its inverse takes less work
    inverse, _ = dpotri(last_rows / np.sqrt(pivots)[:, None])
    inverse = np.triu(inverse)

    def solve(right: FloatArray) -> FloatArray:
        solution = np.empty_like(right)
        solution[order] = factor.solve(np.ascontiguousarray(right[order]))
        return solution

    return inverse + np.triu(inverse, 1).T, solve


def contact_compliance(
    held: ConstrainedBody, stiffness: csc_matrix
) -> tuple[FloatArray, Callable[[FloatArray], FloatArray]]:
    """What `DissectedBody` gives, of a body with this stiffness of its free dofs [N/m]."""
    place = held.free_rows[held.contact_dofs].ravel()
    movable = np.flatnonzero(place >= 0)
    dofs, solve = restricted_inverse(stiffness, place[movable])
    inverse = np.zeros((place.size, place.size))
    inverse[np.ix_(movable, movable)] = dofs
    normal_compliance = held.normal.ravel()[:, None] * inverse * held.normal.ravel()
    return normal_compliance.reshape(*held.normal.shape, *held.normal.shape).sum(axis=(0, 2)), solve
