"""A copper ring between steel plates against CalculiX 2.20 on the same mesh: `benchmarks/calculix_ring.py`."""

from __future__ import annotations

import csv
import sys

import numpy as np
import pytest
from places import ROOT

sys.path.append(str(ROOT / "benchmarks"))
import calculix_ring as ring


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
