"""Ratio of the heat capacities of gases, for what flows without heat: nozzles and orifices."""

from __future__ import annotations

from types import MappingProxyType

from leak.fluids.properties import GAS_CONSTANT

_MONATOMIC = 2.5 * GAS_CONSTANT
_NITROGEN, _OXYGEN = 29.124, 29.376

HEAT_CAPACITIES = MappingProxyType(
    {
        "helium": _MONATOMIC,
        "argon": _MONATOMIC,
        "hydrogen": 28.836,
        "nitrogen": _NITROGEN,
        "oxygen": _OXYGEN,
        # dry air by volume
        "air": 0.78084 * _NITROGEN + 0.20946 * _OXYGEN + 0.0097 * _MONATOMIC,
        "methane": 35.639,
        "carbon dioxide": 37.129,
    }
)
"""Name of a gas -> molar heat capacity at constant pressure of the ideal gas at 25 degC [J/(mol K)], read-only.

NIST-JANAF Thermochemical Tables, 4th ed. (1998).
"""


def heat_capacity_ratio(name: str) -> float | None:
    """Kappa = c_p/(c_p - R) of a gas of the library at 25 degC; None for any other name.

    Parameters
    ----------
    name : str
        Of `leak.GASES`, or "CoolProp:..." with the optional package CoolProp.

    Examples
    --------
    >>> round(heat_capacity_ratio("nitrogen"), 3), round(heat_capacity_ratio("helium"), 3)
    (1.4, 1.667)
    """
    if name.startswith("CoolProp:"):
        from leak.fluids.coolprop import coolprop_heat_capacity

        heat_capacity: float | None = coolprop_heat_capacity(name)
    else:
        heat_capacity = HEAT_CAPACITIES.get(name)
    return None if heat_capacity is None else heat_capacity / (heat_capacity - GAS_CONSTANT)
