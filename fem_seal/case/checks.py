"""Checks across tables: contradictions between the tables of a case, and loads that cannot be calculated."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from fem_seal.case.fields import OF_GASES, OF_LIQUIDS, RATES, show
from fem_seal.case.material_table import suggestion
from fem_seal.case.roughness import (
    SHAPE,
    MeasuredSpectrum,
    SelfAffine,
    scanned_faces,
    self_affine_part,
    uncertain_heights,
)
from fem_seal.case.shapes import FlangeFace
from fem_seal.case.tables import RELIEF, CaseTables, Leak, Requirement, Uncertainty, curves
from fem_seal.case.temperature import Temperature
from fem_seal.case.tightening import problems_of_bolts
from fem_seal.errors import InputError, Problem
from fem_seal.files import UnreadableFileError, check_file, problem
from fem_seal.loads import CONSTRAINT, LARGEST_TURNING, contact_force, line_load, plastic_half_width
from fem_seal.wording import Quantity
from meshes import ContactGeometry, GeometryError
from meshes.errors import mm
from meshes.geometry.contact_geometry import facets_at
from meshes.shapes.shape import named_face

# Interference of a press fit over the radius of the wall, up to which strains are small.
_LARGEST_FIT = 0.01
# Thermal strain up to which strains are small.
_LARGEST_STRAIN = 0.02


def contradictions(case: CaseTables) -> list[Problem]:
    """Everything in a case that does not fit together."""
    return [
        *(geometry := list(_bodies(case) if case.has_shapes else _without_shapes(case))),
        *_gasket(case),
        *_spectrum(case),
        *_interface(case),
        *_of_paper(case),
        *_turned(case),
        *_hardness(case),
        *(load := list(_load(case))),
        *([] if geometry or load else problems_of_all_loads(case)),
        *(earlier := list(_earlier(case))),
        *_history(case),
        *([] if case.bolts is None else problems_of_bolts(case, case.bolts)),
        *([] if geometry or load or earlier else filter(None, [problem_of_earlier_load(case)])),
        *([] if geometry or case.temperature is None else _temperature(case, case.temperature)),
        *_fluid(case),
        *_flow(case),
        *_direct(case),
        *([] if geometry else _lands(case)),
        *([] if case.uncertainty is None else problems_with_uncertainty(case, case.uncertainty)),
        *_form(case),
        *_leak_rates(case),
        *([] if case.requirement is None else _requirement(case, case.requirement)),
    ]


def _flow(case: CaseTables) -> Iterator[Problem]:
    if case.leak.fluid_in_gap == "local" and case.fluid is not None and case.fluid.gas is not None:
        yield problem("local_gas")


def _direct(case: CaseTables) -> Iterator[Problem]:
    if case.direct is not None and case.roughness is None:
        yield Problem("direct", "simulates the surface of [roughness], and there is none; add it")
    yield from _asperities(case)
    hardness = None if case.simulated_asperities == "elastic" else case.hardness
    if case.direct is not None and case.direct.pressure is not None and hardness is not None:
        highest = max(case.direct.pressure)
        if highest >= hardness:
            yield problem("direct_pressure", hardness=hardness / 1e6, highest=highest / 1e6)
    if case.leak.conductivity == "direct" and case.direct is None:
        yield problem("direct_missing")


def _asperities(case: CaseTables) -> Iterator[Problem]:
    """What yields in a simulation, and whether it can."""
    direct = case.direct
    if direct is None:
        return
    if direct.yield_stress is not None and direct.asperities != "von-mises":
        yield problem("direct_yield_stress", stress=direct.yield_stress / 1e6)
    if direct.asperities in (None, "elastic"):
        return
    if case.hardness is None and (direct.asperities == "capped" or direct.yield_stress is None):
        needs = "a hardness" + (" or direct.yield_stress" if direct.asperities == "von-mises" else "")
        yield problem("direct_hardness", needs=needs, asperities=direct.asperities)
    elif case.hardness is not None and not case.leak.plasticity:
        yield problem("direct_elastic", asperities=direct.asperities)


def _bodies(case: CaseTables) -> Iterator[Problem]:
    faults = [*case.closure.problems(), *case.lower.problems()]
    if faults:
        yield from faults
        return
    try:
        r0 = case.initial_contact_radius
    except GeometryError as error:
        yield _geometry_problem(str(error), case)
        return
    size = case.mesh.contact_size
    if size is not None and size > r0 / 4:
        yield problem("mesh_contact_size", radius=mm(r0), limit=mm(r0 / 4), value=mm(size))
    if case.gasket is not None:
        yield from _meets_beside(case)
    # around a small bore the strain is up to three times that of the wall, which must stay small, too
    yield from _small_fit(case, "seat_interference", case.lower.interference or 0.0)


def _without_shapes(case: CaseTables) -> Iterator[Problem]:
    """What needs more of the bodies than their materials."""
    keys = {"bolts": case.bolts, "form": case.form, "temperature.faces": case.conducts_heat or None}
    yield from (problem("without_shapes", key=key) for key, table in keys.items() if table is not None)


def _meets_beside(case: CaseTables) -> Iterator[Problem]:
    """Flanges that meet each other, or penetrate the gasket beside its contact, before it is touched."""
    closure, seat = case.contact.closure, case.contact.seat
    height = case.faces * (seat.extent[1][1] - seat.extent[1][0])
    if case.gasket is not None and case.gasket.stop is not None and case.gasket.stop > height / 2:
        yield problem("stop_beyond_half", height=mm(height), value=mm(case.gasket.stop))
    distance = closure.extent[1][0] - seat.extent[1][0]
    if distance < 0:
        yield problem("flanges_meet", deep=mm(-distance))
    slack = 1e-3 * case.initial_contact_radius
    for outline, opposite in ((seat, closure), (closure, seat)):
        corners = np.array([s.start for s in outline.segments]).T
        is_inside = np.all([opposite.shift(way).holds(corners) for way in (-slack, slack)], axis=0)
        if is_inside.any():
            r, z = corners[:, is_inside][:, 0].tolist()
            yield problem("penetrates", r=mm(r), apart=mm(z))
            return


def _small_fit(case: CaseTables, name: str, motion: float) -> Iterator[Problem]:
    """The problem of this name where the wall of the seat is moved inwards by more than small strains allow [m]."""
    wall, percent = case.contact.seat.largest_radius, 100 * _LARGEST_FIT
    if motion > _LARGEST_FIT * wall:
        lengths = {"wall": mm(wall), "limit": mm(_LARGEST_FIT * wall), "value": mm(motion)}
        yield problem(name, share=100 * motion / wall, most=percent, **lengths)


def _temperature(case: CaseTables, heat: Temperature) -> Iterator[Problem]:
    """What in [temperature] contradicts itself, or needs a number that no material has."""
    for name, body in (("closure", case.closure), ("seat", case.lower)):
        if body.base == "held":
            yield problem("held_base_heated", key=f"{name}.base")
    bodies = [name for name in ("uniform", "closure", "seat") if getattr(heat, name) is not None]
    entries = [*bodies, *heat.faces]
    if bodies not in ([], ["uniform"], ["closure", "seat"]) or not entries or (bodies and heat.faces):
        yield problem("temperature_given", given=" and ".join(entries) or "no temperature")
        return
    if heat.contact_conductance is not None and not heat.faces:
        yield problem("contact_conductance")
    if heat.of_rough_faces and case.roughness is None:
        yield problem("conductance_without_roughness")
    has_fixed_wall = case.lower.wall == "fixed"
    for name in ("housing", "housing_expansion"):
        if getattr(heat, name) is not None and not has_fixed_wall:
            yield problem("without_housing", name=name)
    if heat.faces:
        for name in ("closure", "seat"):
            yield from _unknown(case, "material_number", name, "thermal_conductivity", "W/(m K)")
            yield from _unknown(case, "material_number", name, "thermal_expansion", "1/K")
        return
    strains = []
    for name in ("closure", "seat") if case.expands or has_fixed_wall else ():
        try:
            strains.append(case.thermal_strain(name))
        except InputError as error:
            material = case.table_of(name).material.name
            range_problem = Problem(
                f"{case.key_of(name)}.material.thermal_expansion", f"{material}: {error.message}"
            )
            yield from [*_unknown(case, "no_expansion", name, "thermal_expansion", "1/K")] or [range_problem]
    for name, strain in zip(("closure", "seat"), strains, strict=False):
        if abs(strain) > _LARGEST_STRAIN:
            yield problem(
                "thermal_strain", name=case.key_of(name), strain=100 * strain, limit=100 * _LARGEST_STRAIN
            )
    if len(strains) == 2 and has_fixed_wall:
        yield from _fit(case)


def _unknown(case: CaseTables, name: str, body: str, number: str, unit: str) -> Iterator[Problem]:
    """The problem of this name where a number of a body's material is not known at any temperature."""
    material = case.table_of(body).material
    if getattr(material, number) is None and material.table(number) is None:
        remedy = suggestion(material.name, number, unit)
        yield problem(name, name=case.key_of(body), number=number, material=material, remedy=remedy)


