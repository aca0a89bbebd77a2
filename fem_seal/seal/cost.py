"""Estimated cost of a case."""

from __future__ import annotations

from fem_seal.case.tables import CaseTables, Direct
from fem_seal.units import duration

# Processor seconds of the examples: a load on bodies that are there; the bodies and table of a problem that shares
# none; conduction of heat in both bodies.
_LOAD, OWN, _HEAT = 0.004, 0.3, 0.7
# A path of load steps to one load, with the fluid between the surfaces twice as many of them; the way of the fluid
# between surfaces that do not yield, and of a gas; contacts around a seal with waves or scratches.
_PATH, _FLUID, _GAS, _AROUND = 0.4, 0.03, 0.5, 0.05
# Load steps of a path with what comes after it, such as its error: of any, and of each load; and the seconds of one, by
# the elements along the contact line.
_STEPS, _STEPS_OF_LOAD, _STEP = 30, 25, 1.2e-3
# Times below this are not worth a number [s].
_SOON = 10.0
# A point of a simulated map at one pressure, and how much longer metal takes that flows below the surface.
_POINT, _FLOWS = 1.2e-5, 40.0


def load_seconds(case: CaseTables) -> float:
    """Estimated processor time of one load on bodies that are there [s], good to a factor of three.

    Parameters
    ----------
    case : CaseTables
    """
    penetrates = not case.on_sealed_area
    of_gas = case.fluid is not None and case.fluid.gas is not None
    way = _GAS if of_gas else _FLUID
    path = _PATH * (2 if penetrates else 1) if yields(case) else way * penetrates
    return _LOAD + path + _AROUND * (case.uneven_key is not None)


def yields(case: CaseTables) -> bool:
    """Whether a body yields, so that its loads are a path.

    Parameters
    ----------
    case : CaseTables
    """
    return any(body.material.hardening is not None for body in (case.closure, case.lower))


def path_seconds(elements: float, loads: int) -> float:
    """Estimated processor time of a run of bodies that yield [s], good to a factor of three.

    Parameters
    ----------
    elements : float
        Along the contact line.
    loads : int

    Examples
    --------
    >>> round(path_seconds(elements=120, loads=4))
    19
    """
    return _STEP * elements * (_STEPS + _STEPS_OF_LOAD * loads)


def about(seconds: float) -> str:
    """An estimated time in words, which is good to a factor of three.

    Examples
    --------
    >>> about(4.0), about(34.0), about(200.0)
    ('some seconds', 'about 30 s', 'about 3 min')
    """
    if seconds < _SOON:
        return "some seconds"
    digits = 10 if seconds < 60 else 60
    return f"about {duration(digits * max(1, round(seconds / digits)))}"


def seconds(case: CaseTables) -> float:
    """Estimated processor time of the loads of a case and their leak rates [s], good to a factor of three.

    Bodies and tables that neighbouring cases share are taken to be there.

    Parameters
    ----------
    case : CaseTables

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": ["20 bar", "40 bar"]},
    ... )
    >>> seconds(case)
    0.008
    """
    heat = case.temperature is not None and bool(case.temperature.faces)
    direct = case.direct if case.leak.conductivity == "direct" else None
    is_turned = case.roughness is not None and case.roughness.is_turned
    maps = 0.0 if direct is None else _map_seconds(direct, is_turned)
    return (
        len(case.load.path) * load_seconds(case)
        + (OWN if heat or yields(case) else 0.0)
        + _HEAT * heat
        + maps
    )


def _map_seconds(direct: Direct, is_turned: bool) -> float:
    pressures = len(direct.path or range(12 if is_turned else 8))
    flows = _FLOWS if direct.asperities == "von-mises" else 1.0
    # of a turned face these are the most
    points, samples = (
        usual if is_turned and name not in direct.model_fields_set else getattr(direct, name)
        for name, usual in (("points", 512), ("samples", 2))
    )
    return _POINT * flows * points**2 * samples * pressures
