"""Limit loads of wedges by fem-seal, beside those of slip lines (R. Hill, The Mathematical Theory of Plasticity, 1950).

How a rigid, perfectly plastic body got its shape does not matter to what it bears, so one that large strains have
shaped needs none of them: its shape is known by similarity, and its limit load is found by small strains. Plane strain
is a ring with a radius 4000 times the contact's length, half of its section beside a wall that holds it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from fem_seal import HardContact, Material, Supports, condense
from fem_seal.bodies.elasticity import node_dofs
from fem_seal.contact.load_path import LoadPath, load_path
from fem_seal.contact.plastic_step import PathLoad, PlasticSettings
from fem_seal.errors import LimitLoadError
from fem_seal.materials import HardeningCurve
from meshes import ContactGeometry, Outline, Segment, Sizing, build_contact

FloatArray = NDArray[np.float64]
Point = tuple[float, float]

# Length of the contact and radius of the ring [m], yield stress [Pa].
LENGTH, RADIUS, YIELD = 1e-3, 4.0, 200e6
# So stiff that small strains hold up to the limit load, and that the ring of the other body does not turn.
METAL = Material("metal", 5e3 * YIELD, 0.3, hardening=HardeningCurve((0.0,), (YIELD,)))
RIGID = Material("rigid", 1e9 * METAL.youngs_modulus, 0.3)
# Loads over that of slip lines, up to where elements bear no more; loads over the limit, between whose last two the
# body moves as it does at the limit.
UP_TO_LIMIT, AT_LIMIT = (0.95, *np.linspace(0.99, 1.1, 12)), (0.95, 0.99, 0.998, 0.9995)


@dataclass(frozen=True)
class Wedge:
    """Half a section in units of the contact's length, x from the plane of symmetry and z from the contact's end there.

    Parameters
    ----------
    contact, lip, rest : (x, z)
        Ends of the contact, of the raised lip beside it, which is as long, and of the surface that is still as it was.
    fan : float
        Angle psi of the fan of slip lines between contact and lip [rad].
    """

    contact: Point
    lip: Point
    rest: Point
    fan: float

    @property
    def pressure(self) -> float:
        """Of slip lines over the yield stress: 2 k (1 + psi), by von Mises 2 k = 2/sqrt(3) yield stresses."""
        return 2.0 / math.sqrt(3.0) * (1.0 + self.fan)

    @property
    def growth(self) -> float:
        """How fast the lip moves across itself if the shape stays similar, over the speed with which it is pressed.

        Every line is as far from the place of first touch as before in proportion to the way from there.
        """
        lip, rest = np.subtract(self.lip, self.contact), np.subtract(self.rest, self.lip)
        depth = self.lip[1] - self.lip[0] * rest[1] / rest[0]
        return float(_across(lip) @ np.subtract(self.contact, (0.0, depth))) / depth


def _across(line: FloatArray) -> FloatArray:
    """Unit normal that looks out of the body below a line that runs away from the plane of symmetry."""
    return np.array([-line[1], line[0]]) / np.hypot(*line)


def crushed(angle: float, fan: float | None = None) -> Wedge:
    """A wedge with a semi-angle [rad] that a smooth flat has crushed.

    Its volume is kept, and the shape stays similar, with tan(angle) = (1 + sin psi)^2/(cos psi (2 + sin psi)); with
    another fan [rad] neither.
    """
    psi = (
        _root(lambda psi: (1 + math.sin(psi)) ** 2 - math.tan(angle) * math.cos(psi) * (2 + math.sin(psi)))
        if fan is None
        else fan
    )
    lip = (1.0 + math.sin(psi), -math.cos(psi))
    return Wedge((1.0, 0.0), lip, (6.0, lip[1] - (6.0 - lip[0]) / math.tan(angle)), psi)


def pressed(angle: float) -> Wedge:
    """A block into which a smooth, rigid wedge of a semi-angle [rad] is pressed.

    As above, with cos(2 angle - psi) = tan(pi/4 - psi/2).
    """
    psi = _root(lambda psi: psi + math.acos(math.tan(math.pi / 4 - psi / 2)) - 2 * angle)
    contact = math.sin(angle), math.cos(angle)
    lip = contact[0] + math.cos(psi - angle), contact[1] + math.sin(psi - angle)
    return Wedge(contact, lip, (lip[0] + 3.0, lip[1]), psi)


def _root(equation: Callable[[float], float]) -> float:
    return float(brentq(equation, 1e-9, math.pi / 2 - 1e-9))


def limit_pressure(wedge: Wedge, finer: float = 1.0) -> float:
    """Mean pressure under which a wedge flows, over the yield stress.

    Parameters
    ----------
    wedge : Wedge
    finer : float
        By which the size of every element is divided.
    """
    path, yields = _press(wedge, finer, [share * wedge.pressure for share in UP_TO_LIMIT])
    if not isinstance(path.failure, LimitLoadError):
        raise RuntimeError(f"no limit load was found: {path.failure}")
    return float(path.failure.args[0].says.values["force"]) / yields


@dataclass(frozen=True)
class Flow:
    """How the surface of a wedge moves across itself under its limit load, over the speed with which it is pressed.

    Parameters
    ----------
    lip, rest : ndarray, shape (n, 2)
        Of the lip and of the surface that is as it was: way from its beginning over its length, and speed.
    """

    lip: FloatArray
    rest: FloatArray

    @property
    def middle(self) -> float:
        """Speed of the middle of the lip."""
        return float(np.interp(0.5, *self.lip.T))


def flow(wedge: Wedge, finer: float, pressure: float) -> Flow:
    """The flow under a limit pressure over the yield stress that `limit_pressure` has found."""
    path, _ = _press(wedge, finer, [share * pressure for share in AT_LIMIT])
    before, after = path.contacts[-2:]
    fem = after.bodies["seat"].fem
    r, z = fem.nodes[0].T
    # z of the mesh is that from the middle of the contact
    x = np.stack([RADIUS - r, z - z.max()], axis=1) / LENGTH + (0.0, max(0.0, wedge.contact[1]))
    way = after.states["seat"].displacement - before.states["seat"].displacement
    radial, axial = way[node_dofs(fem.mesh)] / (after.approach - before.approach)
    return Flow(
        *(
            _speed(x, np.stack([-radial, axial], axis=1), np.array(start), np.array(end))
            for start, end in ((wedge.contact, wedge.lip), (wedge.lip, wedge.rest))
        )
    )


def _speed(x: FloatArray, speed: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Of the nodes between two corners, see `Flow`."""
    line = end - start
    along, across = (x - start) @ line / (line @ line), (x - start) @ _across(line)
    on = np.flatnonzero((np.abs(across) < 1e-6) & (along > -1e-6) & (along < 1.0 + 1e-6))
    on = on[np.argsort(along[on])]
    return np.stack([along[on], speed[on] @ _across(line)], axis=1)