def _fit(case: CaseTables) -> Iterator[Problem]:
    """A bore holds the seat's wall where it presses on it, and cannot pull."""
    try:
        motion = case.wall_motion
    except InputError as error:
        yield error.problems[0]
        return
    if motion < -1e-12 * case.contact.seat.largest_radius:
        yield problem("loose_fit", moved=1e6 * -motion)
    yield from _small_fit(case, "tight_fit", motion)


def _geometry_problem(message: str, case: CaseTables) -> Problem:
    """A geometry that cannot be, at its key if the message begins with one."""
    key_match = re.match(r"(closure|seat|gasket) ([\w\[\].]+) = ([^:]+): (.+)", message, re.DOTALL)
    outline = re.match(r"(closure|seat|gasket) outline: (.+)", message, re.DOTALL)
    if outline is not None:
        body, what = outline[1] if outline[1] == "closure" else case.key_of("seat"), outline[2]
        table = case.closure if body == "closure" else case.lower
        source = "outline" if getattr(table, "outline", None) is not None else "file"
        return Problem(f"{body}.{source}", what)
    if key_match is None:
        return Problem(case.key_of("seat"), message)
    body, key, value, what = key_match.groups()
    return Problem(f"{body}.{key}", what, value)


def _gasket(case: CaseTables) -> Iterator[Problem]:
    """What does not go together with a gasket, and what only goes together with one."""
    if case.gasket is None:
        if isinstance(case.closure, FlangeFace):
            yield problem("flange_without_gasket", value=show(case.closure.shape))
        if case.roughness is not None and case.roughness.gasket is not None:
            yield problem("roughness_without_gasket")
        return
    if isinstance(case.closure, FlangeFace) and case.load.closing == "penetration":
        yield problem("penetration_of_flange", shape=show(case.closure.shape))
    if case.temperature is not None and case.temperature.uniform is None:
        yield problem("temperature_of_gasket")
    if case.form is not None and case.form.seat is not None:
        yield problem("form_of_gasket")
    if case.roughness is not None and case.roughness.seat is not None:
        yield problem("face_of_lower_flange")


