"""Checks of the fluid: its temperature, high pressure, choking, inertia, gaps as narrow as molecules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem_seal.materials import ROOM_TEMPERATURE, in_degrees
from fem_seal.profile import PressureProfile
from fem_seal.seal.findings import ORDERS_OF_MAGNITUDE, Bounds, Finding, Level, caution, fade_in
from fem_seal.seal.leak_model import FlowModel
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.units import round_digits
from fem_seal.validity.materials import FAR, NEAR
from fem_seal.wording import Quantity

if TYPE_CHECKING:
    from leak import Gas, GasInertia, LeakResult

# Pressure from which on the thickening of a liquid should be known [Pa].
_THICKENS = 2e7
# Bounds of the thickening of an unknown liquid: mixtures with water (Barus [1/Pa]) and oils (exponent of Roelands).
_LEAST_BARUS, _LARGEST_ROELANDS = 2.5e-9, 0.75
# Viscosity below which Roelands' law predicts too little thickening [Pa s].
_THIN = 5e-4
# Uncertainty of the leak rate from the pressure law, and thickening beyond its range, above which they are reported.
_UNCERTAIN, _SLIGHT = 0.2, 1.05

# Share of the driving force of a gas that inertia takes: doubtful above the first, void above the second; Mach number
# of choking.
_DOUBTFUL_SHARE, _VOID_SHARE, _CHOKING_MACH = 0.05, 0.3, 0.8
# Reynolds numbers: of the hydraulic diameter, where flow becomes turbulent, and of the gap times gap over width.
_TURBULENT, _INERTIAL = 2000.0, 1.0
# Share of the pressure that inertia takes at a reduced Reynolds number of one: 6/5 of rho v^2 over 12 eta v L/u^2.
_PRESSURE_SHARE = 0.1
# Density of a liquid for which none is given [kg/m^3].
_DENSITY = 1000.0
# Sizes of a molecule from which on a gap is that of a fluid without molecules; at one of them the seal may be tight.
_FEW = 4.0
# Contact pressure below which the gap counts as open [Pa].
_NO_PRESSURE = 1e-200


def opening_factor(share: float) -> float:
    """How many times as much leaks at most because the fluid opens the gap [-].

    1 + 1.7 p_f/p0 up to a half, and from there ever more up to infinity at one: not below what a liquid between the
    surfaces does that is taken off the load of the asperities, place by place (`leak.coupled_leak_flow`).

    Parameters
    ----------
    share : float
        Fluid pressure over peak contact pressure [-].
    """
    excess = max(2.0 * share - 1.0, 0.0)
    return math.inf if excess >= 1.0 else 1.0 + 1.7 * share / (1.0 - excess) ** 2


def film_cautions(problem: SealProblem) -> Iterator[Finding]:
    """A fluid whose given temperature is not that of the faces, which a film of micrometres takes at once.

    Parameters
    ----------
    problem : SealProblem
    """
    temperature = problem.at_rest.fluid_temperature
    if temperature is None:
        return
    name, film, limit = "film_temperature", ROOM_TEMPERATURE, NEAR
    if problem.at_rest.temperatures:
        film = math.fsum(problem.at_rest.temperatures.values()) / len(problem.at_rest.temperatures)
    else:
        # oil of 50 degC is usual in a valve whose metals are those of a table at 20 degC
        name, limit = "body_temperature", 2 * NEAR
    if abs(temperature - film) > limit:
        finding = caution(name, given=in_degrees(temperature), film=in_degrees(film))
        yield finding if abs(temperature - film) >= FAR else replace(finding, level=Level.VALID)


def fluid_cautions(flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Cautions about the fluid: gaps as narrow as molecules, thickening or dense gas, inertia.

    Parameters
    ----------
    flow : FlowModel
    loads : sequence of LoadResult
        Each caution is about the worst of them.
    """
    at_pressure = _thickening if flow.gas is None else _dense_gas
    yield from (item for check in (molecule_cautions, at_pressure, _inertia) for item in check(flow, loads))


