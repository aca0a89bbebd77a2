"""Elastic bodies: a small library with sources, and the effective modulus of a pair."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fem_seal.errors import InputError, Problem
from fem_seal.hardening import HardeningCurve

_PAPER = "Fischer, Schmitz, Tiwari, Persson, Fluid leakage in metallic seals, Tribol. Lett. 68, 125 (2020)"
_KAYE_LABY = "Kaye & Laby, Tables of Physical and Chemical Constants, 16th ed. (1995), 2.2.2"
_MIL_HDBK_5J = "MIL-HDBK-5J (2003)"


@dataclass(frozen=True)
class Material:
    """A homogeneous, isotropic material, linearly elastic up to its yield stress.

    Parameters
    ----------
    name : str
        As it is called in tables and reports.
    youngs_modulus : float
        E [Pa].
    poissons_ratio : float
        nu [-], below 0.5.
    hardness : float, optional
        Penetration hardness sigma_P [Pa], the pressure at which asperities yield; about three times the yield
        stress at 15 % strain (Tabor). None if unknown.
    yield_stress : float, optional
        Onset of plastic flow in tension [Pa], compared with the von Mises stress under the contact. None if
        unknown.
    source : str, optional
        Where the numbers come from.
    hardening : HardeningCurve, optional
        Flow stress over plastic strain; the body is then solved as elastoplastic, and `yield_stress` is that of the
        curve. Without it the body is elastic whatever its stress.

    Raises
    ------
    InputError
        If a number is not finite or outside its physical range, or two of them contradict each other.

    Examples
    --------
    >>> steel = Material("steel", youngs_modulus=210e9, poissons_ratio=0.3)
    >>> round(steel.plane_strain_modulus / 1e9, 3)
    230.769
    """

    name: str
    youngs_modulus: float
    poissons_ratio: float
    hardness: float | None = None
    yield_stress: float | None = None
    source: str = ""
    hardening: HardeningCurve | None = None

    def __post_init__(self) -> None:
        for key in ("youngs_modulus", "hardness", "yield_stress"):
            value = getattr(self, key)
            if value is not None and not (math.isfinite(value) and value > 0):
                raise InputError(
                    Problem(f"{self.name}: {key}", "must be a positive pressure [Pa]", repr(value))
                )
        if not -1 < self.poissons_ratio < 0.5:
            raise InputError(
                Problem(
                    f"{self.name}: poissons_ratio", "must lie between -1 and 0.5", repr(self.poissons_ratio)
                )
            )
        if self.hardening is not None:
            self._yield_with(self.hardening)

    def _yield_with(self, hardening: HardeningCurve) -> None:
        if self.yield_stress not in (None, hardening.yield_stress):
            raise InputError(
                Problem(
                    f"{self.name}: yield_stress",
                    f"contradicts stress_strain, which begins at {hardening.yield_stress / 1e6:.6g} MPa; leave "
                    "yield_stress out",
                    f"{(self.yield_stress or 0.0) / 1e6:.6g} MPa",
                )
            )
        object.__setattr__(self, "yield_stress", hardening.yield_stress)

    @property
    def plane_strain_modulus(self) -> float:
        """E / (1 - nu^2) [Pa]."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)


# Hardness and yield stress depend on grade and heat treatment by factors; the library gives them only where
# the source states them for that very material.
LIBRARY = {
    material.name: material
    for material in (
        Material("steel", 210e9, 0.30, source="EN 1993-1-1:2005, 3.2.6"),
        Material(
            "steel 1.4122",
            210e9,
            0.30,
            hardness=3.5e9,
            yield_stress=500e6,
            source=f"{_PAPER}: penetration hardness as used there, yield stress at the onset of plastic flow",
        ),
        Material("stainless steel", 200e9, 0.30, source="EN 1993-1-4:2006, 2.1.3 (austenitic grades)"),
        Material("aluminium", 70e9, 0.30, source="EN 1999-1-1:2007, 3.2.5 (alloys)"),
        Material("titanium Ti-6Al-4V", 110.3e9, 0.31, source=f"{_MIL_HDBK_5J}, table 5.4.1"),
        Material("brass", 100.6e9, 0.350, source=f"{_KAYE_LABY} (70 % copper, 30 % zinc)"),
        Material("copper", 129.8e9, 0.343, source=_KAYE_LABY),
        Material("nickel", 199.5e9, 0.312, source=f"{_KAYE_LABY} (soft)"),
        Material("silver", 82.7e9, 0.367, source=_KAYE_LABY),
        Material("tungsten carbide", 534.4e9, 0.22, source=_KAYE_LABY),
    )
}


def material(name: str) -> Material:
    """Material of the library.

    Parameters
    ----------
    name : str
        One of `LIBRARY`, for example "steel".

    Raises
    ------
    InputError
        If the library does not have it.
    """
    if name not in LIBRARY:
        known = ", ".join(f'"{known}"' for known in LIBRARY)
        raise InputError(Problem("material", f"not in the library; known are {known}", repr(name)))
    return LIBRARY[name]


def effective_modulus(first: Material, second: Material) -> float:
    """Effective modulus E* of a contact pair [Pa], 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.

    Parameters
    ----------
    first, second : Material
        The two bodies, in any order.

    References
    ----------
    Johnson, Contact Mechanics (1985), eq. 4.23.

    Examples
    --------
    >>> steel = material("steel")
    >>> round(effective_modulus(steel, steel) / 1e9, 3)
    115.385
    """
    return 1 / (1 / first.plane_strain_modulus + 1 / second.plane_strain_modulus)
