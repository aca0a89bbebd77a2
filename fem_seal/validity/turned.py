"""Cautions about turned faces: few crests in the contact, and crests that are nearly sealed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.seal.findings import AGREE, ORDERS_OF_MAGNITUDE, Bounds, Finding, caution
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import LoadResult

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.profile import PressureProfile
    from leak import TurnedContact

# Crests in the full width at half maximum of a contact, below which it is asked which face is meant.
_FEW_CRESTS = 3.0
# Places of the first crest within a feed.
_PHASES = 16
# Share of the thread in the conductivity above which it does not matter how tight the crests are.
_THREAD = 0.7
# Factor that the place of the crests may make before it is reported.
_REPORTED = 1.1


def turned_cautions(surface: TurnedContact, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Cautions about the leak rate between a turned face and a flat one.

    Parameters
    ----------
    surface : TurnedContact
    loads : sequence of LoadResult
        At least one.
    """
    narrow = min(loads, key=lambda load: load.tightest.fwhm)
    crests, factors = narrow.tightest.fwhm / surface.feed, crest_places(surface, narrow)
    if crests < _FEW_CRESTS or factors.high > _REPORTED * factors.low:
        yield caution(
            "few_crests",
            narrow,
            loads,
            leak_factor=factors,
            outside=factors.high == math.inf,
            is_reported=crests < _FEW_CRESTS,
            crests=crests,
            feed=surface.feed,
        )
    tight = max(loads, key=lambda load: acting_pressure(surface, load))
    acts, at_rest = acting_pressure(surface, tight), tight.tightest.at_rest(surface).peak_pressure
    limit = surface.nearly_sealed_pressure if tight.rough is None else tight.rough.crests_open_up_to
    if acts <= limit:
        return
    # what the thread lets through flows all the same
    thread_share = float(surface.thread_share(acts))
    low = max(1.0 / ORDERS_OF_MAGNITUDE, thread_share)
    leak, high = tight.leak, math.inf
    if tight.circumference is not None:
        # what a form error adds has no bound
        high = 1.0 / low
    elif leak is not None and leak.leak_rate > 0.0 and tight.leak_before_sealing > 0.0:
        high = max(tight.leak_before_sealing / leak.leak_rate, 1.0)
    matters = thread_share < _THREAD or high > 1.0 / _THREAD
    yield caution(
        "crests_nearly_sealed",
        tight,
        loads,
        leak_factor=Bounds(low, high),
        is_reported=matters,
        proven=not matters,
        pressure=limit,
        simulated=tight.rough is not None and tight.rough.is_direct,
        sealed=acts >= surface.sealing_pressure,
        acts=acts if acts > AGREE * tight.peak_pressure else None,
        flows=at_rest > AGREE * tight.peak_pressure,
        remembers=acts > AGREE * at_rest,
        times=high if high < ORDERS_OF_MAGNITUDE and tight.circumference is None else None,
    )


def acting_pressure(surface: TurnedContact, load: LoadResult) -> float:
    """Of first loading, for the tightest place after what it has carried before [Pa].

    Parameters
    ----------
    surface : TurnedContact
    load : LoadResult
    """
    tight = load.tightest.at_rest(surface)
    return float(surface.equivalent_first_loading_pressure(tight.peak_pressure, tight.highest))


def crest_places(surface: TurnedContact, load: LoadResult) -> Bounds:
    """Factors on the leak rate between which the place of the crests in the contact leaves it.

    The resistance of a contact is that of the crests in it, f/sigma(p) of each; the integral over x is its mean over
    all places of the first one.

    Parameters
    ----------
    surface : TurnedContact
    load : LoadResult
    """
    if load.rough is None or load.rough.flow is None:
        return Bounds(1.0, 1.0)
    totals = np.zeros(_PHASES * surface.crest_places.size)
    for land in load.profiles:
        totals = totals + _resistances(surface, load.rough, land) if land.touches else totals
    mean = float(totals.mean())
    if not 0.0 < mean < math.inf:
        return Bounds(1.0, 1.0)
    least = float(totals.min())
    return Bounds(mean / float(totals.max()), mean / least if least > 0.0 else math.inf)


def _resistances(surface: TurnedContact, rough: LeakModel, land: PressureProfile) -> FloatArray:
    """Of the crests on a land for each place of the first one, in any unit."""
    assert rough.flow is not None and rough.table is not None  # of the caller
    table, places, x = rough.table.liquid, surface.crest_places, land.x
    count, period = _PHASES * places.size, surface.crest_distance * places.size
    # what is all but sealed has its own bound, which the place of the crests moves as it moves this
    land = land.equivalent(table, surface).pressed_up_to(rough.crests_open_up_to)
    totals = []
    for phase in range(count):
        crests = np.arange(x[0] + (phase / count - 1.0) * period, x[-1], period) + places[:, None]
        pressure = np.interp(crests, x, land.pressure)
        carry = (crests >= x[0]) & (crests < x[-1]) & (pressure > 1e-6 * land.peak_pressure)
        pressure = np.where(carry, pressure, land.peak_pressure)
        with np.errstate(divide="ignore"):
            each = surface.crest_shares(pressure) / np.asarray(table.conductivity(pressure, 1.0))
        totals.append(float(each[carry].sum()))
    return np.array(totals)
