"""Loads of a case: the nominal scenario, the scenarios beside it, and what answers found about them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from html import escape
from typing import TYPE_CHECKING, Self, TypeVar

import numpy as np

from fem_seal.answers.judgement import BoltState, LoadVerdict, PassProbability, Verdict, VerdictForce
from fem_seal.seal.findings import (
    AGREE,
    DIRECT_SCATTER,
    EXACT,
    NEARLY_SEALED,
    SEALED,
    VALID,
    Bounds,
    Finding,
    Level,
    Validity,
)
from fem_seal.seal.load_result import LoadResult, MissingLoad, highest_load, in_order, strongest_load
from fem_seal.seal.scenarios import SCENARIOS, alternatives_on_contact, names
from fem_seal.units import DIGITS, Display, digits_within
from fem_seal.wording import Quantity, Words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem_seal.case.case import Case
    from fem_seal.contact.load_path import Imprint, UnloadedBodies
    from fem_seal.contact.model import ContactModel
    from fem_seal.contact.solution import ContactSolution, PlasticZone, YieldedZone
    from fem_seal.errors import Problem
    from fem_seal.profile import PressureProfile
    from fem_seal.seal.evaluate import Evaluation
    from fem_seal.seal.leak_model import LeakModel
    from fem_seal.seal.problem import SealProblem
    from leak import FlowError, LeakResult
    from leak.flow.turned_contact import FaceContact
    from meshes import SealMesh


Item = TypeVar("Item", "SealProblem", "Evaluation")


@dataclass(frozen=True, eq=False, repr=False)
class CaseLoad(LoadResult):
    """A load of a case in its nominal scenario, the scenarios beside it, and what answers found.

    Parameters
    ----------
    scenarios : mapping
        The load in each scenario that stands beside, by its name.
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
    sample_ends : Bounds or None
        Ends of the samples of uncertain inputs, in all scenarios whose numbers are in the interval and with the
        theory's own error [m^3/s]; None where none is sampled.
    leak_rate_p50 : float or None
        Median of the samples in the nominal scenario, with the theory's own error [m^3/s]; None where none is sampled.
    after_test : bool
        Whether the samples are those that a leak test has left; the inputs as given are then none of them.
    rougher : float
        What the gaps of the roughest samples let through over that of the surface as given, by h^3/eta [-].
    at_preload_ends : Bounds or None
        Leak rate with the least and the largest preload of its bolts [m^3/s]; None where the preload is taken as given.
    judgement : LoadVerdict or None
        Whether it keeps what [requirement] asks of it; None where nothing is asked.
    verdict_force : VerdictForce or None
        The force at which the verdict passes; None if not asked.
    chance : PassProbability or None
        How likely it keeps that; None where nothing is asked.
    bolts : BoltState or None
        What each bolt carries; None without bolts.
    """

    scenarios: Mapping[str, CaseLoad] = field(default_factory=dict)
    effective_radius: float | None = None
    blow_off_pressure: float | None = None
    force_for_target: float | None = None
    contact_force_for_target: float | None = None
    preload_for_target: float | None = None
    validity: Validity = VALID
    target_validity: Validity | None = None
    sample_ends: Bounds | None = None
    leak_rate_p50: float | None = None
    after_test: bool = False
    rougher: float = 1.0
    at_preload_ends: Bounds | None = None
    judgement: LoadVerdict | None = None
    verdict_force: VerdictForce | None = None
    chance: PassProbability | None = None
    bolts: BoltState | None = None

    @classmethod
    def of(cls, load: LoadResult, scenarios: Mapping[str, CaseLoad] | None = None) -> CaseLoad:
        """A load with the scenarios beside it; what it has worked out already stays.

        Parameters
        ----------
        load : LoadResult
        scenarios : mapping, optional
        """
        case_load = object.__new__(cls)
        vars(case_load).update(vars(load), scenarios=scenarios or {})
        return case_load.with_values()

    def with_values(self, **values: object) -> Self:
        """See `LoadResult.with_values`; the interval follows from what a load knows, and is made anew.

        Parameters
        ----------
        values : object
        """
        load = super().with_values(**values)
        vars(load).pop("leak_interval" if "leak_interval" not in values else "", None)
        return load

    def scenario(self, name: str) -> CaseLoad | None:
        """The load in a scenario; itself where it is that one, None where it does not stand beside.

        Parameters
        ----------
        name : str
        """
        return self if name in self.names else self.scenarios.get(name)

    @property
    def names(self) -> tuple[str, ...]:
        """What its own scenario is called: by its surface, and by its theory unless it is simulated."""
        return names(None, None) if self.rough is None else names(self.rough.surface, self.rough.flow)

    def with_scenarios(self, scenarios: Mapping[str, CaseLoad]) -> Self:
        """A copy in which some scenarios are others, or stand beside as well.

        Parameters
        ----------
        scenarios : mapping
            By their names.
        """
        return self.with_values(scenarios={**self.scenarios, **scenarios})

    @property
    def others(self) -> dict[str, CaseLoad]:
        """Scenarios of which a number stands beside wherever that of the load is told."""
        return {name: load for name, load in self.scenarios.items() if SCENARIOS[name].condition}

    @property
    def _in_interval(self) -> list[CaseLoad]:
        """Itself and the scenarios of which the interval is made."""
        return [self, *(load for name, load in self.scenarios.items() if SCENARIOS[name].in_interval)]

    @property
    def leak_range(self) -> Bounds | None:
        """Ends of the leak rates of the scenarios in the interval and the load's own [m^3/s]; None without others."""
        leaks = [load.leak for load in self._in_interval]
        return Bounds.of(leak.leak_rate for leak in leaks if leak) if len(leaks) > 1 and all(leaks) else None

    def load_in_scenario(self, name: str) -> CaseLoad | None:
        """The load in a scenario on its contact, with what is known of the load itself; None where it is that one.

        Parameters
        ----------
        name : str
        """
        other, ends = self.scenarios.get(name), self.at_preload_ends
        if other is None:
            return None
        if (
            self.leak is not None
            and other.leak is not None
            and ends is not None
            and self.leak.leak_rate > 0.0
        ):
            # let through as much more as at the preload that is meant
            ends = Bounds.of(end * other.leak.leak_rate / self.leak.leak_rate for end in ends)
        return other.with_values(
            at_preload_ends=ends,
            rougher=self.rougher,
            after_test=self.after_test,
            validity=self.validity,
            mesh_error=self.mesh_error,
        )

    @property
    def parts(self) -> tuple[CaseLoad, ...]:
        """The load on each contact that is solved by itself and that leaks beside the others; of most seals itself."""
        return (self,)

    def with_parts(self, parts: Sequence[CaseLoad]) -> CaseLoad:
        """The same load, of whose parts more is known.

        Parameters
        ----------
        parts : sequence of CaseLoad
        """
        (load,) = parts
        return load

    def validity_by(self, check: Callable[[Item, CaseLoad], Validity], items: Sequence[Item]) -> Validity:
        """What a check says of it, given the problem or the evaluation of each of its parts.

        Parameters
        ----------
        check : callable
        items : sequence of SealProblem or Evaluation
        """
        (item,) = items
        return check(item, self)

    @property
    def named_bodies(self) -> dict[str, tuple[int, str]]:
        """By the name of each body the number of its part, and its name there."""
        return {name: (0, name) for name in ("closure", "seat")}

    @property
    def zones(self) -> dict[str, YieldedZone | PlasticZone | None]:
        """Where each body has yielded or, solved as elastic, exceeds its yield stress; None of one that does not."""
        # the check of a case loads no finite elements
        from fem_seal.contact.solution import yielding_of

        zones = [yielding_of(load.contact) for load in self.parts]
        return {name: zones[number].get(body) for name, (number, body) in self.named_bodies.items()}

    def __repr__(self) -> str:
        pressure = Quantity(self.fluid_pressure, "given fluid pressure")
        force = Quantity(self.applied_force, "given force")
        return f"<CaseLoad at {pressure}, {force} applied: {self.in_brief}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the same, a line for each number."""
        load, _, numbers = escape(repr(self)[1:-1]).partition(": ")
        return f"<p><b>{load}</b><br>{numbers.replace(', ', '<br>')}</p>"

    @property
    def in_brief(self) -> Words:
        """Peak pressure, width, leak rate and validity in a line, with units and no more digits than they are worth."""
        values: dict[str, object] = {
            "peak": Quantity(self.peak_pressure, f"worth contact pressure {self.pressure_digits}"),
            "width": Quantity(self.fwhm, f"worth length {self.digits_of('fwhm')}"),
            "level": self.validity.level,
        }
        leak_words = ""
        # a line is not worth working the leak rate out
        leak: LeakResult | None = vars(self).get("leak")
        if leak is not None:
            is_known = all("leak" in vars(load) for load in self.others.values()) and self.has_interval
            rate = self.leak_interval if is_known and self.leak_interval is not None else leak.leak_rate
            values |= {"rate": rate, "digits": self.leak_digits, "claimed": not self.validity.outside_theory}
            leak_words = "leak rate {{ display.leak_range(rate, digits, claimed=claimed) }}, "
        return Words(f"peak {{{{ peak }}}}, FWHM {{{{ width }}}}, {leak_words}{{{{ level }}}}", values)

    def digits_of(self, name: str) -> int:
        """Significant digits that known errors leave of one of its numbers, four at most: the mesh's and the theory's.

        Parameters
        ----------
        name : {"peak_pressure", "fwhm", "std", "leak_rate", "force_for_target"}
            Stresses in the bodies are as good as the peak pressure.
        """
        validity = {"leak_rate": self.validity, "force_for_target": self.target_validity}.get(name)
        digits = DIGITS if validity is None else digits_within(validity.leak_error)
        # a leak rate off by orders of magnitude leaves more of the force, which stands beside its line load
        least = 3 if name == "force_for_target" else 1
        return max(min(digits, super().digits_of("leak_rate" if least > 1 else name)), least)

    @property
    def digits(self) -> int:
        """Significant digits that numbers which follow from the contact force are worth, four at most."""
        return DIGITS if self.opening is None else self.opening.digits

    @cached_property
    def flow_error(self) -> FlowError | None:
        """Distribution of what direct simulation finds over the leak rate.

        By `flow_error` of the surface at the peak pressure, with the waves of the sealing area; None where the
        conductivity is itself simulated, and for the paper's theory, which does not know its error.
        """
        from leak import TurnedContact

        surface = None if self.rough is None or self.rough.is_direct else self.rough.surface
        if surface is None or not surface.knows_deviation or not self.peak_pressure > 0.0:
            return None
        # a lay stretches waves one way and shortens them as much the other
        wavelength = 2.0 * math.pi / surface.spectrum.median_wavenumber
        profile = self.tightest
        circle = 2.0 * math.pi * float(np.interp(profile.centroid, profile.x, profile.radius))
        waves = self.fwhm * circle / wavelength**2
        if isinstance(surface, TurnedContact):
            return surface.flow_error(
                self.peak_pressure, waves=waves, largest=profile.highest, strain=profile.peak_strain
            )
        return profile.surface_at_peak(surface).flow_error(self.peak_pressure, waves=waves)

    @property
    def stop_force(self) -> float | None:
        """What goes past the gasket through its stop [N]; None without a stop."""
        return None if self.of_profile or math.isinf(self.contact.model.stop) else self.contact.stop_force

    @property
    def remembers(self) -> bool:
        """Whether a place that carries the load has carried more before."""
        return any(
            bool((face.largest > AGREE * np.maximum(face.pressure, 0.01 * face.pressure.max())).any())
            for face in self.contacts
            if face.largest is not None
        )

    @cached_property
    def unsealed_rates(self) -> tuple[float, float]:
        """What flows through the open bore, and through the rough gap without load [m^3/s]; infinite if not known."""
        flow = None if self.rough is None else self.rough.flow
        if self.rough is None or flow is None:
            return math.inf, math.inf
        radius = min(float(profile.radius.min()) for profile in self.profiles)
        bore = flow.through_open_bore(self.fluid_pressure, radius)
        # what a form error leaves open is no rough gap
        if self.circumference is not None:
            return bore, math.inf
        return bore, self.rough.leak_without_load(self.whole_profile, self.fluid_pressure)

    @property
    def effective_viscosity(self) -> float | None:
        """Constant viscosity of a liquid that leaks as much [Pa s]; None without roughness, and for a gas."""
        flow = None if self.rough is None else self.rough.flow
        return None if flow is None else flow.effective_viscosity(self.fluid_pressure)

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
        temperatures = [value for value in faces if value is not None]
        return sum(temperatures) / 2 if len(temperatures) == 2 else None

    @property
    def gap_pressure(self) -> NDArray[np.float64] | None:
        """Fluid pressure at the points of the contact line [Pa]; None where nothing is known of it."""
        return self.contact.loads.gap_pressure if self.leak_round is None else self.leak_round.fluid_pressure

    @property
    def fwhm(self) -> float:
        """Full width at half maximum on the line that is pressed hardest [m]."""
        return self.tightest.fwhm

    @property
    def leak_digits(self) -> int:
        """Significant digits of leak rates: what errors and the distance from opening leave."""
        return min(self.digits, self.digits_of("leak_rate"))

    @property
    def theory_error(self) -> Bounds:
        """Factors on the leak rate between which direct simulation finds it in nine of ten seals, see `flow_error`."""
        # what is told lies between its ends
        return EXACT if self.flow_error is None else Bounds.of([1.0, *self.flow_error.factor(_NINE_OF_TEN)])

    @property
    def leak_validity(self) -> Validity:
        """The validity with what the mesh leaves uncertain of the leak rate: what its interval may be off by."""
        # the samples have the theory's own error
        error = self.theory_error if self.sample_ends is None else EXACT
        share = None if self.mesh_error is None else self.mesh_error.leak_rate
        return _add_doubts(self.validity, share, error)

    @property
    def is_simulated(self) -> bool:
        """Whether its conductivity is simulated, with a scatter of its own."""
        return self.rough is not None and self.rough.is_direct

    @property
    def calculated_ends(self) -> Bounds | None:
        """`leak_interval` without what the calculation may be off by [m^3/s]."""
        if self.leak is None:
            return None
        rates = [self.leak.leak_rate, *(self.leak_range or ()), *(self.sample_ends or ())]
        if self.leak_range is not None and self.sample_ends is not None and self.is_simulated:
            rates = [*_independent(self.leak.leak_rate, self.leak_range, self.sample_ends)]
        if self.after_test and self.sample_ends is not None:
            rates = [*self.sample_ends]
        return Bounds.of([*rates, *(self.at_preload_ends or ())])

    @cached_property
    def leak_interval(self) -> Bounds | None:
        """Ends of the leak rate, wherever they are told or judged [m^3/s]; None without a leak rate.

        They hold the scenarios that are in the interval, the samples of uncertain inputs, the preload of bolts, and
        what the calculation may be off by (`leak_validity`), but no more than physics lets through.
        """
        ends = self.calculated_ends
        if self.leak is None or ends is None:
            return None
        return _combine_ends(
            self.leak.leak_rate,
            ends,
            self.leak_validity,
            self.rougher,
            lambda: max(load.leak_before_sealing for load in self._in_interval),
            lambda: self.most_leak,
        )

    @property
    def most_leak(self) -> float:
        """What physics lets through: the open bore, and the rough gap of a round seal without load [m^3/s]."""
        bore, gap = self.unsealed_rates
        return min(bore, self.rougher * gap)

    @property
    def has_interval(self) -> bool:
        """Whether the ends of `leak_interval` are told as two numbers, or made of what could be two."""
        ends = self.leak_interval
        varies = any(pair is not None for pair in (self.leak_range, self.sample_ends, self.at_preload_ends))
        return ends is not None and (varies or ends.is_range)

    @property
    def verdict(self) -> Verdict | None:
        """What is claimed of the requirement, such as "pass"; None where nothing is required."""
        return None if self.judgement is None else self.judgement.verdict

    @property
    def margin(self) -> float | None:
        """Allowed over calculated leak rate, see `LoadVerdict.margin`; None where nothing is required."""
        return None if self.judgement is None else self.judgement.margin

    @property
    def pass_probability(self) -> float | None:
        """Share of the samples that keep the requirement; None where nothing is required."""
        return None if self.chance is None else self.chance.share

    @property
    def pass_probability_error(self) -> float | None:
        """Its standard error; None where nothing is required."""
        return None if self.chance is None else self.chance.error

    @property
    def batch_share_p05(self) -> float | None:
        """Share of a batch that passes with 95 % confidence; None where nothing is required."""
        return None if self.chance is None else self.chance.batch_low

    @property
    def force_for_verdict(self) -> float | None:
        """Of `verdict_force` [N]; None if not asked, and where no force passes."""
        return None if self.verdict_force is None else self.verdict_force.force


