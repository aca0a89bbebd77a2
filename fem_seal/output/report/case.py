"""The case and its accuracy as the report lists them: names with values in readable units."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.leakage_class import volume_of
from fem_seal.case.tables import curves
from fem_seal.contact.laws import HardContact
from fem_seal.output.answers.form import form_rows
from fem_seal.output.answers.particles import particle_rows
from fem_seal.output.case_words import earlier_load, listed_dimensions, section, section_text
from fem_seal.output.finish import finish_rows
from fem_seal.output.report.tables import curve_in_words
from fem_seal.output.temperature import celsius, temperature_rows
from fem_seal.seal.problem import exponential_law
from fem_seal.units import given, number, percent, quantity, trimmed

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution
    from fem_seal.case.case import Case
    from fem_seal.case.fluid import Fluid
    from fem_seal.materials import Material


_FLUID_ACTS_ON = {
    "sealed-area": "the sealed area",
    "penetration": "the wetted surfaces and between them",
}


@dataclass(frozen=True)
class Group:
    """Part of the case: names with their values.

    Parameters
    ----------
    name : str
    rows : list of (name, value)
    """

    name: str
    rows: list[tuple[str, str]]


def seal_groups(result: SealSolution) -> list[Group]:
    """Geometry, load and fluid of the case in readable units."""
    case = result.case
    groups = [Group("Geometry", _geometry(result)), Group("Load", _load(case))]
    if case.fluid is not None:
        groups.append(Group("Fluid", list(_fluid(case.fluid, max(case.load.fluid_pressure)))))
    if case.temperature is not None:
        problem = result.problem
        heating = problem.heating
        field = None if heating is None else heating.field(result.seal_mesh, problem.materials)
        groups.append(Group("Temperature", list(temperature_rows(case, problem, field))))
    if case.form is not None:
        groups.append(Group("Form error", form_rows(case.form)))
    return groups


def _fluid(fluid: Fluid, highest: float) -> Iterator[tuple[str, str]]:
    yield "name", fluid.name
    yield "temperature", celsius(fluid.temperature)
    yield "viscosity", quantity("viscosity", fluid.viscosity, 4)
    law = fluid.pressure_law
    if law is not None and fluid.gas is None:
        there = float(law.viscosity_ratio(highest)) * fluid.viscosity
        yield f"viscosity at {given('fluid pressure', highest)}", quantity("viscosity", there, 3)
    if fluid.gas is not None and fluid.outlet_pressure is not None:
        yield "molar mass", f"{trimmed(1e3 * fluid.gas.molar_mass)} g/mol"
        outlet = given("fluid pressure", fluid.outlet_pressure) if fluid.outlet_pressure else "vacuum"
        yield "outlet pressure, absolute", outlet
    if fluid.particles is not None:
        yield from particle_rows(fluid.particles)
    if fluid.library_entry is not None:
        yield "source", fluid.library_entry.source


def surface_groups(result: SealSolution) -> list[Group]:
    """Materials, roughness, interface and leak of the case in readable units."""
    groups = list(_materials(result.case))
    if result.surface is not None:
        groups.append(Group("Roughness of both surfaces", _roughness(result)))
    groups.append(Group("Interface law", _interface(result)))
    if result.surface is not None and result.case.fluid is not None:
        groups.append(Group("Leak", _leak(result.case)))
    return groups


def _geometry(result: SealSolution) -> list[tuple[str, str]]:
    case, contact = result.case, result.seal_mesh.contact
    return [
        *_dimensions(case, "closure"),
        *_dimensions(case, "seat"),
        ("angle θ of the contact normal", f"{trimmed(math.degrees(contact.angle))}°"),
        ("radius of first touch r₀", quantity("length", contact.touch_radius, 4)),
        ("radius of relative curvature", _curvature(contact.relative_radius)),
    ]


def _curvature(radius: float) -> str:
    return "infinite: the faces conform" if math.isinf(radius) else quantity("length", radius, 4)


def _dimensions(case: Case, name: str) -> Iterator[tuple[str, str]]:
    """All dimensions of a body; those that the case leaves open say so."""
    body = getattr(case, name)
    yield name, body.shape
    drawn = section(case, name)
    if drawn:
        yield from ((f"{name}, {key}", text) for key, text in section_text(drawn).items())
    if name == "seat":
        held = "held radially" if body.wall == "fixed" else "free"
        yield "seat, outer wall", held
    for key, (value, chosen) in listed_dimensions(case, name).items():
        text = f"{trimmed(math.degrees(value))}°" if key.endswith("angle") else given("length", value)
        yield f"{name}, {key.replace('_', ' ')}", f"{text} (chosen)" if chosen else text


def _materials(case: Case) -> Iterator[Group]:
    closure, seat = case.closure.material, case.seat.material
    if closure == seat:
        yield Group("Material of closure and seat", _material(closure))
    else:
        yield Group("Material of the closure", _material(closure))
        yield Group("Material of the seat", _material(seat))


def _material(material: Material) -> list[tuple[str, str]]:
    rows = [
        ("name", material.name),
        ("Young's modulus", given("contact pressure", material.youngs_modulus)),
        ("Poisson's ratio", trimmed(material.poissons_ratio)),
    ]
    for name, value in (("hardness", material.hardness), ("yield stress", material.yield_stress)):
        rows.append((name, "not given" if value is None else given("contact pressure", value)))
    if material.hardening is not None:
        rows.append(("stress over plastic strain", curve_in_words(material.hardening)))
    if material.thermal_expansion is not None:
        rows.append(("thermal expansion", f"{trimmed(1e6 * material.thermal_expansion)}·10⁻⁶ 1/K"))
    if material.thermal_conductivity is not None:
        rows.append(("thermal conductivity", f"{trimmed(material.thermal_conductivity)} W/(m K)"))
    keys = [table.key.replace("_", " ") for table in material.over_temperature if table.changes]
    if material.hardening_over_temperature is not None:
        keys.append("stress over plastic strain")
    if keys:
        rows.append(("taken from a table over temperature", ", ".join(keys)))
    if material.creeps:
        rows.append(("creep", "creeps: results are those of a short time"))
    rows += [("condition", material.condition)] if material.condition else []
    return [*rows, ("source", material.source)] if material.source else rows


def _roughness(result: SealSolution) -> list[tuple[str, str]]:
    assert result.surface is not None
    spectrum = result.surface.spectrum
    rows = [
        ("rms height", quantity("length", spectrum.rms_height, 4)),
        ("rms slope", number(spectrum.rms_slope, 3)),
        ("longest wavelength", quantity("length", 2 * math.pi / spectrum.q_low)),
        ("shortest wavelength", quantity("length", 2 * math.pi / spectrum.q_high)),
    ]
    if result.surface.peklenik != 1.0:
        rows.append(("Peklenik number, along the flow over across it", number(result.surface.peklenik, 3)))
    given_as = result.case.roughness.spectrum if result.case.roughness else None
    hurst = getattr(given_as, "hurst", None)
    if hurst is not None:
        rows.insert(2, ("Hurst exponent", trimmed(hurst)))
    return [*rows, *finish_rows(result.case)]


def _interface(result: SealSolution) -> list[tuple[str, str]]:

    interface = result.case.interface
    names = {
        "spectrum": "p(u) of the spectrum" + (", yielded" if interface.plastic else ", elastic"),
        "exponential": "p = p_c exp(−u/u₀)",
        "smooth": "smooth, hard contact",
    }
    u0, p_c = exponential_law(result.case, result.surface)
    rows = [("law", names[interface.law])]
    if u0 is not None and p_c is not None:
        when = " at low pressure" if interface.law == "spectrum" else ""
        rows.append((f"decay length u₀{when}", quantity("length", u0)))
        rows.append((f"p_c{when}", quantity("contact pressure", p_c)))
    law = result.problem.law
    if interface.law == "spectrum" and u0 is None and not isinstance(law, HardContact):
        peak = max(load.peak_pressure for load in result.loads)
        found = law.decay_length(np.array([math.log(peak)]))
        rows.append(("decay length at the highest peak pressure", quantity("length", float(found[0]))))
    return rows


def _load(case: Case) -> list[tuple[str, str]]:
    # bodies that yield remember the order of the loads
    order = case.load.fluid_pressure if curves(case) else sorted(case.load.fluid_pressure)
    pressures = [given("fluid pressure", p) for p in order]
    if len(set(pressures)) == 1:
        pressures = pressures[:1]
    shown = (
        ", ".join(pressures)
        if len(pressures) <= 3
        else f"{len(pressures)} from {pressures[0]} to {pressures[-1]}"
    )
    return [
        ("fluid pressure", shown),
        ("applied force (spring or actuator)", _forces([force for _, force in case.load.points])),
        *([("largest earlier load", earlier)] if (earlier := earlier_load(case.load)) else []),
        ("high pressure", f"on the {case.load.pressure_side} side"),
        ("fluid acts on", _FLUID_ACTS_ON[case.load.closing]),
        *(
            [("target leak rate", _with_state(case, given("flow", case.load.target_leak_rate)))]
            if case.load.target_leak_rate is not None
            else []
        ),
    ]


def _with_state(case: Case, leak_rate: str) -> str:
    state = volume_of(case).state
    return f"{leak_rate} at {state}" if state else leak_rate


def _forces(forces: list[float]) -> str:
    ends = [given("force", force) if force else "0 N" for force in (min(forces), max(forces))]
    return ends[0] if ends[0] == ends[1] else f"{len(forces)} from {ends[0]} to {ends[1]}"


_SIMULATED = {
    "elastic": "elastic asperities",
    "capped": "pressure capped at the hardness",
    "von-mises": "metal that flows by von Mises",
}
_THEORIES = {
    "paper": "of the paper: gaps by Persson's theory",
    "corrected": "corrected: gap law of waves in series, checked by direct simulation",
}
_YIELD = {"paper": "yield at the hardness", "corrected": "flow by von Mises' criterion"}


def _leak(case: Case) -> list[tuple[str, str]]:
    conductivity = {
        "bruggeman": "effective medium (Bruggeman)",
        "critical-junction": "critical junction",
        "direct": f"direct simulation of rough patches, {_SIMULATED[case.simulated_asperities]}",
        "threshold-law": "effective medium, closed law near the threshold",
    }
    return [
        ("theory", _THEORIES[case.leak.theory]),
        ("asperities", _YIELD[case.leak.theory] if case.leak.plasticity else "elastic"),
        # a simulation finds by itself where the last path closes
        *(
            [("no open path above", f"{percent(case.leak.percolation_threshold)} real contact")]
            if case.leak.conductivity != "direct"
            else []
        ),
        ("flow conductivity", conductivity[case.leak.conductivity]),
        *(
            [("fluid pressure in the gap", "opens it, point by point")]
            if case.leak.fluid_in_gap == "local"
            else []
        ),
    ]


_STEPS = {
    "interface": "roughness and interface law",
    "direct": "direct simulation of the surface",
    "mesh": "mesh",
    "condense": "condensing the bodies on the contact line",
    "contact": "all contacts",
    "leak": "flow conductivity and leak rates",
    "stress": "stresses",
    "error": "estimate of the error",
    "far field": "influence of the far field",
    "questions": "blow-off and target leak rate",
    "variants": "other interface law",
    "theory": "other readings of the theory",
    "uncertainty": "uncertain inputs",
}


def times(result: SealSolution) -> list[tuple[str, str]]:
    """How long each step of the calculation took."""
    return [(_STEPS.get(name, name), f"{seconds:.2f} s") for name, seconds in result.timings.items()]
