"""Fluid that carries part of the load: closed forms, limits, symmetries, lift-off and blow-off."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from paper_surface import E, spectrum, surface
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.special import erfc

import leak

R = 0.0141421
LY = 2 * np.pi * R


def conductivity(**kwargs) -> leak.Conductivity:
    return surface(**kwargs).conductivity_table(1e-2, 3e9).at(1e-3)


def power_law(B: float, m: float):
    return lambda p: B * np.asarray(p, dtype=float) ** -m


def gauss(points: int, *, p0: float = 57.4e6, s: float = 1.39e-4, reach: float = 4.5):
    x = np.linspace(-reach, reach, points) * s
    return x, p0 * np.exp(-0.5 * (x / s) ** 2)


def coupled(x, p, sigma, drop, **kwargs) -> leak.CoupledLeakResult:
    return leak.coupled_leak_flow(x, p, sigma, drop, R, **kwargs)


# ------------------------------------------------------------------ closed forms


@pytest.mark.parametrize("share", [1e-6, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("m", [1.0, 2.0, 3.5])
def test_uniform_pressure_and_a_power_law(m, share):
    """Q = (L_y B/W) [(p - Delta P)^(1-m) - p^(1-m)]/(m-1), and ln(p/(p - Delta P)) for m = 1."""
    p, W, B = 4e6, 1e-3, 1e-12 * 4e6**m
    drop = share * p
    log_left = np.log1p(-share)
    exact = -log_left if m == 1 else p ** (1 - m) * np.expm1((1 - m) * log_left) / (m - 1)
    result = coupled(np.linspace(0, W, 4), np.full(4, p), power_law(B, m), drop)
    # the second-order steps are finest where sigma varies, up to a factor 10^3.5 here
    assert result.leak_rate == pytest.approx(LY * B / W * exact, rel=3e-5)
    assert result.lift_off_x is None
    assert result.blow_off_pressure == pytest.approx(p)
    assert result.resistance * result.leak_rate == pytest.approx(drop)


def test_uniform_pressure_and_a_rough_surface():
    """Q W/L_y = int of sigma over the pressures that the asperities carry, for any sigma."""
    sigma, p, W, drop = conductivity(), 20e6, 3e-4, 15e6
    exact = LY / W * quad(lambda w: float(sigma(w)), p - drop, p, epsrel=1e-10)[0]
    assert coupled([0, W / 2, W], [p] * 3, sigma, drop).leak_rate == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize(
    ("peak", "share", "alpha"),
    [
        *(
            (peak, share, alpha)
            for peak, share in [(0.9, 0.01), (0.9, 0.99), (0.99, 0.5), (1.1, 0.9)]
            for alpha in (0, 60e-9)
        ),
        # a liquid as good as solid: psi of the last half of the drop is psi of all of it to four digits
        (0.3, 0.99, 480e-9),
    ],
)
def test_uniform_pressure_near_sealing(peak, share, alpha):
    """Q W/L_y = int sigma(p - p_f) (eta0/eta)(p_f) dp_f, where sigma falls by decades over the drop."""
    contact = leak.RoughContact(spectrum(), effective_modulus=0.01 * E)
    sigma = contact.conductivity_table(1e-2, 2 * contact.sealing_pressure).at(1e-3)
    p, W = peak * contact.sealing_pressure, 3e-4
    drop = share * p
    nodes, weights = np.polynomial.legendre.leggauss(12)
    left = np.geomspace(p - drop, p, 2001)
    half = 0.5 * np.diff(left)[:, None]
    w = left[:-1, None] + half * (1 + nodes)
    exact = LY / W * np.sum(half * weights * sigma(w) * np.maximum(np.exp(alpha * (w - p)), 1e-9))
    result = coupled(np.linspace(0, W, 5), np.full(5, p), sigma, drop, pressure_law=leak.Barus(alpha))
    # 400 steps over many decades of sigma
    assert result.leak_rate == pytest.approx(exact, rel=3e-4)
    # the flow is found to 1e-7; of a liquid as good as solid that leaves its last pressures open
    assert result.fluid_pressure[-1] == pytest.approx(drop, rel=1e-4 if alpha == 480e-9 else 1e-6)


@pytest.mark.parametrize("alpha", [0.0, 40e-9])
@pytest.mark.parametrize(("peak", "share"), [(0.5, 0.2), (0.8, 0.9), (1.1, 0.99)])
def test_a_gaussian_near_sealing_against_radau(peak, share, alpha):
    """dw/dx = dp/dx - Q (eta/eta0)(p - w)/(2 pi r sigma(w)) by an implicit method of order five.

    w = p - p_f is what the asperities carry. At both ends, where w falls to zero, 1/sigma(w) falls so steeply that no
    step is small enough: the way up begins where w has 1e-8 of the peak, and on the way down, where w always falls,
    x is found over ln w, down to the same 1e-8.
    """
    contact = leak.RoughContact(spectrum(), effective_modulus=0.01 * E)
    sigma = contact.conductivity_table(1e-2, 2 * contact.sealing_pressure).at(1e-3)
    s, p0 = 1.39e-4, peak * contact.sealing_pressure
    x, p = gauss(401, p0=p0, s=s)
    Q = coupled(x, p, sigma, share * p0, pressure_law=leak.Barus(alpha)).leak_rate
    thin = 1e-8 * p0

    def total(x):
        return p0 * np.exp(-0.5 * (x / s) ** 2)

    def rises(x, w, Q):
        # tries of the method lie anywhere
        w = np.clip(w, 0.1 * thin, contact.sealing_pressure)
        thickening = np.exp(np.minimum(alpha * np.maximum(total(x) - w, 0.0), 9.0))
        return -x / s**2 * total(x) - Q / LY * thickening / (sigma(w) + 1e-60)

    def drop(Q: float) -> float:
        start = -6.0 * s if rises(-6.0 * s, thin, Q) > 0.0 else brentq(rises, -6.0 * s, -s, args=(thin, Q))
        up = solve_ivp(rises, (start, 0.0), [thin], "Radau", args=(Q,), rtol=1e-7, atol=1e-9 * p0)
        log_w = np.log(up.y[0, -1]), np.log(thin)
        down = solve_ivp(
            lambda v, x: np.exp(v) / rises(x, np.exp(v), Q), log_w, [0.0], "Radau", rtol=1e-7, atol=1e-9 * s
        )
        assert up.success
        assert down.success
        return total(down.y[0, -1]) - thin

    assert drop(Q * (1 - 3e-4)) < share * p0 < drop(Q * (1 + 3e-4))


def test_a_flow_that_no_path_settles_is_not_guessed(monkeypatch):
    from leak.flow import fluid_in_gap

    monkeypatch.setattr(fluid_in_gap, "_PATH_TOLERANCE", 0.0)
    x, p = gauss(161)
    with pytest.raises(leak.ProfileError, match="not found to 0 %"):
        coupled(x, p, conductivity(), 0.999 * p.max())


def test_linear_profile_of_pressure_and_sigma_1_over_p():
    """m = 1 is a linear equation: p_f on a Gaussian is the Gaussian smeared by an exponential, up to lift-off."""
    s, p0, B, drop = 1.39e-4, 50e6, 1e-7, 20e6
    x, p = gauss(401, p0=p0, s=s, reach=6.0)
    lift = s * np.sqrt(2 * np.log(p0 / drop))

    def at_lift_off(log_c: float) -> float:
        """int c exp(-c (x - x')) p(x') dx' = p0 c s sqrt(pi/2) exp(c^2 s^2/2 - c x) erfc((c s^2 - x)/(s sqrt 2))."""
        c = np.exp(log_c)
        smeared = p0 * c * s * np.sqrt(np.pi / 2) * np.exp(0.5 * (c * s) ** 2 - c * lift)
        return smeared * erfc((c * s**2 - lift) / (s * np.sqrt(2))) - drop

    c = np.exp(brentq(at_lift_off, np.log(0.01 / s), np.log(8 / s)))
    result = coupled(x, p, power_law(B, 1.0), drop)
    assert result.leak_rate == pytest.approx(LY * B * c, rel=3e-5)
    assert result.lift_off_x == pytest.approx(lift, rel=1e-6)


# ------------------------------------------------------------------ limits


@pytest.mark.parametrize("hardness", [None, 3.5e9])
def test_small_fluid_pressure_is_uncoupled(hardness):
    sigma = conductivity(hardness=hardness)
    x, p = gauss(201, reach=6.0)
    more = np.array(
        [
            coupled(x, p, sigma, drop).leak_rate / leak.leak_rate(x, p, sigma, drop, R) - 1
            for drop in (1e2, 1e4, 1e6)
        ]
    )
    # the far flanks, where even a small fluid pressure meets a smaller p, hold some of the resistance back for long
    assert np.all(more > 0)
    assert more[0] < 8e-3
    assert np.all(np.diff(more) > 0)


def test_power_law_at_small_fluid_pressure_is_uncoupled():
    """Without the flanks' logarithm: relative difference of the order of m Delta P/p0."""
    x, p = gauss(201, reach=6.0)
    sigma = power_law(1e-5, 2.0)
    ratio = coupled(x, p, sigma, 1.0).leak_rate / leak.leak_rate(x, p, sigma, 1.0, R)
    assert ratio == pytest.approx(1.0, abs=1e-5)


def test_uniform_pressure_at_small_fluid_pressure_is_uncoupled_to_rounding():
    sigma, x, p = conductivity(), [0, 2e-4, 4e-4], [20e6] * 3
    uncoupled = leak.leak_flow(x, p, sigma, 1.0, R)
    result = coupled(x, p, sigma, 1.0)
    assert result.leak_rate == pytest.approx(uncoupled.leak_rate, rel=1e-6)
    np.testing.assert_allclose(result.fluid_pressure, uncoupled.fluid_pressure, rtol=1e-6, atol=1e-6)


def test_sealed_contact_opens_where_the_fluid_has_relieved_it():
    """Sealed as long as p - Delta P exceeds the sealing pressure somewhere, open from there on."""
    contact = surface()
    sigma = contact.conductivity_table(1e-2, 2 * contact.sealing_pressure).at(1e-3)
    over = 50e6
    x, p = gauss(201, p0=contact.sealing_pressure + over)
    below, above = coupled(x, p, sigma, 0.9 * over), coupled(x, p, sigma, 3 * over)
    assert below.leak_rate == 0.0
    assert below.resistance == np.inf
    assert below.fluid_pressure[0] == 0.0
    assert below.fluid_pressure[-1] == pytest.approx(0.9 * over)
    assert leak.leak_rate(x, p, sigma, 3 * over, R) == 0.0
    assert 0.0 < above.leak_rate < 1e-12
    # over 80 decades of Q, down to where nothing is left to be called a flow
    rates = [coupled(x, p, sigma, drop).leak_rate for drop in (150e6, 300e6, 500e6, 1e9, 3e9, 8e9)]
    assert np.all(np.diff(np.log(rates)) > 0)


# ------------------------------------------------------------------ lift-off and blow-off


def test_lift_off_is_where_the_fluid_meets_the_total_pressure():
    x, p = gauss(301)
    drop = 5e6
    result = coupled(x, p, conductivity(), drop)
    lift = 1.39e-4 * np.sqrt(2 * np.log(57.4 / 5))
    assert result.lift_off_x == pytest.approx(lift, rel=1e-6)
    beyond = x > lift
    np.testing.assert_allclose(result.fluid_pressure[beyond], drop, rtol=1e-12)
    assert np.all(result.contact_pressure[beyond] == 0)
    inside = ~beyond
    # in the low-pressure flank p_f is p to within the interpolation between steps
    total = result.fluid_pressure + result.contact_pressure
    np.testing.assert_allclose(total[inside], p[inside], rtol=1e-12, atol=1e-6 * drop)
    assert np.all(result.contact_pressure[inside & (p > 1e4)] > 0)
    assert np.all(np.diff(result.fluid_pressure) >= 0)


def test_lift_off_in_the_tail_of_a_short_profile():
    x, p = gauss(61, reach=2.5)
    drop = 0.2 * p[-1]
    result = coupled(x, p, conductivity(), drop)
    assert result.lift_off_x > x[-1]
    assert result.lift_off_x == pytest.approx(1.39e-4 * np.sqrt(2 * np.log(57.4e6 / drop)), rel=1e-4)
    longer = coupled(*gauss(161, reach=5.0), conductivity(), drop)
    assert result.leak_rate == pytest.approx(longer.leak_rate, rel=1e-4)


@pytest.mark.parametrize("profile", ["gauss", "hertz"])
def test_blow_off_is_the_peak(profile):
    line = leak.hertz_line(20e3, 0.02, E)
    x, p = (np.linspace(-1, 1, 161) * line.half_width,) * 2 if profile == "hertz" else gauss(160)
    p = line.pressure(x) if profile == "hertz" else p
    peak = line.peak_pressure if profile == "hertz" else 57.4e6
    sigma = conductivity()
    result = coupled(x, p, sigma, 0.999 * peak)
    assert result.blow_off_pressure == pytest.approx(peak, rel=1e-6)
    assert np.isfinite(result.leak_rate)
    blown = coupled(x, p, sigma, 1.001 * peak)
    assert blown.leak_rate == np.inf
    assert blown.resistance == 0.0
    assert np.all(np.isnan(blown.fluid_pressure))
    assert blown.lift_off_x is None


def test_a_pocket_between_two_ridges_is_lifted_off():
    """Where the valley of p lies below the fluid pressure, the fluid passes it without loss."""
    x = np.linspace(-6e-4, 6e-4, 601)
    p = 60e6 * (np.exp(-0.5 * ((x - 3e-4) / 6e-5) ** 2) + np.exp(-0.5 * ((x + 3e-4) / 6e-5) ** 2))
    result = coupled(x, p, conductivity(), 20e6)
    middle = np.abs(x) < 0.8e-4
    assert np.all(result.contact_pressure[middle] == 0)
    assert np.ptp(result.fluid_pressure[middle]) < 1e-3 * 20e6
    # each ridge takes about half; the upstream one, more relieved, somewhat less
    assert 0.5 < result.fluid_pressure[300] / 20e6 < 0.7
    alone = coupled(x, 60e6 * np.exp(-0.5 * ((x - 3e-4) / 6e-5) ** 2), conductivity(), 20e6)
    assert 0.35 < result.leak_rate / alone.leak_rate < 0.55


# ------------------------------------------------------------------ symmetry, scaling, convergence


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(
    p0=st.floats(1e6, 3e8),
    share=st.floats(1e-3, 0.97),
    skew=st.floats(-0.4, 0.4),
    factor=st.floats(0.01, 100.0),
)
def test_mirror_viscosity_and_monotony(p0, share, skew, factor):
    table = surface().conductivity_table(1e-2, 3e9)
    x, p = gauss(90, p0=p0)
    p = p * (1 + skew * np.tanh(x / 2e-4))
    r, drop = 0.014 + 0.7 * x, share * p.max()
    one = leak.coupled_leak_flow(x, p, table.at(1e-3), drop, r)
    mirrored = leak.coupled_leak_flow(-x[::-1], p[::-1], table.at(1e-3), drop, r[::-1], pressure_side="inner")
    assert mirrored.leak_rate == pytest.approx(one.leak_rate, rel=1e-9)
    np.testing.assert_allclose(mirrored.fluid_pressure[::-1], one.fluid_pressure, rtol=1e-6, atol=1e-6 * drop)
    assert mirrored.lift_off_x == pytest.approx(-one.lift_off_x, rel=1e-9)
    # ln Q is found to 1e-8
    thinner = leak.coupled_leak_flow(x, p, table.at(1e-3 * factor), drop, r)
    assert thinner.leak_rate * factor == pytest.approx(one.leak_rate, rel=1e-6)
    assert one.leak_rate > leak.leak_rate(x, p, table.at(1e-3), drop, r)
    assert leak.coupled_leak_flow(x, 1.02 * p, table.at(1e-3), drop, r).leak_rate < one.leak_rate
    assert leak.coupled_leak_flow(x, p, table.at(1e-3), 0.98 * drop, r).leak_rate < 0.98 * one.leak_rate


def test_sides_of_a_symmetric_contact_are_equal():
    x, p = gauss(121)
    sigma = conductivity()
    outer, inner = (coupled(x, p, sigma, 20e6, pressure_side=side) for side in ("outer", "inner"))
    assert outer.leak_rate == pytest.approx(inner.leak_rate, rel=1e-9)
    np.testing.assert_allclose(inner.fluid_pressure[::-1], outer.fluid_pressure, rtol=1e-6)


@pytest.mark.parametrize("drop", [1e4, 2e6, 2e7, 5e7])
def test_finer_steps_and_profiles_change_little(drop, monkeypatch):
    x, p = gauss(101, reach=5.0)
    sigma = conductivity()
    usual = coupled(x, p, sigma, drop).leak_rate
    monkeypatch.setattr("leak.flow.fluid_in_gap._STEPS", 3000)
    monkeypatch.setattr("leak.flow.fluid_in_gap._FIRST_STEPS", 600)
    fine = coupled(*gauss(501, reach=5.0), sigma, drop).leak_rate
    assert usual == pytest.approx(fine, rel=1e-4)


@pytest.mark.parametrize("drop", [2e6, 3e7])
def test_against_an_adaptive_integrator(drop):
    """The same equation from the low side by scipy's LSODA with the Q found here: p_f at the lift-off point."""
    from scipy.integrate import solve_ivp

    sigma, s, p0 = conductivity(), 1.39e-4, 57.4e6
    result = coupled(*gauss(201, reach=6.0), sigma, drop)

    def rate(x: float, p_f: np.ndarray) -> list[float]:
        w = p0 * np.exp(-0.5 * (x / s) ** 2) - p_f[0]
        return [result.leak_rate / LY / float(sigma(w)) if w > 1e-6 else 0.0]

    # starts close enough to p_f = p, which the flank enforces by itself: further out it is stiff, and nothing changes
    start = -s * np.sqrt(2 * np.log(p0 / (5e-4 * drop)))
    solved = solve_ivp(rate, (start, result.lift_off_x), [0.0], method="LSODA", rtol=1e-7, atol=1.0)
    assert solved.y[0, -1] == pytest.approx(drop, rel=2e-4)


# ------------------------------------------------------------------ wrong input


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"x": [0.0, 2e-4, 1e-4]}, r"x\[2\]"),
        ({"p": [1e6, -1.0, 1e6]}, r"p\[1\]"),
        ({"pressure_drop": 0.0}, "pressure_drop"),
        ({"pressure_side": "top"}, "pressure_side"),
        ({"conductivity": lambda p: -p}, "conductivity"),
        ({"conductivity": [1e-15, 1e-15, 1e-15]}, "function of p"),
    ],
)
def test_wrong_input(change, says):
    arguments = {
        "x": [0.0, 1e-4, 2e-4],
        "p": [1e6, 2e6, 1e6],
        "conductivity": power_law(1e-9, 1.0),
        "pressure_drop": 1e5,
        "radius": 0.01,
    } | change
    with pytest.raises(leak.ProfileError, match=says):
        leak.coupled_leak_flow(**arguments)


@pytest.mark.parametrize("side", ["outer", "inner"])
@pytest.mark.parametrize("ends", [(-2.1, 2.1), (-2.6, 3.0), (-2.02, None), (None, None)])
def test_a_small_pressure_drop_ends_where_the_faces_end(ends, side):
    """For Delta P << p it is the flow without coupling, whose integral ends there."""
    x, p = gauss(60, reach=2.0)
    placed = tuple(None if end is None else end * 1.39e-4 for end in ends)
    sigma, drop = power_law(1e-20, 1.0), 1.0
    alone = leak.leak_flow(x, p, sigma, drop, R, pressure_side=side, ends=placed).leak_rate
    result = coupled(x, p, sigma, drop, pressure_side=side, ends=placed)
    assert result.leak_rate == pytest.approx(alone, rel=1e-4)
    high = placed[1] if side == "outer" else placed[0]
    assert (result.lift_off_x is None) == (high is not None)
