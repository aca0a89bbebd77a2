"""What designs share: one condensation for equal bodies, one table for surfaces of one shape.

The default mesh follows from roughness and load, so that hardly two designs would have the same. Here the element sizes
are rounded to powers of the fourth root of two, to the finer and to the wider side. A design's mesh still depends
on that design alone and not on its neighbours or their order, but equal geometries now share a few meshes.

Persson's theory knows no lengths and no pressures of its own. A surface whose heights are h times those of another,
with modulus E* and hardness sigma_P, behaves like that other one:

    ubar(p) = h f(p / (E* h)),    u_eff(p) = h g(p / (E* h), sigma_P / (E* h)).

The first relation and, for elastic asperities, the second are exact: one table per shape of the spectrum serves every
height. With a hardness g has a second argument; it is tabulated at values of ln(sigma_P / (E* h)) on a fixed lattice
and interpolated between four of them, at equal p over the sealing pressure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bodies.condensed import CondensedBody
from fem_seal.contact.laws import InterfaceLaw
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.solution import ContactSolution
from fem_seal.materials import Material
from leak import ConductivityTable, PowerSpectrum, RoughContact
from meshes import ContactGeometry, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.analysis.flow import Flow
    from fem_seal.analysis.problem import SealProblem

# Steps of the sizes and of the reach in the logarithm to base 2. A longer reach costs few elements: they grow along it.
_STEP, _REACH_STEP = 0.25, 1.0
# A model with the displacements of its bodies holds some 20 MB, the condensed one a few hundred kB.
_FULL_MODELS, _LIGHT_MODELS = 12, 64


@dataclass(frozen=True)
class Bodies:
    """What a condensation depends on."""

    contact: ContactGeometry
    sizing: Sizing
    closure_material: Material
    seat_material: Material


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
    return _full_model(bodies) if stress else _light_model(bodies)


def rounded(sizing: Sizing, contact: ContactGeometry, *, exact_size: bool = False) -> Sizing:
    """Sizing with rounded numbers: never coarser, never narrower; a spot moves by half an element at most.

    Parameters
    ----------
    sizing : Sizing
    contact : ContactGeometry
        The zone still ends where one of the faces ends.
    exact_size : bool
        Whether the contact size is the user's own and stays.
    """
    lower, upper = contact.reach
    start, end = (_up(abs(x), _REACH_STEP) for x in sizing.zone)
    size = sizing.contact_size if exact_size else min(_down(sizing.contact_size, _STEP), sizing.far_size)
    return replace(
        sizing,
        contact_size=size,
        # a rounded number of elements, so that it brings no meshes of its own beside those of the sizes
        core=size * _up(sizing.core / size, _STEP),
        zone=(max(-start, lower), min(end, upper)),
        growth_along=_down(sizing.growth_along, _STEP),
        spots=_rounded_spots(sizing, contact),
    )


def _rounded_spots(sizing: Sizing, contact: ContactGeometry) -> tuple[tuple[float, float], ...]:
    """Spots with rounded sizes, at multiples of them; edges and ends of the faces stay where they are."""
    lower, upper = contact.reach
    edges = {lower, upper, *contact.breaks.tolist()}
    found = set()
    for place, wanted in sizing.spots:
        size = _down(wanted, _STEP)
        near = min(max(size * round(place / size), lower), upper)
        found.add((place if place in edges else near, size))
    return tuple(sorted(found))


def _elastic(material: Material) -> Material:
    """What stiffness depends on: materials that differ in hardness or name only are the same body."""
    return replace(material, name="", source="", hardness=None, yield_stress=None)


@lru_cache(maxsize=_FULL_MODELS)
def _full_model(bodies: Bodies) -> ContactModel:
    seal_mesh = build_contact(bodies.contact, bodies.sizing)
    return condense(seal_mesh, {"closure": bodies.closure_material, "seat": bodies.seat_material})


@lru_cache(maxsize=_LIGHT_MODELS)
def _light_model(bodies: Bodies) -> ContactModel:
    full = _full_model.__wrapped__(bodies)
    return replace(full, closure=_without_displacement(full.closure), seat=_without_displacement(full.seat))


def _without_displacement(body: CondensedBody) -> CondensedBody:
    return replace(body, solve=None)


def _down(size: float, step: float) -> float:
    return float(2.0 ** (step * math.floor(math.log2(size) / step + 1e-9)))


def _up(size: float, step: float) -> float:
    return float(2.0 ** (step * math.ceil(math.log2(size) / step - 1e-9)))


# The surface that stands for all of its shape.
_HEIGHT, _MODULUS = 1e-6, 1e11
# Densities are compared to so many decimals of their logarithm, far coarser than rounding and finer than any effect.
_DIGITS = 10
# Lattice of ln(hardness / (E* h)); u_eff between four neighbours is good to a few parts in 1e5
# (tests/test_fem_seal_studies_surfaces.py).
_SPACING = 0.1
# Tables reach from this fraction of the sealing pressure to it; below they go on by the law at low pressure.
_RANGE, _NODES = 1e-9, 64
_REMEMBERED = 4096


@dataclass(frozen=True)
class ScaledLaw:
    """The law of one surface from that of another one of the same shape.

    Parameters
    ----------
    law : InterfaceLaw
    height : float
        Ratio of the heights.
    pressure : float
        Ratio of the products of modulus and height.
    """

    law: InterfaceLaw
    height: float
    pressure: float

    def gap(self, log_pressure: FloatArray) -> FloatArray:
        """Mean separation u [m] at ln(p/Pa)."""
        return self.height * self.law.gap(log_pressure - math.log(self.pressure))

    def decay_length(self, log_pressure: FloatArray) -> FloatArray:
        """-du/d ln p [m], positive."""
        return self.height * self.law.decay_length(log_pressure - math.log(self.pressure))


@dataclass(frozen=True)
class TabulatedSurface:
    """A surface whose sealing pressure is that of its table: to look for it takes longer than a design.

    Parameters
    ----------
    surface : RoughContact
    sealing_pressure : float
        [Pa]
    """

    surface: RoughContact
    sealing_pressure: float

    def sealing_pressure_by(self, method: str) -> float:
        """The same: the table is that of the reading in use [Pa]."""
        return self.sealing_pressure

    @property
    def spectrum(self) -> PowerSpectrum:
        """Of the surface."""
        return self.surface.spectrum

    @property
    def percolation_threshold(self) -> float:
        """Of the surface."""
        return self.surface.percolation_threshold

    @property
    def peklenik(self) -> float:
        """Of the surface."""
        return self.surface.peklenik

    def contact_area(self, pressure: float) -> FloatArray | float:
        """Relative contact area A/A0 at a nominal pressure [Pa]."""
        return self.surface.contact_area(pressure)


def family_law(surface: RoughContact) -> ScaledLaw:
    """The elastic p(u) of a surface, exact, from the law of its shape.

    Parameters
    ----------
    surface : RoughContact
    """
    member, height, pressure = _member(surface.elastic)
    return ScaledLaw(_law(member), height, pressure)


def family_table(flow: Flow, surface: RoughContact, contact: ContactSolution) -> ConductivityTable | None:
    """Flow conductivity of a surface from the tables of its shape; None where the relations above do not hold.

    Parameters
    ----------
    flow : Flow
        The relations hold for liquids: a gas brings its mean free path, a length of its own.
    surface : RoughContact
    contact : ContactSolution
    """
    if flow.gas is not None or flow.simulated is not None:
        return None
    method = flow.conductivity
    member, height, pressure = _member(surface)
    if member.hardness is None:
        peak = math.log10(float(contact.pressure.max()) / pressure)
        table = _elastic_table(member, math.floor(peak - 9), math.ceil(peak + 0.3), method)
    else:
        place = math.log(member.hardness / _MODULUS) / _SPACING
        first = math.floor(place) - 1
        table = _interpolated(replace(member, hardness=None), first, place - first, method)
    return ConductivityTable(
        table.pressure * pressure,
        table.separation * height,
        table.sealing_pressure * pressure,
        table.p_max * pressure,
        method,
    )


def _member(surface: RoughContact) -> tuple[RoughContact, float, float]:
    """The standing member of a surface's family; height and pressure that turn its results into the surface's."""
    height = surface.spectrum.rms_height / _HEIGHT
    pressure = height * surface.effective_modulus / _MODULUS
    return (
        replace(
            surface,
            spectrum=_shape(surface.spectrum, height),
            effective_modulus=_MODULUS,
            hardness=None if surface.hardness is None else surface.hardness / pressure,
        ),
        height,
        pressure,
    )


@lru_cache(maxsize=_REMEMBERED)
def _shape(spectrum: PowerSpectrum, height: float) -> PowerSpectrum:
    density: FloatArray = np.power(10.0, np.round(np.log10(spectrum.density / height**2), _DIGITS))
    return _known(PowerSpectrum(spectrum.wavenumber, density))


@lru_cache(maxsize=_REMEMBERED)
def _known(spectrum: PowerSpectrum) -> PowerSpectrum:
    """The same object for equal spectra, so that what it has worked out already is kept."""
    return spectrum


@lru_cache(maxsize=_REMEMBERED)
def _law(surface: RoughContact) -> InterfaceLaw:
    return surface.interface_law()


@lru_cache(maxsize=_REMEMBERED)
def _elastic_table(surface: RoughContact, low: int, high: int, method: str) -> ConductivityTable:
    return surface.conductivity_table(10.0**low, 10.0**high, _NODES, method=method)


def _interpolated(surface: RoughContact, first: int, t: float, method: str) -> ConductivityTable:
    """Table between the lattice points first to first + 3, at `t` steps from the first one."""
    tables = [_lattice_table(surface, first + n, method) for n in range(4)]
    # the last points before sealing, far below any molecule's size, round to zero in some of them
    count = min(len(table.pressure) for table in tables)
    weights = _lagrange(t)
    over_sealing = tables[0].pressure[:count] / tables[0].sealing_pressure
    sealing = math.exp(
        sum(w * math.log(one.sealing_pressure) for w, one in zip(weights, tables, strict=True))
    )
    log_separation = sum(w * np.log(one.separation[:count]) for w, one in zip(weights, tables, strict=True))
    return ConductivityTable(over_sealing * sealing, np.exp(log_separation), sealing, math.inf, method)


@lru_cache(maxsize=_REMEMBERED)
def _lattice_table(surface: RoughContact, place: int, method: str) -> ConductivityTable:
    """Table of a surface with the hardness of one lattice point, at fixed fractions of its sealing pressure."""
    plastic = replace(surface, hardness=_MODULUS * math.exp(_SPACING * place))
    sealing = plastic.sealing_pressure_by(method)
    return plastic.conductivity_table(_RANGE * sealing, sealing, _NODES, method=method)


def _lagrange(t: float) -> tuple[float, float, float, float]:
    """Weights of the cubic through the values at 0, 1, 2, 3."""
    return (
        -(t - 1) * (t - 2) * (t - 3) / 6,
        t * (t - 2) * (t - 3) / 2,
        -t * (t - 1) * (t - 3) / 2,
        t * (t - 1) * (t - 2) / 6,
    )