_NINE_OF_TEN = 0.05, 0.95
AnyLoad = CaseLoad | MissingLoad
Prepare = Callable[[str, "LeakModel"], "LeakModel"]


def model_as_it_is(name: str, model: LeakModel) -> LeakModel:
    """The surfaces and the fluid of a scenario, with nothing worked out; see `case_loads`.

    Parameters
    ----------
    name : str
    model : LeakModel
    """
    return model


def case_loads(
    problem: SealProblem, loads: Sequence[LoadResult], prepare: Prepare = model_as_it_is
) -> list[CaseLoad]:
    """Loads of a problem with the scenarios that share their contacts.

    Parameters
    ----------
    problem : SealProblem
    loads : sequence of LoadResult
    prepare : callable
        Given the name of a scenario, its surfaces and its fluid: may work out what all loads share.
    """
    # a load that comes again is the same one, and so is its leak rate
    different = {id(load): load for load in loads}
    models = {id(load.rough): load.rough for load in loads}
    ready = {key: model and prepare("", model) for key, model in models.items()}
    ready_loads = [load.with_values(rough=ready[id(load.rough)]) for load in different.values()]
    results = dict(zip(different, _add_scenarios(problem, ready_loads, prepare), strict=True))
    return [results[id(load)] for load in loads]


