"""A flange bent by a moment or by its bolts, against CalculiX 2.20 in 3D: `benchmarks/calculix_around.py`."""

from __future__ import annotations

import calculix_around
import numpy as np
import pytest
from case_to_line_load import line_load
from three_dimensional_seat import at_angles


@pytest.mark.parametrize("share", calculix_around.SHARES)
def test_bent_flange_against_calculix(share: float) -> None:
    """Line load and tilt, touching all around and after one side has lifted off: to 2 % of the mean."""
    stored = np.loadtxt(calculix_around.TABLE, delimiter=",", skiprows=1)
    angle, theirs, tilt, moment = stored[stored[:, 0] == share, 1:].T
    found = line_load(calculix_around.bent_flange(share))
    np.testing.assert_allclose(at_angles(found, found.over_mean, np.radians(angle)), theirs, atol=0.02)
    assert found.tilt_angle == pytest.approx(tilt[0], rel=0.02)
    assert moment[0] == pytest.approx(found.form.moment, rel=1e-3)


@pytest.mark.parametrize("third", calculix_around.THIRDS)
def test_bolts_one_by_one_against_calculix(third: float) -> None:
    """Four bolts, the third tight or loose: to 2 % of the mean."""
    stored = np.loadtxt(calculix_around.BOLTS_TABLE, delimiter=",", skiprows=1)
    angle, theirs = stored[stored[:, 0] == third, 1:].T
    found = line_load(calculix_around.bolted_flange(third))
    np.testing.assert_allclose(at_angles(found, found.over_mean, np.radians(angle)), theirs, atol=0.02)