def of_unlike_flanges(case: CaseTables) -> Iterator[Problem]:
    """What does not go together with two different flange faces.

    Parameters
    ----------
    case : CaseTables
        Of the upper flange.
    """
    particles = case.fluid is not None and case.fluid.particles is not None
    options = {
        case.uneven_key or "form": case.uneven_key is not None,
        "gasket.stop": case.gasket is not None and case.gasket.stop is not None,
        "fluid.particles": particles,
        "leak.conductivity": case.leak.conductivity == "direct",
    }
    yield from (problem("with_unlike_flanges", key=key) for key, is_used in options.items() if is_used)
    if case.bolts is not None:
        yield problem("bolts_of_unlike_flanges")
    if case.contact.chambers:
        # how the contacts of a face share its force depends on the other one
        yield problem("unlike_flanges_in_series")


def _spectrum(case: CaseTables) -> Iterator[Problem]:
    for name, spectrum in case.roughness.parts.items() if case.roughness else ():
        if isinstance(spectrum, SelfAffine):
            has_band = spectrum.q_low < spectrum.q_high
            if not has_band or not spectrum.q_low <= spectrum.q_rolloff <= spectrum.q_high:
                entry = "q_rolloff" if has_band else "q_low"
                yield problem(entry, key=f"roughness.{name}", spectrum=spectrum)


def _interface(case: CaseTables) -> Iterator[Problem]:
    interface, rough = case.interface, case.roughness is not None
    if interface.law == "spectrum" and not rough:
        yield problem("roughness")
    if interface.law != "exponential":
        for key in ("gamma", "u0", "p_c"):
            if getattr(interface, key) is not None:
                yield problem("other_law", key=key, interface=interface)
    if interface.law != "spectrum" and interface.plastic:
        yield problem("plastic_law", interface=interface)
    if interface.law == "spectrum" and interface.plastic and rough and not case.leak.plasticity:
        yield problem("plastic_elastic")
    if interface.law == "exponential" and interface.gamma is not None and interface.u0 is not None:
        yield problem("gamma_and_u0", interface=interface)
    if interface.law == "exponential" and not rough:
        for key, source in (("u0", "gamma times rms height"), ("p_c", "spectrum")):
            if getattr(interface, key) is None:
                yield problem("law_without_roughness", key=key, source=source)
        if interface.gamma is not None:
            yield problem("gamma_without_roughness", interface=interface)