def _add_scenarios(
    problem: SealProblem, loads: Sequence[LoadResult], prepare: Prepare, *, interval_alone: bool = False
) -> list[CaseLoad]:
    """Loads with the scenarios beside them, or with those alone of which the interval is made."""
    scenarios: list[dict[str, CaseLoad]] = [{} for _ in loads]
    for scenario in alternatives_on_contact(problem):
        if interval_alone and not SCENARIOS[scenario.name].in_interval:
            continue
        others = scenario.on_contacts(loads, partial(prepare, scenario.name))
        different = [number for number, other in enumerate(others) if other is not loads[number]]
        new_loads = [others[number] for number in different]
        if SCENARIOS[scenario.name].has_interval:
            results = _add_scenarios(scenario.problem, new_loads, prepare, interval_alone=True)
        else:
            results = list(map(CaseLoad.of, new_loads))
        for number, load in zip(different, results, strict=True):
            scenarios[number][scenario.name] = load
    return list(map(CaseLoad.of, loads, scenarios))


def rate_of(load: CaseLoad) -> float | Bounds:
    """The leak rate of a load as it is told: its interval, or the only number; NaN without one [m^3/s].

    Parameters
    ----------
    load : CaseLoad
    """
    ends = load.leak_interval
    if load.leak is None or ends is None:
        return math.nan
    return ends if ends.is_range else load.leak.leak_rate


