"""Two different flange faces on one gasket: the seal leaks the mean of two that have one of them on both sides.

Each face carries the same force along the axis, which alone determines its contact: what a face does to the other one
through the gasket balances itself, and fades over the height of the gasket (Saint-Venant).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self

from fem_seal.answers.case_load import CaseLoad, Item
from fem_seal.seal.findings import EXACT, Bounds, Finding, Level, Validity
from fem_seal.seal.load_result import DiscretisationError

if TYPE_CHECKING:
    from leak import FlowError, LeakResult


def load_of_parts(parts: Sequence[CaseLoad]) -> CaseLoad:
    """A load of which each part is known; of one part itself.

    Parameters
    ----------
    parts : sequence of CaseLoad
    """
    if len(parts) == 1:
        return parts[0]
    values = {field.name: getattr(parts[0], field.name) for field in fields(CaseLoad)}
    return GasketLoad(**values).with_parts(parts)


def mean_rate(rates: Iterable[float]) -> float:
    """Leak rate of a seal from those of seals that have the contact of one of its parts alone [m^3/s].

    Parameters
    ----------
    rates : iterable of float
        [m^3/s]
    """
    values = [*rates]
    return sum(values) / len(values)


@dataclass(frozen=True, eq=False, repr=False)
class GasketLoad(CaseLoad):
    """A load of a gasket between two different flanges: it leaks through both faces, half of it as with each alone.

    All that is no leak rate is that of the upper one.

    Parameters
    ----------
    parts : tuple of CaseLoad
        The same load with the upper and with the lower flange on both faces.
    """

    parts: tuple[CaseLoad, ...] = ()

    def with_parts(self, parts: Sequence[CaseLoad]) -> Self:
        """The same load, of whose faces more is known.

        Parameters
        ----------
        parts : sequence of CaseLoad
            With the upper and with the lower flange.
        """
        upper, lower = parts
        load = self.with_values(parts=(upper, lower))
        margins = [face.opening for face in parts if face.opening is not None]
        opens = [face.blow_off_pressure for face in parts if face.blow_off_pressure is not None]
        scenarios: dict[str, CaseLoad] = {}
        for name, face in upper.scenarios.items():
            scenario, lower_face = self.scenarios.get(name), lower.scenarios.get(name)
            if lower_face is not None and isinstance(scenario, GasketLoad):
                scenarios[name] = scenario.with_parts((face, lower_face))
            elif lower_face is not None:
                scenarios[name] = load_of_parts((face, lower_face))
        return load.with_values(
            effective_radius=upper.effective_radius,
            blow_off_pressure=min(opens, default=None),
            opening=min(margins, key=lambda margin: margin.share, default=None),
            validity=_joined_validity(upper.validity, lower.validity, load.upper_share),
            mesh_error=_joined_error(upper.mesh_error, lower.mesh_error, load.upper_share),
            scenarios=scenarios,
        )

    def validity_by(self, check: Callable[[Item, CaseLoad], Validity], items: Sequence[Item]) -> Validity:
        """That of both faces, each off by its own share of the leak."""
        upper, lower = map(check, items, self.parts)
        return _joined_validity(upper, lower, self.upper_share)

    @property
    def named_bodies(self) -> dict[str, tuple[int, str]]:
        """Those of the lower flange and its half of the gasket have "lower " before their names."""
        faces = enumerate(("", "lower "))
        return {f"{face}{name}": (number, name) for number, face in faces for name in ("closure", "seat")}

    def upper_share(self) -> float:
        """Share of the upper face in the leak; a half without a leak rate."""
        upper, lower = (face.leak for face in self.parts)
        return 0.5 if upper is None or lower is None else share_of(upper, lower)

    @cached_property
    def leak(self) -> LeakResult | None:
        """The mean of both faces, where it flows that of the upper one; None without roughness or fluid."""
        upper, lower = (face.leak for face in self.parts)
        return None if upper is None or lower is None else mean_leak(upper, lower)

    @cached_property
    def leak_before_sealing(self) -> float:
        """What leaks at most where the percolation threshold decides, in the mean of both faces [m^3/s]."""
        return mean_rate(face.leak_before_sealing for face in self.parts)

    @cached_property
    def unsealed_rates(self) -> tuple[float, float]:
        """What flows through open bore and rough gap, in the mean of both faces [m^3/s]."""
        bore, gap = map(mean_rate, zip(*(face.unsealed_rates for face in self.parts), strict=True))
        return bore, gap

    @cached_property
    def flow_error(self) -> FlowError | None:
        """That of the face that decides."""
        return self.parts[0 if self.upper_share() >= 0.5 else 1].flow_error


def mean_leak(first: LeakResult, second: LeakResult) -> LeakResult:
    """Leak of a gasket, half of it as in one result and half as in another; where it flows is told by the first.

    Parameters
    ----------
    first, second : LeakResult
    """
    rate = mean_rate((first.leak_rate, second.leak_rate))
    if 0.0 < first.leak_rate < math.inf or rate == first.leak_rate:
        return first.scaled(rate)
    # one is sealed or the other open: where it flows is not scaled
    return replace(second.scaled(rate), fluid_pressure=first.fluid_pressure, lands=first.lands)


def share_of(first: LeakResult, second: LeakResult) -> float:
    """Share of one result in the leak of both; a half where both are sealed or open.

    Parameters
    ----------
    first, second : LeakResult
    """
    if first.leak_rate == second.leak_rate:
        return 0.5
    # an open one has all of it
    return 1.0 / (1.0 + second.leak_rate / first.leak_rate) if first.leak_rate > 0.0 else 0.0


def _joined_validity(upper: Validity, lower: Validity, share: Callable[[], float]) -> Validity:
    """Cautions in the words of the face for which they are worse; each face is off by its own share of the leak.

    Parameters
    ----------
    upper, lower : Validity
    share : callable
        Gives the share of the upper face in the leak, where it is needed.
    """
    return Validity.of(_join_cautions(upper, lower, share)) if upper.cautions or lower.cautions else upper


def _join_cautions(upper: Validity, lower: Validity, share: Callable[[], float]) -> Iterator[Finding]:
    share_of_upper = share()
    for kind in dict.fromkeys(caution.kind for caution in (*upper.cautions, *lower.cautions)):
        alike = [Validity.of(x for x in face.cautions if x.kind == kind) for face in (upper, lower)]
        factor = [
            share_of_upper * first + (1.0 - share_of_upper) * second
            for first, second in zip(*(face.leak_factor for face in alike), strict=True)
        ]
        worst, *others = max(alike, key=_how_bad).cautions
        yield replace(worst, leak_factor=Bounds(*factor))
        yield from (replace(caution, leak_factor=EXACT) for caution in others)


def _how_bad(face: Validity) -> tuple[int, float]:
    return list(Level).index(face.level) if face.cautions else -1, face.leak_error


def _joined_error(
    upper: DiscretisationError | None, lower: DiscretisationError | None, share: Callable[[], float]
) -> DiscretisationError | None:
    """Of two different faces, of which the upper one has a share in the leak."""
    if upper is None or lower is None:
        return upper or lower
    peak, fwhm, std = (
        max(getattr(upper, key), getattr(lower, key)) for key in ("peak_pressure", "fwhm", "std")
    )
    rate = upper.leak_rate
    if rate is not None and lower.leak_rate is not None:
        rate = share() * rate + (1.0 - share()) * lower.leak_rate
    return DiscretisationError(peak, fwhm, std, rate)
