"""What designs share: one condensation for equal bodies.

Surfaces share tables, see `fem_seal.seal.conductivity_tables`.

The default mesh follows from roughness and load, so that hardly two designs would have the same. Here the element sizes
are rounded to powers of the fourth root of two, to the finer and to the wider side. A design's mesh still depends
on that design alone and not on its neighbours or their order, but equal geometries now share a few meshes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import count
from typing import TYPE_CHECKING

# the time limit is that of designs, not of loading what some of them need
import scipy.interpolate  # noqa: F401

from fem_seal.contact.model import ContactModel, condense, screened
from fem_seal.materials import Material
from fem_seal.seal.conductivity_tables import family_law
from meshes import ContactGeometry, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.seal.problem import SealProblem

# Elements in the core of a soft contact, as most are in a study, and what three digits of their size may add.
_SOFT_CORE = 18.2
# A model with the displacements of its bodies holds some 20 MB, the condensed one a few hundred kB.
_FULL_MODELS, _LIGHT_MODELS = 12, 64
# Loads of one model from which on a quick look at the stress is made: it takes as long as the fields of so many. What
# it lets pass has no field that could say otherwise: the numbers of a design stay those of that design alone.
_WORTH_A_SCREEN = 6


@dataclass(frozen=True)
class Rounding:
    """How far apart rounded sizes are, and how much coarser than a run's elements are inside the bodies.

    Parameters
    ----------
    step, reach_step : float
        Of the sizes and of the reach, in the logarithm to base 2. A longer reach costs few elements.
    along, deep : float
        Factors on the growth of the elements along the faces and into the bodies.
    """

    step: float = 0.25
    reach_step: float = 1.0
    along: float = 1.0
    deep: float = 1.0


OF_STUDIES = Rounding()


@dataclass(frozen=True)
class Bodies:
    """What a condensation depends on."""

    contact: ContactGeometry
    sizing: Sizing
    closure_material: Material
    seat_material: Material


def with_shared_law(problem: SealProblem) -> SealProblem:
    """The problem with the law of its surface's family, made once for all surfaces of one shape."""
    interface, surface = problem.interface, problem.surface
    if interface.law == "spectrum" and not interface.plastic and surface is not None:
        return replace(problem, given_law=family_law(surface))
    return problem


def shared_model(problem: SealProblem, sizing: Sizing, *, stress: bool) -> ContactModel:
    """The condensed bodies of a problem, from this process's memory if they are known.

    Parameters
    ----------
    problem : SealProblem
    sizing : Sizing
        Rounded here, so that neighbouring designs share a mesh.
    stress : bool
        Whether stresses will be asked for; without them the model takes far less memory.
    """
    bodies = Bodies(
        problem.contact,
        rounded(sizing, problem.contact, exact_size=problem.contact_size is not None),
        _elastic(problem.materials["closure"]),
        _elastic(problem.materials["seat"]),
    )
    if not stress:
        return _light_model(bodies)
    strengths = {name: one.yield_stress for name, one in problem.materials.items()}
    can_yield = tuple(name for name, stress in strengths.items() if stress)
    often = next(_uses(bodies)) >= _WORTH_A_SCREEN
    return _screened_model(bodies, can_yield) if often else _full_model(bodies)


def rounded(
    sizing: Sizing, contact: ContactGeometry, *, exact_size: bool = False, rounding: Rounding = OF_STUDIES
) -> Sizing:
    """Sizing with rounded numbers: never coarser nor narrower along the contact; a spot moves by half an element.

    Parameters
    ----------
    sizing : Sizing
    contact : ContactGeometry
        The zone still ends where one of the faces ends.
    exact_size : bool
        Whether the contact size is the user's own and stays.
    rounding : Rounding
    """
    lower, upper = contact.reach
    step = rounding.step
    start, end = (_up(abs(x), rounding.reach_step) for x in sizing.zone)
    size = sizing.contact_size if exact_size else min(_down(sizing.contact_size, step), sizing.far_size)
    elements = _SOFT_CORE * _up(sizing.core / sizing.contact_size / _SOFT_CORE, step)
    return replace(
        sizing,
        contact_size=size,
        # so many of the largest elements that are rounded to this size: it brings no meshes of its own beside theirs
        core=elements * (size if exact_size else 2.0**step * size),
        zone=(max(-start, lower), min(end, upper)),
        growth_along=rounding.along * _down(sizing.growth_along, step),
        growth_deep=rounding.deep * sizing.growth_deep,
        spots=_rounded_spots(sizing, contact, step),
    )


def _rounded_spots(sizing: Sizing, contact: ContactGeometry, step: float) -> tuple[tuple[float, float], ...]:
    """Spots with rounded sizes, at multiples of them; edges and ends of the faces stay where they are."""
    lower, upper = contact.reach
    edges = {lower, upper, *contact.breaks.tolist()}
    found = set()
    for place, wanted in sizing.spots:
        size = _down(wanted, step)
        near = min(max(size * round(place / size), lower), upper)
        found.add((place if place in edges else near, size))
    return tuple(sorted(found))


def _elastic(material: Material) -> Material:
    """What stiffness depends on: materials that differ in hardness or name only are the same body."""
    return Material("", material.youngs_modulus, material.poissons_ratio, hardening=material.hardening)


@lru_cache(maxsize=_FULL_MODELS)
def _full_model(bodies: Bodies) -> ContactModel:
    seal_mesh = build_contact(bodies.contact, bodies.sizing)
    return condense(seal_mesh, {"closure": bodies.closure_material, "seat": bodies.seat_material})


@lru_cache(maxsize=_FULL_MODELS)
def _screened_model(bodies: Bodies, names: tuple[str, ...]) -> ContactModel:
    return screened(_full_model(bodies), names)


@lru_cache(maxsize=_LIGHT_MODELS)
def _uses(bodies: Bodies) -> Iterator[int]:
    return count()


@lru_cache(maxsize=_LIGHT_MODELS)
def _light_model(bodies: Bodies) -> ContactModel:
    full = _full_model.__wrapped__(bodies)
    return replace(full, closure=full.closure.line_alone, seat=full.seat.line_alone)


def _down(size: float, step: float) -> float:
    return float(2.0 ** (step * math.floor(math.log2(size) / step + 1e-9)))


def _up(size: float, step: float) -> float:
    return float(2.0 ** (step * math.ceil(math.log2(size) / step - 1e-9)))
