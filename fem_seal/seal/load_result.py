"""Results: a load with its contact and leak rate, and a seal with its solved loads."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Self, TypeVar

import numpy as np

from fem_seal.profile import PressureProfile, joined, tightest
from fem_seal.seal.both_faces import joined_validity, mean_leak, share_of
from fem_seal.seal.bounds import AGREE, EXACT, Bounds
from fem_seal.seal.findings import DIRECT_SCATTER, NEARLY_SEALED, SEALED, VALID, Finding, Level, Validity
from fem_seal.seal.lazy import ByReading, variant
from fem_seal.seal.leak_model import Conductivity, FlowModel, LeakModel
from fem_seal.units import DIGITS, digits_within, format_quantity, leak_range_text, quantity_worth, share_text
from leak import Reading

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem_seal.case.case import Case
    from fem_seal.contact.load_path import Imprint, Unloaded
    from fem_seal.contact.model import ContactModel
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.errors import LoadProblem
    from fem_seal.seal.circumference import Circumference
    from fem_seal.seal.problem import SealProblem
    from leak import FlowError, LeakResult, RoughContact
    from meshes import SealMesh


_NINE_OF_TEN = 0.05, 0.95


@dataclass(frozen=True, eq=False)
class LoadResult(ByReading):
    """One load of a case, which works out what it is asked for.

    Parameters
    ----------
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    applied_force : float
        Force of spring or actuator on the closure [N], positive where it closes.
    contact : ContactSolution
    rough : LeakModel or None
        Surfaces and fluid; None without roughness.
    formed : Circumference or None
        Line load around the axis, of which `contact` carries the mean; None for a round seal.
    effective_radius : float or None
        Radius of the circle whose area times the fluid pressure is the fluid's force on the closure [m]; None unless
        the fluid gets between the surfaces.
    blow_off_pressure : float or None
        Fluid pressure that lifts the closure off at this applied force [Pa], infinite if none does; None if not asked.
    force_for_target : float or None
        Smallest applied force for which the leak rate stays below the target [N]; None if not asked or not found.
    contact_force_for_target : float or None
        Contact force F_N with it [N].
    preload_for_target : float or None
        Preload of all bolts with it [N]; None without bolts.
    validity : Validity
        How far the numbers can be trusted, and why no further; see guide/validity in the manual.
    target_validity : Validity or None
        The same of `force_for_target`; None without it.
    opening : OpeningMargin or None
        How far the load is from opening the seal; None where neither fluid nor spring opens it, or it is not known.
    mesh_error : DiscretisationError or None
        What the mesh leaves uncertain; None where nobody asked.
    sampled : Bounds or None
        Ends of the samples of uncertain inputs, in all readings and with the theory's own error [m^3/s]; None where
        none is sampled.
    sampled_in_test : Bounds or None
        The same with the gas of the standards' tests, see `in_test` [m^3/s].
    leak_rate_p50 : float or None
        Median of the samples in the case's own reading, with the theory's own error [m^3/s]; None where none is
        sampled.
    tested : bool
        Whether the samples are those that a leak test has left; the inputs as given are then none of them.
    by_theory : mapping or None
        The load by theories of the rough contact that it is not calculated with; None where nobody asked.
    at_preload_ends : Bounds or None
        Leak rate with the least and the largest preload of its bolts [m^3/s]; None where the preload is taken as given.
    of_faces : tuple of LoadResult or None
        The same load with the upper and with the lower flange on both faces of a gasket, of which the leak rate is the
        mean; None where the flanges are alike. All that is no leak rate is that of the upper one.
    """

    fluid_pressure: float
    applied_force: float
    contact: ContactSolution
    rough: LeakModel | None = None
    formed: Circumference | None = None
    effective_radius: float | None = None
    blow_off_pressure: float | None = None
    force_for_target: float | None = None
    contact_force_for_target: float | None = None
    preload_for_target: float | None = None
    validity: Validity = VALID
    target_validity: Validity | None = None
    opening: OpeningMargin | None = None
    mesh_error: DiscretisationError | None = None
    sampled: Bounds | None = None
    sampled_in_test: Bounds | None = None
    leak_rate_p50: float | None = None
    tested: bool = False
    by_theory: Mapping[str, LoadResult] | None = None
    at_preload_ends: Bounds | None = None
    of_faces: tuple[LoadResult, LoadResult] | None = None

    def beside(self, lower: LoadResult) -> Self:
        """The load of a gasket with this face above and another one below, with what is known of each.

        Parameters
        ----------
        lower : LoadResult
            The same load with the lower flange on both faces.
        """
        return replace(self, by_theory=None).with_faces(self, lower)

    def with_faces(self, upper: LoadResult, lower: LoadResult) -> Self:
        """`beside` with all that is known of the whole seal already."""
        found = self.with_values(of_faces=(upper, lower))
        margins = [one.opening for one in (upper, lower) if one.opening is not None]
        opens = [one.blow_off_pressure for one in (upper, lower) if one.blow_off_pressure is not None]
        theories, below = upper.by_theory, lower.by_theory or {}
        return found.with_values(
            effective_radius=upper.effective_radius,
            blow_off_pressure=min(opens, default=None),
            opening=min(margins, key=lambda one: one.share, default=None),
            validity=joined_validity(upper.validity, lower.validity, found.upper_share),
            mesh_error=_joined_error(upper.mesh_error, lower.mesh_error, found.upper_share),
            by_theory=theories
            and {key: one.beside(below[key]) for key, one in theories.items() if key in below},
        )

    def upper_share(self) -> float:
        """Share of the upper of two different faces in the leak; a half without a leak rate."""
        leaks = [None if self.leak is None else one.leak for one in self.of_faces or ()]
        upper, lower = leaks or (None, None)
        return 0.5 if upper is None or lower is None else share_of(upper, lower)

    @property
    def each_face(self) -> tuple[tuple[str, LoadResult], ...]:
        """The load with each of two different faces, with what names of bodies of the lower one begin with."""
        return tuple(zip(("", "lower "), self.of_faces or (self,), strict=False))

    def _faces_as(self, change: Callable[[LoadResult], LoadResult]) -> tuple[LoadResult, LoadResult] | None:
        """Both faces changed; the very same where neither is."""
        if self.of_faces is None:
            return None
        upper, lower = map(change, self.of_faces)
        return self.of_faces if (upper, lower) == self.of_faces else (upper, lower)

    def __repr__(self) -> str:
        pressure = format_quantity("fluid pressure", self.fluid_pressure)
        force = format_quantity("force", self.applied_force)
        return f"<LoadResult at {pressure}, {force} applied: {self.in_brief}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the same, a line for each number."""
        load, _, numbers = escape(repr(self)[1:-1]).partition(": ")
        return f"<p><b>{load}</b><br>{numbers.replace(', ', '<br>')}</p>"

    @property
    def in_brief(self) -> str:
        """Peak pressure, width, leak rate and validity in a line, with units and no more digits than they are worth."""
        parts = [
            f"peak {quantity_worth('contact pressure', self.peak_pressure, self.pressure_digits)}",
            f"FWHM {quantity_worth('length', self.fwhm, self.digits_of('fwhm'))}",
        ]
        # a line is not worth working the leak rate out
        leak: LeakResult | None = vars(self).get("leak")
        if leak is not None:
            known = all("leak" in vars(one) for one in self.others.values()) and self.has_interval
            told = self.leak_interval if known and self.leak_interval is not None else leak.leak_rate
            claimed = not self.validity.outside
            parts.append(f"leak rate {leak_range_text(told, self.leak_digits, claimed=claimed)}")
        return ", ".join([*parts, str(self.validity.level)])

    @property
    def digits(self) -> int:
        """Significant digits that numbers which follow from the contact force are worth, four at most."""
        return DIGITS if self.opening is None else self.opening.digits

    def digits_of(self, name: str) -> int:
        """Significant digits that known errors leave of one of its numbers, four at most: the mesh's and the theory's.

        Parameters
        ----------
        name : {"peak_pressure", "fwhm", "std", "leak_rate", "force_for_target"}
            Stresses in the bodies are as good as the peak pressure.
        """
        of_theory = {"leak_rate": self.validity, "force_for_target": self.target_validity}.get(name)
        theory = DIGITS if of_theory is None else digits_within(of_theory.leak_error)
        # a leak rate off by orders of magnitude leaves more of the force, which stands beside its line load
        least = 3 if name == "force_for_target" else 1
        if self.mesh_error is None:
            return max(theory, least)
        # where the strongest load is sealed, nothing is known of what the others leak but the contact that it follows
        known = getattr(self.mesh_error, "leak_rate" if name == "force_for_target" else name)
        share = max(self.mesh_error.peak_pressure, self.mesh_error.std) if known is None else known
        return max(min(theory, digits_within(share)), least)

    @property
    def leak_validity(self) -> Validity:
        """The validity with what the mesh leaves uncertain of the leak rate: what its interval may be off by."""
        # the interval holds what a simulation leaves open
        known = list(self.validity.without(DIRECT_SCATTER).cautions)
        share = None if self.mesh_error is None else self.mesh_error.leak_rate
        if share is not None and share > 0.0:
            told = f"the mesh leaves an error of {share_text(share)}"
            known.append(Finding("mesh", Level.VALID, told, told, Bounds.factor_bounds(1.0 + share)))
        if self.theory_error != EXACT and self.sampled is None:  # or the samples have it
            low, high = self.theory_error
            told = f"direct simulation of rough surfaces finds {low:.2f} to {high:.2f} times as much"
            known.append(Finding("theory", Level.VALID, told, told, self.theory_error))
        return Validity.of(known)

    @property
    def theory_error(self) -> Bounds:
        """Factors on the leak rate between which direct simulation finds it in nine of ten seals, see `flow_error`."""
        # what is told lies between its ends
        return EXACT if self.flow_error is None else Bounds.of([1.0, *self.flow_error.factor(_NINE_OF_TEN)])

    @cached_property
    def flow_error(self) -> FlowError | None:
        """Distribution of what direct simulation finds over the leak rate.

        By `RoughContact.flow_error` at the peak pressure, with the waves of the sealing area; None where the
        conductivity is itself simulated, and for the paper's theory, which does not know its error.
        """
        if self.of_faces is not None:
            # that of the face that decides
            return self.of_faces[0 if self.upper_share() >= 0.5 else 1].flow_error
        surface = None if self.rough is None or self.rough.ends else self.rough.surface
        if surface is None or surface.theory == "paper" or not self.peak_pressure > 0.0:
            return None
        # a lay stretches waves one way and shortens them as much the other
        wavelength = 2.0 * math.pi / surface.spectrum.median_wavenumber
        profile = self.tightest
        around = 2.0 * math.pi * float(np.interp(profile.centroid, profile.x, profile.radius))
        return surface.flow_error(self.peak_pressure, waves=self.fwhm * around / wavelength**2)

    def in_theory(self, theory: str) -> LoadResult | None:
        """The load by a theory of the rough contact, on its own contact; None where it is not known.

        Parameters
        ----------
        theory : {"paper", "corrected"}
        """
        if theory in (self.by_theory or {}):
            return self.by_theory[theory]  # type: ignore[index]
        # a simulated flow is neither
        own = self.rough is not None and not self.rough.ends and self.rough.surface.theory == theory
        return self if own else None

    @property
    def pressure_digits(self) -> int:
        """Significant digits of contact pressures and stresses: what errors and the distance from opening leave."""
        return min(self.digits, self.digits_of("peak_pressure"))

    @property
    def leak_digits(self) -> int:
        """The same of leak rates."""
        return min(self.digits, self.digits_of("leak_rate"))

    @property
    def of_profile(self) -> bool:
        """Whether its contact is a given pressure profile, of whose bodies and their forces nothing is known."""
        return isinstance(self.contact, GivenContact)

    @property
    def contacts(self) -> tuple[ContactSolution, ...]:
        """The contact at the mean line load and, of a seal that is not round, at the largest."""
        return (self.contact,) if self.formed is None else (self.contact, *self.formed.extremes)

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and force of spring or actuator [N]."""
        return self.fluid_pressure, self.applied_force

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Nominal pressure profile on each contact line, from the axis outwards."""
        return self.contact.profiles

    @property
    def whole(self) -> PressureProfile:
        """All of the contact as one profile, with its lands."""
        return joined(self.profiles)

    @property
    def tightest(self) -> PressureProfile:
        """The profile on the line that is pressed hardest."""
        return self.contact.profile

    @property
    def peak_pressure(self) -> float:
        """Highest contact pressure [Pa]."""
        return self.tightest.peak_pressure

    @property
    def fwhm(self) -> float:
        """Full width at half maximum on that line [m]."""
        return self.tightest.fwhm

    @property
    def std(self) -> float:
        """Square root of the second central moment of the pressure on that line [m]."""
        return self.tightest.std

    @property
    def contact_force(self) -> float:
        """Force F_N that the solid contact carries [N]."""
        return self.contact.contact_force

    @property
    def stop_force(self) -> float | None:
        """What goes past the gasket through its stop [N]; None without a stop."""
        return None if self.of_profile or math.isinf(self.contact.model.stop) else self.contact.stop_force

    @property
    def line_load(self) -> float:
        """f_N [N/m]."""
        return self.contact.line_load

    @cached_property
    def leak(self) -> LeakResult | None:
        """Flow through the contact, with its form error; None without roughness or fluid.

        Through different faces the mean of both, where it flows that of the upper one.
        """
        if self.of_faces is not None:
            upper, lower = (one.leak for one in self.of_faces)
            return None if upper is None or lower is None else mean_leak(upper, lower)
        if self.formed is None:
            return self.leak_round
        return None if self.around is None else self.around.leak

    @cached_property
    def leak_round(self) -> LeakResult | None:
        """The same of the round seal."""
        return None if self.rough is None else self.rough.leak(self.whole, self.fluid_pressure)

    @cached_property
    def around(self) -> Circumference | None:
        """Line load, pressure and leak around the axis; None for a round seal."""
        formed = self.formed
        flow = None if self.rough is None else self.rough.at(self.fluid_pressure)
        if formed is None or flow is None:
            return formed
        from fem_seal.seal.circumference import LeakCurve

        return formed.with_leak(LeakCurve(formed.local, flow))

    def _read_as(self, reading: Reading) -> Self:
        rough = None if self.rough is None else self.rough.reading(reading)
        faces = self._faces_as(lambda one: one.reading(reading))
        if rough is self.rough and faces is self.of_faces:
            return self
        return replace(
            self,
            rough=rough,
            of_faces=faces,
            force_for_target=None,
            contact_force_for_target=None,
            preload_for_target=None,
            target_validity=None,
        )

    @property
    def readings(self) -> Mapping[Reading, Self]:
        """The same contact in each reading of its yielding asperities, or in the only one; the default first."""
        known = (Reading.ELASTIC,) if self.rough is None else self.rough.readings
        return {one: self.reading(one) for one in known}

    @property
    def others(self) -> Mapping[Reading, Self]:
        """`readings` but the one of the load itself."""
        return {reading: load for reading, load in self.readings.items() if load is not self}

    @property
    def yields(self) -> bool:
        """Whether asperities yield by a theory that reads this in several ways."""
        return len(self.readings) > 1

    @variant
    def first_loading(self) -> Self:
        """The same load if no place had carried more before; itself where none is known to have."""
        contact = self.contact if self.of_profile else self.contact.first_loading
        formed = None if self.formed is None else self.formed.first_loading
        faces = self._faces_as(lambda one: one.first_loading)
        same = contact is self.contact and faces is self.of_faces
        return self if same else replace(self, contact=contact, formed=formed, of_faces=faces)

    @property
    def remembers(self) -> bool:
        """Whether a place that carries the load has carried more before."""
        return any(
            bool((one.largest > AGREE * np.maximum(one.pressure, 0.01 * one.pressure.max())).any())
            for one in self.contacts
            if one.largest is not None
        )

    @property
    def leak_range(self) -> Bounds | None:
        """Leak rates of all readings of yielding asperities [m^3/s]; None where there is but one reading.

        With a direct simulation instead of the theory the ends of its interval.
        """
        read = self.readings.values() if self.yields else self._simulated_ends
        leaks = [one.leak for one in read]
        return Bounds.of(leak.leak_rate for leak in leaks if leak) if leaks and all(leaks) else None

    @cached_property
    def _simulated_ends(self) -> tuple[Self, ...]:
        return () if self.rough is None else tuple(replace(self, rough=end) for end in self.rough.ends)

    @cached_property
    def rougher(self) -> float:
        """What the gaps of the roughest samples let through over that of the surface as given, by h^3/eta [-]."""
        return 1.0

    @property
    def most_leak(self) -> float:
        """What physics lets through: the open bore, and the rough gap of a round seal without load [m^3/s]."""
        bore, gap = self.unsealed
        return min(bore, self.rougher * gap)

    @cached_property
    def unsealed(self) -> tuple[float, float]:
        """What flows through the open bore, and through the rough gap without load [m^3/s]; infinite if not known."""
        if self.of_faces is not None:
            upper, lower = (one.unsealed for one in self.of_faces)
            return 0.5 * (upper[0] + lower[0]), 0.5 * (upper[1] + lower[1])
        flow = None if self.rough is None else self.rough.flow
        if self.rough is None or flow is None:
            return math.inf, math.inf
        radius = min(float(one.radius.min()) for one in self.profiles)
        bore = flow.through_open_bore(self.fluid_pressure, radius)
        # what a form error leaves open is no rough gap
        round_seal = self.formed is None
        return bore, self.rough.leak_without_load(self.whole, self.fluid_pressure) if round_seal else math.inf

    @cached_property
    def leak_before_sealing(self) -> float:
        """What leaks at most where the percolation threshold decides [m^3/s]; zero where it does not."""
        if self.of_faces is not None:
            return 0.5 * sum(one.leak_before_sealing for one in self.of_faces)
        if self.rough is None or self.rough.ends or self.formed is not None:
            return 0.0
        return self.rough.leak_before_sealing(self.whole, self.fluid_pressure)

    @property
    def calculated_ends(self) -> Bounds | None:
        """`leak_interval` without what the calculation may be off by [m^3/s]."""
        if self.leak is None:
            return None
        known = [self.leak.leak_rate, *(self.leak_range or ()), *(self.sampled or ())]
        if self.tested and self.sampled is not None:
            known = [*self.sampled]
        return Bounds.of([*known, *(self.at_preload_ends or ())])

    @property
    def leak_interval(self) -> Bounds | None:
        """Ends of the leak rate, wherever they are told or judged [m^3/s]; None without a leak rate.

        They hold all readings of yielding asperities or what a simulation leaves open, the samples of uncertain
        inputs, the preload of bolts, and what the calculation may be off by (`leak_validity`), but no more than
        physics lets through (`most_leak`).
        """
        ends, doubts = self.calculated_ends, self.leak_validity
        if self.leak is None or ends is None:
            return None
        # the threshold is that of the surface as given: rougher samples are further from it, and leak no more by it
        near = [one.leak_factor.high for one in doubts.cautions if one.kind in (NEARLY_SEALED, SEALED)]
        by_threshold = self.leak_before_sealing if near else 0.0
        if near and not by_threshold and self.leak.leak_rate > 0.0:
            by_threshold = math.prod(near) * self.leak.leak_rate
        most = doubts.without(NEARLY_SEALED, SEALED).leak_factor.high
        found = Bounds(ends.low * doubts.leak_factor.low, max(ends.high, self.rougher * by_threshold) * most)
        # faces that are lifted off, as at the least preload, have no gap that bounds what passes
        if not found.apart or math.isinf(ends.high):
            return found
        limit = max(self.most_leak, self.leak.leak_rate)
        return Bounds(min(found.low, limit), min(found.high, limit))

    @property
    def has_interval(self) -> bool:
        """Whether the ends of `leak_interval` are told as two numbers, or made of what could be two."""
        ends = self.leak_interval
        made = any(one is not None for one in (self.leak_range, self.sampled, self.at_preload_ends))
        return ends is not None and (made or ends.apart)

    @property
    def in_test(self) -> Self:
        """The same contact with the gas that the standards test with; itself where that leaks, or a liquid."""
        found = self.with_test_gas
        if found is self:
            return self
        own, other, ends = self.leak, found.leak, self.at_preload_ends
        if own is not None and other is not None and ends is not None and own.leak_rate > 0.0:
            # let through as much more of it as at the preload that is meant
            ends = Bounds.of(one * other.leak_rate / own.leak_rate for one in ends)
        return found.with_values(
            at_preload_ends=ends,
            rougher=self.rougher,
            sampled=self.sampled_in_test,
            leak_rate_p50=None,
            tested=self.tested,
            validity=self.validity,
            mesh_error=self.mesh_error,
        )

    @variant
    def with_test_gas(self) -> Self:
        """`in_test` without what is known of its interval."""
        rough = None if self.rough is None else self.rough.in_test
        if rough is self.rough:
            return self
        return replace(self, rough=rough, of_faces=self._faces_as(lambda one: one.with_test_gas))

    @property
    def effective_viscosity(self) -> float | None:
        """Constant viscosity of a liquid that leaks as much [Pa s]; None without roughness, and for a gas."""
        flow = None if self.rough is None else self.rough.flow
        return None if flow is None else flow.effective_viscosity(self.fluid_pressure)

    @cached_property
    def critical_separation(self) -> float | None:
        """u_c at the peak pressure [m]; None without roughness."""
        return None if self.rough is None else self.rough.critical_separation(self.contact.profile)

    @cached_property
    def largest_stress(self) -> tuple[float, tuple[str, float, float]]:
        """`max_von_mises` and `max_von_mises_at`."""
        worst = max(self.contact.fields.values(), key=lambda field: float(field.von_mises.max()))
        node = int(np.argmax(worst.von_mises))
        r, z = worst.points[node].tolist()
        return float(worst.von_mises[node]), (worst.name, r, z)

    @property
    def max_von_mises(self) -> float:
        """Largest von Mises stress in both bodies [Pa]."""
        return self.largest_stress[0]

    @property
    def max_von_mises_at(self) -> tuple[str, float, float]:
        """Name of the body and place (r, z) [m] of `max_von_mises`."""
        return self.largest_stress[1]

    @property
    def contact_temperature(self) -> float | None:
        """Mean temperature of both faces where they press on each other [K]; None where it is not given."""
        contact = self.contact
        model = contact.model
        faces = [
            contact.loads.face_temperature(body, contact.pressure, model)
            for body in (model.closure, model.seat)
        ]
        known = [one for one in faces if one is not None]
        return sum(known) / 2 if len(known) == 2 else None

    @property
    def gap_pressure(self) -> NDArray[np.float64] | None:
        """Fluid pressure at the points of the contact line [Pa]; None where nothing is known of it."""
        return self.contact.loads.gap_pressure if self.leak_round is None else self.leak_round.fluid_pressure


