"""Sections of the verification page: contacts of other shapes, sizes and materials, and fluid on the bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from verification_page import Figure, PageSection

import leak
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import BodyLoads, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import MeshFit, element_sizes
from fem_seal.contact.solution import ContactSolution
from fem_seal.materials import Material, effective_modulus
from meshes import (
    Ball,
    ConicalSeat,
    ContactGeometry,
    FlatSeat,
    Shape,
    SharpEdge,
    Sizing,
    SphericalSeat,
    SphericalTip,
    ToroidalEdge,
    ToroidalSeat,
    build_contact,
)

_MM, _DEG = 1e-3, math.pi / 180
_STEEL = Material("steel", 210e9, 0.3)
_SOFT = Material("soft", 70e9, 0.42)
# Half-width of Hertz over the smaller of touch radius and relative radius: a line contact of half-spaces to some 1e-4.
_NARROW = 1 / 300


@dataclass(frozen=True)
class _Pair:
    name: str
    closure: Shape
    seat: Shape
    materials: tuple[Material, Material]


def _row(pair: _Pair) -> tuple[tuple[str, ...], list[Figure]]:
    """Smooth and rough contact of a pair against Hertz and the exact crossover."""
    contact = ContactGeometry.of(pair.closure.outline, pair.seat.outline)
    modulus, R = effective_modulus(*pair.materials), contact.relative_radius
    f = math.pi * modulus * (_NARROW * min(R, contact.initial_contact_radius)) ** 2 / (4 * R)
    hertz = leak.hertz_line(f, R, modulus)
    # a decay length at which roughness and elasticity have the same influence
    u0 = hertz.half_width**2 / (4 * R)
    exact = leak.crossover_line(f, R, modulus, u0)
    smooth = _solve_contact(pair, contact, HardContact(), f).profile
    rough = _solve_contact(pair, contact, leak.ExponentialLaw(p_c=1e9, u0=u0), f)
    errors = {
        "smooth p0": smooth.peak_pressure / hertz.peak_pressure - 1,
        "p0": rough.profile.peak_pressure / exact.peak_pressure - 1,
        "FWHM": rough.profile.fwhm / exact.fwhm - 1,
        "std": rough.profile.std / exact.std - 1,
    }
    row = (
        pair.name,
        f"{contact.initial_contact_radius / _MM:.3f}",
        f"{contact.angle / _DEG:.1f}",
        f"{R / _MM:.4g}",
        *(f"{error:+.1e}" for error in errors.values()),
        f"{rough.force_error:+.0e}",
    )
    figures = [
        Figure(f"{name}, {pair.name}", error, 2e-3 if name == "smooth p0" else 5e-4)
        for name, error in errors.items()
    ]
    return row, figures


def _solve_contact(pair: _Pair, contact: ContactGeometry, law: Law, line_load: float) -> ContactSolution:
    force = line_load * 2 * math.pi * contact.initial_contact_radius * math.cos(contact.angle)
    materials = dict(zip(("closure", "seat"), pair.materials, strict=True))

    def solve_on(sizing: Sizing) -> list[ContactSolution]:
        return [solve(condense(build_contact(contact, sizing), materials), law, contact_force=force)]

    sizing = element_sizes(law, [line_load], contact, effective_modulus(*pair.materials))
    fit = MeshFit.begin(sizing, contact)
    while fit.sizing is not None:
        fit = fit.with_outcome(solve_on(fit.sizing))
    return fit.solutions[0]


_HEAD = ("pair", "r0 [mm]", "angle", "R_rel [mm]", "Hertz p0", "p0", "FWHM", "std", "force")


def _section(title: str, text: str, pairs: list[_Pair]) -> PageSection:
    rows, figures = zip(*(_row(pair) for pair in pairs), strict=True)
    return PageSection(title, text, _HEAD, rows, tuple(figure for part in figures for figure in part))


def sizes_section() -> PageSection:
    """Ball on cone of every size, angle and pair of materials."""
    pairs = [
        _Pair(
            f"R {R} mm, {angle} deg",
            Ball(R * _MM),
            ConicalSeat.around(angle * _DEG, Ball(R * _MM)),
            materials,
        )
        for R, materials in ((5, (_STEEL, _SOFT)), (20, (_SOFT, _STEEL)), (50, (_STEEL, _SOFT)))
        for angle in (20, 45, 70)
    ]
    return _section(
        "Contact: sizes, angles and dissimilar materials",
        "Balls on cones, one body of steel, the other with E = 70 GPa and nu = 0.42; loads at which the half-width of "
        "Hertz is 1/300 of the smaller of r0 and R. First error: smooth bodies against Hertz (goal 2e-3); the others: "
        "an exponential law as soft as the bodies against the exact crossover (goal 5e-4).",
        pairs,
    )


def pairs_section() -> PageSection:
    """Other shapes."""
    ball, rim, tip = Ball(20 * _MM), ToroidalEdge.of(15 * _MM, 3 * _MM), SphericalTip.of(30 * _MM, 20 * _MM)
    pairs = [
        _Pair(
            "hollow ball in cone",
            Ball(20 * _MM, 10 * _MM),
            ConicalSeat.around(45 * _DEG, ball),
            (_STEEL, _STEEL),
        ),
        _Pair(
            "ball in lapped sphere, R_seat 24 mm",
            ball,
            SphericalSeat.around(24 * _MM, ball, contact_angle=45 * _DEG),
            (_STEEL, _STEEL),
        ),
        _Pair("ball on ring of 4 mm", ball, ToroidalSeat.around(14 * _MM, 4 * _MM, ball), (_STEEL, _SOFT)),
        _Pair(
            "ball on edge, fillet 1 mm",
            ball,
            SharpEdge.around(14 * _MM, ball, edge_radius=_MM),
            (_STEEL, _STEEL),
        ),
        _Pair("rim of 3 mm on flat", rim, FlatSeat.on(rim), (_STEEL, _STEEL)),
        _Pair("rim of 3 mm in cone", rim, ConicalSeat.around(30 * _DEG, rim), (_STEEL, _SOFT)),
        _Pair("spherical tip in cone", tip, ConicalSeat.around(30 * _DEG, tip), (_STEEL, _STEEL)),
    ]
    return _section(
        "Contact: other shapes",
        "The same for other closures and seats, which differ by their relative radius. Conforming faces, which have "
        "none, are compared with the closed form of a rounded punch and with an independent program in the tests.",
        pairs,
    )


def hydrostatic_section() -> PageSection:
    """Fluid on all surfaces and in the gap: it strains both bodies evenly, without a lifting force."""
    ball = Ball(20 * _MM)
    contact = ContactGeometry.of(ball.outline, ConicalSeat.around(45 * _DEG, ball).outline)
    law, pressure, force = leak.ExponentialLaw(p_c=5e9, u0=0.76e-6), 2e7, 1000.0
    line_load = force / (2 * math.pi * contact.initial_contact_radius * math.cos(contact.angle))
    sizing = element_sizes(law, [line_load], contact, effective_modulus(_STEEL, _STEEL))
    model = condense(build_contact(contact, sizing), {"closure": _STEEL, "seat": _STEEL})
    all_around = BodyLoads.of_fluid((pressure, pressure), np.full(len(model.line.x), pressure), 0.0)
    lift = all_around.lift(model) / (math.pi * contact.initial_contact_radius**2 * pressure)
    radii, rows, figures = np.array([-1.0, 0.0, 1.0]) * 2e-4, [], []
    for x in radii:
        share = np.where(model.line.x >= x, pressure, 0.0)
        loads = BodyLoads.of_fluid((0.0, pressure), share, 0.0)
        radius = math.sqrt(-loads.lift(model) / (math.pi * pressure))
        # The place of a step in the pressure is known to the distance of two points of the line.
        smallest = np.abs(model.line.radius - contact.radius(np.array(x))).min()
        error = radius / float(contact.radius(np.array(x))) - 1
        rows.append((f"fluid outside x = {x * 1e3:+.1f} mm", f"{radius / _MM:.4f}", f"{error:+.1e}"))
        figures.append(
            Figure(f"effective radius at x = {x * 1e3:+.1f} mm", error, float(smallest / radius) + 2e-4)
        )
    rows.append(("fluid all around", "lifts nothing", f"{lift:+.0e} of the fluid's force"))
    figures.append(Figure("lift of fluid all around", lift, 1e-9))
    return PageSection(
        "Fluid on the bodies: force and effective radius",
        "The axial force of a fluid outside a circle on the contact line is pi r^2 p, whatever the "
        "shape of the closure (divergence theorem); fluid all around gives no lift. Ball of 20 mm, 45 deg.",
        ("fluid", "effective radius [mm]", "difference"),
        tuple(rows),
        tuple(figures),
    )
