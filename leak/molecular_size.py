"""How small a channel a fluid's molecules can pass."""

from __future__ import annotations

from types import MappingProxyType

# Kinetic diameters: D. W. Breck, Zeolite Molecular Sieves, Wiley (1974), table 8.1 (air: nitrogen's).
# Oils and fuels pass where their chains do sideways: the kinetic diameter of normal butane and longer paraffins.
_PARAFFIN = 0.43e-9
_WATER = 0.265e-9

MOLECULAR_SIZES = MappingProxyType(
    {
        "helium": 0.26e-9,
        "hydrogen": 0.289e-9,
        "nitrogen": 0.364e-9,
        "air": 0.364e-9,
        "oxygen": 0.346e-9,
        "argon": 0.34e-9,
        "carbon dioxide": 0.33e-9,
        "methane": 0.38e-9,
        "water": _WATER,
        "oil": _PARAFFIN,
        "diesel": _PARAFFIN,
        "kerosene": _PARAFFIN,
    }
)
"""Word in a fluid's name -> smallest channel that it passes [m], read-only."""


def molecular_size(fluid: str) -> float:
    """Kinetic diameter of a fluid's molecules [m]; of a mixture with water that of water, which passes first.

    Parameters
    ----------
    fluid : str
        Name of the fluid; of one that is not known the smallest size of all is returned, helium's.

    Examples
    --------
    >>> molecular_size("hydraulic oil ISO VG 32")
    4.3e-10
    """
    name = fluid.strip().lower()
    found = [size for word, size in MOLECULAR_SIZES.items() if word in name]
    return min(found, default=min(MOLECULAR_SIZES.values()))
