"""Checks of bodies and roughness: level, number and factor where a result leaves the range of its theory."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.contact.solution import PlasticZone, YieldedZone, yielded_zone, yielding_of
from fem_seal.loads import LARGEST_EXCESS, LARGEST_TURNING, TURNED
from fem_seal.seal.findings import (
    AGREE,
    EXACT,
    ORDERS_OF_MAGNITUDE,
    Bounds,
    Finding,
    Level,
    Validity,
    caution,
    fade_in,
    near_limit,
    remark,
)
from fem_seal.seal.leak_model import DIRECT_END, INPUTS_KNOWN_TO
from fem_seal.seal.load_result import LoadResult, load_words
from fem_seal.seal.problem import SealProblem
from fem_seal.units import DIGITS, format_at_limit
from fem_seal.validity.fluid import film_cautions, fluid_cautions, molecule_cautions, opening_factor
from fem_seal.validity.form import form_cautions
from fem_seal.validity.materials import hardness_cautions, material_cautions
from fem_seal.validity.turned import turned_cautions
from fem_seal.wording import Quantity, Words
from leak import ConductivityTable, RoughContact, TurnedContact
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS

if TYPE_CHECKING:
    from fem_seal.seal.direct import DirectTable
    from fem_seal.seal.evaluate import Evaluation
    from fem_seal.seal.leak_model import FlowModel
    from leak.flow.turned_contact import FaceContact


# Margin to opening over the acting force or pressure below which the contact force is a small difference of large ones.
_NEAR_OPENING = 0.05
# Peak pressure over yield stress at which Hertz's line contact yields (Tresca: K. L. Johnson, Contact Mechanics, 6.1).
# Yield stress of annealed metals over Young's modulus: 210 MPa for steel, 100 MPa for brass.
_HERTZ_YIELDS, _SOFT = 1.67, 1e-3
# Peak pressure over yield stress from which on metal may flow under faces of which nothing else is known: tension and
# bending may take as much, and a flat gasket flows at one.
_MAY_FLOW = 0.5
# Pressure at the end of the contact zone over the peak pressure: above the first the contact is cut off, above the
# second the missing part changes the result noticeably.
_CUT_SHARE, _LARGE_CUT_SHARE = 1e-6, 1e-2
# Share of the hardness above which the theory of yielding asperities is stretched; above the hardness it is void.
_NEAR_HARDNESS = 0.3
_LARGEST_ERROR = 2e-3
# With load steps: error of 16 steps on a perfectly plastic seat (docs/theory/elastoplastic.md).
_LARGEST_ERROR_OF_PATH = 1e-2
# The theory's own A/A0 beyond which its flow conductivity differs from direct numerical results by more than 30 %,
# and the factors by which it does at some areas; the direct area is 0.19 there (docs/verification/verification.md).
_FEW_CHANNELS = 0.15
# ... and below which it is taken to be right; in between the factor fades in.
_NOT_FEW = 0.1
_FACTORS = ((_FEW_CHANNELS, 1.3), (0.2, 1.7), (0.25, 2.3), (0.31, 3.3))
# A/A0 beyond the percolation threshold at which nothing may leak for certain; the doubt fades in from where direct
# results end, so slowly that a thousandth of the force moves no end by 2 %.
_CLOSED_AREA = 0.55
# With a lay it differs by up to these factors at some A/A0, where the fluid crosses the lay, and by one at all where it
# flows along it: direct results for elastic asperities, correlation lengths up to 5 times longer one way, A/A0 up to
# 0.16. For a lay 10 times longer the factors rise by 10/5 to this power.
_LAY_ACROSS, _LAY_ALONG, _LAY_KNOWN = ((0.02, 1.4), (0.1, 1.5), (0.16, 2.5)), 1.4, 0.16
_LAY_LONG, _LAY_LONGEST, _LAY_POWER = 5.0, 10.0, 0.7
_LAY_REPORTED = 1.3
# Uncertainty factor of a simulated conductivity above which it is reported.
_UNSURE = 2.0
# Share of the height variance in waves too long to be roughness of the contact.
_LONG_WAVES = 0.1
# ... and how much less or more strips of such seals leak than by the corrected theory, per such share.
_LESS_OF_LONG, _MORE_OF_LONG = 0.25, 1.5
# Fluid pressure over peak contact pressure from which on it opens the gap noticeably: a fifth more leaks at 0.1.
FLUID_OPENS = 0.1
# ... and from which on a leak rate without this effect is meaningless.
_FLUID_LIFTS = 0.5
# Plastic strain up to which small-strain theory holds.
_LARGE_STRAIN = 0.1
# Separation of the surfaces over the radius of curvature of their faces, averaged over the contact pressure: above the
# first the interface law of parallel planes is doubtful, above the second void; see docs/theory/geometry.md.
_THICK_LAYER, _NO_LAYER = 0.1, 1.0
# Shift of the closest approach along the seat by such a layer, over the radius of first touch: line load, peak and leak
# rate are uncertain by the same share.
_SLIDES = 0.02
# Limits of heat for a contact calculated at its place on the drawing: rotation of the contact normal [rad], and slide
# over the distance to the end of the face. Above them line load and contact are uncertain by some per cent.
_TURNS, _NEAR_END, _TINY = 0.02, 0.2, 1e-12
# Two standard deviations over the radius of first touch, above which the contact is no narrow line.
_NARROW = 0.2
# u_eff [m] above which u_c, which is of its size, need not be compared with molecules of half a nanometre.
_WIDE_GAP = 20e-9


# Findings about the worst of the loads of a problem.
Check = Callable[[SealProblem, Sequence[LoadResult]], Iterator[Finding]]


def contact_cautions(problem: SealProblem, loads: Sequence[LoadResult]) -> tuple[Finding, ...]:
    """All cautions of a result, one of each kind for all its loads.

    Parameters
    ----------
    problem : SealProblem
    loads : sequence of LoadResult
        With their mesh error.
    """
    # remarks that do not make the numbers doubtful
    remarks = [
        f for f in (*_temperature_cautions(problem), *_face_cautions(problem)) if f.level is Level.VALID
    ]
    if problem.faces > 1:
        remarks.append(replace(caution("without_friction"), level=Level.VALID))
    items = (*_of_surface(problem), *load_cautions(problem, loads), *_coarse(loads[0]))
    return (*(item for item in items if not item.silent), *remarks, *_earlier_cautions(problem, loads[0]))


def load_cautions(
    problem: SealProblem, loads: Sequence[LoadResult], sealing: float | None = None
) -> Iterator[Finding]:
    """Cautions that follow from the loads themselves, without those of mesh and roughness.

    Parameters
    ----------
    problem : SealProblem
    loads : sequence of LoadResult
        Each caution is about the worst of them.
    sealing : float, optional
        See `load_validity`.
    """
    bodies: tuple[Check, ...] = (
        _faces,
        _near_opening,
        _yielding,
        _yields_before_fluid,
        _may_yield,
        _beyond_curve,
        _turning,
        _contact_ends,
        _wide,
        _thick_layer,
        _slides,
        _above_hardness,
        _creeps,
        _hot,
        _moved_by_heat,
        _flanges_meet,
    )
    for check in bodies:
        yield from check(problem, loads)
    if problem.form is not None:
        yield from form_cautions(problem.form, problem, loads)
    if problem.surface is not None:
        yield from _interface_cautions(problem, problem.surface, loads, sealing)


def _temperature_cautions(problem: SealProblem, *, bodies: bool = True) -> Iterator[Finding]:
    yield from film_cautions(problem)
    yield from hardness_cautions(problem)
    if problem.at_rest.temperatures:
        yield from material_cautions(problem, bodies=bodies)


def _interface_cautions(
    problem: SealProblem, surface: FaceContact, loads: Sequence[LoadResult], sealing: float | None = None
) -> Iterator[Finding]:
    if isinstance(surface, TurnedContact):
        yield from turned_cautions(surface, loads)
        if problem.flow is not None and problem.flow.direct is not None:
            load = max(loads, key=lambda load: load.peak_pressure)
            yield from _direct_cautions(problem.flow.direct.table(surface), load, loads, surface)
    else:
        sealing = surface.sealing_pressure if sealing is None else sealing
        yield from _sealed_loads(surface, loads, sealing)
        yield from _nearly_sealed(problem, surface, loads, sealing)
        yield from _range(problem, surface, loads)
        yield from _long_waves(surface, loads)
    if problem.flow is not None:
        yield from _fluid_opens(problem, problem.flow, loads)
        yield from fluid_cautions(problem.flow, loads)


def load_validity(problem: SealProblem, load: LoadResult, sealing: float | None = None) -> Validity:
    """Validity of one load, from its own checks and those of the largest earlier load.

    Parameters
    ----------
    problem : SealProblem
    load : LoadResult
        With its mesh error, where it is known.
    sealing : float, optional
        Pressure above which the surface is tight, if a table has it [Pa]: finding it takes longer than a design of a
        study.
    """
    findings = load_cautions(problem, [load], sealing)
    return Validity.of((*_of_surface(problem), *findings, *_coarse(load), *_earlier_cautions(problem, load)))


def validity_of(
    seal: Evaluation, load: LoadResult, *, by_table: bool = True, usual_only: bool = False
) -> Validity:
    """Validity of a load of an evaluation, from its own checks and those of the largest earlier load.

    Parameters
    ----------
    seal : Evaluation
    load : LoadResult
        One of its loads, with its mesh error where it is known.
    by_table : bool
        Whether the conductivity table may give the sealing pressure where bodies are shared: a search takes longer than
        a design.
    usual_only : bool
        Whether the range of a finish is left out.
    """
    problem, sealing = seal.problem, None
    if usual_only and problem.origin.of_finish:
        problem = replace(problem, origin=replace(problem.origin, usual_only=True))
    table = None if load.rough is None or load.rough.flow is None else load.rough.table
    # a gas percolates where a liquid does
    table = getattr(table, "liquid", table)
    if by_table and seal.seal_mesh is None and isinstance(table, ConductivityTable) and table.acts_at is None:
        assert load.rough is not None  # of its table
        sealing = table.sealing_pressure
        # u_eff falls with pressure: its value at the next pressure of the table is a lower bound
        peak = load.tightest.at_rest(load.rough.surface).peak_pressure
        separations = table.separation[table.pressure.searchsorted(peak) :]
        if len(separations) and separations[0] >= _WIDE_GAP:
            load = load.with_values(critical_separation=None)
    return load_validity(problem, load, sealing)


def profile_validity(problem: SealProblem, load: LoadResult) -> Validity:
    """Validity of the leak rate of a given pressure profile, whose bodies are not known.

    Parameters
    ----------
    problem : SealProblem
        With roughness.
    load : LoadResult
        Of a given contact.
    """
    assert problem.surface is not None  # of a leak rate
    return Validity.of(
        (
            *_of_surface(problem),
            *_above_hardness(problem, [load]),
            *_creeps(problem, [load]),
            *_unknown_strain(problem, load),
            *(item for item in _temperature_cautions(problem, bodies=False) if item.level is not Level.VALID),
            *_interface_cautions(problem, problem.surface, [load]),
        )
    )


def _earlier_cautions(problem: SealProblem, current: LoadResult) -> tuple[Finding, ...]:
    """Cautions about the largest load before all loads of a problem, as the contact of one of them knows it."""
    if problem.loads.earlier is None or not current.contact.history:
        return ()
    load = LoadResult(*problem.loads.earlier, current.contact.history[-1], mesh_error=current.mesh_error)
    bodies: tuple[Check, ...] = (_yielding, _may_yield, _beyond_curve, _turning, _contact_ends)
    return tuple(
        finding.at_place("largest earlier load") for check in bodies for finding in check(problem, [load])
    )


def target_cautions(problem: SealProblem, answers: Sequence[LoadResult]) -> Iterator[Finding]:
    """Cautions about the force for a target leak rate.

    Parameters
    ----------
    problem : SealProblem
    answers : sequence of LoadResult
        At least one.
    """
    ends = [pick(answers, key=lambda load: load.applied_force) for pick in (min, max)]
    each = "{{ force | quantity('short force') }} at {{ pressure | quantity('.4g bar') }}"
    forces = [Words(each, {"force": load.applied_force, "pressure": load.fluid_pressure}) for load in ends]
    lowest, highest = forces
    range_of = "at the force for the target leak rate, {{ low }}{{ ' to ' if several }}{{ high if several }}"
    several = str(lowest) != str(highest)
    place = Words(range_of, {"low": lowest, "high": highest, "several": several})
    for finding in _at_target(problem, answers):
        if not finding.silent:
            yield finding.at_place(place)


def target_validity(problem: SealProblem, answer: LoadResult) -> Validity:
    """Validity of the force for a target leak rate at one fluid pressure.

    Parameters
    ----------
    problem : SealProblem
    answer : LoadResult
    """
    return Validity.of(_at_target(problem, [answer]))


def _at_target(problem: SealProblem, answers: Sequence[LoadResult]) -> Iterator[Finding]:
    bodies: tuple[Check, ...] = (
        _yielding,
        _may_yield,
        _turning,
        _contact_ends,
        _wide,
        _above_hardness,
        _flanges_meet,
    )
    for check in bodies:
        yield from check(problem, answers)
    if problem.surface is not None and problem.flow is not None:  # of a leak rate
        if isinstance(problem.surface, RoughContact):
            sealing = problem.surface.sealing_pressure
            yield from _nearly_sealed(problem, problem.surface, answers, sealing)
        yield from molecule_cautions(problem.flow, answers)


def _of_surface(problem: SealProblem) -> Iterator[Finding]:
    if problem.origin.usual_only:
        yield caution("finish", leak_factor=Bounds.factor_bounds(10.0), proven=False)
    for text in problem.origin.remarks:
        yield remark("roughness", Level.DOUBTFUL, text, of_contact=False)


def _face_cautions(problem: SealProblem) -> Iterator[Finding]:
    for name, body, text in problem.origin.face_remarks:
        finding = caution(name, body=problem.contact.label_of(body), text=text, **problem.contact.labels)
        # a land that is wider than the closure is calculated as it is
        yield replace(finding, level=Level.VALID) if name == "land_beyond_face" else finding


def _faces(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    yield from (finding for finding in _face_cautions(problem) if finding.level is not Level.VALID)


def _near_opening(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    close = [(load.opening, load) for load in loads if load.opening and load.opening.share < _NEAR_OPENING]
    if close:
        margin, load = min(close, key=lambda item: item[0].share)
        share = max(margin.share, 0.0)
        yield caution(
            "near_opening",
            load,
            loads,
            share=share,
            force=_two_digits(margin.force, "N"),
            applied=load.applied_force,
            pressure=_two_digits(margin.pressure, "bar"),
            count=len(close),
            limit=100 * _NEAR_OPENING,
        )


def _yielding(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    if not loads[0].contact.model.knows_stress:
        return
    zones = [(load, zone) for load in loads for zone in yielding_of(load.contact, problem.materials).values()]
    elastic = [(load, zone) for load, zone in zones if isinstance(zone, YieldedZone)]
    # the body that is further above its yield stress comes first
    for name in dict.fromkeys(zone.body for _, zone in sorted(elastic, key=lambda item: -item[1].excess)):
        pairs = [(load, zone) for load, zone in elastic if zone.body == name]
        load, zone = max(pairs, key=lambda item: item[1].von_mises)
        first = load_words(min((load for load, _ in pairs), key=lambda load: load.point), loads)
        r, z = zone.place
        yield caution(
            "yield_stress",
            load,
            loads,
            outside=zone.excess > LARGEST_EXCESS,
            name=problem.contact.label_of(name),
            excess=_times(zone.excess, load, 3),
            stress=_stress(zone.von_mises, load, zone.yield_stress),
            limit=Quantity(zone.yield_stress, "fixed MPa"),
            r=r,
            z=z,
            depth=_um(zone.depth, load, 3),
            deepest=_um(zone.deepest, load, 3),
            first=first,
        )


def _yields_before_fluid(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Elastic bodies that have yielded under the applied force alone, before the fluid took a part of it.

    A stress grows at least with the root of the force, as in Hertz's line contact; what spreads the pressure at small
    forces, and faces that conform, make it grow faster.
    """
    has_history = problem.loads.earlier is not None or problem.loads.unsolved_bolts is not None
    if has_history or not loads[0].contact.model.knows_stress:
        return
    worst: dict[str, tuple[float, LoadResult]] = {}
    for name, material in problem.materials.items():
        limit = material.yield_stress
        for load in loads:
            is_lifted = load.applied_force > load.contact_force > 0.0 and not load.contact.stop_force
            if limit is None or material.hardening is not None or not is_lifted:
                continue
            share = math.sqrt(load.applied_force / load.contact_force)
            if load.contact.stays_below(name, limit / share):
                continue
            zone = yielded_zone(load.contact.fields[name], limit / share)
            excess_of_load = 0.0 if zone is None else zone.excess / share
            # told where the load itself does not say as much
            if zone is not None and (excess_of_load <= 1.0 or excess_of_load <= LARGEST_EXCESS < zone.excess):
                worst[name] = max(worst.get(name, (0.0, load)), (zone.excess, load), key=lambda item: item[0])
    for name, (excess, load) in sorted(worst.items(), key=lambda item: -item[1][0]):
        yield caution(
            "yielded_before",
            load,
            loads,
            outside=excess > LARGEST_EXCESS,
            name=problem.contact.label_of(name),
            lower=problem.contact.seat.label,
            excess=_times(excess, load),
            limit=Quantity(problem.materials[name].yield_stress or 0.0, "fixed MPa"),
            applied=load.applied_force,
        )


