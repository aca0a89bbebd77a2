"""Fluids of the optional package CoolProp, asked for as "CoolProp:Water"; nothing else uses the package."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from leak.arrays import FloatArray
from leak.errors import FluidError, positive
from leak.extras import say_missing
from leak.fluids.properties import Gas, Liquid, PressureTable, RealGas
from leak.standards import STANDARD_PRESSURE

PREFIX = "CoolProp:"
# Tables over pressure: the highest [Pa], number of values, and the fewest that are of use.
_HIGHEST_PRESSURE, _PRESSURES, _FEWEST = 1e9, 81, 4
_HIGHEST_OF_GAS, _PRESSURES_OF_GAS = 3e8, 161
# Pressure at which a gas is dilute for any purpose.
_DILUTE = 1000.0


def coolprop_liquid(name: str, temperature: float, pressure: float = STANDARD_PRESSURE) -> Liquid:
    """Liquid at a temperature [K] and pressure [Pa]; FluidError if it is not a liquid there.

    Parameters
    ----------
    name : str
        "CoolProp:" and the name there, such as "CoolProp:Water", "CoolProp:INCOMP::MEG[0.3]".
    temperature, pressure : float
        [K], [Pa].

    References
    ----------
    I. H. Bell et al., Ind. Eng. Chem. Res. 53, 2498 (2014).
    """
    fluid = name.removeprefix(PREFIX)
    T = positive(FluidError, "temperature", temperature, "K")
    package = _package(name)
    if not fluid.startswith("INCOMP::") and "liquid" not in _ask(package.PhaseSI, name, T, pressure, fluid):
        raise FluidError(f"fluid = {name!r}: is not a liquid at {T:g} K and {pressure:g} Pa")
    eta, rho = (_ask(package.PropsSI, name, T, pressure, fluid, key) for key in ("V", "D"))
    law = None if fluid.startswith("INCOMP::") else _pressure_law(fluid, T, pressure)
    return Liquid(name, eta, rho, T, _source(package), law)


@lru_cache(maxsize=16)
def _pressure_law(fluid: str, T: float, pressure: float) -> PressureTable | None:
    """Viscosity and density up to where the package knows them or the liquid freezes; None if they end soon."""
    package = _package(fluid)
    first = [package.PropsSI(key, "T", T, "P", pressure, fluid) for key in ("V", "D")]
    most = min(float(package.PropsSI("PMAX", fluid)), _HIGHEST_PRESSURE) - pressure
    p = np.linspace(0.0, most, _PRESSURES)
    values = _known_range(package, fluid, T, pressure + p[1:])
    if len(values) + 1 < _FEWEST:
        return None
    eta, rho = ((1.0, *(values[:, n] / reference).tolist()) for n, reference in enumerate(first))
    return PressureTable(tuple(p[: len(eta)].tolist()), eta, rho)


def coolprop_gas(name: str, temperature: float) -> Gas:
    """Gas at a temperature [K], with its density and viscosity under pressure.

    Parameters
    ----------
    name : str
        "CoolProp:" and the name there, such as "CoolProp:R134a".
    temperature : float
        [K]

    References
    ----------
    I. H. Bell et al., Ind. Eng. Chem. Res. 53, 2498 (2014).
    """
    fluid = name.removeprefix(PREFIX)
    T = positive(FluidError, "temperature", temperature, "K")
    package = _package(name)
    if "gas" not in _ask(package.PhaseSI, name, T, _DILUTE, fluid):
        raise FluidError(f"fluid = {name!r}: is not a gas at {T:g} K and {_DILUTE:g} Pa")
    eta, molar_mass = (_ask(package.PropsSI, name, T, _DILUTE, fluid, key) for key in ("V", "M"))
    return Gas(name, molar_mass, eta, T, _source(package), real=_real_gas(fluid, T))


@lru_cache(maxsize=16)
def _real_gas(fluid: str, T: float) -> RealGas | None:
    """Z and viscosity up to where the gas condenses or the package knows no more; None if that is at once."""
    package = _package(fluid)
    dilute = package.PropsSI("V", "T", T, "P", _DILUTE, fluid)
    R_s = package.PropsSI("GAS_CONSTANT", fluid) / package.PropsSI("M", fluid)
    condenses = float(package.PropsSI("TCRIT", fluid)) > T
    try:
        # just before the bubble point of a mixture, and the vapour pressure of a substance
        most = 0.999999 * float(package.PropsSI("P", "T", T, "Q", 1, fluid)) if condenses else _HIGHEST_OF_GAS
    except ValueError:
        return None
    most = min(most, _HIGHEST_OF_GAS, float(package.PropsSI("PMAX", fluid)))
    # closer together where the gas is dilute
    p = most * np.linspace(0.0, 1.0, _PRESSURES_OF_GAS) ** 2
    values = _known_range(package, fluid, T, p[1:])
    count = len(values) + 1
    if count < _FEWEST:
        return None
    Z, ratios = (
        (1.0, *(p[1:count] / (values[:, 1] * R_s * T)).tolist()),
        (1.0, *(values[:, 0] / dilute).tolist()),
    )
    return RealGas(tuple(p[:count].tolist()), Z, ratios, condenses and count == _PRESSURES_OF_GAS)


def _known_range(package: Any, fluid: str, T: float, pressures: FloatArray) -> FloatArray:
    """Viscosity and density up to the first pressure [Pa] at which the package has none, shape (n, 2)."""
    rows = []
    for p in pressures.tolist():
        try:
            values = [package.PropsSI(key, "T", T, "P", p, fluid) for key in ("V", "D")]
        except ValueError:
            break
        if not all(0.0 < value < np.inf for value in values):
            break
        rows.append(values)
    return np.array(rows).reshape(-1, 2)


def coolprop_heat_capacity(name: str) -> float:
    """Molar heat capacity at constant pressure of the ideal gas at 25 degC [J/(mol K)].

    Parameters
    ----------
    name : str
        "CoolProp:" and the name there.
    """
    fluid = name.removeprefix(PREFIX)
    return float(_ask(_package(name).PropsSI, name, 298.15, _DILUTE, fluid, "CP0MOLAR"))


def coolprop_thermal_conductivity(name: str, temperature: float) -> float | None:
    """Thermal conductivity at atmospheric pressure, of a gas when dilute [W/(m K)]; None where it has none.

    Parameters
    ----------
    name : str
        "CoolProp:" and the name there.
    temperature : float
        [K]
    """
    pressure = _DILUTE if coolprop_is_gas(name, temperature) else STANDARD_PRESSURE
    package, fluid = _package(name), name.removeprefix(PREFIX)
    try:
        return float(_ask(package.PropsSI, name, temperature, pressure, fluid, "L"))
    except FluidError:
        return None


def coolprop_is_gas(name: str, temperature: float) -> bool:
    """Whether a fluid is a gas at a temperature [K] and atmospheric pressure."""
    fluid = name.removeprefix(PREFIX)
    if fluid.startswith("INCOMP::"):
        return False
    phase = _ask(_package(name).PhaseSI, name, temperature, STANDARD_PRESSURE, fluid)
    return "gas" in phase or phase == "supercritical"


def _ask(function: Any, name: str, T: float, pressure: float, fluid: str, key: str | None = None) -> Any:
    try:
        return function(*([key] if key else []), "T", T, "P", pressure, fluid)
    except ValueError as error:
        raise FluidError(f"fluid = {name!r} at {T:g} K: {error}") from None


def _package(name: str) -> Any:
    try:
        from CoolProp import CoolProp
    except ImportError as error:
        raise FluidError(f"fluid = {name!r}: {say_missing('coolprop', error)}") from None
    return CoolProp


def _source(package: Any) -> str:
    version = package.get_global_param_string("version")
    return f"CoolProp {version}: I. H. Bell et al., Ind. Eng. Chem. Res. 53, 2498 (2014)"
