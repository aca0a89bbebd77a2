"""Where a fluid is not what the leak rate takes it for: at high pressure, and in gaps as narrow as its molecules."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from fem_seal.analysis.caution import Caution, Level
from fem_seal.analysis.load_names import load_name

if TYPE_CHECKING:
    from fem_seal.analysis.flow import Flow
    from fem_seal.analysis.results import LoadResult

# Pressure from which on the thickening of a liquid should be known [Pa].
_THICKENS = 2e7
# Between which a liquid of unknown kind thickens: mixtures with water [1/Pa], and oils of this exponent of Roelands.
_LEAST, _MOST = 2.5e-9, 0.75
# Viscosity below which the latter says too little of thin liquids [Pa s].
_THIN = 5e-4
# Uncertainty of the leak rate by that of a pressure law, and thickening beyond its range, that are worth saying.
_UNCERTAIN, _SLIGHTLY = 0.2, 1.05


def fluid_cautions(flow: Flow, loads: Sequence[LoadResult]) -> Iterator[Caution]:
    """What the fluid itself says against the leak rates.

    Parameters
    ----------
    flow : Flow
    loads : sequence of LoadResult
        What is said is about the worst of them.
    """
    checks = (molecule_cautions, _thickening) if flow.gas is None else (molecule_cautions, _dense_gas)
    yield from (caution for check in checks for caution in check(flow, loads))


def molecule_cautions(flow: Flow, loads: Sequence[LoadResult]) -> Iterator[Caution]:
    """Where the critical separation is narrower than a molecule.

    Parameters
    ----------
    flow : Flow
    loads : sequence of LoadResult
    """
    from leak.fluids.names import molecular_size

    size = molecular_size(flow.fluid)
    narrow = [load for load in loads if load.critical_separation and load.critical_separation < size]
    if narrow:
        load = min(narrow, key=lambda load: load.critical_separation or 0.0)
        yield Caution(
            "molecules",
            Level.DOUBTFUL,
            "critical separation below the size of a molecule of the fluid",
            f"the critical separation {(load.critical_separation or 0.0) * 1e9:.2g} nm at "
            f"{load_name(load, loads)} is below the size of a molecule of the fluid, {size * 1e9:.2g} nm. "
            "The theory treats the fluid as a continuum; in reality the seal is tight there",
        )


def _thickening(flow: Flow, loads: Sequence[LoadResult]) -> Iterator[Caution]:
    from leak import effective_viscosity_ratio

    load = max(loads, key=lambda load: load.fluid_pressure)
    pressure, law = load.fluid_pressure, flow.pressure_law
    if law is None:
        yield from _unknown_thickening(flow, load, loads)
        return
    if pressure > law.highest_pressure and abs(math.log(_ratio(flow, pressure))) > math.log(_SLIGHTLY):
        known = f"{law.highest_pressure / 1e5:.4g} bar"
        yield Caution(
            "thickening",
            Level.DOUBTFUL,
            f"viscosity extrapolated above {known}",
            f"at {load_name(load, loads)} the viscosity of {flow.fluid} is extrapolated: how it thickens is known up "
            f"to {known}; {_ratio(flow, pressure):.3g} times the viscosity at atmospheric "
            "pressure is used on the high side. A liquid may also become solid there",
        )
    share = law.uncertainty * abs(math.log(effective_viscosity_ratio(law, pressure)))
    if share > _UNCERTAIN:
        yield Caution(
            "thickening",
            Level.DOUBTFUL,
            f"leak rate uncertain by {100 * share:.2g} % because of how the liquid thickens",
            f"at {load_name(load, loads)} how much {flow.fluid} thickens under pressure is known to "
            f"{100 * law.uncertainty:.2g} % of the logarithm of its viscosity: the leak rate is uncertain by "
            f"{100 * share:.2g} %. [fluid] pressure_viscosity or roelands_z takes a measured coefficient",
        )


def _ratio(flow: Flow, pressure: float) -> float:
    """Viscosity at a pressure over that at atmospheric pressure."""
    return 1.0 if flow.pressure_law is None else float(flow.pressure_law.viscosity_ratio(pressure))


def _unknown_thickening(flow: Flow, load: LoadResult, loads: Sequence[LoadResult]) -> Iterator[Caution]:
    from leak import Barus, Roelands, effective_viscosity_ratio

    pressure = load.fluid_pressure
    if pressure <= _THICKENS:
        return
    little, much = Barus(_LEAST), Roelands(_MOST, max(flow.viscosity, _THIN))
    most, least = (1.0 / effective_viscosity_ratio(law, pressure) for law in (little, much))
    bar, share = f"{pressure / 1e5:.4g} bar", f"{least:.2g} to {most:.2g}"
    yield Caution(
        "thickening",
        Level.DOUBTFUL,
        f"thickening of the liquid at {bar} not known: in truth {share} times the leak rate",
        f"at {load_name(load, loads)} the viscosity of {flow.fluid} under {bar} is not known and that at atmospheric "
        f"pressure is used. Liquids thicken by {1e9 * little.coefficient:.2g} (with water) to "
        f"{1e9 * much.coefficient:.2g} 1/GPa (oils as viscous as this): in truth {share} times as much "
        "leaks. Give [fluid] pressure_viscosity or roelands_z",
    )


def _dense_gas(flow: Flow, loads: Sequence[LoadResult]) -> Iterator[Caution]:
    gas = flow.gas
    assert gas is not None  # of a gas
    highest = max(load.fluid_pressure for load in loads) + flow.outlet_pressure
    if highest > gas.dilute_pressure:
        yield Caution(
            "dense gas",
            Level.DOUBTFUL,
            f"{gas.name} at {highest / 1e5:.4g} bar is not a dilute ideal gas",
            f"{gas.name} at {highest / 1e5:.4g} bar is not a dilute ideal gas: above "
            f"{gas.dilute_pressure / 1e5:.4g} bar its density or viscosity differs by more than 5 %, "
            "which the leak rate does not take into account",
        )