def _of_paper(case: CaseTables) -> Iterator[Problem]:
    """What only the paper's theory has."""
    if case.leak.theory == "paper":
        return
    if case.interface.plastic:
        yield problem("of_paper", key="interface.plastic", value="true")
    if case.leak.percolation_threshold != Leak().percolation_threshold:
        threshold = f"{case.leak.percolation_threshold:g}"
        yield problem("of_paper", key="leak.percolation_threshold", value=threshold)


# What [direct] says of random patches alone.
_OF_PATCHES = ("size", "waves", "points_per_wave", "amplitudes", "direction", "file")


def _turned(case: CaseTables) -> Iterator[Problem]:
    """What is not known of a turned face."""
    if case.roughness is None or not case.roughness.is_turned:
        return
    particles = case.fluid is not None and case.fluid.particles is not None
    options = {
        'leak.theory = "paper"': case.leak.theory == "paper",
        'leak.fluid_in_gap = "local"': case.leak.fluid_in_gap == "local",
        "fluid.particles": particles,
        "form.lay": case.form is not None and case.form.lay is not None,
    }
    measured = any(isinstance(face, MeasuredSpectrum) for face in case.roughness.turned_faces.values())
    for option, is_used in options.items():
        if is_used:
            yield problem("with_turned_face", option=option, measured=measured)
    if case.direct is not None:
        given = case.direct.model_fields_set
        yield from (problem("direct_turned", name=name) for name in _OF_PATCHES if name in given)
        if "points" in given and case.direct.points % 2:
            yield problem("direct_odd", points=case.direct.points)
    interface = case.interface
    if interface.law == "exponential" and (interface.u0 is None or interface.p_c is None):
        yield problem("turned_exponential")


def _hardness(case: CaseTables) -> Iterator[Problem]:
    if case.roughness is None or case.hardness is not None:
        return
    words = {name: show(case.table_of(name).material.name) for name in ("closure", "seat")}
    words["body"] = case.key_of("seat")
    if case.leak.plasticity:
        yield problem("no_hardness", **words)
    if case.interface.plastic:
        yield problem("no_hardness_of_law", **words)


def _missing(case: CaseTables) -> str | None:
    """The table without which there is no leak rate."""
    return next((name for name in ("roughness", "fluid") if getattr(case, name) is None), None)


def _load(case: CaseTables) -> Iterator[Problem]:
    load = case.load
    if load.is_dry:
        wet = {
            "[fluid]": case.fluid is not None,
            'load.closing = "penetration"': load.closing == "penetration",
            "load.set_pressure": load.set_pressure is not None,
            "load.chamber_pressure": load.chamber_pressure is not None,
        }
        if others := [name for name, is_given in wet.items() if is_given]:
            given = "fluid_pressure" in load.model_fields_set
            yield problem("dry", given=given, others=" and ".join(others))
        elif not all(force > 0 for _, force in load.points):
            yield problem("dry_without_force")
    elif not all(load.fluid_pressure):
        yield problem("dry_in_part")
    pressures, forces = len(load.fluid_pressure), load.applied_force
    if isinstance(forces, tuple) and len(forces) != pressures:
        yield problem("load_applied_force", forces=len(forces), pressures=pressures)
    if load.set_pressure is not None and case.bolts is not None:
        yield problem("bolts_and_force")
    if load.closing == "penetration" and case.leak.fluid_in_gap == "local":
        yield problem("local_penetration")
    if load.target_leak_rate is not None and (table := _missing(case)):
        yield problem(
            "load_target_leak_rate", missing=table, value=Quantity(load.target_leak_rate, "given flow")
        )


def _lands(case: CaseTables) -> Iterator[Problem]:
    """What does not go together with several lands, or only with them."""
    count, pressures_given = len(case.contact.chambers), case.load.chamber_pressure
    if pressures_given is not None and len(pressures_given) not in {1, count}:
        yield problem("chamber_count", given=len(pressures_given), count=count, **case.labels)
    if not count:
        if pressures_given is not None:
            yield problem("no_chamber", **case.labels)
        return
    if case.uneven_key is not None:
        yield problem("lands_form", key=case.uneven_key, **case.labels)
    if case.leak.fluid_in_gap == "local":
        yield problem("lands_local", **case.labels)