def leak_rates(
    surface: RoughContact,
    flows: Sequence[FlowModel],
    loads: Sequence[LoadResult],
    alike: Sequence[LoadResult] = (),
    table: Callable[[FlowModel, RoughContact, Sequence[float]], Conductivity] | None = None,
) -> list[tuple[float, ...]]:
    """Leak rate of each load with another surface or flow on the same contact, for each of the flows [m^3/s].

    Parameters
    ----------
    surface : RoughContact
    flows : sequence of FlowModel
        Of different fluids, of which the conductivity is the same.
    loads : sequence of LoadResult
    alike : sequence of LoadResult
        Other loads over whose pressures the conductivity is tabulated as well.
    table : callable, optional
        Conductivity of a flow and a surface, over peak pressures given as decimal logarithms.
    """
    shown = [contact for load in (*alike, *loads) for contact in load.contacts]
    first = LeakModel.of(surface, flows[0], shown, table)
    assert first is not None  # there is a surface
    found = []
    for flow in flows:
        rough = replace(first, flow=flow)
        leaks = [replace(load, rough=rough).leak for load in loads]
        found.append(tuple(math.nan if leak is None else leak.leak_rate for leak in leaks))
    return found


def rate_of(load: LoadResult) -> float | Bounds:
    """The leak rate of a load as it is told: its interval, or the only number; NaN without one [m^3/s].

    Parameters
    ----------
    load : LoadResult
    """
    ends = load.leak_interval
    if load.leak is None or ends is None:
        return math.nan
    return ends if ends.apart else load.leak.leak_rate