def _may_yield(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Bodies of which no stress says whether they yield, under a pressure under which they may.

    The peak pressure alone says so: a study that has no yield stress does without the stress, which takes memory.
    """
    load = max(loads, key=_highest_pressure)
    peak = _highest_pressure(load)
    for name, material in problem.materials.items():
        flows, hardness, basis = material.yield_stress, material.hardness, "yield stress"
        if flows is not None and load.contact.model.knows_stress:
            continue
        if flows is None and hardness is not None:
            flows, basis = hardness / HARDNESS_OVER_YIELD_STRESS, "hardness"
        elif flows is None:
            flows, basis = _SOFT * material.youngs_modulus, "Young's modulus"
        limit = _HERTZ_YIELDS * flows
        if peak > limit:
            label = problem.contact.label_of(name)
            yield caution(
                "may_yield",
                load,
                loads,
                name=label,
                pressure=_named_pressure(load),
                peak=_stress(peak, load, limit),
                limit=near_limit(limit, peak, 2),
                basis=basis,
                material=material.name or label,
            )


def _unknown_strain(problem: SealProblem, load: LoadResult) -> Iterator[Finding]:
    """A given contact whose metal may flow, so that its asperities sink and less leaks, nobody knows by how much."""
    profile, peak = load.tightest, load.peak_pressure
    surface, limits = problem.surface, dict[float, str]()
    for name, material in problem.materials.items():
        flows = material.yield_stress
        if flows is None and material.hardness is not None:
            flows = material.hardness / HARDNESS_OVER_YIELD_STRESS
        if flows is not None:
            limits.setdefault(flows, problem.contact.label_of(name))
    if surface is None or profile.strain is not None or not limits:
        return
    limit = min(limits)
    # asperities that do not yield do not sink
    if peak > _MAY_FLOW * limit and float(surface.pressure_at_rest(peak, 0.01, 0.01)) > peak:
        yield caution(
            "unknown_strain",
            load,
            [load],
            leak_factor=fade_in(Bounds(1.0 / ORDERS_OF_MAGNITUDE, 1.0), peak / limit),
            proven=False,
            name=limits[limit],
            peak=_stress(peak, load, limit),
            limit=near_limit(limit, peak, 2),
        )


def _beyond_curve(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    for name, material in problem.materials.items():
        curve, label = material.hardening, problem.contact.label_of(name)
        if curve is None:
            continue
        zones_of_loads = [(load, yielding_of(load.contact, problem.materials).get(name)) for load in loads]
        zones = [(load, zone) for load, zone in zones_of_loads if isinstance(zone, PlasticZone)]
        if not zones:
            continue
        load, zone = max(zones, key=lambda item: item[1].strain)
        if zone.strain > curve.last_strain:
            yield caution(
                "stress_strain_curve",
                load,
                loads,
                outside=True,
                name=label,
                strain=zone.strain,
                last=100 * curve.last_strain,
                stress=curve.stress[-1],
            )
        if zone.strain > _LARGE_STRAIN:
            limit = 100 * _LARGE_STRAIN
            yield caution(
                "large_strain", load, loads, outside=True, name=label, strain=zone.strain, limit=limit
            )


def _contact_ends(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    for end, side in ((0, "bore"), (-1, "outer")):
        ends = [load.profiles[end] for load in loads]
        shares = [float(p.pressure[end]) / load.peak_pressure for p, load in zip(ends, loads, strict=True)]
        if max(shares) > _CUT_SHARE:
            load = loads[shares.index(max(shares))]
            # conforming faces always end inside the contact
            conforms = math.isinf(load.contact.model.relative_radius)
            large = max(shares) > _LARGE_CUT_SHARE and not conforms
            values = {"side": side, "share": max(shares), "x": ends[0].x[end]}
            yield caution("cut_off", load, loads, outside=large, lower=problem.contact.seat.label, **values)


def _limit(name: str, share: Callable[[LoadResult], float], limit: float, bound: float = math.inf) -> Check:
    """Check of a number of each load: doubtful above `limit`, outside the theory above `bound`."""

    def check(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
        load = max(loads, key=share)
        worst = share(load)
        if worst > limit:
            numbers: dict[str, Any] = {
                "share": worst,
                "limit": limit,
                "largest": bound,
                "apart": _gap_at_peak(load),
            }
            yield caution(name, load, loads, outside=worst > bound, **numbers, **problem.contact.labels)

    return check


def _gap_at_peak(load: LoadResult) -> float:
    return float(load.contact.gap[int(np.argmax(load.contact.pressure))])


def _gap_over_radius(load: LoadResult) -> float:
    """Separation over the radius of curvature of the faces, averaged over the contact pressure."""
    forces, bend = load.contact.point_forces, load.contact.model.line.bend
    return float(np.maximum(load.contact.gap, 0.0) * bend @ forces / forces.sum())


def _shift_by_gap(load: LoadResult) -> float:
    """Shift of the closest approach along the seat by the separation, over the radius of first touch."""
    model = load.contact.model
    slope = math.sqrt(1 - model.touch_normal_z**2) / model.touch_normal_z / model.initial_contact_radius
    return slope * _gap_at_peak(load)


_turning = _limit("small_strain", lambda load: load.contact.turning, TURNED, LARGEST_TURNING)
_wide = _limit("wide_contact", lambda load: 2 * load.std / load.contact.model.initial_contact_radius, _NARROW)
_thick_layer = _limit("thick_layer", _gap_over_radius, _THICK_LAYER, _NO_LAYER)
_slides = _limit("steep_seat", _shift_by_gap, _SLIDES)


def _moved_by_heat(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Heat slides the faces along each other, but the contact is calculated at its place on the drawing."""
    if not problem.at_rest.temperatures:
        return
    model = loads[0].contact.model
    at_rest, outwards = problem.at_rest.body_loads(model), []
    for body in (model.closure, model.seat):
        touch = body.fem.contact_dofs[0, np.argmin(np.abs(body.fem.contact_x))]
        outwards.append(float(at_rest.displacement(body, model)[touch]))
    # the closure follows along the axis, so that the faces stay together
    shift = outwards[0] - outwards[1]
    slide = abs(shift) / model.touch_normal_z
    contact = problem.contact
    bends = abs(contact.closure_curvature * contact.seat_curvature)
    turn = 0.0 if contact.normal_turns else slide * bends * min(contact.relative_radius, 1 / _TINY)
    ends = min(abs(end) for end in contact.reach)
    if turn > _TURNS or slide > _NEAR_END * ends:
        numbers: dict[str, Any] = {"slide": slide, "beyond": shift, "turn": math.degrees(turn), "ends": ends}
        yield caution("heat", **numbers, **contact.labels)


def _flanges_meet(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Flanges of a gasket that come as much nearer to each other as they are apart at first touch."""
    if problem.faces == 1:
        return
    contact, load = problem.contact, max(loads, key=lambda load: load.contact.approach)
    model, half = load.contact.model, contact.closure.extent[1][0] - contact.seat.extent[1][0]
    limit = problem.stop_approach(model, half)
    if load.contact.approach > limit:
        way, room, stop = (
            1e6 * problem.faces * length for length in (load.contact.face_approach, limit - model.touch, half)
        )
        yield caution("flanges_meet", load, loads, outside=True, way=way, apart=room, stop=stop)


def _creeps(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    for name, material in problem.labelled_materials.items():
        if material.creeps:
            yield caution("creep", name=name, material=material.name)


def _hot(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    yield from (finding for finding in _temperature_cautions(problem) if finding.level is not Level.VALID)


def _stress(pressure: float, load: LoadResult, limit: float) -> Words:
    """A contact pressure or stress of a load, with enough digits to tell it from a limit [Pa]."""
    return near_limit(pressure, limit, load.pressure_digits)


def _two_digits(value: float, unit: str) -> Words:
    """A force or pressure [SI] in a unit of the field, or that in its place."""
    words = "{% set usual = display.fixed_unit(unit) %}{{ usual.of(value) | quantity('number 2') }} {{ usual.name }}"
    return Words(words, {"value": value, "unit": unit})


def _times(share: float, load: LoadResult, digits: int = 2) -> str:
    """A pressure or stress over its limit."""
    return format_at_limit(share, 1.0, min(load.pressure_digits, digits))


def _um(length: float, load: LoadResult, digits: int = DIGITS) -> Quantity:
    """A length with the accuracy of the contact width, in um or what is in its place."""
    return Quantity(length, f"fixed um {min(load.digits_of('std'), digits)}")


def _highest_pressure(load: LoadResult) -> float:
    """Highest contact pressure of this load and the loads before; of a seal that is not round, around its axis [Pa]."""
    highest = load.tightest.highest
    return (
        highest if load.circumference is None else max(highest, float(load.circumference.peak_pressure.max()))
    )


def _named_pressure(load: LoadResult) -> str:
    """Name of `_highest_pressure`."""
    profile = load.tightest
    is_current = profile.highest <= profile.peak_pressure * (1.0 + 1e-9)
    return "peak pressure" if is_current else "largest earlier pressure"


def _above_hardness(problem: SealProblem, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    load = max(loads, key=_highest_pressure)
    peak, hardness = _highest_pressure(load), problem.hardness
    yield_too = problem.surface is not None and problem.surface.hardness is not None
    if hardness is None or peak <= (_NEAR_HARDNESS if yield_too else 1.0) * hardness:
        return
    share = peak / hardness
    yield caution(
        "hardness",
        load,
        loads,
        outside=share > 1,
        pressure=_named_pressure(load),
        times=_times(share, load),
        peak=_stress(peak, load, hardness),
        share=share,
    )


def _is_sealed(load: LoadResult, surface: RoughContact, sealing: float) -> bool:
    """Whether a load is sealed by its own pressure, or still sealed by a larger load before.

    A short contact may leak above the sealing pressure. A seal that is not round may leak elsewhere.
    """
    profile, leak = load.tightest.at_rest(surface), load.leak
    if leak is None or load.circumference is not None:
        return profile.peak_pressure >= sealing
    return profile.highest >= sealing and leak.leak_rate == 0.0


def _sealed_loads(surface: RoughContact, loads: Sequence[LoadResult], sealing: float) -> Iterator[Finding]:
    tight = [load for load in loads if _is_sealed(load, surface, sealing)]
    if tight:
        load = max(tight, key=lambda load: load.peak_pressure)
        peak, acts = load.tightest.highest, load.tightest.at_rest(surface).highest
        first = load_words(min(tight, key=lambda load: load.point), loads)
        leaky = surface.hardness is not None and surface.latest_sealing_pressure > acts
        bounded = load.leak_before_sealing > 0.0
        yield caution(
            "sealed",
            load,
            loads,
            leak_factor=Bounds(0.0 if leaky else 1.0, math.inf if leaky or bounded else 1.0),
            known_to=INPUTS_KNOWN_TO if bounded else None,
            threshold=surface.percolation_threshold,
            pressure=_named_pressure(load),
            peak=_stress(peak, load, sealing),
            acts=_stress(acts, load, sealing) if acts > AGREE * peak else None,
            limit=Quantity(sealing, "fixed MPa"),
            first=first,
        )
        yield from _few_channels(load, loads, surface)


def _nearly_sealed(
    problem: SealProblem, surface: RoughContact, loads: Sequence[LoadResult], sealing: float
) -> Iterator[Finding]:
    leaky = [load for load in loads if not _is_sealed(load, surface, sealing)]
    if not leaky:
        return
    load = max(leaky, key=lambda load: load.peak_pressure)
    if problem.flow is not None and problem.flow.direct is not None:
        yield from _direct_cautions(problem.flow.direct.table(surface), load, loads, surface)
        return
    yield from _few_channels(load, loads, surface)
    rest = load.tightest.at_rest(surface)
    peak = float(surface.equivalent_first_loading_pressure(rest.peak_pressure, rest.highest))
    if surface.most_contact_area(peak) <= DIRECT_END:
        return
    area = float(surface.contact_area(peak))
    if area <= DIRECT_END:
        return
    leak, share_closed = load.leak, (area - DIRECT_END) / (_CLOSED_AREA - DIRECT_END)
    low, high = ORDERS_OF_MAGNITUDE ** -min(share_closed, 1.0), math.inf
    if load.circumference is not None:
        # what a form error adds has no bound
        high = 1.0 / low
    elif leak is not None and leak.leak_rate > 0.0 and load.leak_before_sealing > 0.0:
        high = max(load.leak_before_sealing / leak.leak_rate, 1.0)
    few = Validity.of(_few_channels(load, loads, surface)).leak_factor.high
    finite = load.circumference is None and few * high < ORDERS_OF_MAGNITUDE
    yield caution(
        "close_to_threshold",
        load,
        loads,
        leak_factor=Bounds(low, high),
        proven=False,
        area=area,
        threshold=surface.percolation_threshold,
        flows=rest.peak_pressure > AGREE * load.peak_pressure,
        above=peak >= sealing,
        direct_end=DIRECT_END,
        times=few * high if finite else None,
        with_lay=few > 1.0 and surface.peklenik != 1.0,
    )


def _few_channels(load: LoadResult, loads: Sequence[LoadResult], surface: RoughContact) -> Iterator[Finding]:
    """How far the conductivity is from direct simulation where few channels are left or the roughness has a lay."""
    # the deviation from direct simulation includes that of few channels
    known_all, peak = surface.knows_deviation, load.tightest.at_rest(surface).peak_pressure
    if surface.peklenik == 1.0 and (known_all or surface.most_contact_area(peak) <= _NOT_FEW):
        return
    area = float(surface.contact_area(peak))
    weight = min(max((area - _NOT_FEW) / (_FEW_CHANNELS - _NOT_FEW), 0.0), 1.0)
    if known_all:
        weight *= min(abs(math.log2(surface.peklenik)), 1.0)
    few, lay = _interpolate_factor(_FACTORS, area) ** weight, _lay_factor(area, surface.peklenik)
    factor, of_lay, is_near = max(few, lay), lay > _LAY_REPORTED, area > DIRECT_END
    if of_lay or known_all:
        long = max(surface.peklenik, 1.0 / surface.peklenik) > _LAY_LONGEST
        largest_area, longest = _LAY_KNOWN if area > _LAY_KNOWN else None, _LAY_LONGEST if long else None
        yield caution(
            "lay",
            load,
            loads,
            leak_factor=fade_in(Bounds.factor_bounds(factor), math.log(lay) / math.log(_LAY_REPORTED)),
            is_reported=of_lay and not is_near,
            proven=largest_area is None and longest is None,
            lay=factor,
            area=area,
            flows=peak > AGREE * load.peak_pressure,
            peklenik=surface.peklenik,
            largest_area=largest_area,
            longest=longest,
        )
    else:
        yield caution(
            "few_channels",
            load,
            loads,
            leak_factor=Bounds.factor_bounds(factor),
            is_reported=area > _FEW_CHANNELS and not is_near,
            area=area,
            factor=factor,
            few_channels=_FEW_CHANNELS,
        )


def _direct_cautions(
    table: DirectTable, load: LoadResult, loads: Sequence[LoadResult], surface: FaceContact
) -> Iterator[Finding]:
    """Cautions about a conductivity from direct simulation: its range, tight patches, scatter."""
    peak = load.tightest.at_rest(surface).peak_pressure
    flows = peak > AGREE * load.peak_pressure
    (low, high), crests = table.range, table.simulation.has_crests
    at = _stress(peak, load, min((low, high), key=lambda end: abs(end - peak)))
    # of crests that are tight `turned_cautions` speak
    if not low <= peak <= (math.inf if crests else high):
        side = "above" if peak > high else "below"
        yield caution("direct_range", load, loads, side=side, low=low, high=high, at=at, flows=flows)
    first = [row for row in table.rows if row.branch == "load"]
    nearest = min(first, key=lambda row: abs(math.log(row.pressure / peak)))
    tight = [row for row in first if row.blocked and row.pressure <= max(peak, nearest.pressure)]
    if tight and not crests:
        n, of, pressure = tight[-1].blocked, tight[-1].samples, Quantity(tight[-1].pressure, ".4g MPa")
        yield caution("tight_patches", load, loads, n=n, of=of, pressed=pressure, at=at, flows=flows)
    row = min(table.loading, key=lambda row: abs(math.log(row.pressure / peak)))
    below, above = (math.exp(error) for error in table.log_error(row))
    if max(below, above) > _UNSURE:
        yield caution(
            "direct_scatter",
            load,
            loads,
            leak_factor=Bounds(1.0 / below, above),
            down=below,
            up=above,
            at=at,
            samples=row.samples,
            crests=crests,
            octave=1.0 / row.cutoff_ratio if row.cutoff_ratio > 0.0 else None,
        )


def _interpolate_factor(factors: Sequence[tuple[float, float]], area: float) -> float:
    """A factor that was found at some A/A0, without a step between them: a larger load must not seem to leak more."""
    areas, values = zip(*factors, strict=True)
    return math.exp(np.interp(area, areas, np.log(values)))


def _lay_factor(area: float, peklenik: float) -> float:
    """Largest factor by which the theory's flow conductivity differs from direct numerical results because of a lay."""
    ratio = max(peklenik, 1.0 / peklenik)
    factor = _LAY_ALONG if peklenik >= 1.0 else _interpolate_factor(_LAY_ACROSS, area)
    return float(factor ** min(1.0, math.log2(ratio)) * max(1.0, ratio / _LAY_LONG) ** _LAY_POWER)


def _range(problem: SealProblem, surface: RoughContact, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    load = max(loads, key=lambda load: load.std)
    std, q_low = load.std, surface.spectrum.q_low
    if q_low * std > 1 and problem.origin.cutoff is not None:
        yield caution("waviness", load, loads, cutoff=problem.origin.cutoff, width=_um(2 * np.pi * std, load))
    elif q_low * std > 1:
        yield caution(
            "roughness_range", load, loads, longest=2 * np.pi / q_low, std=_um(std, load), q=1 / std
        )


def _long_waves(surface: RoughContact, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    load = min(loads, key=lambda load: load.std)
    std, spectrum = load.std, surface.spectrum
    share_above = float(spectrum.height_variance_above(1 / std)) / spectrum.rms_height**2
    share = 1.0 - share_above
    factors, times = EXACT, None
    if surface.knows_deviation:
        times = 1.0 + _MORE_OF_LONG * share
        factors = Bounds(1.0 / (1.0 + _LESS_OF_LONG * share), times)
    reports, factors = share > _LONG_WAVES, fade_in(factors, share / _LONG_WAVES)
    if reports or factors.is_range:
        yield caution(
            "long_waves",
            load,
            loads,
            leak_factor=factors,
            is_reported=reports,
            share=share,
            std=_um(std, load),
            times=times,
        )


def _fluid_opens(problem: SealProblem, flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    if flow.fluid_in_gap == "local":
        yield from _lifted_open(loads)
    elif problem.loads.closing != "penetration":
        load = max(loads, key=_fluid_over_contact)
        share = _fluid_over_contact(load)
        times = opening_factor(share)
        yield caution(
            "fluid_opens",
            load,
            loads,
            outside=share > _FLUID_LIFTS,
            leak_factor=fade_in(Bounds(1.0, times), share / FLUID_OPENS),
            is_reported=share > FLUID_OPENS,
            share=share,
            times=times if share < _FLUID_LIFTS else None,
            several_lands=bool(load.whole_profile.parts),
        )


def _fluid_over_contact(load: LoadResult) -> float:
    """Fluid pressure over the peak contact pressure, of the land where it is most [-]."""
    if len(load.profiles) == 1 or load.leak is None:
        return load.fluid_pressure / load.peak_pressure
    pairs = [
        (max(flow.inner_pressure, flow.outer_pressure), float(profile.pressure.max()))
        for flow, profile in zip(load.leak.lands, load.profiles, strict=True)
        if profile.touches
    ]
    return max(fluid / contact for fluid, contact in pairs)


def _lifted_open(loads: Sequence[LoadResult]) -> Iterator[Finding]:
    blown = [load for load in loads if load.leak is not None and math.isinf(load.leak.leak_rate)]
    if blown:
        load = min(blown, key=lambda load: load.point)
        peak = _stress(load.peak_pressure, load, load.fluid_pressure)
        yield caution("lifted_open", load, loads, outside=True, peak=peak)


def _coarse(load: LoadResult) -> Iterator[Finding]:
    """Finding about the mesh, the same for all loads; none where its error is not known."""
    error, model = load.mesh_error, load.contact.model
    if error is None:
        return
    estimates = error.peak_pressure, error.std, error.leak_rate or 0.0
    worst = max(estimates)
    if not all(map(math.isfinite, estimates)):
        yield caution("mesh_not_estimated")
    elif model.yields:
        if worst > _LARGEST_ERROR_OF_PATH:
            yield caution("mesh_and_steps", share=worst)
    elif worst > _LARGEST_ERROR:
        size = float(np.diff(model.line.vertices).min())
        yield caution("mesh", share=worst, size=size)