def _earlier(case: CaseTables) -> Iterator[Problem]:
    """What does not go together with a larger load before all others."""
    load = case.load
    if load.earlier is None:
        return
    key, pressure = load.earlier_key, load.largest_earlier_pressure
    value = (
        Quantity(load.earlier[1], "given force")
        if pressure is None
        else Quantity(pressure, "given fluid pressure")
    )
    if pressure is not None:
        if load.largest_earlier_force is not None:
            yield problem("two_earlier_loads", value=value)
        elif load.pressure_side == "inner":
            yield problem("earlier_lifts", value=value, **case.labels)
        elif len({force for _, force in load.points}) > 1:
            yield problem("earlier_forces", value=value)
    table = _missing(case)
    if not curves(case) and (table or not case.leak.plasticity):
        why = f"no leak rate without [{table}]" if table else "leak.plasticity = false"
        remedy = "add the table" if table else "set plasticity = true"
        yield problem("earlier_without_effect", key=key, why=why, remedy=remedy, value=value)


def _history(case: CaseTables) -> Iterator[Problem]:
    """What says nothing of asperities that were pressed harder before, by an earlier load or on the way."""
    load = case.load
    if load.earlier is not None:
        key = load.earlier_key
        cause, remedy = key, f"remove {key}"
    elif case.bolts is not None and case.roughness is not None and case.leak.plasticity:
        cause, remedy = "[bolts]", "set leak.plasticity = false"
    elif (
        len(load.fluid_pressure) > 1 and curves(case) and case.roughness is not None and case.leak.plasticity
    ):
        cause, remedy = "stress_strain with several loads", "give one load, or set leak.plasticity = false"
    else:
        return
    if case.leak.fluid_in_gap == "local":
        yield problem("local_memory", before=cause, instead=remedy)


def _fluid(case: CaseTables) -> Iterator[Problem]:
    fluid = case.fluid
    if fluid is None:
        return
    fluid_name = show(fluid.name)
    if fluid.gas is None and fluid.outlet_pressure is not None:
        value = Quantity(fluid.outlet_pressure, "given fluid pressure")
        yield problem("fluid_outlet_pressure", fluid=fluid_name, value=value)
    laws = [name for name in ("pressure_viscosity", "roelands_z") if getattr(fluid, name) is not None]
    if fluid.gas is not None:
        for name in laws:
            yield problem("liquid_only", name=name, fluid=fluid_name)
    elif len(laws) > 1:
        yield Problem("fluid.roelands_z", "says the same as fluid.pressure_viscosity; remove one of them")
    elif fluid.roelands_z is not None and fluid.viscosity <= 1e-4:
        yield problem("fluid_roelands_z", viscosity=1e3 * fluid.viscosity, fluid=fluid)
    if fluid.particles is None:
        return
    if case.roughness is None:
        yield problem("fluid_particles")
    if fluid.gas is not None and fluid.particles.iso_4406 is not None:
        yield problem("fluid_particles_iso_4406", fluid=fluid_name, value=show(fluid.particles.iso_4406))


def _form(case: CaseTables) -> Iterator[Problem]:
    """What does not go together with a form error or a moment."""
    form, key = case.form, case.uneven_key
    if form is not None and "guide" in form.model_fields_set:
        circle = None if case.bolts is None else case.bolts.circle
        if case.load.moment or (circle is not None and circle.moment):
            yield problem("guide_and_moment", guide=form.guide, bolts=not case.load.moment)
    if curves(case) and key is not None:
        bodies = [
            case.key_of(name)
            for name in ("closure", "seat")
            if case.table_of(name).material.hardening is not None
        ]
        yield problem("form", key=key, bodies=" and ".join(bodies))
    if form is not None and (form.scratches or form.lay) and (table := _missing(case)):
        yield problem("grooves", key="scratches" if form.scratches else "lay", missing=table)


def _leak_rates(case: CaseTables) -> Iterator[Problem]:
    """What is said of gases only, or of liquids only; and a volume of bubbles that counts for nothing."""
    if case.fluid is None:
        return
    gas, requirement = case.fluid.gas is not None, case.requirement
    fluid = "a gas" if gas else "a liquid"
    for table, key in RATES:
        rate = getattr(getattr(case, table), key, None)
        for kind, meaning in (OF_LIQUIDS if gas else OF_GASES).items():
            if isinstance(rate, kind):
                yield problem("rate_of_fluid", key=f"{table}.{key}", said=meaning, fluid=fluid)
    if requirement is not None and requirement.bubble_volume is not None and not gas:
        yield Problem("requirement.bubble_volume", "is that of a gas, and the fluid is a liquid; remove it")


