"""Discretisation error of a load from the same load on larger elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fem_seal.profile import PressureProfile
from fem_seal.results import DiscretisationError

if TYPE_CHECKING:
    from fem_seal.case_flow import CaseFlow

# The coarser mesh of the error estimate has elements this much larger.
COARSER = 2.0


def discretisation_error(
    flow: CaseFlow | None,
    fine: PressureProfile,
    coarse: PressureProfile,
    fluid_pressure: float,
    *,
    of_coarse: bool = False,
) -> DiscretisationError:
    """Compare a load on the mesh of the result with the same on elements larger by `COARSER`.

    Parameters
    ----------
    flow : CaseFlow or None
        None if the case has no leak rate.
    fine, coarse : PressureProfile
    fluid_pressure : float
        [Pa]
    of_coarse : bool
        Whether the coarse one is the result, as it must be where a ready mesh cannot be made coarser.
    """

    def estimated(fine: float, coarse: float) -> float:
        """Relative error by Richardson's rule for the second order."""
        return abs(coarse / fine - 1) / (COARSER**2 - 1) * (COARSER**2 if of_coarse else 1.0)

    leak_rate = None
    if flow is not None:
        leaks = flow.leak(fine, fluid_pressure).leak_rate
        if 0 < leaks < float("inf"):
            leak_rate = estimated(leaks, flow.leak(coarse, fluid_pressure).leak_rate)
    return DiscretisationError(
        estimated(fine.peak_pressure, coarse.peak_pressure),
        estimated(fine.fwhm, coarse.fwhm),
        estimated(fine.std, coarse.std),
        leak_rate,
    )
