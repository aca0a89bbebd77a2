"""Height and width of the calculated pressure profiles beside those of the closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fem_seal.derived import Derived
    from fem_seal.results import SealResult

FloatArray = NDArray[np.float64]

CLOSED_FORMS = ("hertz", "gaussian", "crossover")


@dataclass(frozen=True)
class Sizes:
    """Measures of one kind of profile, one entry per load.

    Parameters
    ----------
    peak_pressure : ndarray
        [Pa]
    fwhm : ndarray
        Full width at half maximum [m].
    std : ndarray
        Standard deviation [m].
    """

    peak_pressure: FloatArray
    fwhm: FloatArray
    std: FloatArray

    @classmethod
    def of(cls, profiles: Sequence[Any]) -> Sizes:
        """Measure profiles, calculated or closed; each is measured once, because some search for their width."""
        return cls(
            *(np.array([getattr(p, name) for p in profiles]) for name in ("peak_pressure", "fwhm", "std"))
        )


def profile_sizes(result: SealResult, derived: Derived) -> dict[str, Sizes]:
    """Sizes of the "calculated" profiles and of each closed form that the case has, over its loads.

    Parameters
    ----------
    result : SealResult
    derived : Derived
        Closed forms of the case.
    """
    sizes = {"calculated": Sizes.of(result.profiles)}
    for name in CLOSED_FORMS:
        profiles = [getattr(load, name) for load in derived.loads]
        if all(profile is not None for profile in profiles):
            sizes[name] = Sizes.of(profiles)
    return sizes
