"""Conductivity tables and laws of surfaces that differ in height, modulus and hardness only, from those of one of them.

Persson's theory knows no lengths and no pressures of its own. A surface whose heights are h times those of another,
with modulus E* and hardness sigma_P, behaves like that other one:

    ubar(p) = h f(p / (E* h)),    u_eff(p) = h g(p / (E* h), sigma_P / (E* h)).

The first relation and, for elastic asperities, the second are exact: one table per shape of the spectrum serves every
height. With a hardness g has a second argument; it is tabulated at values of ln(sigma_P / (E* h)) on a fixed lattice
and interpolated between four of them, at equal p over the sealing pressure. Asperities that yield only where they touch
have the gaps of elastic ones at another pressure, and need no lattice. The flow of a gas over that of a liquid is a
function of numbers alone, p/(E* h), sigma_P/(E* h) and the Knudsen number of u_eff: the same relations hold for it.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.contact.laws import InterfaceLaw, Law, ScaledLaw
from fem_seal.seal.leak_model import Conductivity, FlowModel
from leak import GasConductivityTable, PowerSpectrum, RoughContact, TurnedContact
from leak.flow.conductivity import AlikeTables
from leak.flow.turned_contact import calculated_table
from leak.numerics.curves import lagrange

if TYPE_CHECKING:
    from leak.flow.turned_contact import FaceContact

# The surface that stands for all of its shape.
_HEIGHT, _MODULUS = 1e-6, 1e11
# Densities are compared to so many decimals of their logarithm, far coarser than rounding and finer than any effect.
_DIGITS = 10
# Lattice of ln(hardness / (E* h)): interpolation adds a few parts in 1e5 to the conductivity below half the sealing
# pressure, up to 0.7 % close to it.
_SPACING = 0.1
# Tables reach from this fraction of the sealing pressure to it; below they go on by the law at low pressure.
# Conductivities, interpolation over the hardness included, are good to 4e-4 below 0.6 of the sealing pressure, to 3e-3
# at 0.8, 1 % at 0.9 and 5 % at 0.95: so much of 24 random surfaces, a thirtieth of it in the median.
_RANGE, _NODES = 1e-9, 50
_CACHE_SIZE = 4096


def family_law(surface: FaceContact) -> Law:
    """The elastic p(u) of a surface, exact, from the law of its shape; of a turned face its own.

    Parameters
    ----------
    surface : FaceContact
    """
    if isinstance(surface, TurnedContact):
        return surface.interface_law(surface.hardness is not None)
    member, height, pressure = _member(surface)
    return ScaledLaw(_law(member.elastic), height, math.log(pressure))


def same_family(surface: FaceContact, other: FaceContact) -> bool:
    """Whether two surfaces differ in height, modulus and hardness alone; no turned faces do."""
    if isinstance(surface, TurnedContact) or isinstance(other, TurnedContact):
        return False
    return _member(surface)[0].elastic == _member(other)[0].elastic


def family_table(flow: FlowModel, surface: FaceContact) -> Conductivity | None:
    """Flow conductivity of a surface from the tables of its shape; None for turned faces and where it is simulated.

    Parameters
    ----------
    flow : FlowModel
    surface : FaceContact
    """
    if flow.direct is not None or isinstance(surface, TurnedContact):
        return None
    return _table_from(surface, flow.gas is not None)


@lru_cache(maxsize=64)
def _table_from(surface: RoughContact, of_gas: bool) -> Conductivity:
    """The table of one surface, which the loads of a grid share."""
    member, height, pressure = _member(surface)
    acts_at = None
    if member.equivalent_elastic_surface is not None:
        table = _calculate_table(member.equivalent_elastic_surface, of_gas)
        acts_at = partial(_equivalent_log_pressure, member, math.log(pressure))
    elif member.hardness is None:
        table = _calculate_table(member, of_gas)
    else:
        # between four of the lattice
        place = math.log(member.hardness / _MODULUS) / _SPACING
        first = math.floor(place) - 1
        tables = tuple(_calculate_table(member.elastic, of_gas, first + step) for step in range(4))
        table = _interpolate_tables(tables, place - first)
    return table.with_liquid(table.liquid.scaled(height, pressure, surface, acts_at))


def _equivalent_log_pressure(member: RoughContact, log_ratio: float, log_pressure: FloatArray) -> FloatArray:
    """`RoughContact.log_equivalent_pressure` of a surface whose pressures are in a ratio to those of a member."""
    return member.log_equivalent_pressure(log_pressure - log_ratio) + log_ratio


@lru_cache(maxsize=_CACHE_SIZE)
def _calculate_table(surface: RoughContact, of_gas: bool, place: int | None = None) -> Conductivity:
    """Table over all pressures up to sealing, of a point of the lattice at fixed fractions of it."""
    num = None
    if place is not None:
        surface, num = replace(surface, hardness=_MODULUS * math.exp(_SPACING * place)), _NODES
    sealing = surface.sealing_pressure
    return calculated_table(surface, _RANGE * sealing, sealing, num, of_gas=of_gas)


@lru_cache(maxsize=64)
def _member(surface: RoughContact) -> tuple[RoughContact, float, float]:
    """The standing member of a surface's family; height and pressure that turn its results into the surface's."""
    height = surface.spectrum.rms_height / _HEIGHT
    pressure = height * surface.effective_modulus / _MODULUS
    return (
        replace(
            surface,
            spectrum=_shape(surface.spectrum.shape),
            effective_modulus=_MODULUS,
            hardness=None if surface.hardness is None else surface.hardness / pressure,
        ),
        height,
        pressure,
    )


@lru_cache(maxsize=_CACHE_SIZE)
def _shape(spectrum: PowerSpectrum) -> PowerSpectrum:
    height = spectrum.rms_height / _HEIGHT
    density: FloatArray = np.power(10.0, np.round(np.log10(spectrum.density / height**2), _DIGITS))
    return _intern_spectrum(PowerSpectrum(spectrum.wavenumber, density))


@lru_cache(maxsize=_CACHE_SIZE)
def _intern_spectrum(spectrum: PowerSpectrum) -> PowerSpectrum:
    """The same object for equal spectra, so that what it has worked out already stays."""
    return spectrum


@lru_cache(maxsize=_CACHE_SIZE)
def _law(surface: RoughContact) -> InterfaceLaw:
    return surface.interface_law()


def _interpolate_tables(tables: tuple[Conductivity, ...], t: float) -> Conductivity:
    """Table between four neighbours on the lattice, at `t` steps from the first one."""
    weights = lagrange(t)
    of_gas = [table for table in tables if isinstance(table, GasConductivityTable)]
    liquid = _join_tables(tables).combine(weights)
    if not of_gas:
        return liquid
    log_R: FloatArray = np.zeros((len(liquid.pressure), of_gas[0].log_inverse_knudsen.size))
    for weight, table in zip(weights, of_gas, strict=True):
        log_R += weight * table.log_rarefaction[: len(liquid.pressure)]
    return GasConductivityTable(liquid, log_R, of_gas[0].log_inverse_knudsen)


@lru_cache(maxsize=64)
def _join_tables(tables: tuple[Conductivity, ...]) -> AlikeTables:
    return AlikeTables.of([table.liquid for table in tables])
