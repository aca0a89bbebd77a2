"""Closed forms (Hertz, crossover, blow-off): printed by `check`, compared with the solution by `run`.

Bodies that yield are foreseen from them before anything is solved, and how long their load steps take.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import leak
from fem_seal.answers.case_load import SolvedSeal
from fem_seal.arrays import FloatArray
from fem_seal.case.case import Case, CaseSource, case_of
from fem_seal.case.checks import MOST_TURNED, turning_angle
from fem_seal.case.material_table import CURVES, library_name
from fem_seal.contact.laws import HardContact, InterfaceLaw
from fem_seal.errors import InputError, Text
from fem_seal.loads import (
    CONSTRAINT,
    LARGEST_EXCESS,
    LARGEST_TURNING,
    TURNED,
    blow_off_of_sealed_area,
    contact_force,
    line_load,
    plastic_half_width,
)
from fem_seal.materials import HardeningCurve, Material
from fem_seal.seal.cost import about, path_seconds
from fem_seal.seal.findings import not_calculated, sentence
from fem_seal.seal.problem import SealProblem, exponential_law, problems_of, size_mesh
from fem_seal.wording import Quantity, Words
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS

# Share by which the decay length of a law may have fallen at the peak before the crossover is called another contact.
_STIFFER = 0.05
# The peak changes little with u0: so many steps settle both.
_PEAKS = 12
# Largest von Mises stress under Hertz's line contact over its peak pressure, in plane strain (K. L. Johnson, Contact
# Mechanics, 4.2 and 6.1; Poisson's ratio 0.3).
_VON_MISES = 0.558
# Plastic strain over a/R that stands for that of a contact in the fully plastic range, and steps to its flow stress.
_TABOR, _ITERATIONS = 0.2, 20
# What samples, and the search for the force of a target, take over the path of the loads: measured on copper rings.
_FOR_SAMPLES, _FOR_TARGET = 2.0, 2.0


@dataclass(frozen=True)
class ClosedForm:
    """One load of a case with its closed pressure profiles.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    contact_force : float
        Axial force F_N that presses the closure on the seat [N]; with closing "penetration" what is expected of it.
    line_load : float
        f_N [N/m].
    hertz : HertzLine or None
        Smooth elastic bodies; None for faces that fit each other along a stretch, and for a load that cannot be
        calculated, as the other profiles.
    gaussian : GaussianLine or None
        Rigid bodies with the exponential law; None for a smooth interface.
    crossover : CrossoverLine or None
        Elastic bodies with the exponential law, exact for half-spaces; None for a smooth interface.
    blow_off_pressure : float or None
        Fluid pressure that lifts the closure off the circle of first touch [Pa]; None where it closes.
    force_for_target : float or None
        Force of spring or actuator for the target leak rate [N], from a Gaussian profile of the expected width; None
        without a target, or if no sensible force reaches it.
    """

    fluid_pressure: float
    contact_force: float
    line_load: float
    hertz: leak.HertzLine | None
    gaussian: leak.GaussianLine | None
    crossover: leak.CrossoverLine | None
    blow_off_pressure: float | None
    force_for_target: float | None


@dataclass(frozen=True)
class ClosedForms:
    """Closed-form numbers of a case.

    Parameters
    ----------
    initial_contact_radius : float
        Radius r0 of the circle of first touch [m].
    effective_modulus : float
        E* [Pa].
    relative_radius : float
        Radius of relative curvature across the contact line [m]; inf for faces that fit each other along a stretch.
    hardness : float or None
        Penetration hardness used for the asperities [Pa]; None without asperity plasticity.
    rms_height, rms_slope : float or None
        Of the combined roughness [m], [-]; None without roughness.
    decay_length : float or None
        u0 of p = p_c exp(-u/u0) [m]: as given, gamma times rms height, or of the spectrum at low pressure, of the
        corrected theory at the peak of the load with the largest contact force; None for a smooth interface.
    law_pressure : float or None
        p_c [Pa].
    loads : tuple of ClosedForm
        One per fluid pressure.
    """

    initial_contact_radius: float
    effective_modulus: float
    relative_radius: float
    hardness: float | None
    rms_height: float | None
    rms_slope: float | None
    decay_length: float | None
    law_pressure: float | None
    loads: tuple[ClosedForm, ...]


def derive(case: CaseSource) -> ClosedForms:
    """Closed-form numbers of a case: geometry, loads, and the Hertz, Gaussian and crossover profiles.

    Parameters
    ----------
    case : Case, path or mapping

    Returns
    -------
    ClosedForms
        Radii [m], pressures [Pa], forces [N]. With law "spectrum" an exponential stands for the law: that of the
        elastic spectrum at low pressure or, of the corrected theory, at each load the one that touches the law at the
        peak pressure.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> derived = fem_seal.derive(case)
    >>> print(f"{derived.initial_contact_radius * 1e3:.2f} mm, {derived.loads[0].hertz.peak_pressure / 1e6:.0f} MPa")
    14.14 mm, 192 MPa
    """
    return derive_problems(problems_of(case_of(case)))


def derive_problems(problems: Sequence[SealProblem]) -> ClosedForms:
    """`derive` of the problems of a seal.

    Parameters
    ----------
    problems : sequence of SealProblem
    """
    return _derive_from_forces(problems, [None] * len(problems[0].loads.points))


def derive_beside(result: SolvedSeal) -> ClosedForms:
    """Closed-form numbers to compare a result with: at a stop those of the force that it leaves to the gasket.

    Parameters
    ----------
    result : SolvedSeal
    """
    if result.of_profile:
        return derive(result.case)
    forces = [load.contact_force if load.stop_force else None for load in result.loads]
    return _derive_from_forces(problems_of(result.case), forces)


def _derive_from_forces(problems: Sequence[SealProblem], forces: Sequence[float | None]) -> ClosedForms:
    """Of a contact force F_N for each load [N], or of the one that is expected; of several problems the first one's."""
    problem, surface = problems[0], problems[0].surface
    loads = tuple(
        _derive_load(problems, *point, force, profiles=number not in problem.loads.refusals)
        for number, (point, force) in enumerate(zip(problem.loads.points, forces, strict=True))
    )
    decay_length, law_pressure = exponential_law(problem.interface, surface)
    crossovers = [load.crossover for load in loads if load.crossover is not None]
    law = _stiffening_law(problem)
    if decay_length is None and law is not None and crossovers:
        strongest = max(crossovers, key=lambda line: line.line_load)
        gap = float(law.gap(np.array([math.log(strongest.peak_pressure)]))[0])
        decay_length = strongest.u0
        law_pressure = strongest.peak_pressure * math.exp(gap / decay_length)
    return ClosedForms(
        initial_contact_radius=problem.initial_contact_radius,
        effective_modulus=problem.effective_modulus,
        relative_radius=problem.contact.relative_radius,
        hardness=surface.hardness if surface else None,
        rms_height=surface.spectrum.rms_height if surface else None,
        rms_slope=surface.spectrum.rms_slope if surface else None,
        decay_length=decay_length,
        law_pressure=law_pressure,
        loads=loads,
    )


