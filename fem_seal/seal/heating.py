"""Calculated temperatures: heat sources, contact temperature, thermal strain of the bodies.

The temperature of the contact decides the numbers of materials and fluid, and these the mesh on which the temperature
is calculated. It is therefore calculated twice: once on a mesh of its own, of the same bodies in hard contact, for what
is taken at the contact, and then on that of the problem, for the field that strains the bodies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from fem_seal.contact.laws import HardContact
from fem_seal.contact.sizing import Opening, contact_widths, element_sizes
from fem_seal.errors import InputError, Problem
from fem_seal.loads import line_load
from fem_seal.materials import Material, effective_modulus

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.bodies.constrained_body import ConstrainedBody, Heat
    from fem_seal.case.tables import CaseTables
    from fem_seal.contact.conduction import Surroundings, TemperatureField
    from meshes import ContactGeometry, SealMesh, Sizing

AnyCase = TypeVar("AnyCase", bound="CaseTables")


@dataclass(frozen=True)
class Heating:
    """What warms a seal, and where its dimensions hold.

    Parameters
    ----------
    surroundings : Surroundings
    reference : float
        Temperature at which the dimensions hold [K].
    housing : float or None
        Temperature of the bore that holds the seat's wall [K]; None: that of the wall, in the mean.
    housing_expansion : float or None
        Its thermal expansion [1/K]; None: that of the seat.
    """

    surroundings: Surroundings
    reference: float
    housing: float | None = None
    housing_expansion: float | None = None

    def field(self, seal_mesh: SealMesh, materials: Mapping[str, Material]) -> TemperatureField:
        """Temperatures on a mesh; see `fem_seal.contact.conduction.conduct`."""
        from fem_seal.contact.conduction import conduct
        from fem_seal.contact.model import line_points

        return conduct(seal_mesh, materials, self.surroundings, *line_points(seal_mesh))

    def of_bodies(self, seal_mesh: SealMesh, materials: Mapping[str, Material]) -> dict[str, Heat]:
        """Temperature and free strain of both bodies at the nodes of a mesh.

        Raises
        ------
        InputError
            If a number of a material is not known at a temperature that is reached, or strains are not small.
        ConvergenceError
        """
        from fem_seal.bodies.constrained_body import Heat

        with _at_temperature():
            temperatures = self.field(seal_mesh, materials)
            base = materials["seat"].thermal_strain(temperatures.faces["seat"], self.reference)
            heat = {
                name: Heat(nodes, materials[name].thermal_strain(nodes, self.reference) - base)
                for name, nodes in temperatures.nodes.items()
            }
            for name, nodes in temperatures.nodes.items():
                _check_curves(name, materials[name], nodes)
        return heat

    def wall_motion(self, seat: ConstrainedBody) -> float:
        """How far a held wall is moved inwards because the bore grows less than the seat at the contact [m].

        Parameters
        ----------
        seat : ConstrainedBody
            With its temperature.
        """
        if not len(seat.wall) or seat.temperature is None:
            return 0.0
        positions = seat.wall_nodes
        strain = seat.free_strain["heat"]
        mean = float(np.mean(strain[positions]))
        warm = float(np.mean(seat.temperature[positions]))
        growth = seat.material.thermal_strain(seat.temperature, self.reference)
        base = float(np.mean(growth - strain))
        housing = warm if self.housing is None else self.housing
        if self.housing is None and self.housing_expansion is None:
            of_housing = base + mean
        elif self.housing_expansion is None:
            of_housing = seat.material.thermal_strain(housing, self.reference)
        else:
            of_housing = self.housing_expansion * (housing - self.reference)
        return (base - of_housing) * float(seat.mesh.p[0].max())


@contextmanager
def _at_temperature() -> Iterator[None]:
    """Name the temperatures as the key of what is wrong with the input."""
    try:
        yield
    except InputError as error:
        raise InputError(*(Problem("temperature", problem) for problem in error.problems)) from None


def _check_curves(name: str, material: Material, temperature: FloatArray) -> None:
    """InputError where the hardening curves of a body do not reach to all of its temperatures [K]."""
    curves = material.hardening_over_temperature
    if curves is None:
        return
    try:
        curves.check(temperature)
    except InputError as error:
        raise InputError(
            *(replace(problem, key=f"{name}.material.{problem.key}") for problem in error.problems)
        ) from None


def heating_of(case: CaseTables) -> Heating:
    """What warms the seal of a case whose temperatures are calculated.

    Parameters
    ----------
    case : CaseTables
    """
    heat = case.temperature
    assert heat is not None  # with faces
    from fem_seal.contact.conduction import Face, Surroundings

    faces = {name: Face(face.temperature, face.heat_transfer) for name, face in heat.faces.items()}
    return Heating(
        Surroundings(faces, _conductance(case), _contact_reach(case)),
        heat.reference,
        heat.housing,
        heat.housing_expansion,
    )


def _conductance(case: CaseTables) -> float | None:
    """Of the contact [W/(m^2 K)]: as given, or of the rough faces at the largest load; None where it is perfect."""
    heat = case.temperature
    assert heat is not None  # with faces
    if not isinstance(heat.contact_conductance, str):
        return heat.contact_conductance
    from fem_seal.seal.rough_faces import mean_conductance

    (low, high), load = _contact_reach(case), case.load
    forces = {point: case.expected_force(*point) for point in load.path}
    point = max(load.points, key=forces.__getitem__)
    larger = max(forces.values()) / forces[point] if forces[point] > 0.0 else 1.0
    return mean_conductance(case, max(_line_loads(case)), high - low, point[0], larger)


def _line_loads(case: CaseTables) -> list[float]:
    contact, forces = case.contact, [case.expected_force(*point) for point in case.load.points]
    closing_forces = [force for force in forces if force > 0] or [1.0]
    return [line_load(force, contact.initial_contact_radius, contact.angle) for force in closing_forces]


def _contact_reach(case: CaseTables) -> tuple[float, float]:
    """Arc lengths within which the bodies touch: two standard deviations of the pressure at the largest load.

    That is Hertz' half-width for hard contact. The resistance around so narrow a strip follows
    its width like a logarithm.
    """
    contact = case.contact
    opening, largest = Opening.of(contact), max(_line_loads(case))
    std = contact_widths(HardContact(), [largest], opening, case.effective_modulus)[0].std
    low, high = contact.reach
    return max(low, -2 * std), min(high, 2 * std)


def with_contact_temperatures(case: AnyCase) -> AnyCase:
    """A case with the numbers of materials and fluid at the temperatures of the contact, where these are calculated.

    Parameters
    ----------
    case : CaseTables

    Raises
    ------
    InputError
        If a number is not known at a temperature that is reached.
    ConvergenceError
    """
    if not case.conducts_heat or case.body_temperatures:
        return case
    materials = {"closure": case.closure.material, "seat": case.lower.material}
    modulus = effective_modulus(materials["closure"], materials["seat"])
    sizing = element_sizes(HardContact(), _line_loads(case), case.contact, modulus)
    try:
        heating = heating_of(case)
        with _at_temperature():
            faces = heating.field(_mesh(case.contact, sizing), materials).faces
        return case.with_temperatures(faces["closure"], faces["seat"])
    except InputError as error:
        raise error.in_file(case.file) from None


@lru_cache(maxsize=4)
def _mesh(contact: ContactGeometry, sizing: Sizing) -> SealMesh:
    # the check of a case loads no finite elements
    from meshes import build_contact

    return build_contact(contact, sizing)
