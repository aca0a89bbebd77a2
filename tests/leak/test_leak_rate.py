"""The leak integral: closed forms, convergence with the number of points, reference leak rates, wrong input."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import HARDNESS, E, surface
from scipy.special import beta

import leak
from leak.flow.contact_profile import law_bends

LENGTH = 2 * np.pi * 0.0141421


def gauss(n: int, reach: float = 3.5, p0: float = 50e6, s: float = 0.139e-3):
    x = np.linspace(-reach, reach, n) * s
    return x, p0 * np.exp(-0.5 * (x / s) ** 2)


def power_law(B: float, m: float):
    return lambda p: B * p**-m


@pytest.mark.parametrize("m", [0.5, 1.0, 3.0])
def test_power_law_on_a_gaussian(m):
    """Q = Delta P L B p0^-m / (s sqrt(2 pi/m)), all of the tails included."""
    x, p = gauss(50, reach=2.0)
    Q = leak.leak_rate(x, p, power_law(1e-9, m), 2e6, 0.0141421)
    exact = 2e6 * LENGTH * 1e-9 * 50e6**-m / (0.139e-3 * np.sqrt(2 * np.pi / m))
    assert pytest.approx(exact, rel=1e-7) == Q  # ln p is a parabola: only the quadrature is left


@pytest.mark.parametrize("m", [0.5, 1.0, 3.0])
def test_power_law_on_a_hertzian(m):
    hertz = leak.hertz_line(20e3, 0.02, E)
    x = np.linspace(-1, 1, 401) * hertz.half_width
    Q = leak.leak_rate(x, hertz.pressure(x), power_law(1e-9, m), 2e6, 0.0141421)
    width = hertz.half_width * beta(0.5, 0.5 * m + 1)
    # int p^m dx; the square-root end is exact, the spline of ln p beside it is not.
    assert pytest.approx(2e6 * LENGTH * 1e-9 * hertz.peak_pressure**-m / width, rel=1e-4) == Q


def test_uniform_contact_ends_with_its_points():
    x, p = np.array([0.0, 1e-4, 4e-4, 1e-3]), np.full(4, 3e7)
    Q = leak.leak_rate(x, p, lambda p: 1e-15 + 0 * p, 2e6, 0.01)
    assert pytest.approx(2e6 * 2 * np.pi * 0.01 * 1e-15 / 1e-3, rel=1e-12) == Q


def test_radius_along_the_profile():
    """Uniform sigma, r = r0 + k x: resistance ln(r1/r0)/(2 pi k sigma)."""
    x = np.linspace(0, 1e-3, 9)
    r = 2e-3 + 0.7 * x
    Q = leak.leak_rate(x, np.full(9, 1e7), lambda p: 1e-15 + 0 * p, 2e6, r)
    assert pytest.approx(2e6 * 2 * np.pi * 0.7 * 1e-15 / np.log(r[-1] / r[0]), rel=1e-10) == Q


def brute_force(table: leak.Conductivity, log_pressure, s: float, drop: float) -> float:
    """Trapezoidal rule over 60 s."""
    y = np.linspace(-60, 60, 240_001)
    return drop * LENGTH / (s * (y[1] - y[0]) * np.sum(1 / table.at_log_pressure(log_pressure(y * s))))


@pytest.mark.parametrize(("points", "tolerance"), [(50, 1e-4), (200, 1e-5)])
@pytest.mark.parametrize("reach", [2.0, 3.5, 6.0])
def test_few_points_over_a_gaussian(points, reach, tolerance):
    conductivity = surface(hardness=HARDNESS).conductivity_table(1e3, 1e8).at(1e-3)
    x, p = gauss(points, reach)
    exact = brute_force(conductivity, lambda x: np.log(50e6) - 0.5 * (x / 0.139e-3) ** 2, 0.139e-3, 2e6)
    assert leak.leak_rate(x, p, conductivity, 2e6, 0.0141421) == pytest.approx(exact, rel=tolerance)


@pytest.mark.parametrize(("points", "tolerance"), [(50, 1e-3), (200, 1e-4)])
@pytest.mark.parametrize("c", [0.05, 1.0])
def test_few_points_over_a_crossover_on_an_uneven_grid(points, c, tolerance):
    """Between Gauss and Hertz, points crowded on one side: what a finite-element profile looks like."""
    conductivity = surface(hardness=HARDNESS).conductivity_table(1e3, 1e9).at(1e-3)
    u0 = 1.1e-6
    line = leak.crossover_line(c * np.pi * E * u0, 0.02, E, u0)
    t = np.linspace(-1, 1, points)
    x = 3.2 * line.std * (t + 0.25 * t**2)
    Q = leak.leak_rate(x, line.pressure(x), conductivity, 2e6, 0.0141421)
    y = np.linspace(-40, 40, 4001) * line.std
    exact = 2e6 * LENGTH / ((y[1] - y[0]) * np.sum(1 / conductivity.at_log_pressure(line.log_pressure(y))))
    assert pytest.approx(exact, rel=tolerance) == Q


def test_reference_leak_rates(reference):
    """Gauss and Hertz profiles, elastic and plastic; the file's Gaussian tails end at about 12 s: 4e-4 of Q."""
    rows = reference("leak_paper.csv")
    plastic = surface(hardness=HARDNESS).conductivity_table(1e3, 3e8)
    elastic = surface(hardness=HARDNESS).elastic.conductivity_table(1e3, 3e8)
    for row in rows:
        width, peak = float(row["width_m"]), float(row["peak_pressure_Pa"])
        if row["profile"] == "gauss":
            x, p = gauss(200, p0=peak, s=width)
        else:
            x = np.linspace(-1, 1, 200) * width
            p = peak * np.sqrt(np.maximum(1 - (x / width) ** 2, 0))
        radius = float(row["length_m"]) / (2 * np.pi)
        for table, column in ((plastic, "leak_rate_m3_per_s"), (elastic, "leak_rate_elastic_m3_per_s")):
            Q = leak.leak_rate(
                x, p, table.at(float(row["viscosity_Pa_s"])), float(row["fluid_pressure_Pa"]), radius
            )
            assert pytest.approx(float(row[column]), rel=5e-4) == Q


