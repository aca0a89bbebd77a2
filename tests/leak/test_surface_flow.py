"""Flow over a surface in contact: closed forms, profiles, stated errors, sealed and open places, wrong maps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial import Delaunay

import leak
from leak.flow.rarefied import log_flow_factor

S, DROP = 1e-9, 1e5
ROUGH = leak.RoughContact(
    leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6),
    effective_modulus=115e9,
)


def quads(m: int, k: int, closed: bool) -> np.ndarray:
    """Triangles of a grid of m times k points, around or not."""
    i = np.arange(m * k).reshape(m, k)
    if closed:
        i = np.column_stack([i, i[:, :1]])
    a, b, c, d = (part.ravel() for part in (i[:-1, :-1], i[:-1, 1:], i[1:, :-1], i[1:, 1:]))
    return np.concatenate([np.column_stack([a, b, d]), np.column_stack([a, d, c])])


def ring(m: int, k: int, radius=lambda x: 1.0 + x, height=lambda x: 0.0 * x, shift: float = 0.0):
    """A ring, x from zero at its inner to one at its outer side and the angle of its points."""
    x, phi = (
        values.ravel()
        for values in np.meshgrid(np.linspace(0, 1, m), 2 * np.pi * np.arange(k) / k, indexing="ij")
    )
    r = radius(x)
    points = np.column_stack([r * np.cos(phi) + shift * (1 - x), r * np.sin(phi), height(x)])
    return leak.ContactSurface(points, quads(m, k, True)), x, phi


def strip(m: int, k: int):
    x, y = (
        values.ravel() for values in np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, k), indexing="ij")
    )
    return leak.ContactSurface(np.column_stack([x, y]), quads(m, k, False)), x, y


def cloud(n: int, hole=None):
    """A square of points without order."""
    edge = np.linspace(0, 1, int(np.sqrt(n)))
    sides = [np.column_stack(pair) for pair in ((edge, 0 * edge), (edge, 0 * edge + 1))]
    sides += [side[1:-1, ::-1] for side in sides]
    points = np.concatenate([*sides, 0.01 + 0.98 * np.random.default_rng(0).random((n, 2))])
    triangles = Delaunay(points).simplices
    if hole is not None:
        triangles = triangles[~hole(*points[triangles].mean(axis=1).T)]
    return leak.ContactSurface(points, triangles), *points.T


def across(surface, x, pressure, sigma, **more):
    return leak.surface_flow(surface, pressure, sigma, DROP, high=x == 0, low=x == 1, **more)


def even(pressure):
    return S * np.ones_like(pressure)


def observed_order(errors):
    return np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))


def test_ring_of_even_pressure():
    errors = []
    for m, k in ((20, 120), (40, 240), (80, 480)):
        surface, x, _ = ring(m, k)
        found = leak.surface_flow(surface, 1e6 + 0 * x, even, DROP)
        errors.append(found.leak_rate * np.log(2) / (2 * np.pi * S * DROP) - 1)
        assert abs(errors[-1]) < found.error
        assert found.worst_tenth_share == pytest.approx(0.1, rel=0.05)
    assert abs(errors[-1]) < 2e-5
    assert observed_order(np.array(errors)) == pytest.approx(2, abs=0.1)


def test_eccentric_ring():
    surface, x, _ = ring(70, 280, shift=0.6)
    found = leak.surface_flow(surface, 1e6 + 0 * x, even, DROP)
    assert found.leak_rate == pytest.approx(2 * np.pi * S * DROP / np.arccosh((1 + 4 - 0.36) / 4), rel=2e-4)


def test_cone_is_a_flat_ring_unrolled():
    """The generator runs from s = 1 to s = 2, and the flow is 2 pi sin(slope)/ln 2."""
    slope = 0.6
    surface, x, _ = ring(60, 330, lambda x: (1 + x) * np.sin(slope), lambda x: x * np.cos(slope))
    found = leak.surface_flow(surface, 1e6 + 0 * x, even, DROP, pressure_side="inner")
    assert found.leak_rate == pytest.approx(2 * np.pi * np.sin(slope) / np.log(2) * S * DROP, rel=2e-4)
    inwards = np.vecdot(found.flux, surface.points[surface.triangles].mean(axis=1) * [1, 1, 0])
    assert (inwards > 0).all()


@pytest.mark.parametrize("make", [lambda n: strip(n, n), lambda n: cloud(n * n)])
@pytest.mark.parametrize("decades", [2.6, 8.7])
def test_series_across_and_parallel_along(make, decades):
    """The pressure varies along the flow, or across it: resistances add up, or conductances."""
    sigma = lambda p: S * np.exp(-p)  # noqa: E731
    pressure = lambda z: 0.5 * np.log(10) * decades * (1 + np.sin(2 * np.pi * z))  # noqa: E731
    integrals = [quad(lambda z, sign=sign: sigma(sign * pressure(z)) / S, 0, 1)[0] for sign in (-1, 1)]
    for n, close in ((35, 1), (142, 2e-4)):
        surface, x, y = make(n)
        for along, exact in ((x, 1 / integrals[0]), (y, integrals[1])):
            # pressures well above zero, as ln p is interpolated
            found = across(surface, x, 1 + pressure(along), lambda p: sigma(p - 1))
            assert abs(found.leak_rate / (S * DROP * exact) - 1) < min(found.error, close)


@pytest.mark.parametrize("a", [2.0, 0.5 * np.log(1e30)])
def test_second_order_towards_the_exact_dual_solution(a):
    """sigma -> 1/sigma when the square is turned: its conductance is one (Keller), over thirty decades as well."""
    errors = []
    for n in (36, 71, 141):
        surface, x, y = strip(n, n)
        p = np.exp(a * np.cos(np.pi * x) * np.cos(np.pi * y))
        found = across(surface, x, p, lambda p: S * p, tolerance=10)
        errors.append(found.leak_rate / (S * DROP) - 1)
        assert abs(errors[-1]) < found.error
    assert abs(errors[-1]) < 1e-3
    assert observed_order(np.array(errors)) == pytest.approx(2, abs=0.2)


def test_axisymmetric_profile():
    """The leak integral of the same pressures, on 400 points around."""
    sigma = lambda p: 1e-12 * (1e6 / p) ** 3  # noqa: E731
    profile = lambda x: 50e6 * np.exp(-0.5 * ((x - 0.5) / 0.12) ** 2)  # noqa: E731
    at = np.linspace(0, 1, 1001)
    s = 1e-3 * (at - 0.5)
    exact = leak.leak_flow(s, profile(at), sigma, DROP, 0.014 + s, ends=(s[0], s[-1]))
    for m, close in ((12, 3e-3), (50, 2e-4)):
        surface, x, _ = ring(m, 400, lambda x: 0.014 + 1e-3 * (x - 0.5))
        found = leak.surface_flow(surface, profile(x), sigma, DROP)
        assert abs(found.leak_rate / exact.leak_rate - 1) < min(found.error, close)
        expected = np.interp(x, at, exact.fluid_pressure)
        assert np.abs(found.result.fluid_pressure - expected).max() < 10 * close * DROP


def test_contact_that_ends_at_zero_pressure():
    """Hertz on a ring, open on both sides."""
    sigma = lambda p: 1e-12 * np.log(1e9 / np.maximum(p, 1e-200)) ** 3 * np.exp(-p / 1e7)  # noqa: E731
    hertz = lambda x: 50e6 * np.sqrt(np.maximum(0, 1 - ((x - 0.5) / 0.33) ** 2))  # noqa: E731
    at = np.linspace(0, 1, 4001)
    s = 1e-3 * (at - 0.5)
    exact = leak.leak_flow(s, hertz(at), sigma, DROP, 0.014 + s).leak_rate
    surface, x, _ = ring(51, 400, lambda x: 0.014 + 1e-3 * (x - 0.5))
    found = leak.surface_flow(surface, hertz(x), sigma, DROP)
    assert abs(found.leak_rate / exact - 1) < min(found.error, 1e-3)
    assert found.result.fluid_pressure.min() == 0.0


def test_around_a_narrow_ring():
    """Parallel strips, and what flows round tight places, as finite volumes on a finer grid have it."""
    sigma = lambda p: 1e-12 * np.exp(-p / 2e6)  # noqa: E731
    field = lambda x, phi: 20e6 * np.exp(-(((x - 0.5) / 0.2) ** 2)) * (1 + 0.5 * np.cos(3 * phi))  # noqa: E731
    at, phi = np.linspace(0, 1, 301), 2 * np.pi * np.arange(600) / 600
    s = 1e-3 * (at - 0.5)
    exact = leak.around_flow(s, 0.014 + s, sigma(field(at[:, None], phi)), DROP)
    surface, x, angle = ring(51, 400, lambda x: 0.014 + 1e-3 * (x - 0.5))
    found = leak.surface_flow(surface, field(x, angle), sigma, DROP)
    assert found.leak_rate == pytest.approx(exact.leak_rate, rel=1e-3)
    flows = np.sort(exact.radial_flow)[::-1]
    assert found.worst_tenth_share == pytest.approx(flows[:60].sum() / flows.sum(), rel=0.02)


@pytest.mark.parametrize(
    ("gas", "inlet", "outlet"),
    [("nitrogen", 2e7, 1e7), ("nitrogen", 3e6, 1e5), ("helium", 1e5, 0.0), ("helium", 2e2, 0.0)],
)
def test_gas_from_the_continuum_to_free_molecules(gas, inlet, outlet):
    table = leak.gas_conductivity_table(ROUGH, 1e-2, 1e9)
    profile = lambda x: 50e6 * np.exp(-0.5 * ((x - 0.5) / 0.15) ** 2)  # noqa: E731
    at = np.linspace(0, 1, 501)
    s = 1e-3 * (at - 0.5)
    exact = leak.gas_leak_flow(
        s, profile(at), table, leak.gas(gas), inlet, outlet, 0.014 + s, ends=(s[0], s[-1])
    )
    surface, x, _ = ring(50, 400, lambda x: 0.014 + 1e-3 * (x - 0.5))
    found = leak.gas_surface_flow(surface, profile(x), table, leak.gas(gas), inlet, outlet)
    assert abs(found.result.mass_flow / exact.mass_flow - 1) < min(found.error, 1e-3)
    expected = np.interp(x, at, exact.fluid_pressure)
    assert np.abs(found.result.fluid_pressure - expected).max() < 2e-3 * inlet


@pytest.mark.parametrize("sigma", [lambda p: S * (1e6 / (p + 1e3)) ** 3, lambda p: S * np.exp(-p / 3e6)])
@pytest.mark.parametrize("turn", [0.0, *(pytest.param(turn, marks=pytest.mark.slow) for turn in (0.4, 1.0))])
def test_six_decades_over_three_elements(sigma, turn):
    """In any direction to the flow and the mesh, smooth or with kinks: the error is stated and kept."""
    fields = (
        lambda z: 10 ** (8 - 6 * np.clip((z - 0.4) / 0.3, 0, 1)),
        lambda z: 10 ** (2 + 6 / (1 + np.exp((z - 0.55) / 0.05))),
    )
    for field in fields:
        (coarse, x, y), (fine, x_fine, y_fine) = strip(11, 11), strip(161, 161)
        found = across(coarse, x, field((1 - turn) * x + turn * y), sigma)
        exact = across(fine, x_fine, field((1 - turn) * x_fine + turn * y_fine), sigma)
        assert exact.error < 0.1 * found.error or exact.error < 0.01
        assert abs(exact.leak_rate / found.leak_rate - 1) < found.error + exact.error


def test_sealed_all_around_leaks_nothing():
    surface, x, _ = ring(41, 100)
    found = leak.surface_flow(
        surface, np.where(abs(x - 0.5) < 0.1, 1e7, 1e6), lambda p: np.where(p > 9e6, 0, S), DROP
    )
    assert found.leak_rate == 0.0
    assert np.isnan(found.worst_tenth_share)
    pressure = found.result.fluid_pressure
    assert (pressure[x < 0.3] == 0).all()
    assert (pressure[x > 0.7] == DROP).all()
    assert np.isnan(pressure[np.isclose(x, 0.5)]).all()


@pytest.mark.parametrize(("inside", "sign"), [(1e7, -1), (0.0, 1)])
def test_sealed_and_open_islands(inside, sign):
    """A disc of radius r in a square of one: (1 +- f)/(1 -+ f) but for higher images (Rayleigh), f = pi r^2."""
    surface, x, y = cloud(12000)
    sigma = lambda p: np.where(p > 5e6, 0, S)  # noqa: E731
    found = across(surface, x, np.where(np.hypot(x - 0.5, y - 0.5) < 0.2, inside, 1e6), sigma)
    f = np.pi * 0.2**2
    expected = ((1 + f) / (1 - f)) ** sign
    assert found.leak_rate / (S * DROP) == pytest.approx(expected, rel=0.02)
    hole, x, y = cloud(12000, hole=lambda x, y: np.hypot(x - 0.5, y - 0.5) < 0.2)
    assert len(hole.loops) == 2
    assert across(hole, x, 1e6 + 0 * x, even).leak_rate / (S * DROP) == pytest.approx(
        (1 - f) / (1 + f), rel=0.02
    )


def test_several_parts_of_each_side():
    """From both holes to both ends, which is twice what flows from one to one in half of the square."""
    away = lambda x, y: np.minimum(np.hypot(x - 0.3, y - 0.5), np.hypot(x - 0.7, y - 0.5))  # noqa: E731
    surface, x, _ = cloud(12000, hole=lambda x, y: away(x, y) < 0.1)
    holes = np.unique(np.concatenate(surface.loops[1:]))
    both = leak.surface_flow(
        surface, 1e6 + 0 * x, even, DROP, high=holes, low=(x == 0) | (x == 1), tolerance=5e-3
    )
    right = holes[x[holes] > 0.5]
    assert both.error < 6e-3
    half = surface.triangles[x[surface.triangles].mean(axis=1) > 0.5]
    alone = leak.surface_flow(
        leak.ContactSurface(surface.points, half),
        1e6 + 0 * x,
        even,
        DROP,
        high=right,
        low=x == 1,
        tolerance=5e-3,
    )
    assert both.leak_rate == pytest.approx(2 * alone.leak_rate, rel=5e-3)


def test_pieces_side_by_side_add_up_and_others_do_not_matter():
    surface, x, _ = strip(6, 6)
    n, away = len(x), np.array([0, 2, 0])
    points = np.concatenate(
        [surface.points, surface.points + away, surface.points + 2 * away, [[np.nan] * 3]]
    )
    three = leak.ContactSurface(points, np.concatenate([surface.triangles + i * n for i in range(3)]))
    x = np.append(np.tile(x, 3), 0)
    low = (x == 1) & (np.arange(3 * n + 1) < 2 * n)
    found = leak.surface_flow(three, 1e6 + 0 * x, even, DROP, high=x == 0, low=low)
    assert found.leak_rate == pytest.approx(2 * S * DROP, rel=1e-9)
    assert found.result.fluid_pressure[2 * n : 3 * n] == pytest.approx(DROP)


@pytest.mark.parametrize("long", [True, False])
def test_lay(long):
    """Oblique to a strip that is short, or long: sigma_xx, or 1/(1/sigma)_xx."""
    a, along = np.pi / 6, 9 * S
    surface, x, _ = strip(*((201, 21) if long else (21, 201)))
    points = surface.points * ([1.0, 0.01, 1.0] if long else [0.01, 1.0, 1.0])
    surface = leak.ContactSurface(points, surface.triangles)
    lay = [np.cos(a), np.sin(a), 0.3]
    found = across(surface, x, 1e6 + 0 * x, even, along=lambda p: 9 * even(p), lay=lay)
    flat = np.cos(a) ** 2 * along + np.sin(a) ** 2 * S
    steep = 1 / (np.cos(a) ** 2 / along + np.sin(a) ** 2 / S)
    assert found.leak_rate == pytest.approx((0.01 * steep if long else 100 * flat) * DROP, rel=1e-2)


@pytest.mark.parametrize("degrees", [0, 30, 90])
def test_lay_along_spirals_of_a_ring(degrees):
    """psi depends on r alone, whatever flows around: 2 pi sigma_rr/ln 2."""
    surface, x, _ = ring(40, 240)
    out = surface.points[surface.triangles].mean(axis=1)
    a, around = np.radians(degrees), np.cross([0.0, 0.0, 1.0], out)
    lay = np.cos(a) * out + np.sin(a) * around
    found = leak.surface_flow(surface, 1e6 + 0 * x, even, DROP, along=lambda p: 9 * even(p), lay=lay)
    radial = (9 * np.cos(a) ** 2 + np.sin(a) ** 2) * S
    deviation = found.leak_rate * np.log(2) / (2 * np.pi * radial * DROP) - 1
    assert abs(deviation) < min(found.error, 2e-3)
    # sigma_rt flows around where sigma_rr comes in
    flows = [np.vecdot(found.flux, way) @ (surface.areas / np.vecdot(out, out)) for way in (out, around)]
    assert flows[1] == pytest.approx(
        flows[0] * 8 * np.cos(a) * np.sin(a) * S / radial, abs=5e-3 * abs(flows[0])
    )


def test_gap_where_nothing_touches():
    surface, x, _ = strip(81, 41)
    found = across(surface, x, 0 * x, even, gap=1e-5 * (1 + x), viscosity=1e-3)
    assert found.leak_rate == pytest.approx(DROP / (12e-3 * (1 - 1 / 4) / 2 / 1e-15), rel=1e-4)
    helium = leak.gas("helium")
    gas = leak.gas_surface_flow(
        surface, 0 * x, ROUGH, helium, 1e5, 0, gap=1e-6 + 0 * x, high=x == 0, low=x == 1
    )
    knudsen = lambda p: np.log(p * 1e-6 / (helium.viscosity * helium.molecular_speed))  # noqa: E731
    carried = quad(lambda p: p * np.exp(log_flow_factor(knudsen(p))), 1e-3, 1e5, limit=500)[0]
    assert gas.result.throughput == pytest.approx(1e-18 / (12 * helium.viscosity) * carried, rel=1e-3)


def test_a_gap_of_nothing_beside_the_contact_seals_nothing():
    surface, x, _ = strip(41, 41)
    p = np.where(abs(x - 0.5) < 0.3, 1e7, 0)
    gap = np.where(p > 0, np.nan, 0.0)
    found = across(surface, x, p, lambda p: S * 1e6 / p, gap=gap, viscosity=1e-3)
    # all of it at 1e7 Pa, but for the edge between both
    assert found.leak_rate == pytest.approx(0.1 * S * DROP, rel=0.05)
    assert found.error < 0.1


def test_pieces_that_touch_at_a_point():
    surface, x, _ = strip(5, 5)
    middle = surface.points[surface.triangles].mean(axis=1)
    blocks = ((middle[:, 0] < 0.5) & (middle[:, 1] < 0.5)) | ((middle[:, 0] > 0.5) & (middle[:, 1] > 0.5))
    two = leak.ContactSurface(surface.points, surface.triangles[blocks])
    with pytest.raises(leak.ProfileError, match="touch at points only"):
        across(two, x, 1e6 + 0 * x, even)


def test_numbering_direction_and_size_do_not_matter():
    surface, x, phi = ring(12, 40)
    p = 1e6 * (2 + np.cos(phi) + x)
    sigma = lambda p: S * np.exp(-p / 1e5)  # noqa: E731
    expected = leak.surface_flow(surface, p, sigma, DROP)
    rng = np.random.default_rng(1)
    order = rng.permutation(len(p))
    triangles = np.argsort(order)[surface.triangles]
    flip = rng.random(len(triangles)) < 0.5
    triangles[flip] = triangles[flip, ::-1]
    other = leak.ContactSurface(1e-3 * surface.points[order], triangles[rng.permutation(len(triangles))])
    found = leak.surface_flow(other, p[order], sigma, DROP)
    assert found.leak_rate == pytest.approx(expected.leak_rate, rel=1e-6)
    assert found.error == pytest.approx(expected.error, rel=1e-3)
    assert found.result.fluid_pressure[np.argsort(order)] == pytest.approx(
        expected.result.fluid_pressure, abs=1e-3 * DROP
    )


def test_what_flows_through_the_triangles_is_the_leak_rate():
    """Of a divergence-free flow along x the mean over the strip."""
    surface, x, y = strip(41, 41)
    p = 1e6 * (2 + np.sin(7 * x + 3 * y))
    found = across(surface, x, p, lambda p: S * np.exp(-p / 1e6))
    assert found.flux[:, 0] @ surface.areas == pytest.approx(found.leak_rate, rel=1e-3)


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("points", "triangles", "words"),
    [
        ([[0, 0], [1, 1], [2, 2]], [[0, 1, 2]], "all lie on a line"),
        (SQUARE, [[0, 1, 2], [0, 0, 3]], "has no area"),
        ([*SQUARE[:3], [0, np.nan, 0]], [[0, 1, 2], [0, 2, 3]], r"points\[3\]"),
        (SQUARE, [[0, 1, 4]], "from 0 to 3"),
        (SQUARE, [[0, 1]], "must be \\(t, 3\\)"),
        ([0, 1], [[0, 1, 2]], "must be \\(n, 3\\)"),
        ([*SQUARE, [0, 0, 1]], [[0, 2, 1], [0, 2, 3], [0, 2, 4]], "3 share the edge between points 0 and 2"),
        ([*SQUARE, *SQUARE[::2]], [[0, 1, 2], [4, 5, 3]], "such a crack"),
    ],
)
def test_surfaces_that_are_none(points, triangles, words):
    with pytest.raises(leak.ProfileError, match=words):
        leak.ContactSurface(points, triangles)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"high": None, "low": None}, "has 1 closed line"),
        ({"low": None}, "low: no two of its points are neighbours"),
        ({"low": [1, 2]}, "point 2 belongs to high and to low"),
        ({"high": [7]}, "high: must be numbers of points"),
        ({"pressure": [1e6, -1, 1e6, 1e6]}, r"pressure\[1\] = -1.0"),
        ({"pressure": [1e6, np.nan, 1e6, 1e6]}, r"pressure\[1\] = nan"),
        ({"pressure": [1e6]}, "must be \\(4,\\)"),
        ({"gap": [1e-6] * 4}, "viscosity = None"),
        ({"lay": [1, 0, 0]}, "along and lay belong together"),
        ({"lay": [0, 0, 1], "along": even}, "straight across"),
        ({"tolerance": 0}, "tolerance = 0"),
    ],
)
def test_maps_that_are_wrong(change, words):
    square = leak.ContactSurface(SQUARE, [[0, 1, 2], [0, 2, 3]])
    given = {"pressure": [1e6] * 4, "high": [2, 3], "low": [0, 1]} | change
    with pytest.raises(leak.ProfileError, match=words):
        leak.surface_flow(square, given.pop("pressure"), even, DROP, **given)


def test_a_way_without_contact():
    surface, x, y = strip(9, 9)
    with pytest.raises(leak.ConductivityError, match="a way without contact"):
        across(surface, x, np.where(abs(y - 0.5) < 0.2, 0, 1e6), even)
    with pytest.raises(leak.ProfileError, match="no piece"):
        lone = leak.ContactSurface(
            surface.points, surface.triangles[abs(x[surface.triangles].mean(axis=1) - 0.5) > 0.2]
        )
        across(lone, x, 1e6 + 0 * x, even)