def molecule_cautions(flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Finding where the critical separation is narrower than a molecule.

    Parameters
    ----------
    flow : FlowModel
    loads : sequence of LoadResult
    """
    from leak.fluids.library import molecular_size

    size = molecular_size(flow.fluid)
    gaps = [(load.critical_separation, load) for load in loads if load.critical_separation is not None]
    # no path at all is no matter of molecules, unless a short contact leaks nevertheless
    narrow = [(gap, load) for gap, load in gaps if gap < _FEW * size and (gap > 0.0 or _leaks(load))]
    if narrow:
        gap, load = min(narrow, key=lambda pair: pair[0])
        tight = 1.0 if gap <= size else math.log(_FEW * size / gap) / math.log(_FEW)
        yield caution(
            "molecules",
            load,
            loads,
            leak_factor=Bounds(ORDERS_OF_MAGNITUDE**-tight, 1.0),
            proven=False,
            is_reported=0.0 < gap < size,
            gap=gap,
            size=size,
        )


def _thickening(flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    from leak import effective_viscosity_ratio

    load = max(loads, key=lambda load: load.fluid_pressure)
    pressure, law = load.fluid_pressure, flow.pressure_law
    if law is None:
        yield from _unknown_thickening(flow, load, loads)
        return
    ratio = float(law.viscosity_ratio(pressure))
    if pressure > law.highest_pressure and abs(math.log(ratio)) > math.log(_SLIGHT):
        limit = Quantity(law.highest_pressure, ".4g bar")
        yield caution("thickening_extrapolated", load, loads, known=limit, fluid=flow.fluid, ratio=ratio)
    share = law.uncertainty * abs(math.log(effective_viscosity_ratio(law, pressure)))
    yield caution(
        "thickening_uncertain",
        load,
        loads,
        leak_factor=fade_in(Bounds.factor_bounds(1.0 + share), share / _UNCERTAIN),
        is_reported=share > _UNCERTAIN,
        share=share,
        fluid=flow.fluid,
        known=law.uncertainty,
    )


def _unknown_thickening(flow: FlowModel, load: LoadResult, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    from leak import Barus, Roelands, effective_viscosity_ratio

    pressure = load.fluid_pressure
    if not pressure > 0.0:
        return
    weak, strong = Barus(_LEAST_BARUS), Roelands(_LARGEST_ROELANDS, max(flow.viscosity, _THIN))
    high, low = (1.0 / effective_viscosity_ratio(law, pressure) for law in (weak, strong))
    share = f"{low:.2g} to {high:.2g}"
    yield caution(
        "thickening_unknown",
        load,
        loads,
        leak_factor=fade_in(Bounds(low, high), pressure / _THICKENS),
        proven=False,
        is_reported=pressure > _THICKENS,
        pressure=Quantity(pressure, ".4g bar"),
        share=share,
        fluid=flow.fluid,
        little=1e9 * weak.coefficient,
        much=1e9 * strong.coefficient,
    )


def _dense_gas(flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    from leak.fluids.library import condensation_pressure

    gas = flow.gas
    assert gas is not None  # of a gas
    highest = max(load.fluid_pressure for load in loads) + flow.outlet_pressure
    if gas.real is not None and highest > gas.real.highest_pressure:
        at, limit = (Quantity(pressure, ".4g bar") for pressure in (highest, gas.real.highest_pressure))
        condenses = gas.real.condenses
        yield caution(
            "condensed" if condenses else "dense_gas",
            outside=condenses,
            gas=gas.name,
            temperature=gas.temperature,
            at=at,
            known=limit,
        )
    elif gas.real is None and highest > (liquid := condensation_pressure(gas)):
        at, limit = (Quantity(pressure, ".4g bar") for pressure in (highest, liquid))
        yield caution(
            "condensed", outside=True, gas=gas.name, temperature=gas.temperature, at=at, known=limit
        )
        yield from _not_ideal(flow, gas, liquid, is_reported=False)
    elif gas.real is None and highest > 0.5 * gas.dilute_pressure:
        yield from _not_ideal(flow, gas, highest, is_reported=highest > gas.dilute_pressure)


def _not_ideal(flow: FlowModel, gas: Gas, highest: float, *, is_reported: bool) -> Iterator[Finding]:
    from leak import real_gas_flow_ratio
    from leak.fluids.library import coolprop_name, estimated_real_gas

    real, name = estimated_real_gas(gas, highest), coolprop_name(gas.name)
    factors: dict[str, Any] = {"times": None}
    ratio = 1.0
    if real is not None:
        ratio = real_gas_flow_ratio(real, highest, flow.outlet_pressure)
        factors = {
            "times": ratio,
            "factor": float(real.factor(highest)),
            "viscosity": float(real.viscosity_ratio(highest)),
        }
    yield caution(
        "not_ideal_gas",
        leak_factor=fade_in(Bounds(min(ratio, 1.0), max(ratio, 1.0)), highest / gas.dilute_pressure),
        proven=False,
        is_reported=is_reported,
        gas=gas.name,
        at=Quantity(highest, ".4g bar"),
        dilute=Quantity(gas.dilute_pressure, ".4g bar"),
        other=name,
        **factors,
    )


def _inertia(flow: FlowModel, loads: Sequence[LoadResult]) -> Iterator[Finding]:
    """Finding where flow is too fast to be viscous, in the result or else in its upper end."""
    fastest = _fastest_liquid if flow.gas is None else _fastest_gas
    # the other readings of yielding asperities only where their leak is already calculated
    others = [(load, other) for load in loads for other in load.others.values() if _leak_known(other)]
    for end, pairs in ((False, [(load, load) for load in loads]), (True, others)):
        finding = fastest(flow, loads, pairs, end=end)
        if finding is not None:
            yield finding
            if not finding.silent:
                return


def _fastest_gas(
    flow: FlowModel, loads: Sequence[LoadResult], pairs: Sequence[tuple[LoadResult, LoadResult]], *, end: bool
) -> Finding | None:
    """Finding about the inertia of a gas; None below the limits. `end`: it concerns one end of the interval only."""
    flows = [(inertia, load) for load, scenario in pairs if (inertia := _inertia_of(flow, scenario))]
    if not flows:
        return None
    (numbers, reduced_Re), load = max(flows, key=lambda pair: (pair[0][0].acceleration, pair[0][1]))
    worst_reynolds = max(gas_flow.reynolds for (gas_flow, _), _ in flows)
    is_void = numbers.acceleration > _VOID_SHARE or worst_reynolds > _TURBULENT
    ratio = max(numbers.acceleration / _DOUBTFUL_SHARE, reduced_Re / _INERTIAL, worst_reynolds / _TURBULENT)
    is_reported = ratio > 1.0
    if end and not is_reported:
        return None
    low = min(1.0 - numbers.acceleration, 1.0 / (1.0 + _PRESSURE_SHARE * reduced_Re))
    return caution(
        "gas_inertia",
        load,
        loads,
        outside=is_void and not end,
        leak_factor=fade_in(Bounds(1.0 if end else max(low, 0.0), 1.0), ratio),
        proven=False,
        is_reported=is_reported,
        around=_has_waves(load),
        end=end,
        fast=f"Mach number {_two(numbers.mach)} and Reynolds number {_two(numbers.reynolds)}",
        share=numbers.acceleration,
        limit=100 * _DOUBTFUL_SHARE,
        reduced=_two(reduced_Re),
        most=_INERTIAL,
        chokes=numbers.mach > _CHOKING_MACH,
    )


def _fastest_liquid(
    flow: FlowModel, loads: Sequence[LoadResult], pairs: Sequence[tuple[LoadResult, LoadResult]], *, end: bool
) -> Finding | None:
    """`_fastest_gas` for a liquid."""
    flows = [(*numbers, load) for load, scenario in pairs if (numbers := _of_liquid(flow, scenario))]
    # a turbulent flow before any other
    worst = max(flows, key=lambda item: (item[0] > _TURBULENT, item[1]), default=(0.0, 0.0, None))
    reynolds, reduced_Re, load = worst
    ratio = max(reduced_Re / _INERTIAL, reynolds / _TURBULENT)
    is_reported = ratio > 1.0
    if load is None or (end and not is_reported):
        return None
    return caution(
        "liquid_inertia",
        load,
        loads,
        outside=reynolds > _TURBULENT and not end,
        leak_factor=fade_in(Bounds(1.0 if end else 1.0 / (1.0 + _PRESSURE_SHARE * reduced_Re), 1.0), ratio),
        proven=False,
        is_reported=is_reported,
        around=_has_waves(load),
        end=end,
        fluid=flow.fluid,
        reynolds=_two(reynolds),
        turbulent=_TURBULENT,
        reduced=_two(reduced_Re),
        most=_INERTIAL,
    )


def _of_liquid(flow: FlowModel, load: LoadResult) -> tuple[float, float] | None:
    """Reynolds number of the hydraulic diameter, and of the gap times gap over width; None where nothing flows.

    The gap is the uniform gap across the width of the contact with the same flow.
    """
    place = _where_most_leaks(load) if _leak_known(load) else None
    if place is None or not 0 < place[1].leak_rate < math.inf or not load.fluid_pressure > 0:
        return None
    (profile, leak), viscosity = place, flow.effective_viscosity(load.fluid_pressure) or flow.viscosity
    density = leak.mass_flow / leak.leak_rate if leak.mass_flow else _DENSITY
    radius = float(profile.radius[int(profile.pressure.argmax())])
    per_length, width = leak.leak_rate / (2 * math.pi * radius), 2.0 * profile.std
    gap = (12 * viscosity * per_length * width / load.fluid_pressure) ** (1 / 3)
    reynolds = density * per_length / viscosity
    return 2 * reynolds, reynolds * gap / width


def _leak_known(load: LoadResult) -> bool:
    """Whether the leak is already calculated; a check alone does not calculate it."""
    return not vars(load).keys().isdisjoint({"leak", "leak_round", "around"})


def _leaks(load: LoadResult) -> bool:
    """Whether a leak that is already calculated is more than none."""
    return _leak_known(load) and load.leak is not None and load.leak.leak_rate > 0.0


def _where_most_leaks(load: LoadResult) -> tuple[PressureProfile, LeakResult] | None:
    """Contact pressure at the angle with the largest leak, and the leak of a face with this pressure all around."""
    flow = None if load.rough is None else load.rough.flow
    share = 1.0 if flow is None else 1.0 / flow.faces
    if load.circumference is None:
        return None if load.leak is None else (load.tightest, load.leak.scaled(share * load.leak.leak_rate))
    circumference = load.around
    if circumference is None or circumference.leak is None or circumference.leak_rate is None:
        return None
    at = int(np.argmax(circumference.leak_rate))
    whole = 2.0 * math.pi * float(circumference.leak_rate[at])
    return circumference.profile_at(float(circumference.angle[at])), circumference.leak.scaled(share * whole)


def _has_waves(load: LoadResult) -> bool:
    return load.circumference is not None and load.circumference.form.uneven


def _two(value: float) -> str:
    """A number with two digits, written out."""
    return f"{round_digits(value, 2):g}"


def _inertia_of(flow: FlowModel, load: LoadResult) -> tuple[GasInertia, float] | None:
    """Numbers of the flow, and Reynolds number of the gap times gap over width."""
    from leak import gas_inertia
    from leak.fluids.library import heat_capacity_ratio

    place, rough = _where_most_leaks(load), load.rough
    if place is None or rough is None or (table := rough.table) is None:
        return None
    profile_there, leak = place
    if not leak.mass_flow or not math.isfinite(leak.mass_flow):
        return None
    assert flow.gas is not None  # of a gas
    profile = (load.whole_profile if load.circumference is None else profile_there).equivalent(
        table, rough.surface
    )
    with np.errstate(divide="ignore"):
        gap = np.asarray(table.at_log_pressure(np.log(np.maximum(profile.pressure, _NO_PRESSURE))))
    pressure = leak.fluid_pressure + flow.outlet_pressure
    ratio = heat_capacity_ratio(flow.gas.name) or 1.4
    numbers = gas_inertia(profile.radius, gap, pressure, leak.mass_flow, flow.gas, ratio)
    return numbers, 0.5 * numbers.reynolds * float(gap.min()) / (2.0 * profile_there.std)