def test_hertz_needs_not_end_on_a_point():
    """Points at arbitrary places, zeros outside the contact: the edge is found from p^2."""
    conductivity = surface(hardness=HARDNESS).conductivity_table(1e3, 3e8).at(1e-3)
    hertz = leak.hertz_line(20e3, 0.02, E)
    fine = np.linspace(-1, 1, 2001) * hertz.half_width
    exact = leak.leak_rate(fine, hertz.pressure(fine), conductivity, 2e6, 0.0141421)
    x = np.linspace(-1.37, 1.21, 200) * hertz.half_width
    assert leak.leak_rate(x, hertz.pressure(x), conductivity, 2e6, 0.0141421) == pytest.approx(
        exact, rel=3e-4
    )


def test_fluid_pressure_falls_from_the_high_side():
    conductivity = surface(hardness=HARDNESS).conductivity_table(1e3, 1e8).at(1e-3)
    x, p = gauss(101)
    outer = leak.leak_flow(x, p, conductivity, 2e6, 0.0141421)
    inner = leak.leak_flow(x, p, conductivity, 2e6, 0.0141421, pressure_side="inner")
    assert np.all(np.diff(outer.fluid_pressure) > 0)
    assert outer.fluid_pressure[50] == pytest.approx(1e6, rel=1e-9)
    assert 0 < outer.fluid_pressure[0] < 0.05 * 2e6  # what the tail holds back
    np.testing.assert_allclose(outer.fluid_pressure + inner.fluid_pressure, 2e6, rtol=1e-12)
    assert outer.leak_rate == inner.leak_rate == pytest.approx(2e6 / outer.resistance)


def test_sealed_contact_leaks_nothing():
    contact = surface(hardness=HARDNESS)
    conductivity = contact.conductivity_table(1e3, 3e9).at(1e-3)
    x, p = gauss(81, p0=2e9)
    result = leak.leak_flow(x, p, conductivity, 2e6, 0.0141421)
    assert result.leak_rate == 0.0
    assert result.resistance == np.inf
    assert result.fluid_pressure[0] == 0.0
    assert result.fluid_pressure[-1] == 2e6
    assert leak.leak_rate(*gauss(81, p0=5e9), conductivity, 2e6, 0.0141421) == 0.0