def by_face(loads: Iterable[LoadResult]) -> list[tuple[LoadResult, ...]]:
    """Loads with each of two different faces; of alike ones the loads themselves.

    Parameters
    ----------
    loads : iterable of LoadResult
    """
    return list(zip(*(load.of_faces or (load,) for load in loads), strict=True))


def strongest_load(loads: Sequence[LoadResult]) -> int:
    """Number of the load with the largest closing force F_N."""
    return max(range(len(loads)), key=lambda n: loads[n].line_load)


def highest_load(loads: Sequence[AnyLoad]) -> int:
    """Number of the load with the highest fluid pressure; of several, the one that spring or actuator closes most."""
    return max(range(len(loads)), key=lambda n: loads[n].point)


@dataclass(frozen=True, eq=False)
class GivenContact:
    """A contact of which nothing but the pressure profile is known.

    Parameters
    ----------
    whole : PressureProfile
        With its lands.
    """

    whole: PressureProfile
    largest = None

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Of each land, from the axis outwards."""
        return self.whole.lands

    @property
    def profile(self) -> PressureProfile:
        """Of the land that is pressed hardest."""
        return tightest(self.profiles)

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Contact pressure [Pa]."""
        return self.whole.pressure

    @property
    def line_load(self) -> float:
        """Int p dx [N/m]."""
        return self.whole.moment(0)