def _requirement(case: CaseTables, required: Requirement) -> Iterator[Problem]:
    """What in [requirement] cannot be judged."""
    table = _missing(case)
    if table or case.fluid is None:
        yield Problem("requirement", f"needs a leak rate, and there is none without [{table}]; add it")
        return
    if required.leak_rate is None and required.standard is None and required.class_name is None:
        yield problem("requirement")
    yield from _class(required, gas=case.fluid.gas is not None)
    yield from _own_tests(case, required, gas=case.fluid.gas is not None)
    loads = case.load.fluid_pressure
    for pressure in required.pressures:
        if not any(math.isclose(pressure, load_pressure, rel_tol=1e-6) for load_pressure in loads):
            loads_in_bar = ", ".join(f"{load_pressure / 1e5:.6g}" for load_pressure in dict.fromkeys(loads))
            yield problem("requirement_fluid_pressure", listed=loads_in_bar, pressure=pressure / 1e5)


def _own_tests(case: CaseTables, required: Requirement, *, gas: bool) -> Iterator[Problem]:
    """What the tests of a standard lack, and a relief valve that has no set pressure."""
    standard, _ = required.standard_and_class or ("", "")
    if standard == RELIEF and case.set_pressure is None:
        yield problem("relief_without_set_pressure", standard=standard)
    if required.test == "service":
        if required.rated_pressure is not None and required.standard is not None:
            yield problem("rated_pressure_unused")
        return
    if case.bolts is not None or not required.tests(gas=gas):
        yield problem("no_tests", standard=standard or "not given")
    elif standard == RELIEF and required.rated_pressure is not None:
        yield problem("rated_pressure_of_relief")
    elif standard != RELIEF and required.rated_pressure is None:
        yield problem("rated_pressure_missing")
    elif (p_set := case.set_pressure) and any(not t.pressure(p_set) > 0.0 for t in required.tests(gas=gas)):
        yield problem("set_pressure_of_test", held=p_set)


def _class(required: Requirement, *, gas: bool) -> Iterator[Problem]:
    from leak.standards import STANDARDS, classes_of, standard_named

    if required.standard is None:
        for key in ("class", "rated_capacity", "rated_pressure"):
            if getattr(required, key) is not None:
                yield Problem(f"requirement.{key}", 'belongs to a standard; add standard, such as "ISO 5208"')
        return
    standard = standard_named(required.standard)
    if standard is None:
        standards = " or ".join(f'"{name}"' for name in STANDARDS)
        yield Problem("requirement.standard", f"is not known; known are {standards}", show(required.standard))
        return
    pair, fluid = required.standard_and_class, "a gas" if gas else "a liquid"
    possible = classes_of(standard, gas=gas)
    if not possible:
        yield problem("requirement_standard_fluid", standard=standard, fluid=fluid)
    elif pair is None or pair[1] not in possible:
        classes, class_name = ", ".join(possible), required.class_name
        if class_name is None:
            yield Problem("requirement.class", f"is missing; known are {classes}")
        else:
            words = {"standard": standard, "fluid": fluid, "known": classes}
            yield problem("requirement_class", **words, value=show(class_name))
    elif pair[1] not in classes_of(standard, gas=gas, rated_capacity=required.rated_capacity is not None):
        yield problem("requirement_rated_capacity", name=pair[1], standard=standard)


def problems_with_uncertainty(case: CaseTables, table: Uncertainty) -> Iterator[Problem]:
    """What in a table [uncertainty] does not fit the other tables of a case.

    Parameters
    ----------
    case : CaseTables
    table : Uncertainty
        The case's own, or another one.
    """
    if case.fluid is not None and case.fluid.gas is not None and table.viscosity is not None:
        yield problem("uncertainty_viscosity", fluid=show(case.fluid.name))
    for name in ("roughness", "fluid"):
        if getattr(case, name) is None:
            yield Problem("uncertainty", f"is about the leak rate, which needs a table [{name}]; add it")
    if (
        not table.spreads
        and table.spectrum is None
        and table.posterior is None
        and not any(uncertain_heights(case.roughness, between_scans=False))
        and not (case.roughness is not None and case.roughness.leaves_open)
    ):
        yield problem("no_uncertain_input")
    if table.hardness is not None and not case.leak.plasticity:
        yield Problem("uncertainty.hardness", "has no effect with leak.plasticity = false; remove it")
    if table.posterior is not None:
        try:
            check_file(table.posterior)
        except UnreadableFileError as error:
            yield Problem("uncertainty.posterior", str(error), show(table.posterior))
    if table.form is not None and case.form is None:
        yield Problem("uncertainty.form", "is about the deviations in a table [form]; add it, or remove this")
    if case.roughness is None:
        return
    if self_affine_part(case.roughness) is None and not case.roughness.finishes:
        for key in SHAPE:
            if key in table.spreads:
                yield problem("shape_of_spectrum", key=key)
    if table.spectrum is not None and not scanned_faces(case.roughness):
        yield problem("uncertainty_spectrum")