def test_next_to_nothing_gets_through_without_a_word():
    """Just before it seals a contact may resist beyond all floats, which is no overflow to complain of."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = leak.leak_flow(*gauss(81), lambda p: np.full_like(p, 1e-310), 2e6, 0.0141421)
    assert result.leak_rate == 0.0 and result.resistance == np.inf


@settings(max_examples=15, deadline=None)
@given(
    p0=st.floats(1e5, 3e8),
    skew=st.floats(-0.4, 0.4),
    points=st.integers(12, 90),
    factor=st.floats(0.01, 100.0),
)
def test_scaling_and_mirror(p0, skew, points, factor):
    table = surface(hardness=HARDNESS).conductivity_table(1e3, 3e9)
    x, p = gauss(points, p0=p0)
    p = p * (1 + skew * np.tanh(x / 2e-4))
    r = 0.014 + 0.7 * x
    Q = leak.leak_rate(x, p, table.at(1e-3), 2e6, r)
    assert leak.leak_rate(x, p, table.at(1e-3 * factor), 2e6, r) == pytest.approx(Q / factor, rel=1e-12)
    assert leak.leak_rate(x, p, table.at(1e-3), 2e6 * factor, r) == pytest.approx(Q * factor, rel=1e-12)
    mirrored = leak.leak_rate(-x[::-1], p[::-1], table.at(1e-3), 2e6, r[::-1])
    assert mirrored == pytest.approx(Q, rel=1e-10)
    more = leak.leak_rate(x, 1.1 * p, table.at(1e-3), 2e6, r)
    assert more < Q


def test_shift_and_extra_zeros_change_nothing():
    conductivity = surface(hardness=HARDNESS).conductivity_table(1e3, 3e8).at(1e-3)
    hertz = leak.hertz_line(20e3, 0.02, E)
    x = np.linspace(-1, 1, 101) * hertz.half_width
    Q = leak.leak_rate(x, hertz.pressure(x), conductivity, 2e6, 0.0141421)
    wide = np.concatenate([[-3e-4, -2e-4], x, [2e-4, 5e-4]])
    assert leak.leak_rate(wide + 1.0, hertz.pressure(wide), conductivity, 2e6, 0.0141421) == pytest.approx(
        Q, rel=1e-8
    )


GOOD = {"x": [0.0, 1e-4, 2e-4], "p": [1e6, 2e6, 1e6], "pressure_drop": 1e5, "radius": 0.01}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"x": [0.0, 2e-4, 1e-4]}, r"x\[2\]"),
        ({"x": [0.0, 0.0, 1e-4]}, r"x\[1\]"),
        ({"x": [0.0, np.nan, 1e-4]}, r"x\[1\]"),
        ({"p": [1e6, -1.0, 1e6]}, r"p\[1\]"),
        ({"p": [1e6, np.inf, 1e6]}, r"p\[1\]"),
        ({"p": [0.0, 0.0, 0.0]}, "zero everywhere"),
        ({"x": [0.0, 1e-4], "p": [1e6, 1e6]}, "at least 3"),
        ({"p": [1e6, 1e6]}, "shape"),
        ({"radius": [0.01, 0.02]}, "radius"),
        ({"radius": -0.01}, "radius"),
        ({"pressure_drop": 0.0}, "pressure_drop"),
        ({"x": ["a", "b", "c"]}, "numbers"),
    ],
)
def test_wrong_input(change, says):
    arguments = GOOD | change
    with pytest.raises(leak.ProfileError, match=says):
        leak.leak_rate(
            arguments["x"],
            arguments["p"],
            power_law(1e-9, 1.0),
            arguments["pressure_drop"],
            arguments["radius"],
        )


def test_wrong_conductivity_and_side():
    with pytest.raises(leak.ProfileError, match="conductivity"):
        leak.leak_rate(GOOD["x"], GOOD["p"], lambda p: -p, 1e5, 0.01)
    with pytest.raises(leak.ProfileError, match="pressure_side"):
        leak.leak_flow(GOOD["x"], GOOD["p"], power_law(1e-9, 1.0), 1e5, 0.01, pressure_side="top")


def test_the_paper_case():
    """Plastic below elastic leak rate by 5.7 (1 bar) to 8.1 (20 bar), u_c ratio 1.8 to 2.0, all plastic at zeta 100."""
    contact = surface(hardness=HARDNESS)
    ratios = []
    for fluid_pressure in (1e5, 20e5):
        line = leak.gaussian_line(0.5 * 0.02 * fluid_pressure, 0.02, 0.139e-3**2 / 0.02)
        x = np.linspace(-3.5, 3.5, 101) * line.std
        rates = [
            leak.leak_rate(
                x, line.pressure(x), c.conductivity_table(1e3, 1e8).at(1e-3), fluid_pressure, 0.0141421
            )
            for c in (contact.elastic, contact)
        ]
        ratios.append(rates[0] / rates[1])
    np.testing.assert_allclose(ratios, [5.7, 8.1], atol=0.05)
    p = np.array([2.87e6, 57.4e6])
    u_c = contact.elastic.critical_separation(p) / contact.critical_separation(p)
    np.testing.assert_allclose(u_c, [1.8, 2.0], atol=0.06)
    q = 100 * contact.spectrum.q_low
    share = contact.plastic_area(50e6, q) / contact.contact_area(50e6, q)
    assert share == pytest.approx(0.9994, abs=1e-4)


def test_two_separate_bands_add_their_resistances() -> None:
    x = np.linspace(-1e-3, 1e-3, 401)
    bands = [
        height * np.maximum(0, 1 - ((x - centre) / 2e-4) ** 2)
        for height, centre in ((1e7, -5e-4), (2e7, 5e-4))
    ]
    single = [leak.leak_rate(x, band, lambda p: 1e-10 / p, 1e6, 0.014) for band in bands]
    both = leak.leak_rate(x, bands[0] + bands[1], lambda p: 1e-10 / p, 1e6, 0.014)
    assert both == pytest.approx(1 / (1 / single[0] + 1 / single[1]), rel=1e-9)


@pytest.mark.parametrize("node", [20, 35, 50])
@pytest.mark.parametrize("value", [0.0, 1e-3])
def test_one_bad_point_changes_little_and_invents_no_pressure(node: int, value: float) -> None:
    x = np.linspace(-6, 6, 101) * 1e-4
    p = 3e7 * np.exp(-((x / 1e-4) ** 2) / 2)
    largest: list[float] = []

    def conductivity(pressure: np.ndarray) -> np.ndarray:
        largest.append(float(np.max(pressure)))
        return 1e-10 / pressure

    good = leak.leak_rate(x, p, conductivity, 1e6, 0.014)
    p[node] = value
    # a point is at most 5 % of the resistance of this profile, and its neighbours' cells go with it
    assert leak.leak_rate(x, p, conductivity, 1e6, 0.014) == pytest.approx(good, rel=0.11)
    assert max(largest) < 1.11 * 3e7


def test_conductivity_may_be_given_at_the_points() -> None:
    x, p = gauss(61, reach=5.0)
    table = surface(hardness=HARDNESS).conductivity_table(1.0, 2e8).at(1e-3)
    as_function = leak.leak_rate(x, p, table, 2e6, 0.014)
    assert leak.leak_rate(x, p, table(p), 2e6, 0.014) == pytest.approx(as_function, rel=1e-3)


@pytest.mark.parametrize("values", [np.ones(3), "many", -np.ones(61), np.full(61, np.nan)])
def test_wrong_conductivity_values_are_refused(values) -> None:
    x, p = gauss(61)
    with pytest.raises(leak.ProfileError, match="conductivity"):
        leak.leak_rate(x, p, values, 2e6, 0.014)


@pytest.mark.parametrize("rising", [-3.0, 0.0, 2.0])
@pytest.mark.parametrize("count", [6, 24])
def test_the_contact_ends_where_its_face_ends(rising, count) -> None:
    """sigma = B/p and p = p0 exp(k x/W) over a face of width W, known at points inside: int p dx in closed form."""
    W, p0, B = 1e-3, 1e7, 1e-9
    x = W * (np.arange(count) + 0.5) / count
    p = p0 * np.exp(rising * x / W)
    area = p0 * W * (np.expm1(rising) / rising if rising else 1.0)
    exact = 2e6 * LENGTH * B / area
    results = [
        leak.leak_flow(
            *((x, p) if side == "outer" else (-x[::-1], p[::-1])),
            power_law(B, 1.0),
            2e6,
            0.0141421,
            pressure_side=side,
            ends=(0.0, W) if side == "outer" else (-W, 0.0),
        )
        for side in ("outer", "inner")
    ]
    for result in results:
        assert result.leak_rate == pytest.approx(exact, rel=1e-9)
        assert result.fluid_pressure.shape == x.shape
    np.testing.assert_allclose(results[0].fluid_pressure, results[1].fluid_pressure[::-1], rtol=1e-9)


@pytest.mark.parametrize("end", [2.2, 2.6, 3.5, 30.0])
def test_a_tail_is_cut_where_the_face_ends(end) -> None:
    """Gaussian over points up to 2 s, face up to `end`: int p^3 dx between the ends."""
    from scipy.special import erf

    x, p = gauss(50, reach=2.0)
    s, m = 0.139e-3, 3.0
    ends = (-end * s, None)
    Q = leak.leak_flow(x, p, power_law(1e-9, m), 2e6, 0.0141421, ends=ends).leak_rate
    width = s * np.sqrt(np.pi / (2 * m)) * (erf(end * np.sqrt(m / 2)) + 1)
    assert pytest.approx(2e6 * LENGTH * 1e-9 * 50e6**-m / width, rel=1e-7) == Q


@pytest.mark.parametrize("ends", [(1e-3, 0.0), ("a", "b"), (0.0,), 3.0])
def test_ends_that_are_none_are_refused(ends) -> None:
    x, p = gauss(20)
    with pytest.raises(leak.ProfileError, match="ends"):
        leak.leak_flow(x, p, power_law(1e-9, 1.0), 2e6, 0.0141421, ends=ends)


def test_equal_pressures_at_an_end_have_no_bend():
    """Flowing metal has the pressure of the hardness wherever its gap is closed, whatever its gap."""
    gap = np.array([0.0, -1.0, -2.0, -2.0, -1.0, 0.0]) * 1e-7
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert law_bends(np.full(6, 3e8), gap) == (0.0, 0.0)