def _press(wedge: Wedge, finer: float, pressures: list[float]) -> tuple[LoadPath, float]:
    """A wedge under pressures over the yield stress, as far as it bears them, and the force of a pressure of one."""
    # the other body reaches past the contact
    x, z = (1.5 * part for part in wedge.contact)
    other = _outline("closure", [(0.0, 0.0), (0.0, 4.0), (x, 4.0), (x, z)], "outer top inner face")
    deep = min(wedge.rest[1], 0.0) - 3.0
    corners = [(wedge.rest[0], deep), (0.0, deep), (0.0, 0.0), wedge.contact, wedge.lip, wedge.rest]
    geometry = ContactGeometry.of(other, _outline("seat", corners, "bottom wall face inner inner inner"))
    ends = geometry.reach
    sizing = Sizing(LENGTH / 6, LENGTH, ends, 0.4, 0.2, 2 * LENGTH, tuple((end, LENGTH / 24) for end in ends))
    supports = Supports(wall="fixed", base="held", closure_base="held")
    model = condense(
        build_contact(geometry, sizing.refined(finer)), {"closure": RIGID, "seat": METAL}, supports
    )
    # only what points along the axis is a load
    force = 2 * math.pi * RADIUS * LENGTH * wedge.contact[0] * YIELD
    loads = [PathLoad(float(pressure) * force) for pressure in pressures]
    # a hundredth of a step of a hundredth, in balance to far less than that
    settings = PlasticSettings(smallest_step=0.01, tolerance=1e-9)
    return load_path(model, HardContact(), loads, settings=settings, partial=True, unload=False), force


def _outline(name: str, corners: list[Point], names: str) -> Outline:
    points = [(RADIUS - LENGTH * x, LENGTH * z) for x, z in corners]
    ends, boundaries = [*points[1:], points[0]], names.split()
    return Outline(
        name, tuple(Segment(a, b, f"{name}_{n}") for a, b, n in zip(points, ends, boundaries, strict=True))
    )