def closed_form_limits(case: Case, forms: ClosedForms) -> str | Words:
    """Why the closed forms are not what a run finds: a law or faces that change within the contact; "" if they are.

    Parameters
    ----------
    case : Case
    forms : ClosedForms
        Of the same case.
    """
    law = _stiffening_law(SealProblem.of(case))
    for load in forms.loads:
        line = load.crossover or load.hertz
        if line is None:
            continue
        if law is not None and load.crossover is not None:
            peak_length = float(law.decay_length(np.array([math.log(line.peak_pressure)]))[0])
            if peak_length < (1 - _STIFFER) * load.crossover.u0:
                lengths = {"low": load.crossover.u0, "peak": peak_length}
                return sentence("closed_forms", "stiffer", pressure=load.fluid_pressure, **lengths)
        # Beyond two standard deviations there is a twentieth of the load; Hertz's contact ends there.
        breaks = case.contact.breaks[np.abs(case.contact.breaks) < 2 * line.std]
        if len(breaks):
            nearest = float(np.abs(breaks).min())
            return sentence("closed_forms", "breaks", pressure=load.fluid_pressure, nearest=nearest)
    return ""


def without_stop(case: Case) -> str | Words:
    """That what is expected of a case has no stop; "" if the case has none."""
    stops = case.gasket is not None and case.gasket.stop is not None
    return sentence("closed_forms", "stop") if stops else ""


def strain_limit(forms: ClosedForms) -> str | Words:
    """From which load on the closed forms expect more than small strains; "" if from none.

    Parameters
    ----------
    forms : ClosedForms
    """
    for load in forms.loads:
        line = load.crossover or load.hertz
        angle = 0.0 if line is None else 2 * line.peak_pressure / forms.effective_modulus
        if angle > TURNED:
            limits = {"limit": TURNED, "largest": LARGEST_TURNING}
            return sentence("closed_forms", "strain", pressure=load.fluid_pressure, turned=angle, **limits)
    return ""


def nearly_open(forms: ClosedForms) -> str | Words:
    """Which loads the fluid carries on the sealed area, so that only a run decides about them; "" if there are none.

    Parameters
    ----------
    forms : ClosedForms
    """
    pressures = [load.fluid_pressure for load in forms.loads if math.isnan(load.contact_force)]
    return sentence("closed_forms", "nearly_open", pressures=pressures) if pressures else ""


