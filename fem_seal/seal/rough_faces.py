"""The rough faces of a seal, and how heat crosses them where they are pressed on each other."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.errors import InputError
from fem_seal.files import problem

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.case.tables import CaseTables
    from fem_seal.materials import Material
    from leak import GapFluid, RoughContact
    from leak.flow.turned_contact import FaceContact

# Places across a contact whose conductances are averaged.
_PLACES = 24


def rough_contact(case: CaseTables) -> FaceContact | None:
    """The case's faces, with the hardness if their asperities yield; None without roughness.

    Parameters
    ----------
    case : CaseTables
    """
    from leak import RoughContact, TurnedContact

    if case.roughness is None:
        return None
    joined = case.roughness.combine()
    hardness = case.hardness if case.leak.plasticity else None
    if joined.crests:
        return TurnedContact(
            **joined.of_crests,
            fine=joined.spectrum,
            effective_modulus=case.effective_modulus,
            hardness=hardness,
            thread_radius=case.initial_contact_radius if case.roughness.has_thread else math.inf,
        )
    return RoughContact(
        joined.spectrum,
        effective_modulus=case.effective_modulus,
        hardness=hardness,
        theory=case.leak.theory,
        percolation_threshold=case.leak.percolation_threshold,
        peklenik=joined.peklenik,
    )


@dataclass(frozen=True)
class Joint:
    """Faces with what fills their gap, through which heat goes from one body to the other.

    Parameters
    ----------
    surface : RoughContact
    conductivity : float
        Harmonic mean of both bodies [W/(m K)].
    fluid : GapFluid or None
        None in vacuum, and where a case has no fluid.
    outlet_pressure : float
        Absolute, of a gas on the low side [Pa].
    """

    surface: RoughContact
    conductivity: float
    fluid: GapFluid | None
    outlet_pressure: float

    @classmethod
    def of(
        cls,
        surface: FaceContact | None,
        materials: Mapping[str, Material],
        fluid: str | None,
        temperature: float | None,
        outlet_pressure: float = 0.0,
    ) -> Joint | None:
        """None of faces that are not random, and where a thermal conductivity is not known.

        Parameters
        ----------
        surface : FaceContact or None
        materials : mapping
            Of both bodies.
        fluid : str or None
            Its name; None without one.
        temperature : float or None
            Of the fluid [K]; None where it is not from the library.
        outlet_pressure : float
            [Pa]
        """
        resistance = [1.0 / k for material in materials.values() if (k := material.thermal_conductivity)]
        if len(resistance) < 2:
            return None
        from leak import GapFluid, RoughContact

        filling = None if fluid is None or temperature is None else GapFluid.of(fluid, temperature)
        if not isinstance(surface, RoughContact) or (fluid is not None and filling is None):
            return None
        return cls(surface, 2.0 / sum(resistance), filling, outlet_pressure)

    def conductance(
        self, pressure: FloatArray, fluid_pressure: FloatArray, largest: FloatArray | None = None
    ) -> FloatArray:
        """Heat flux over the step in temperature, NaN where the faces are farther apart than they touch [W/(m^2 K)].

        Parameters
        ----------
        pressure, fluid_pressure, largest : ndarray, shape (m,)
            Contact pressure, that of the fluid above the outlet, and the largest that each place has carried [Pa].
        """
        from leak import joint_conductance

        touches = pressure > self.surface.pressure(self.surface.touch_distance)
        values = np.full(pressure.shape, np.nan)
        values[touches] = joint_conductance(
            self.surface,
            pressure[touches],
            self.conductivity,
            self.fluid,
            fluid_pressure=self.outlet_pressure + fluid_pressure[touches],
            largest=None if largest is None else largest[touches],
        )
        return values


def mean_conductance(
    case: CaseTables, line_load: float, width: float, fluid_pressure: float, larger: float = 1.0
) -> float | None:
    """Mean conductance of the contact of a case under Hertz' pressure, None where it is perfect [W/(m^2 K)].

    Parameters
    ----------
    case : CaseTables
        With a number of both conductivities.
    line_load : float
        [N/m]
    width : float
        Of the contact [m].
    fluid_pressure : float
        [Pa]
    larger : float
        How many times as large the largest load before was, 1 without one [-].

    Raises
    ------
    InputError
        If something it needs is not known.
    """
    from leak import TurnedContact

    fluid, surface = case.fluid, rough_contact(case)
    materials = {"closure": case.closure.material, "seat": case.lower.material}
    of_fluid = (
        (None, None) if fluid is None else (fluid.name, fluid.temperature, fluid.outlet_pressure or 0.0)
    )
    joint = Joint.of(surface, materials, *of_fluid)
    if joint is None:
        turned = isinstance(surface, TurnedContact)
        raise InputError(
            problem("conductance_of_rough_faces", turned=turned, fluid=None if fluid is None else fluid.name)
        )
    share = np.linspace(-1.0, 1.0, 2 * _PLACES + 1)[1::2]
    hertz = 4.0 / np.pi * line_load / width
    pressure = hertz * np.sqrt(1.0 - share**2)
    largest = hertz * np.sqrt(larger - share**2) if larger > 1.0 else None
    half = np.full(pressure.shape, 0.5 * fluid_pressure)
    mean = float(np.nan_to_num(joint.conductance(pressure, half, largest), nan=0.0, posinf=np.inf).mean())
    return mean if math.isfinite(mean) else None
