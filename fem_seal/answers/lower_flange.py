"""Two different flange faces on one gasket: the seal leaks the mean of two that have one of them on both sides.

Each face carries the same force along the axis, which alone determines its contact: what a face does to the other one
through the gasket balances itself, and fades over the height of the gasket (Saint-Venant).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from fem_seal.answers.answer import Answer, Inquiry
from fem_seal.seal.bounds import EXACT, Bounds
from fem_seal.seal.findings import Finding, Level, Validity
from fem_seal.seal.load_result import DiscretisationError, LoadResult, SolvedSeal
from leak import LeakResult, Reading


def _compute(seal: SolvedSeal, ask: Inquiry) -> SolvedSeal:
    assert ask.solve is not None and seal.case.lower_half is not None  # of `applies`
    ask.clock.progress("the lower flange on both faces of the gasket")
    return ask.solve(seal.case.lower_half)


# A solution with answers and warnings of its own.
LOWER_FLANGE = Answer[Any](
    "lower_flange",
    "contact of the lower flange",
    _compute,
    None,
    lambda seal, wanted: seal.case.lower_half is not None,
)


def mean_leak(one: LeakResult, other: LeakResult) -> LeakResult:
    """Leak of a gasket, half of it as in one result and half as in another; where it flows is told by the first.

    Parameters
    ----------
    one, other : LeakResult
    """
    rate = 0.5 * (one.leak_rate + other.leak_rate)
    if 0.0 < one.leak_rate < math.inf or rate == one.leak_rate:
        return one.scaled(rate)
    # one is sealed or the other open: where it flows is not scaled
    shares = other.scaled(rate)
    return replace(shares, fluid_pressure=one.fluid_pressure, lands=one.lands)


def share_of(one: LeakResult, other: LeakResult) -> float:
    """Share of one result in the leak of both; a half where both are sealed or open.

    Parameters
    ----------
    one, other : LeakResult
    """
    if one.leak_rate == other.leak_rate:
        return 0.5
    # an open one has all of it
    return 1.0 / (1.0 + other.leak_rate / one.leak_rate) if one.leak_rate > 0.0 else 0.0


def of_both_faces(upper: LoadResult, lower: LoadResult | None) -> LoadResult:
    """A load of a gasket between two different flange faces; without a leak rate where one of them is not known.

    Parameters
    ----------
    upper : LoadResult
        With the upper flange on both faces.
    lower : LoadResult or None
        The same with the lower one.
    """
    both = _in_one_reading(upper, lower)
    if lower is None or both.leak is None:
        return both
    readings = dict.fromkeys((*upper.readings, Reading.ELASTIC))
    return both.with_readings(
        {
            reading: _in_one_reading(load, lower.reading(reading))
            for reading in readings
            if (load := upper.reading(reading)) is not upper
        }
    )


def _in_one_reading(upper: LoadResult, lower: LoadResult | None) -> LoadResult:
    if lower is None or upper.leak is None or lower.leak is None:
        return upper.with_values(leak=None, by_theory=None)
    theories = {
        theory: of_both_faces(load, (lower.by_theory or {}).get(theory))
        for theory, load in (upper.by_theory or {}).items()
    }
    known: dict[str, object] = {
        name: of_both_faces(other, getattr(lower, name))
        for name in ("with_test_gas", "first_loading")
        if (other := getattr(upper, name)) is not upper
    }
    share = share_of(upper.leak, lower.leak)
    return upper.with_values(
        leak=mean_leak(upper.leak, lower.leak),
        of_faces=(upper, lower),
        by_theory=theories,
        validity=Validity.of(_of_both(upper.validity, lower.validity, share)),
        mesh_error=_mesh_error(upper.mesh_error, lower.mesh_error, share),
        # that of the face that decides
        flow_error=(upper if share >= 0.5 else lower).flow_error,
        at_preload_ends=_mean(upper.at_preload_ends, lower.at_preload_ends),
        **known,
    )


def _mean(one: Bounds | None, other: Bounds | None) -> Bounds | None:
    if one is None or other is None:
        return None
    return Bounds.of(0.5 * (a + b) for a, b in zip(one, other, strict=True))


def _of_both(upper: Validity, lower: Validity, share: float) -> Iterator[Finding]:
    """Cautions in the words of the face for which they are worse; each face is off by its own share of the leak."""
    for kind in dict.fromkeys(one.kind for one in (*upper.cautions, *lower.cautions)):
        alike = [Validity.of(one for one in face.cautions if one.kind == kind) for face in (upper, lower)]
        factor = [
            share * above + (1.0 - share) * below
            for above, below in zip(*(face.leak_factor for face in alike), strict=True)
        ]
        worst, *others = max(alike, key=_how_bad).cautions
        yield replace(worst, leak_factor=Bounds(*factor))
        yield from (replace(one, leak_factor=EXACT) for one in others)


def _how_bad(face: Validity) -> tuple[int, float]:
    return list(Level).index(face.level) if face.cautions else -1, face.leak_error


def _mesh_error(
    upper: DiscretisationError | None, lower: DiscretisationError | None, share: float
) -> DiscretisationError | None:
    if upper is None or lower is None:
        return upper or lower
    peak, fwhm, std = (
        max(getattr(upper, key), getattr(lower, key)) for key in ("peak_pressure", "fwhm", "std")
    )
    rate = None
    if upper.leak_rate is not None and lower.leak_rate is not None:
        rate = share * upper.leak_rate + (1.0 - share) * lower.leak_rate
    return DiscretisationError(peak, fwhm, std, upper.leak_rate if rate is None else rate)


def _loads(seal: SolvedSeal, ask: Inquiry) -> tuple[LoadResult, ...]:
    lower = LOWER_FLANGE.of(ask.answers)
    # a path may come to the same load twice
    left = [] if lower is None else list(lower.loads)

    def taken(point: tuple[float, float]) -> LoadResult | None:
        found = next((one for one in left if one.point == point), None)
        return found and left.pop(left.index(found))

    return tuple(
        ask.steps.compute(
            "leak of both faces",
            partial(of_both_faces, load, taken(load.point)),
            load.with_values(leak=None, by_theory=None),
        )
        for load in seal.loads
    )


BOTH_FACES = Answer[tuple[LoadResult, ...]](
    "both_faces",
    "leak of both faces",
    _loads,
    (),
    lambda seal, wanted: seal.case.lower_half is not None,
    lambda load, number, found: found[number] if found else load,
)