def _stiffening_law(problem: SealProblem) -> InterfaceLaw | None:
    """The law of the rough surface; None where it is an exponential or hard contact."""
    if problem.interface.law != "spectrum":
        return None

    law = problem.law
    assert not isinstance(law, HardContact)  # that is law = "smooth"
    return law


def _derive_load(
    problems: Sequence[SealProblem],
    fluid_pressure: float,
    applied_force: float,
    given_force: float | None,
    *,
    profiles: bool,
) -> ClosedForm:
    problem = problems[0]
    r0, R, E = problem.initial_contact_radius, problem.contact.relative_radius, problem.effective_modulus
    profiles = profiles and not math.isinf(R)
    side = problem.loads.pressure_side
    force = problem.expected_force(fluid_pressure, applied_force) if given_force is None else given_force
    if force > contact_force(r0, fluid_pressure, applied_force, side):
        # what a run begins with where the fluid balances the applied force or nearly so, and no estimate of the force
        force, profiles = math.nan, False
    f = line_load(force, r0, problem.contact.angle)
    decay_length = _decay_length(problem, f) if profiles else None
    return ClosedForm(
        fluid_pressure=fluid_pressure,
        contact_force=force,
        line_load=f,
        hertz=leak.hertz_line(f, R, E) if profiles else None,
        gaussian=leak.gaussian_line(f, R, decay_length) if decay_length else None,
        crossover=leak.crossover_line(f, R, E, decay_length) if decay_length else None,
        blow_off_pressure=blow_off_of_sealed_area(r0, applied_force) if side == "inner" else None,
        force_for_target=_force_for_target(problems, fluid_pressure),
    )


def _decay_length(problem: SealProblem, line_load: float) -> float | None:
    """u0 of the exponential that stands for the law; of the corrected theory the one at the peak that it gives."""
    u0, law = exponential_law(problem.interface, problem.surface)[0], _stiffening_law(problem)
    if u0 is not None or law is None:
        return u0
    assert problem.surface is not None  # of law spectrum
    u0 = problem.surface.spectrum.rms_height
    for _ in range(_PEAKS):
        line = leak.crossover_line(line_load, problem.contact.relative_radius, problem.effective_modulus, u0)
        u0 = float(law.decay_length(np.array([math.log(line.peak_pressure)]))[0])
    return u0


def _force_for_target(problems: Sequence[SealProblem], fluid_pressure: float) -> float | None:
    problem, target = problems[0], problems[0].loads.target_leak_rate
    if target is None:
        return None
    from fem_seal.answers.target import expected_contact_force, flows_of

    flows = flows_of(problems)
    if not flows:
        return None
    try:
        force = expected_contact_force(flows, fluid_pressure, target)
    except InputError:
        return None
    return force - contact_force(
        problem.initial_contact_radius, fluid_pressure, 0.0, problem.loads.pressure_side
    )


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
        """Measure profiles, calculated or closed."""
        return cls(
            np.array([p.peak_pressure for p in profiles]),
            widths(profiles),
            np.array([p.std for p in profiles]),
        )


def widths(profiles: Sequence[Any]) -> FloatArray:
    """Full widths at half maximum of profiles of one kind [m]; those that have to be looked for all together."""
    if profiles and isinstance(profiles[0], leak.CrossoverLine):
        return leak.crossover_widths(profiles)
    return np.array([p.fwhm for p in profiles])


def profile_sizes(result: SolvedSeal, forms: ClosedForms) -> dict[str, Sizes]:
    """Sizes of the "calculated" profiles and of each closed form that the case has, over its loads.

    Parameters
    ----------
    result : SolvedSeal
    forms : ClosedForms
        Closed forms of the case.
    """
    sizes = {"calculated": Sizes.of(result.profiles)}
    for name in () if result.of_profile else CLOSED_FORMS:
        profiles = [getattr(load, name) for load in forms.loads]
        if all(profile is not None for profile in profiles):
            sizes[name] = Sizes.of(profiles)
    return sizes


def foresee_findings(problem: SealProblem, forms: ClosedForms | None = None) -> Iterator[Text]:
    """Loads that are not calculated, and bodies that yield though they are solved as elastic, one sentence for each.

    Parameters
    ----------
    problem : SealProblem
    forms : ClosedForms, optional
        Of the same problem.
    """
    yield from not_calculated(problem.loads, problem.loads.refusals)
    yield from foresee_yielding(problem, forms or derive_problems([problem]))


