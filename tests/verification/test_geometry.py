"""Contacts of all families against closed solutions, and of fitting faces against an independent program.

The closed solutions are those of half-planes; a contact that is narrow against every radius differs from them by some
1e-3, growing in proportion to its width. Tolerances are that.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from independent_contact import Sector, press
from numpy.typing import NDArray

from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.newton import solve
from fem_seal.contact.sizing import MeshFit, element_sizes
from fem_seal.contact.solution import ContactSolution
from fem_seal.loads import line_load
from fem_seal.materials import Material, effective_modulus
from fem_seal.profile import PressureProfile
from leak import ExponentialLaw, crossover_line, hertz_line
from meshes import (
    Ball,
    ConicalLand,
    ConicalSeat,
    ContactGeometry,
    Disc,
    FlatSeat,
    Profile,
    RoundedCone,
    Segment,
    Shape,
    SharpEdge,
    Sizing,
    SphericalSeat,
    ToroidalEdge,
    ToroidalSeat,
    build_contact,
)

FloatArray = NDArray[np.float64]

MM, DEG = 1e-3, math.pi / 180
STEEL = Material("steel", youngs_modulus=210e9, poissons_ratio=0.3)
SOFT = Material("soft", youngs_modulus=70e9, poissons_ratio=0.42)


def pressed(
    closure: Shape,
    seat: Shape,
    law: Law,
    line_load: float,
    materials: tuple[Material, Material] = (STEEL, STEEL),
    refine: float = 1.0,
) -> ContactSolution:
    """Contact under a line load [N/m], on the mesh that the program chooses or with elements smaller by a factor."""
    contact = ContactGeometry.of(closure.outline, seat.outline)
    modulus = effective_modulus(*materials)
    force = line_load * 2 * math.pi * contact.initial_contact_radius * math.cos(contact.angle)

    def solve_on(sizing: Sizing) -> list[ContactSolution]:
        model: ContactModel = condense(
            build_contact(contact, sizing), dict(zip(("closure", "seat"), materials, strict=True))
        )
        return [solve(model, law, contact_force=force)]

    sizing = element_sizes(law, [line_load], contact, modulus).refined(refine)
    fit = MeshFit.begin(sizing, contact)
    while fit.sizing is not None:
        fit = fit.with_outcome(solve_on(fit.sizing))
    return fit.solutions[0]


def narrow_load(contact: ContactGeometry, modulus: float, share: float = 1 / 300) -> float:
    """Line load [N/m] whose half-width of Hertz is a share of the smaller of r0 and R_rel."""
    R = contact.relative_radius
    return math.pi * modulus * (share * min(R, contact.initial_contact_radius)) ** 2 / (4 * R)


PAIRS = {
    "R 5 mm, 20 deg": (Ball(5 * MM), ConicalSeat.around(20 * DEG, Ball(5 * MM)), (STEEL, SOFT)),
    "R 50 mm, 70 deg": (Ball(50 * MM), ConicalSeat.around(70 * DEG, Ball(50 * MM)), (SOFT, STEEL)),
    "ball in sphere": (
        Ball(20 * MM),
        SphericalSeat.around(24 * MM, Ball(20 * MM), contact_angle=45 * DEG),
        (STEEL, STEEL),
    ),
    "ball on ring": (Ball(20 * MM), ToroidalSeat.around(14 * MM, 4 * MM, Ball(20 * MM)), (STEEL, SOFT)),
    "torus on flat": (
        ToroidalEdge.of(15 * MM, 3 * MM),
        FlatSeat.on(ToroidalEdge.of(15 * MM, 3 * MM)),
        (STEEL, STEEL),
    ),
}


@pytest.mark.parametrize("name", PAIRS)
def test_narrow_contacts_meet_hertz_and_the_exact_crossover(name: str) -> None:
    closure, seat, materials = PAIRS[name]
    contact = ContactGeometry.of(closure.outline, seat.outline)
    modulus = effective_modulus(*materials)
    f = narrow_load(contact, modulus)
    hertz = hertz_line(f, contact.relative_radius, modulus)
    smooth = pressed(closure, seat, HardContact(), f, materials).profile
    assert smooth.peak_pressure == pytest.approx(hertz.peak_pressure, rel=2e-3)
    assert smooth.std == pytest.approx(hertz.std, rel=2e-3)
    # a decay length at which roughness and elasticity matter alike
    u0 = hertz.half_width**2 / (4 * contact.relative_radius)
    rough = pressed(closure, seat, ExponentialLaw(p_c=1e9, u0=u0), f, materials).profile
    exact = crossover_line(f, contact.relative_radius, modulus, u0)
    assert rough.peak_pressure == pytest.approx(exact.peak_pressure, rel=1e-3)
    assert rough.std == pytest.approx(exact.std, rel=1e-3)


def rounded_punch(half_width: float, edge_radius: float, radius: float) -> Profile:
    """A plunger whose lower end is a flat ring with rounded edges of so large a radius that it stays a half-plane."""
    b, rho = half_width, edge_radius
    turn = 12 * DEG
    out, up = rho * math.sin(turn), rho * (1 - math.cos(turn))
    inner, outer = radius - b, radius + b
    top = 1.2 * radius
    return Profile(
        "closure",
        (
            Segment((0.0, up), (inner - out, up), ""),
            Segment((inner - out, up), (inner, 0.0), "", (inner, rho)),
            Segment((inner, 0.0), (outer, 0.0), ""),
            Segment((outer, 0.0), (outer + out, up), "", (outer, rho)),
            Segment((outer + out, up), (outer + out, top), ""),
            Segment((outer + out, top), (0.0, top), ""),
            Segment((0.0, top), (0.0, up), ""),
        ),
    )


@pytest.mark.slow
def test_flat_rounded_punch_meets_the_closed_form() -> None:
    """Ciavarella, Hills, Monno, Proc. IMechE C 212 (1998) 319: flat half-width b, edge radius R, contact half-width a.

    With sin(phi0) = b/a:  4 P R/(E* b^2) = (pi - 2 phi0)/sin^2(phi0) - 2 cot(phi0), and the pressure at x = a sin(phi)
    is (P/a) (2/pi)/(pi - 2 phi0 - sin(2 phi0)) times
    (pi - 2 phi0) cos(phi) + sin(phi) ln|sin(phi + phi0)/sin(phi - phi0)|
    + sin(phi0) ln|tan((phi + phi0)/2) tan((phi - phi0)/2)|.
    """
    b, rho, radius = 0.1 * MM, 4 * MM, 60 * MM
    phi0 = 50 * DEG
    modulus = effective_modulus(STEEL, STEEL)
    load = modulus * b**2 / (4 * rho) * ((math.pi - 2 * phi0) / math.sin(phi0) ** 2 - 2 / math.tan(phi0))
    a = b / math.sin(phi0)

    def closed(x: FloatArray) -> FloatArray:
        phi = np.arcsin(np.clip(x / a, -1, 1))
        terms = (
            (math.pi - 2 * phi0) * np.cos(phi)
            + np.sin(phi) * np.log(np.abs(np.sin(phi + phi0) / np.sin(phi - phi0)))
            + math.sin(phi0) * np.log(np.abs(np.tan((phi + phi0) / 2) * np.tan((phi - phi0) / 2)))
        )
        return 2 * load / (math.pi * a * (math.pi - 2 * phi0 - math.sin(2 * phi0))) * terms

    x = np.linspace(-a, a, 20002)
    middle = 0.5 * (x[1:] + x[:-1])
    # the formula as it stands here carries the load
    assert float(closed(middle).sum() * (x[1] - x[0])) == pytest.approx(load, rel=1e-3)

    punch = rounded_punch(b, rho, radius)
    for refine in (1.0, 2.0):
        profile = pressed(
            punch, FlatSeat.on(punch, bore_radius=0.5 * radius), HardContact(), load, refine=refine
        ).profile
        x = profile.x[np.abs(profile.x) < 0.95 * a]
        # Bending tilts the ring by a little more than its bodies' width over its radius: mean of both sides. One end
        # stands 1.1 % farther out, the other farther in, of which the mean keeps the square: 0.9 % of the pressure at
        # 0.95 a, on elements of any size.
        mean = 0.5 * sum(np.interp(side * x, profile.x, profile.pressure) for side in (1, -1))
        off = np.abs(mean / closed(x) - 1)
        # The slope of the closed form is infinite at x = b, where the pressure of the elements is piecewise linear:
        # only smaller ones come as close there.
        assert off[np.abs(np.abs(x) - b) > 0.03 * b].max() < 1e-2
        assert off.max() < (1.5e-2 if refine == 1 else 1e-2)
        assert np.sqrt(np.mean(off**2)) < 4e-3
        assert float(mean.max()) == pytest.approx(float(closed(middle).max()), rel=5e-3)
    ends = profile.x[profile.pressure > 0][[0, -1]]
    assert ends[1] - ends[0] == pytest.approx(2 * a, rel=1e-2)


def shell_seat(seat: SphericalSeat, low: float, high: float, thickness: float) -> Profile:
    """The hollow face between two angles, on a shell of even thickness that is held along its outside."""
    R, c = seat.radius, (seat.centre_offset, 0.0)

    def at(radius: float, angle: float) -> tuple[float, float]:
        return c[0] + radius * math.sin(angle), -radius * math.cos(angle)

    return Profile(
        "seat",
        (
            Segment(at(R, low), at(R, high), "face", c),
            Segment(at(R, high), at(R + thickness, high), "wall"),
            Segment(at(R + thickness, high), at(R + thickness, low), "bottom", c),
            Segment(at(R + thickness, low), at(R, low), "inner"),
        ),
    )


@pytest.mark.slow
def test_nearly_fitting_sphere_meets_an_independent_program() -> None:
    """Radii that differ by 0.1 %: the contact is as wide as the seat, and no closed form holds.

    The other program (tests/support/independent_contact.py) knows its own elements (nine-node quadrilaterals on polar
    grids), integrates the law over the face, and minimises the energy of both whole bodies.
    """
    ball = Ball(20 * MM, 10 * MM)
    lapped = SphericalSeat.around(20.02 * MM, ball, contact_angle=45 * DEG)
    seat = shell_seat(lapped, 22 * DEG, 68 * DEG, 15 * MM)
    law, f = ExponentialLaw(p_c=1e9, u0=1e-6), 4e4
    solution = pressed(ball, seat, law, f)
    profile = solution.profile

    closure = Sector((0.0, 0.0), (10 * MM, 20 * MM), (0.0, math.pi))
    below = Sector((lapped.centre_offset, 0.0), (20.02 * MM, 35.02 * MM), (22 * DEG, 68 * DEG))
    x, pressure = press(
        closure, below, STEEL.youngs_modulus, 0.3, law.p_c, law.u0, solution.contact_force, 45 * DEG
    )
    crossover = crossover_line(f, 20 * 20.02 / 0.02 * MM, effective_modulus(STEEL, STEEL), law.u0)
    # far from what half-planes would do
    assert abs(profile.peak_pressure / crossover.peak_pressure - 1) > 0.2
    ours = np.interp(x, profile.x, profile.pressure)
    # The seat ends with sharp corners, where both programs still change with their elements.
    away = np.abs(x) < 0.97 * profile.x[-1]
    assert ours[away] == pytest.approx(pressure[away], abs=1e-3 * pressure.max())
    assert ours[~away] == pytest.approx(pressure[~away], abs=1e-2 * pressure.max())


# ---------------------------------------------------------------- faces that bend within the thickness of the layer

# Two programs that had no part in this one: two-body finite elements with the contact along the closure's normal, and
# CalculiX. They differ from each other by 0.3 %.
POPPET = RoundedCone.of(45 * DEG, mean_radius=12 * MM, outer_radius=14 * MM)
NARROW_LAND = {"land_width": 0.6 * MM, "land_radius": 12 * MM, "edge_radius": 30e-6}


def poppet_on_land(law: Law, fluid_pressures: list[float]) -> list[PressureProfile]:
    land = ConicalLand.around(45 * DEG, POPPET, **NARROW_LAND)
    loads = [0.5 * 12 * MM * p / math.cos(45 * DEG) for p in fluid_pressures]
    return [pressed(POPPET, land, law, f).profile for f in loads]


@pytest.mark.parametrize("p_c", [50e6, 5e9, 1e12])
def test_poppet_on_a_land_meets_two_other_programs_whatever_p_c_is(p_c: float) -> None:
    light, heavy = poppet_on_land(ExponentialLaw(p_c=p_c, u0=0.5e-6), [20e5, 100e5])
    assert light.peak_pressure == pytest.approx(31.55e6, rel=3e-3)
    assert heavy.peak_pressure == pytest.approx(203.8e6, rel=3e-3)


def edges_and_rings() -> Iterator[tuple[str, Shape, Shape]]:
    """Pairs with a small radius somewhere."""
    small, large = Ball(6 * MM), Ball(20 * MM)
    cone = RoundedCone.of(30 * DEG, mean_radius=5 * MM, outer_radius=7 * MM)
    disc, rim = Disc.of(20 * MM), ToroidalEdge.of(6 * MM, 0.2 * MM)
    yield "ball on edge", small, SharpEdge.around(4 * MM, small, edge_radius=0.1 * MM)
    yield "cone on edge", cone, SharpEdge.around(5 * MM, cone, edge_radius=0.3 * MM)
    yield "ball on ring", large, ToroidalSeat.around(14 * MM, 0.3 * MM, large)
    yield "disc on ring", disc, ToroidalSeat.around(14 * MM, 0.3 * MM, disc)
    yield (
        "ball on land",
        large,
        ConicalLand.around(45 * DEG, large, land_width=0.2 * MM, edge_radius=0.1 * MM),
    )
    yield "rim on cone", rim, ConicalSeat.around(45 * DEG, rim)
    yield "rim on ring", rim, ToroidalSeat.around(6.2 * MM, 0.2 * MM, rim)


@pytest.mark.parametrize(
    ("closure", "seat"), [pytest.param(*pair, id=name) for name, *pair in edges_and_rings()]
)
@pytest.mark.parametrize("fluid_pressure", [2e5, 100e5])
def test_p_c_only_shifts_the_approach_on_every_curved_face(
    closure: Shape, seat: Shape, fluid_pressure: float
) -> None:
    """p_c from 50 MPa to 1000 GPa moves the surfaces 5 um apart, and does nothing else (theory_geometry.md)."""
    contact = ContactGeometry.of(closure.outline, seat.outline)
    f = line_load(
        math.pi * contact.initial_contact_radius**2 * fluid_pressure,
        contact.initial_contact_radius,
        contact.angle,
    )
    found = [pressed(closure, seat, ExponentialLaw(p_c=p_c, u0=0.5e-6), f).profile for p_c in (50e6, 1e12)]
    for size in ("peak_pressure", "fwhm", "std"):
        assert getattr(found[0], size) == pytest.approx(getattr(found[1], size), rel=1e-5)


def half_planes(gap: FloatArray, t: FloatArray, f: float, modulus: float, law: ExponentialLaw) -> FloatArray:
    """Pressure of half-planes with any gap over even points t: boundary elements of constant pressure, Newton."""
    h = t[1] - t[0]
    between = np.subtract.outer(t, t)
    # opening under an even pressure on a strip: -(2/(pi E*)) int ln|t - t'| dt'
    near, far = between - h / 2, between + h / 2
    C = -(2 / (math.pi * modulus)) * (far * np.log(np.abs(far)) - near * np.log(np.abs(near)) - h)
    v, d = -gap / law.u0, 0.0
    v += math.log(f / (h * np.exp(v).sum()))
    for _ in range(100):
        p = np.exp(v)
        residual = np.append(gap - d + C @ p + law.u0 * (v - math.log(law.p_c)), h * p.sum() - f)
        jacobian = np.block(
            [[C * p + law.u0 * np.eye(len(t)), -np.ones((len(t), 1))], [h * p[None], np.zeros((1, 1))]]
        )
        step = np.linalg.solve(jacobian, -residual)
        v, d = v + np.clip(step[:-1], -1, 1), d + step[-1]
        if np.abs(step[:-1]).max() < 1e-11:
            return np.exp(v)
    raise AssertionError("no convergence")


@pytest.mark.parametrize("c", [0.02, 0.1])
def test_edge_under_a_straight_face_feels_the_exact_distance_to_it(c: float) -> None:
    """The distance to the cone is rho - sqrt(rho^2 - t^2), no parabola: 0.7 % in peak and width at u0/rho = 0.02.

    c = f/(pi E* u0) is small, so that an edge is as stiff as a half-plane; what it is not changes the peak by less than
    1e-3, which is the tolerance. With the distance along the seat's own normal the peak is off by 3 % and more.
    """
    rho, u0 = 0.1 * MM, 2e-6
    cone = RoundedCone.of(45 * DEG, mean_radius=5 * MM, outer_radius=7 * MM)
    seat = SharpEdge.around(5 * MM, cone, edge_radius=rho)
    law, modulus = ExponentialLaw(p_c=5e9, u0=u0), effective_modulus(STEEL, STEEL)
    f = c * math.pi * modulus * u0
    profile = pressed(cone, seat, law, f).profile
    t = np.linspace(-0.7 * rho, 0.7 * rho, 1401)
    exact = half_planes(rho - np.sqrt(rho**2 - t**2), t, f, modulus, law)
    assert profile.peak_pressure == pytest.approx(exact.max(), rel=1e-3)
    across = rho * np.sin(profile.x / rho)
    assert np.interp(across, t, exact) == pytest.approx(profile.pressure, abs=2e-3 * exact.max())
    parabola = crossover_line(f, rho, modulus, u0).peak_pressure
    assert abs(profile.peak_pressure / parabola - 1) > 4e-3


def test_rim_in_a_hollow_fillet_feels_the_distance_of_the_lifted_closure() -> None:
    """The layer lifts the closure by u/cos(theta), and closest approach slides by u tan(theta) R_s/(R_s - rho) = 10 um.

    Half-planes at the distance of two circles along the radii of the larger one; at first touch, which the slope alone
    would give, the width is 1.8 % smaller.
    """
    rho, R_s, u0, p_c = 0.15 * MM, 0.3 * MM, 0.5e-6, 1e12
    centre = 5 * MM
    apart = (R_s - rho) * math.sqrt(0.5)
    rim = ToroidalEdge.of(centre, rho)
    # hollow about a circle that lies inwards of and above the rim's, so that they touch at 45 degrees
    about = (centre - apart, apart)
    ends = [(about[0] + R_s * math.sin(a), about[1] - R_s * math.cos(a)) for a in (25 * DEG, 65 * DEG)]
    top, bottom, wall, bore = ends[1][1], -5 * MM, 12 * MM, ends[0][0]
    seat = Profile(
        "seat",
        (
            Segment((bore, bottom), (wall, bottom), "bottom"),
            Segment((wall, bottom), (wall, top), "wall"),
            Segment((wall, top), ends[1], "outer"),
            Segment(ends[1], ends[0], "face", about),
            Segment(ends[0], (bore, bottom), "inner"),
        ),
    )
    law, modulus = ExponentialLaw(p_c=p_c, u0=u0), effective_modulus(STEEL, STEEL)
    f = 0.02 * math.pi * modulus * u0
    profile = pressed(rim, seat, law, f).profile
    phi = np.linspace(-0.3, 0.3, 1201)
    lift = math.sqrt(2) * u0 * math.log(p_c / profile.peak_pressure)
    # centre of the rim, lifted, from that of the fillet; phi is counted from the 45 degree line
    along, across = (R_s - rho) + lift * (-math.sqrt(0.5)), lift * math.sqrt(0.5)
    gap = (
        R_s
        - along * np.cos(phi)
        - across * np.sin(phi)
        - np.sqrt(rho**2 - (along * np.sin(phi) - across * np.cos(phi)) ** 2)
    )
    # the force is axial, and the contact stands steeper where it has slid to
    carried = float(profile.arc_weight @ profile.pressure)
    assert carried / f - 1 == pytest.approx(lift * math.sqrt(0.5) / (R_s - rho), rel=0.1)
    exact = half_planes(gap - gap.min(), R_s * phi, carried, modulus, law)
    half = R_s * phi[exact > 0.5 * exact.max()]
    assert profile.fwhm == pytest.approx(half[-1] - half[0], rel=5e-3)
    assert profile.peak_pressure == pytest.approx(exact.max(), rel=2e-3)