@dataclass(frozen=True, eq=False, repr=False)
class GivenLoad(LoadResult):
    """The leak of a given pressure profile: of its bodies and their forces nothing is known."""

    contact: GivenContact  # type: ignore[assignment]


@dataclass(frozen=True)
class DiscretisationError:
    """Estimated error of the load with the largest closing force, from the same solve on elements twice as large.

    A third of the difference: what the finer solution's error would be if it fell with the second power of the
    element size. It falls with the fourth, so that this is an upper estimate. Where a body yields, the load steps are
    twice as large, too, and it is the whole difference: their error falls with the first power of their size.

    Parameters
    ----------
    peak_pressure, fwhm, std : float
        Relative.
    leak_rate : float or None
        Relative.
    """

    peak_pressure: float
    fwhm: float
    std: float
    leak_rate: float | None


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


@dataclass(frozen=True)
class OpeningMargin:
    """Distance of a load from opening the seal.

    Parameters
    ----------
    force : float
        By which the force of spring or actuator may fall at this fluid pressure before the seal opens [N].
    pressure : float
        By which the fluid pressure may change under this force: rise where it lifts the closure, fall where it holds
        it against the spring [Pa].
    share : float
        Either of them over what acts; the same number, as force and pressure that open the seal are in proportion.
    """

    force: float
    pressure: float
    share: float

    @property
    def digits(self) -> int:
        """Significant digits that what the solid contact carries is worth, see `digits_near_opening`."""
        return digits_near_opening(self.share)