@dataclass(frozen=True)
class SolvedSeal:
    """A case, its bodies on their mesh and its loads.

    Parameters
    ----------
    case : Case
        Without the loads that could not be calculated.
    problem : SealProblem
        The same as the calculation knows it; of several the first one.
    seal_mesh : SealMesh
    model : ContactModel
    loads : tuple of CaseLoad
        In the order of the case.
    unloaded_bodies : UnloadedBodies or None
        Residual stress and imprint after the last load; None if all bodies are elastic.
    missing_loads : tuple of MissingLoad
        The other loads of the case.
    missing_load_findings : tuple of Finding
        Why, in words.
    other_parts : tuple of SolvedSeal
        The seal with each further contact that is solved by itself.
    """

    case: Case
    problem: SealProblem = field(repr=False)
    seal_mesh: SealMesh
    model: ContactModel
    loads: tuple[CaseLoad, ...]
    unloaded_bodies: UnloadedBodies | None = None
    missing_loads: tuple[MissingLoad, ...] = ()
    missing_load_findings: tuple[Finding, ...] = ()
    other_parts: tuple[SolvedSeal, ...] = ()

    @property
    def display(self) -> Display:
        """The units of its case."""
        return self.case.display

    @classmethod
    def of(cls, evaluations: Sequence[Evaluation], case: Case, loads: Sequence[CaseLoad]) -> SolvedSeal:
        """What answers are computed from; bodies that are shared have no mesh, which few of them ask for.

        Parameters
        ----------
        evaluations : sequence of Evaluation
            Of each part of the case.
        case : Case
            Without the loads that could not be calculated.
        loads : sequence of CaseLoad
            Of the evaluations.
        """
        first, *others = (
            SolvedSeal(
                part,
                evaluation.problem,
                evaluation.seal_mesh,  # type: ignore[arg-type]
                evaluation.model,
                of_part,
                evaluation.solved_loads.unloaded_bodies,
            )
            for part, evaluation, of_part in zip(
                case.parts, evaluations, zip(*(load.parts for load in loads), strict=True), strict=True
            )
        )
        return replace(first, loads=tuple(loads), other_parts=tuple(others))

    @property
    def load_problems(self) -> dict[tuple[float, float], Problem]:
        """Fluid pressure [Pa] and applied force [N] of each load without a result, with the reason."""
        return {load.point: load.problem for load in self.missing_loads}

    @property
    def every_load(self) -> list[AnyLoad]:
        """The loads of the case in its order, with those that could not be calculated."""
        return in_order([*self.loads], self.missing_loads, lambda load: load)

    @property
    def parts(self) -> tuple[SolvedSeal, ...]:
        """The seal with each contact that is solved by itself and that leaks beside the others; of most itself."""
        if not self.other_parts:
            return (self,)
        first, *others = zip(*(load.parts for load in self.loads), strict=True)
        values = {field.name: getattr(self, field.name) for field in fields(SolvedSeal)}
        return (
            SolvedSeal(**{**values, "loads": first, "other_parts": ()}),
            *(replace(part, loads=loads) for part, loads in zip(self.other_parts, others, strict=True)),
        )

    @property
    def problems(self) -> tuple[SealProblem, ...]:
        """The problem of each of its parts, see `fem_seal.seal.problem.problems_of`."""
        return (self.problem, *(part.problem for part in self.other_parts))

    @property
    def imprints(self) -> dict[str, Imprint]:
        """Lasting imprints by the name of the body, see `CaseLoad.named_bodies`."""
        of_parts = [part.unloaded_bodies for part in (self, *self.other_parts)]
        return {
            name: bodies.imprints[body]
            for name, (number, body) in self.loads[0].named_bodies.items()
            if (bodies := of_parts[number]) is not None and body in bodies.imprints
        }

    def with_parts(self, parts: Sequence[SolvedSeal]) -> Self:
        """The same seal, of whose parts more is known.

        Parameters
        ----------
        parts : sequence of SolvedSeal
            Its `parts`.
        """
        rows = zip(self.loads, *(part.loads for part in parts), strict=True)
        loads = tuple(load.with_parts(of_parts) for load, *of_parts in rows)
        return replace(self, loads=loads, other_parts=tuple(parts[1:]))

    def with_loads(self, loads: Sequence[CaseLoad]) -> Self:
        """The same seal, whose loads know more."""
        return replace(self, loads=tuple(loads))

    @property
    def of_profile(self) -> bool:
        """Whether its contacts are given pressure profiles; it has no mesh and no model then."""
        return self.loads[0].of_profile

    @property
    def surface(self) -> FaceContact | None:
        """With the hardness if asperities yield; None without roughness."""
        return self.problem.surface

    @property
    def strongest(self) -> CaseLoad:
        """The load with the largest closing force; for it error, far field and interface laws are compared."""
        return self.loads[strongest_load(self.loads)]

    @property
    def highest(self) -> CaseLoad:
        """The load with the highest fluid pressure, which headline, report and terminal explain."""
        return self.loads[highest_load(self.loads)]

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Pressure profile of each load."""
        return tuple(load.tightest for load in self.loads)

    @property
    def contact(self) -> tuple[ContactSolution, ...]:
        """Contact solution of each load."""
        return tuple(load.contact for load in self.loads)

    @property
    def leak_ranges(self) -> tuple[tuple[float, float] | None, ...]:
        """`CaseLoad.leak_interval` of each load [m^3/s]; None where nothing makes one."""
        return tuple(load.leak_interval if load.has_interval else None for load in self.loads)


def _add_doubts(validity: Validity, mesh_error: float | None, own_error: Bounds) -> Validity:
    """A validity with what the mesh leaves uncertain of the leak rate, and with the theory's own error.

    Parameters
    ----------
    validity : Validity
    mesh_error : float or None
        Relative error of the leak rate; None if not known.
    own_error : Bounds
        Factors on the leak rate between which direct simulation finds it.
    """
    # the interval holds what a simulation leaves open
    cautions = list(validity.without_kinds(DIRECT_SCATTER).cautions)
    if mesh_error is not None and mesh_error > 0.0:
        factors = Bounds.factor_bounds(1.0 + mesh_error)
        cautions.append(Finding("mesh_left", Level.VALID, {"share": mesh_error}, factors))
    if own_error != EXACT:
        cautions.append(Finding("own_error", Level.VALID, {"factors": own_error}, own_error))
    return Validity.of(cautions)


def _independent(rate: float, *ranges: Bounds) -> Bounds:
    """Range of a leak rate from what varies independently: logarithms of the factors on either side as errors add."""
    if not (rate > 0.0 and all(ends.low > 0.0 for ends in ranges)):
        return Bounds.of([rate, *(end for ends in ranges for end in ends)])
    down, up = (
        math.hypot(*(max(factor, 0.0) for factor in factors))
        for factors in zip(*((math.log(rate / x.low), math.log(x.high / rate)) for x in ranges), strict=True)
    )
    return Bounds(rate * math.exp(-down), rate * math.exp(up))


def _combine_ends(
    rate: float,
    ends: Bounds,
    doubts: Validity,
    rougher: float,
    before_sealing: Callable[[], float],
    most_leak: Callable[[], float],
) -> Bounds:
    """Ends of a leak rate, but no more than physics lets through [m^3/s].

    Parameters
    ----------
    rate : float
        In the nominal scenario [m^3/s].
    ends : Bounds
        Of scenarios and samples [m^3/s].
    doubts : Validity
        What the calculation may be off by.
    rougher : float
        What the gaps of the roughest samples let through over that of the surface as given.
    before_sealing, most_leak : callable
        Give what leaks at most where the percolation threshold decides, and what physics lets through [m^3/s]; asked
        only where they count.
    """
    # the threshold is that of the surface as given: rougher samples are further from it, and leak no more by it
    factors = [
        finding.leak_factor.high for finding in doubts.cautions if finding.kind in (NEARLY_SEALED, SEALED)
    ]
    by_threshold = before_sealing() if factors else 0.0
    if factors and not by_threshold and rate > 0.0:
        by_threshold = math.prod(factors) * rate
    widening = doubts.without_kinds(NEARLY_SEALED, SEALED).leak_factor.high
    interval = Bounds(ends.low * doubts.leak_factor.low, max(ends.high, rougher * by_threshold) * widening)
    # faces that are lifted off, as at the least preload, have no gap that bounds what passes
    if not interval.is_range or math.isinf(ends.high):
        return interval
    limit = max(most_leak(), rate)
    return Bounds(min(interval.low, limit), min(interval.high, limit))
