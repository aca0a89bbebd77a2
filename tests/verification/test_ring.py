"""A copper ring between steel plates against CalculiX 2.20 on the same mesh: `benchmarks/calculix_ring.py`."""

from __future__ import annotations

import csv
from collections.abc import Sequence

import calculix_ring as ring
import numpy as np
import pytest

from fem_seal.contact.load_path import load_path
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.contact.solution import ContactSolution


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "width", "pressing", "springback"),
    [("elastic", 0.005, 0.001, 0.001), ("plastic", 0.005, 0.005, 0.005)],
)
def test_a_ring_is_pressed_and_springs_back_as_in_another_code(
    name: str, width: float, pressing: float, springback: float
) -> None:
    """Width of the contact, and how far the plate goes from load to load, up and down.

    CalculiX gives the pressure at nodes; its peak over the line load is compared up to what few of them leave.
    """
    with ring.TABLE.open() as file:
        rows = [[float(one) for one in row[2:]] for row in csv.reader(file) if row[0] == name]
    theirs, own = np.array(rows), ring.own_measures(name, ring.mesh(name))
    assert own[:, 2] == pytest.approx(theirs[:, 2], rel=width)
    assert own[:, 0] == pytest.approx(theirs[:, 0], rel=0.04)
    up = int(np.argmax(ring.FORCES))
    own_way, their_way = np.diff(own[:, 3]), np.diff(theirs[:, 3])
    assert own_way[:up] == pytest.approx(their_way[:up], rel=pressing)
    assert own_way[up:] == pytest.approx(their_way[up:], rel=springback)
    # copper has flowed: less comes back than was pressed in
    assert (-own_way[up:].sum() < 0.9 * own_way[:up].sum()) == (name == "plastic")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "force", "springback"), [("elastic", 0.0005, 0.001), ("plastic", 0.004, 0.004)]
)
def test_a_ring_at_a_stop_carries_what_its_compression_takes_in_another_code(
    name: str, force: float, springback: float
) -> None:
    """The stop stands where CalculiX has the plate at 6 kN; 20 kN press it there, and 3 kN and 1 kN are left."""
    with ring.TABLE.open() as file:
        way = [float(row[-1]) for row in csv.reader(file) if row[0] == name]
    seal_mesh, settings = ring.mesh(name), PlasticSettings(steps=2 * ring.STEPS)
    model, loads = condense(seal_mesh, ring.MATERIALS[name]), (1e3, 20e3, 3e3, 1e3)

    def pressed(model: ContactModel) -> Sequence[ContactSolution]:
        if name == "elastic":
            return [solve(model, ring.LAW, contact_force=one) for one in loads]
        return load_path(
            model, ring.LAW, list(map(PathLoad, loads)), settings=settings, unload=False
        ).contacts

    begins = ring.ours(name, seal_mesh)[0].approach
    at = pressed(model.with_stop(begins + way[2] - way[0]))
    assert at[1].contact_force == pytest.approx(6e3, rel=force)
    assert at[1].contact_force + at[1].stop_force == pytest.approx(20e3, rel=1e-12)
    assert [at[1].approach - one.approach for one in at[2:]] == pytest.approx(
        [way[2] - way[3], way[2] - way[4]], rel=springback
    )
