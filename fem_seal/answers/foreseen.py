"""Bodies that yield, foreseen from closed forms before anything is solved, and how long their load steps take."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fem_seal.answers.closed_forms import Derived, derive_problem
from fem_seal.case.checks import MOST_TURNED, turning
from fem_seal.case.material_table import CURVES, library_name
from fem_seal.loads import CONSTRAINT, LARGEST_EXCESS, plastic_half_width
from fem_seal.materials import HARDNESS_OVER_YIELD_STRESS, HardeningCurve, Material
from fem_seal.seal.cost import about, path_seconds
from fem_seal.seal.problem import SealProblem, sizing
from fem_seal.units import fixed_quantity, short_quantity
from fem_seal.validity.words import not_calculated, sentence

# Largest von Mises stress under Hertz's line contact over its peak pressure, in plane strain (K. L. Johnson, Contact
# Mechanics, 4.2 and 6.1; Poisson's ratio 0.3).
_VON_MISES = 0.558
# Plastic strain over a/R that stands for that of a contact in the fully plastic range, and steps to its flow stress.
_TABOR, _ITERATIONS = 0.2, 20
# What samples, and the search for the force of a target, take over the path of the loads: measured on copper rings.
_SAMPLED, _TARGET = 2.0, 2.0


def foreseen(problem: SealProblem, derived: Derived | None = None) -> Iterator[str]:
    """Loads that are not calculated, and bodies that yield though they are solved as elastic, one sentence for each.

    Parameters
    ----------
    problem : SealProblem
    derived : Derived, optional
        Of the same problem.
    """
    yield from (one.text for one in not_calculated(problem.loads, problem.loads.refused))
    yield from yielding(problem, derived or derive_problem(problem))


def run_seconds(problem: SealProblem, *, sampled: bool = False, target: bool = False) -> float | None:
    """Estimated processor time of a run of bodies that yield [s]; None where none does.

    Parameters
    ----------
    problem : SealProblem
    sampled : bool
        With samples of uncertain inputs or of a drawing's finish.
    target : bool
        With the force for a target leak rate.
    """
    kept = problem.loads.without(problem.loads.refused)
    if not (problem.curves and kept.points):
        return None
    return (1.0 + _SAMPLED * sampled + _TARGET * target) * _seconds(replace(problem, loads=kept))


def yielding(problem: SealProblem, derived: Derived) -> Iterator[str]:
    """Bodies solved as elastic whose stress the closed forms expect above their yield stress.

    Parameters
    ----------
    problem : SealProblem
    derived : Derived
    """
    closed = [(load.contact_force, load.line_load, load.crossover or load.hertz) for load in derived.loads]
    loads = sorted((one.peak_pressure, force, f) for force, f, one in closed if one is not None)
    if not loads:
        return
    # a body that yields lets no more through to the other one
    loads = [(min(pressure, borne(problem, f)), force, f) for pressure, force, f in loads]
    peak, _, line_load = loads[-1]
    said: dict[str, list[str]] = {}
    for name, material in problem.materials.items():
        known = material.yield_stress is not None
        limit = material.yield_stress or (material.hardness or 0.0) / HARDNESS_OVER_YIELD_STRESS
        above = [force for pressure, force, _ in loads if _VON_MISES * pressure > limit]
        if material.hardening is not None or not (limit and above):
            continue
        below = [force for _, force, _ in loads if force < min(above)]
        excess, hardness = _VON_MISES * peak / limit, material.hardness
        crushed = hardness is not None and peak > hardness
        text = sentence(
            "foreseen",
            material=material.name,
            first=short_quantity("force", min(above)),
            # only the forces of the case are looked at: where between two of them it begins is not known
            not_yet=sentence("foreseen", "not_yet", force=short_quantity("force", max(below)))
            if below
            else "",
            # two digits, or as many as say that it is above one
            excess=f"{excess:.2g}" if excess >= 1.05 else f"{max(excess, 1.01):.2f}",
            limit=fixed_quantity("MPa", limit, 3),
            which=sentence("foreseen", "known" if known else "hard"),
            crushed=sentence("foreseen", "crushed", peak=peak, hardness=hardness) if crushed else "",
            worth=sentence("foreseen", "outside" if excess > LARGEST_EXCESS else "doubtful"),
            run=_with_curve(problem, name, material, limit, line_load),
        )
        said.setdefault(text, []).append(problem.contact.label_of(name))
    for text, names in said.items():
        yield f"{' and '.join(names)}: {text}"


def borne(problem: SealProblem, line_load: float) -> float:
    """Pressure that bodies with a stress-strain curve bear in the fully plastic range [Pa]; infinite without one.

    The flow stress is that at a plastic strain of 0.2 a/R (Tabor, The Hardness of Metals, 1951).

    Parameters
    ----------
    problem : SealProblem
    line_load : float
        f_N [N/m].
    """
    radius, most = problem.contact.relative_radius, math.inf
    for curve in problem.curves:
        stress = curve.stress[-1]
        for _ in range(_ITERATIONS if math.isfinite(radius) else 0):
            strain = _TABOR * plastic_half_width(line_load, stress) / radius
            stress = 0.5 * (stress + float(curve.flow_stress(np.array(strain))))
        most = min(most, CONSTRAINT * stress)
    return most


def _with_curve(problem: SealProblem, name: str, material: Material, limit: float, line_load: float) -> str:
    """What a run takes if this body had a stress-strain curve, that of the library or a perfectly plastic one."""
    of_library = CURVES.get(library_name(material.name) or "")
    curve = HardeningCurve((0.0,), (limit,)) if of_library is None else of_library.hardening
    strongest = max(curve.stress[-1], (material.hardness or 0.0) / HARDNESS_OVER_YIELD_STRESS)
    turned = turning(problem.contact, plastic_half_width(line_load, strongest))
    if turned > MOST_TURNED:
        return sentence("foreseen", "too_large", turned=turned)
    yields = replace(material, hardening=curve, yield_stress=None, over_temperature=())
    path = replace(problem, materials={**problem.materials, name: yields})
    words = "library" if of_library is not None else "own"
    return sentence("foreseen", words, time=about(_seconds(path)))


def _seconds(problem: SealProblem) -> float:
    elements = len(sizing(problem).contact_vertices(problem.contact.breaks)) - 1
    return path_seconds(elements, len(problem.loads.points))