def face_remarks(case: CaseTables) -> Iterator[tuple[str, str, Problem]]:
    """What is said of the faces that touch: name of the finding, body and text.

    A body may be touched first beside the face that its shape is named after, or on short lines that stand for a curve.

    Parameters
    ----------
    case : CaseTables
        Whose tables fit together.
    """
    contact, tables = case.contact, (case.closure, case.lower)
    radius = contact.initial_contact_radius
    faces = (contact.closure_face, contact.seat_face)
    for name, table, body, curve in zip(("closure", "seat"), tables, case.bodies, faces, strict=True):
        face = named_face(body)
        if face is not None and not face.holds(radius):
            side, end = ("inside", face.inner) if radius < face.inner else ("outside", face.outer)
            words = {"key": case.key_of(name), "shape": table.shape, "face": face.name}
            yield "touched_beside", name, problem(f"touched_{side}", **words, radius=mm(radius), end=mm(end))
        if (
            name == "seat"
            and face is not None
            and face.name == "land"
            and math.isinf(contact.relative_radius)
        ):
            upper = named_face(case.bodies[0])
            if (
                upper is not None
                and upper.holds(radius)
                and not (upper.holds(face.inner) and upper.holds(face.outer))
            ):
                ends = (mm(radius) for radius in (face.inner, face.outer, upper.inner, upper.outer))
                words = dict(zip(("inner", "outer", "closure_inner", "closure_outer"), ends, strict=True))
                names = {"key": case.key_of(name), "shape": table.shape, "upper": case.label_of("closure")}
                text = problem("land_beyond_face", face=upper.name, **names, **words)
                yield "land_beyond_face", name, text
        if facets := facets_at(curve, radius):
            length = mm(sum(s.length for s in facets) / len(facets))
            yield (
                "facets",
                name,
                problem("facets", body=case.label_of(name), count=len(facets), length=length),
            )


# Pressure over effective modulus that the whole face would have to carry in the mean, above which the contact runs over
# the ends of the faces whatever their shape: even of an edge pressed flat over all of its radius it is less.
_CRUSHING_PRESSURE = 0.25
# Angle by which the faces of a body that yields turn [rad] above which load steps shrink until they end: a knife edge
# that would turn copper by 0.5 stops at a sixth of its load.
MOST_TURNED = 0.4


def refused_loads(case: CaseTables) -> dict[int, Problem]:
    """Loads of a case of which is known before anything is solved that they cannot be calculated, by their numbers.

    Parameters
    ----------
    case : CaseTables
        Whose tables fit together otherwise.
    """
    problems: dict[int, Problem] = {}
    if not case.has_shapes:
        return problems
    crushing_load = None
    for number, (pressure, applied_force) in enumerate(case.load.points):
        load = case, pressure, applied_force
        refusal = _opening_problem(*load) or _strain_problem(*load)
        if refusal is None and crushing_load is not None:
            refusal = problem("after_a_load", load=crushing_load)
        if refusal is not None:
            problems[number] = refusal
            if refusal.kind == "strain" and crushing_load is None and curves(case):
                crushing_load = f"that at {pressure / 1e5:.6g} bar"
    return problems


def problems_of_all_loads(case: CaseTables) -> list[Problem]:
    """Why no load of a case can be calculated, one problem of each kind; empty if one can."""
    problems = refused_loads(case)
    if len(problems) < len(case.load.points):
        return []
    force = dict(enumerate(case.expected_force(*point) for point in case.load.points))
    worst: dict[str, Problem] = {}
    for number in sorted(problems, key=lambda number: -abs(force[number])):
        # the worst of its kind: what is allowed there is allowed to the others as well
        worst.setdefault(problems[number].kind, problems[number])
    return list(worst.values())


def check_formed(case: CaseTables) -> None:
    """InputError where bodies that yield were not formed by an earlier load that is as large as all others.

    Parameters
    ----------
    case : CaseTables
    """
    load = case.load
    largest = max(case.expected_force(*point) for point in load.points)
    if load.earlier is None:
        raise InputError(problem("table_not_formed", largest=math.ceil(largest)))
    forming = case.expected_force(*load.earlier)
    if forming < largest * (1 - 1e-6):
        raise InputError(problem("table_formed_less", key=load.earlier_key, formed=forming, largest=largest))


def problem_of_earlier_load(case: CaseTables) -> Problem | None:
    """Why the largest load before all others cannot be calculated; None if it can or there is none.

    Parameters
    ----------
    case : CaseTables
    """
    if case.load.earlier is None:
        return None
    pressure, force = case.load.earlier
    key, open_seal = case.load.earlier_key, _opening_problem(case, pressure, force) if pressure else None
    refusal = open_seal or _strain_problem(case, pressure, force, key.removeprefix("load."))
    return None if refusal is None else replace(refusal, key=key)