def digits_near_opening(share: float) -> int:
    """Significant digits that what the solid contact carries is worth, four at most.

    It is the difference of spring and fluid: their relative errors count 1/share times, and each factor of ten costs a
    digit.

    Parameters
    ----------
    share : float
        See `OpeningMargin.share`.
    """
    return min(max(DIGITS + round(math.log10(share)), 1), DIGITS) if share > 0 else 1


@dataclass(frozen=True)
class MissingLoad:
    """A load of a case that could not be calculated.

    Parameters
    ----------
    number : int
        Among all loads of the case.
    fluid_pressure : float
        [Pa]
    applied_force : float
        Of spring or actuator, with bolts their preload [N].
    problem : LoadProblem
        Why.
    bolted : bool
        Whether the force is a preload.
    """

    number: int
    fluid_pressure: float
    applied_force: float
    problem: LoadProblem
    bolted: bool = False

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and applied force [N]."""
        return self.fluid_pressure, self.applied_force

    @property
    def given(self) -> dict[str, float]:
        """What is known of it, by the names of columns."""
        force = "bolt_preload_N" if self.bolted else "applied_force_N"
        return {"fluid_pressure_Pa": self.fluid_pressure, force: self.applied_force}


AnyLoad = LoadResult | MissingLoad
Row = TypeVar("Row")


def in_order(
    of_loads: Iterable[Row], missing: Iterable[MissingLoad], row: Callable[[MissingLoad], Row]
) -> list[Row]:
    """One entry per load of a case: those of the loads that were calculated, and those of the others between them.

    Parameters
    ----------
    of_loads : iterable
    missing : iterable of MissingLoad
        In their order.
    row : callable
        The entry of a load that could not be calculated.
    """
    rows = list(of_loads)
    for one in missing:
        rows.insert(one.number, row(one))
    return rows


@dataclass(frozen=True)
class SolvedSeal:
    """A case, its bodies on their mesh and its loads.

    Parameters
    ----------
    case : Case
        Without the loads that could not be calculated.
    problem : SealProblem
        The same as the calculation knows it.
    seal_mesh : SealMesh
    model : ContactModel
    loads : tuple of LoadResult
        In the order of the case.
    unloaded : Unloaded or None
        Residual stress and imprint after the last load; None if all bodies are elastic.
    earlier : ContactSolution or None
        At the largest load before those of the case; None without one.
    not_calculated : tuple of MissingLoad
        The other loads of the case.
    said_of_missing : tuple of Finding
        Why, in words.
    lower_half : SolvedSeal or None
        With the lower flange on both faces of a gasket; None where the flanges are alike.
    """

    case: Case
    problem: SealProblem = field(repr=False)
    seal_mesh: SealMesh
    model: ContactModel
    loads: tuple[LoadResult, ...]
    unloaded: Unloaded | None = None
    earlier: ContactSolution | None = None
    not_calculated: tuple[MissingLoad, ...] = ()
    said_of_missing: tuple[Finding, ...] = ()
    lower_half: SolvedSeal | None = None

    @property
    def missing(self) -> dict[tuple[float, float], LoadProblem]:
        """Fluid pressure [Pa] and applied force [N] of each load without a result, with the reason."""
        return {one.point: one.problem for one in self.not_calculated}

    @property
    def every_load(self) -> list[AnyLoad]:
        """The loads of the case in its order, with those that could not be calculated."""
        return in_order([*self.loads], self.not_calculated, lambda one: one)

    @property
    def faces(self) -> tuple[SolvedSeal, ...]:
        """The seal with each of two different flanges on both faces; only itself where they are alike."""
        if self.lower_half is None:
            return (self,)
        upper, lower = by_face(self.loads)
        known = {field.name: getattr(self, field.name) for field in fields(SolvedSeal)}
        return (
            SolvedSeal(**{**known, "loads": upper, "lower_half": None}),
            replace(self.lower_half, loads=lower),
        )

    @property
    def imprints(self) -> dict[str, Imprint]:
        """Lasting imprints by body; "lower closure" and "lower seat" are another lower flange and its half."""
        faces = zip(("", "lower "), (self, self.lower_half), strict=True)
        known = [(face, one.unloaded) for face, one in faces if one is not None and one.unloaded is not None]
        return {f"{face}{name}": imprint for face, one in known for name, imprint in one.imprints.items()}

    def with_faces(self, upper: SolvedSeal, lower: SolvedSeal) -> Self:
        """The same seal, of whose two faces more is known.

        Parameters
        ----------
        upper, lower : SolvedSeal
            Its `faces`.
        """
        each = zip(self.loads, upper.loads, lower.loads, strict=True)
        return replace(self, loads=tuple(load.with_faces(*faces) for load, *faces in each), lower_half=lower)

    def with_loads(self, loads: Sequence[LoadResult]) -> Self:
        """The same seal, whose loads know more."""
        return replace(self, loads=tuple(loads))

    @property
    def of_profile(self) -> bool:
        """Whether its contacts are given pressure profiles; it has no mesh and no model then."""
        return self.loads[0].of_profile

    @property
    def surface(self) -> RoughContact | None:
        """With the hardness if asperities yield; None without roughness."""
        return self.problem.surface

    @property
    def strongest(self) -> LoadResult:
        """The load with the largest closing force; for it error, far field and interface laws are compared."""
        return self.loads[strongest_load(self.loads)]

    @property
    def highest(self) -> LoadResult:
        """The load with the highest fluid pressure, which headline, report and terminal explain."""
        return self.loads[highest_load(self.loads)]

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Pressure profile of each load."""
        return tuple(load.contact.profile for load in self.loads)

    @property
    def contact(self) -> tuple[ContactSolution, ...]:
        """Contact solution of each load."""
        return tuple(load.contact for load in self.loads)

    @property
    def leak_ranges(self) -> tuple[tuple[float, float] | None, ...]:
        """`LoadResult.leak_interval` of each load [m^3/s]; None where nothing makes one."""
        return tuple(load.leak_interval if load.has_interval else None for load in self.loads)