def run_seconds(problem: SealProblem, *, samples: bool = False, target: bool = False) -> float | None:
    """Estimated processor time of a run of bodies that yield [s]; None where none does.

    Parameters
    ----------
    problem : SealProblem
    samples : bool
        With samples of uncertain inputs or of a drawing's finish.
    target : bool
        With the force for a target leak rate.
    """
    loads = problem.loads.without_loads(problem.loads.refusals)
    if not (problem.curves and loads.points):
        return None
    return (1.0 + _FOR_SAMPLES * samples + _FOR_TARGET * target) * _seconds(replace(problem, loads=loads))


def foresee_yielding(problem: SealProblem, forms: ClosedForms) -> Iterator[Words]:
    """Bodies solved as elastic whose stress the closed forms expect above their yield stress.

    Parameters
    ----------
    problem : SealProblem
    forms : ClosedForms
    """
    lines = [(load.contact_force, load.line_load, load.crossover or load.hertz) for load in forms.loads]
    loads = sorted((line.peak_pressure, force, f) for force, f, line in lines if line is not None)
    if not loads:
        return
    # a body that yields lets no more through to the other one
    loads = [(min(pressure, bearable_pressure(problem, f)), force, f) for pressure, force, f in loads]
    peak, _, line_load = loads[-1]
    bodies: dict[str, tuple[Words, list[str]]] = {}
    for name, material in problem.materials.items():
        is_known = material.yield_stress is not None
        limit = material.yield_stress or (material.hardness or 0.0) / HARDNESS_OVER_YIELD_STRESS
        above_limit = [force for pressure, force, _ in loads if _VON_MISES * pressure > limit]
        if material.hardening is not None or not (limit and above_limit):
            continue
        below_limit = [force for _, force, _ in loads if force < min(above_limit)]
        excess, hardness = _VON_MISES * peak / limit, material.hardness
        is_crushed = hardness is not None and peak > hardness
        text = sentence(
            "foreseen",
            material=material.name,
            first=Quantity(min(above_limit), "short force"),
            # only the forces of the case are looked at: where between two of them it begins is not known
            not_yet=sentence("foreseen", "not_yet", force=Quantity(max(below_limit), "short force"))
            if below_limit
            else "",
            # two digits, or as many as say that it is above one
            excess=f"{excess:.2g}" if excess >= 1.05 else f"{max(excess, 1.01):.2f}",
            limit=Quantity(limit, "fixed MPa 3"),
            which=sentence("foreseen", "known" if is_known else "hard"),
            crushed=sentence("foreseen", "crushed", peak=peak, hardness=hardness) if is_crushed else "",
            worth=sentence("foreseen", "outside" if excess > LARGEST_EXCESS else "doubtful"),
            run=_with_curve(problem, name, material, limit, line_load),
        )
        bodies.setdefault(str(text), (text, []))[1].append(problem.contact.label_of(name))
    for text, names in bodies.values():
        yield Words("{{ names }}: {{ text }}", {"names": " and ".join(names), "text": text})


def bearable_pressure(problem: SealProblem, line_load: float) -> float:
    """Pressure that bodies with a stress-strain curve bear in the fully plastic range [Pa]; infinite without one.

    The flow stress is that at a plastic strain of 0.2 a/R (Tabor, The Hardness of Metals, 1951).

    Parameters
    ----------
    problem : SealProblem
    line_load : float
        f_N [N/m].
    """
    radius, pressure = problem.contact.relative_radius, math.inf
    for curve in problem.curves:
        stress = curve.stress[-1]
        for _ in range(_ITERATIONS if math.isfinite(radius) else 0):
            strain = _TABOR * plastic_half_width(line_load, stress) / radius
            stress = 0.5 * (stress + float(curve.flow_stress(np.array(strain))))
        pressure = min(pressure, CONSTRAINT * stress)
    return pressure


def _with_curve(problem: SealProblem, name: str, material: Material, limit: float, line_load: float) -> Words:
    """What a run takes if this body had a stress-strain curve, that of the library or a perfectly plastic one."""
    of_library = CURVES.get(library_name(material.name) or "")
    curve = HardeningCurve((0.0,), (limit,)) if of_library is None else of_library.hardening
    strongest = max(curve.stress[-1], (material.hardness or 0.0) / HARDNESS_OVER_YIELD_STRESS)
    angle = turning_angle(problem.contact, plastic_half_width(line_load, strongest))
    if angle > MOST_TURNED:
        return sentence("foreseen", "too_large", turned=angle)
    yields = replace(material, hardening=curve, yield_stress=None, over_temperature=())
    path = replace(problem, materials={**problem.materials, name: yields})
    words = "library" if of_library is not None else "own"
    return sentence("foreseen", words, time=about(_seconds(path)))


def _seconds(problem: SealProblem) -> float:
    elements = len(size_mesh(problem).contact_vertices(problem.contact.breaks)) - 1
    return path_seconds(elements, len(problem.loads.points))