def _opening_problem(case: CaseTables, fluid_pressure: float, applied_force: float) -> Problem | None:
    """Why a load leaves the seal open, as far as this is known before where the fluid gets to; None if it does not."""
    load, r0 = case.load, case.initial_contact_radius
    lifts = load.pressure_side == "inner"
    lift = -contact_force(r0, fluid_pressure, 0.0, load.pressure_side)
    # Where fluid gets to between surfaces or lands is a result: only what no contact can hold is known before.
    penetrates = not case.on_sealed_area
    force = case.expected_force(fluid_pressure, applied_force)
    holds = applied_force > 0 or not lifts if penetrates else force > 0
    if holds:
        return None
    if case.bolts is not None:
        forces = {"force": lift, "applied": applied_force}
        return problem("bolts_open", pressure=fluid_pressure, radius=mm(r0), **forces)
    return problem(
        "lifted" if penetrates else "open",
        pressure=fluid_pressure,
        **case.labels,
        how=f"lifts the {case.label_of('closure')} with" if lifts else "closes with",
        force=abs(lift),
        radius=mm(r0),
        needed=lift,
        applied=applied_force,
    )


def _strain_problem(
    case: CaseTables,
    fluid_pressure: float,
    applied_force: float,
    lower: str = "fluid_pressure or applied_force",
) -> Problem | None:
    """What a load is that the faces cannot carry over all their length; `lower` is what to lower.

    How large the strains of a smaller load are is said after it is solved (`fem_seal.validity.checks`); what a stop
    leaves to a gasket is known then, too.
    """
    if case.gasket is not None and case.gasket.stop is not None:
        return None
    contact, force = case.contact, case.expected_force(fluid_pressure, applied_force)
    f = line_load(force, contact.initial_contact_radius, contact.angle)
    start, end = contact.reach
    length = end - start
    limits = [("crushed", _CRUSHING_PRESSURE, case.effective_modulus)]
    if hardened := [curve.stress[-1] for curve in curves(case)]:
        limits.insert(0, ("fully_plastic", CONSTRAINT, min(hardened)))
    for name, share, strength in limits:
        capacity = share * strength * length
        if f > capacity:
            forces = {"force": force, "most": force * capacity / f}
            return problem(name, **forces, length=mm(length), share=share, lower=lower)
    if not hardened or any(len(curve.stress) == 1 for curve in curves(case)):
        # what a body bears that does not harden is found on the way to the load
        return None
    # a narrower contact cannot carry the load, whatever else yields
    half_width = plastic_half_width(f, min(hardened))
    angle = turning_angle(contact, half_width)
    if angle <= MOST_TURNED:
        return None
    share = _largest_share(lambda share: turning_angle(contact, share * half_width) <= LARGEST_TURNING)
    forces = {"force": force, "most": force * share}
    limits_of = {"turned": angle, "largest": LARGEST_TURNING}
    return problem("turned", **forces, **limits_of, width=2 * half_width, lower=lower)


# Places of each side at which the gap is looked at, and halvings until the force is known to two digits.
_PLACES, _HALVINGS = 201, 12


def turning_angle(contact: ContactGeometry, half_width: float) -> float:
    """Angle by which faces turn that are pressed into each other over a width [rad]; a/R on a parabola.

    The width is taken where the undeformed faces are closest. Where they open more slowly further in, as on a flat land
    with rounded edges, the mean angle counts, and where they open as a cone their own.

    Parameters
    ----------
    contact : ContactGeometry
    half_width : float
        a [m]; zero is the answer where the faces are shorter.
    """
    x = np.linspace(0.0, 2.0 * half_width, _PLACES)
    inner, outer = (
        np.maximum.accumulate(
            np.where(x <= abs(end), np.maximum(contact.gap(math.copysign(1.0, end) * x), 0.0), np.inf)
        )
        for end in contact.reach
    )
    widest = np.maximum(inner, outer[::-1])
    at = int(np.argmin(widest))
    if not math.isfinite(widest[at]):
        return 0.0
    ends = [(gaps, place) for gaps, place in ((inner, at), (outer, _PLACES - 1 - at)) if place > 0]
    slope = max(float(gaps[place] - gaps[place - 1]) / float(x[1]) for gaps, place in ends)
    return min(2.0 * float(widest[at]) / half_width, slope)


def _largest_share(holds: Callable[[float], bool]) -> float:
    """Largest share below one that holds, to two digits."""
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low
