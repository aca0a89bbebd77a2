"""Direct simulation: contact and flow against closed forms, the whole against boundary elements of others."""

import numpy as np
import pytest

import leak
from leak.direct import PeriodicHalfSpace, patch_flow, periodic_flow, press, simulate

E = 1.0e11


def rough(n, cutoff, seed=0, hurst=0.8, rolloff=8):
    """Periodic map of rms slope one on the unit square, every amplitude as the spectrum says."""
    q = 2.0 * np.pi
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=1.0, hurst=hurst, q_low=0.9 * q, q_rolloff=rolloff * q, q_high=1.000001 * cutoff * q
    )
    h = leak.random_map(spectrum, size=1.0, points=n, seed=seed, amplitudes="exact")
    wave = q * np.fft.fftfreq(n, 1.0 / n)
    power = np.abs(np.fft.fft2(h) / n**2) ** 2
    return h / np.sqrt(np.sum(power * (wave[:, None] ** 2 + wave[None, :] ** 2)))


# ---------------------------------------------------------------- contact


@pytest.mark.parametrize("share", [0.1, 0.4, 0.8])
def test_sinusoidal_waves_touch_as_westergaard_says(share):
    """p* = pi E* D/lambda closes a wave D cos; the contact half width is (lambda/pi) asin sqrt(p/p*)."""
    n, size, amplitude = 256, 1e-3, 1e-6
    full = np.pi * E * amplitude / size
    wave = amplitude * np.cos(2.0 * np.pi * np.arange(n) / n)[:, None] * np.ones(n)
    state = press(PeriodicHalfSpace(n, size, E), wave, share * full)
    a = np.arcsin(np.sqrt(share)) / np.pi * size
    # one point more or less on either side
    assert np.mean(state.pressure > 0.0) == pytest.approx(2.0 * a / size, abs=2.0 / n)
    x = (np.arange(n) + (n // 2)) % n - n // 2
    x = x * size / n
    inside = np.sin(np.pi * a / size) ** 2 - np.sin(np.pi * x / size) ** 2
    p = (
        2.0
        * share
        * full
        * np.cos(np.pi * x / size)
        / np.sin(np.pi * a / size) ** 2
        * np.sqrt(inside.clip(0))
    )
    # the end of the contact, where p falls like a root, is a cell wide
    assert state.pressure[:, 0] == pytest.approx(p, abs=0.03 * p.max())
    # the gap is what the exact pressure leaves: its own displacement, from the same closed form by quadrature
    psi, psi_a = np.pi * np.abs(x) / size, np.pi * a / size
    opened = psi > psi_a + 2.0 * np.pi / n
    gap = np.zeros(n)
    for i in np.flatnonzero(opened):
        t = np.linspace(psi_a, psi[i], 2001)
        # dg/dx of an opened periodic crack: (4 p/E*) cos(psi)/S^2 sqrt(sin^2 psi - S^2)/2, S = sin psi_a
        s = np.sqrt((np.sin(t) ** 2 - np.sin(psi_a) ** 2).clip(0))
        slope = 2.0 * share * full / (E * np.sin(psi_a) ** 2) * 2.0 * s * np.cos(t)
        gap[i] = np.trapezoid(slope, t) * size / np.pi
    assert state.gap[opened, 0] == pytest.approx(gap[opened], abs=0.01 * amplitude)


def test_small_sphere_follows_hertz():
    """A paraboloid in a cell ten times wider than its contact: radius and peak pressure of Hertz."""
    n, size, radius = 256, 1e-3, 5e-3
    x = (np.arange(n) - n / 2) * size / n
    paraboloid = -(x[:, None] ** 2 + x[None, :] ** 2) / (2.0 * radius)
    a = 8e-5
    force = 4.0 * E * a**3 / (3.0 * radius)
    state = press(PeriodicHalfSpace(n, size, E), paraboloid, force / size**2)
    touching = state.pressure > 0.0
    edge = sum(np.count_nonzero(touching ^ np.roll(touching, 1, axis)) for axis in (0, 1)) * size / n
    # points counted along an edge are too many: Yastrebov et al., Tribol. Int. 114 (2017), (pi - 1 + ln 2)/24 each
    area = np.mean(touching) * size**2 - (np.pi - 1.0 + np.log(2.0)) / 24.0 * edge * size / n
    assert area == pytest.approx(np.pi * a**2, rel=0.015)
    assert state.pressure.max() == pytest.approx(1.5 * force / (np.pi * a**2), rel=0.01)
    assert state.pressure.sum() * (size / n) ** 2 == pytest.approx(force, rel=1e-10)


@pytest.mark.parametrize("hardness", [None, 0.2, 0.05])
@pytest.mark.parametrize("pressure", [0.0025, 0.01, 0.04])
def test_contact_satisfies_its_conditions(hardness, pressure):
    h = rough(128, 32)
    H = np.inf if hardness is None else hardness
    body = PeriodicHalfSpace(128, 1.0, 1.0)
    state = press(body, h, pressure, hardness=hardness, tolerance=1e-6)
    p = state.pressure
    assert p.mean() == pytest.approx(pressure, rel=1e-12)
    assert p.min() >= 0.0
    assert p.max() <= H
    # gap less overlap is the displaced surface, up to the approach of the bodies: nothing else moved
    rest = state.gap - state.overlap - (body.displacement(p) - h)
    assert np.ptp(rest) < 3e-6 * h.std()
    assert not np.any((state.gap > 0.0) & (p > 0.0))
    assert not np.any((state.overlap > 0.0) & (p < H))


def test_pressures_do_the_least_work():
    """Among all pressures of the same load within the bounds, the solution has the least energy p.Sp/2 - p.h."""
    h, rng = rough(64, 16), np.random.default_rng(1)
    body = PeriodicHalfSpace(64, 1.0, 1.0)

    def energy(p):
        return np.sum(p * (0.5 * body.displacement(p) - h))

    p = press(body, h, 0.02, hardness=0.1, tolerance=1e-8).pressure
    least = energy(p)
    for size in (1e-4, 1e-3, 1e-2):
        for _ in range(5):
            other = np.clip(p + size * rng.standard_normal(p.shape) * (rng.random(p.shape) < 0.3), 0.0, 0.1)
            # back to the same load, between the bounds, by mixing with a flat pressure that has too much or little
            flat = np.full_like(p, 0.03 if other.mean() < 0.02 else 0.0)
            share = (0.02 - other.mean()) / (flat.mean() - other.mean())
            other = (1.0 - share) * other + share * flat
            assert energy(other) >= least - 1e-9 * abs(least)


def test_scale_and_offset_do_not_matter():
    """Heights by a, side by b, modulus by c: pressures scale with c a/b, gaps with a; any plane may be the zero."""
    h = rough(64, 16)
    first = simulate(h, 1.0, [0.01, 0.03], effective_modulus=1.0, hardness=0.1, unload=[0.01])
    a, b, c = 3e-7, 2e-3, 7e10
    second = simulate(
        a * h + 1e-3, b, np.array([0.01, 0.03]) * c * a / b, effective_modulus=c, hardness=0.1 * c * a / b,
        unload=[0.01 * c * a / b],
    )  # fmt: skip
    assert second.contact_area == pytest.approx(first.contact_area, rel=1e-3)
    assert second.mean_gap / a == pytest.approx(first.mean_gap, rel=1e-4)
    sigma = second.flow_conductivity(1e-3) / a**3
    assert sigma == pytest.approx(first.flow_conductivity(1e-3), rel=2e-3)
    assert second.unloaded.mean_gap / a == pytest.approx(first.unloaded.mean_gap, rel=1e-4)


def test_order_of_the_pressures_does_not_matter():
    h = rough(64, 16)
    up = simulate(h, 1.0, [0.005, 0.02], effective_modulus=1.0, hardness=0.1)
    down = simulate(h, 1.0, [0.02, 0.005], effective_modulus=1.0, hardness=0.1)
    assert down.mean_gap[::-1] == pytest.approx(up.mean_gap, rel=1e-12)
    assert down.contact_area[::-1] == pytest.approx(up.contact_area, rel=1e-12)


def test_soft_asperities_yield_entirely():
    """Hardness far below E* h': all contact is at the hardness, so that its area is p/H (Bowden and Tabor)."""
    h = rough(128, 32)
    result = simulate(h, 1.0, [2e-5, 1e-4, 4e-4], effective_modulus=1.0, hardness=1e-3)
    assert result.contact_area == pytest.approx(result.pressure / 1e-3, rel=0.01)
    assert result.yielded_area == pytest.approx(result.contact_area, rel=0.01)
    # a rigid-plastic body is cut off at a plane: the gap is what the heights below it leave
    top = np.sort(h.ravel())[::-1]
    for fraction, gap in zip(result.contact_area, result.mean_gap, strict=True):
        plane = top[int(fraction * h.size) - 1]
        assert gap == pytest.approx(np.mean(np.maximum(plane - h, 0.0)), rel=0.01)


@pytest.mark.parametrize("share", [1e-6, 1e-3, 0.5, 0.999])
def test_flat_map_touches_everywhere(share):
    """There is no rms height to measure an error by, and the pressure is the same at every point."""
    for heights in (np.zeros((16, 16)), np.full((16, 16), 5e-6)):
        found = simulate(
            heights, 1e-3, share * 1e9, effective_modulus=E, hardness=1e9, unload=[0.5 * share * 1e9]
        )
        for branch in (found, found.unloaded):
            assert branch.contact_area[0] == 1.0
            assert branch.yielded_area[0] == branch.mean_gap[0] == branch.flow_conductivity(1e-3)[0] == 0.0


@pytest.mark.parametrize("height", [1e-14, 1e-12, 1e-10])
def test_nearly_flat_map_needs_no_hardness(height):
    """The load closes it without a pressure near the hardness, as the elastic solution says."""
    spike = np.zeros((32, 32))
    spike[16, 16] = height
    for p in (1e6, 5e8):
        hard = simulate(spike, 1e-3, p, effective_modulus=E, hardness=1e9)
        elastic = simulate(spike, 1e-3, p, effective_modulus=E)
        assert hard.contact_area[0] == elastic.contact_area[0] == 1.0
        assert hard.yielded_area[0] == 0.0


def test_unloading_remembers_the_largest_pressure():
    h = rough(128, 32)
    result = simulate(
        h, 1.0, [0.0025, 0.005, 0.01], effective_modulus=1.0, hardness=0.1, unload=[0.0025, 0.005, 0.009999]
    )
    back = result.unloaded
    assert np.all(back.contact_area[:2] > result.contact_area[:2])
    assert np.all(back.mean_gap[:2] < result.mean_gap[:2])
    assert np.all(back.flow_conductivity(1.0)[:2] < result.flow_conductivity(1.0)[:2])
    # just below the largest pressure nothing has changed yet: the map without its overlap fits at that pressure
    assert back.mean_gap[2] == pytest.approx(result.mean_gap[2], rel=1e-3)
    assert back.flow_conductivity(1.0)[2] == pytest.approx(result.flow_conductivity(1.0)[2], rel=5e-3)


def test_elastic_contact_remembers_nothing():
    h = rough(64, 16)
    result = simulate(h, 1.0, [0.01, 0.05], effective_modulus=1.0, unload=[0.01])
    assert result.unloaded.contact_area[0] == pytest.approx(result.contact_area[0], abs=2.0 / h.size)
    assert result.unloaded.mean_gap[0] == pytest.approx(result.mean_gap[0], rel=1e-4)


# ---------------------------------------------------------------- flow


@pytest.mark.parametrize("flow", [patch_flow, periodic_flow])
def test_plates_and_channels(flow):
    """Parallel plates; a wavy gap along its crests is the mean of g^3, across them the harmonic mean."""
    n = 128
    assert flow(np.full((n, n), 2e-6)).gap_cubed == pytest.approx(8e-18, rel=1e-10)
    x = (np.arange(n) + 0.5) / n
    k = 0.6
    wave = 1.0 + k * np.cos(2.0 * np.pi * x)
    along = flow(np.tile(wave, (n, 1)))
    across = flow(np.tile(wave, (n, 1)).T.copy())
    # <(1 + k cos)^3> = 1 + 3 k^2/2; <(1 + k cos)^-3> = (1 + k^2/2)/(1 - k^2)^(5/2)
    assert along.gap_cubed == pytest.approx(1.0 + 1.5 * k**2, rel=1e-8)
    assert across.gap_cubed == pytest.approx((1.0 - k**2) ** 2.5 / (1.0 + 0.5 * k**2), rel=1e-6)
    assert max(along.imbalance, across.imbalance) < 1e-9


def test_checkerboard_conducts_the_geometric_mean():
    """Keller and Dykhne: squares of two conductivities in a checkerboard make sqrt(k1 k2)."""
    n = 128
    square = (np.arange(n) // (n // 2))[:, None] ^ (np.arange(n) // (n // 2))[None, :]
    gap = np.where(square == 1, 1.0, 2.0)
    # the pressures at the four corners are singular: first order in the grid, 1.4 % at 64 cells a square
    assert periodic_flow(gap).gap_cubed == pytest.approx(np.sqrt(8.0), rel=0.02)


def test_lattice_of_channels_counts_as_resistors():
    """A square lattice of channels one cell wide: per period one channel of resistance L g^-3 in each direction."""
    n, period = 96, 12
    open_ = (np.arange(n) % period == 6)[:, None] | (np.arange(n) % period == 6)[None, :]
    flow = patch_flow(np.where(open_, 0.5, 0.0))
    # symmetric: nothing flows sideways, so that each channel is straight, and its width is a cell
    assert flow.gap_cubed == pytest.approx(0.125 / period, rel=1e-10)
    pools = np.where(open_, 0.5, 0.0)
    pools[3, :] = 0.0
    sealed = patch_flow(pools)
    assert sealed.gap_cubed == 0.0
    assert np.isnan(sealed.pressure).all()
    # the other direction keeps all its straight channels
    assert patch_flow(pools.T.copy()).gap_cubed == pytest.approx(0.125 / period, rel=1e-10)


def test_islands_change_nothing_but_their_own_cells():
    """A pool that no flow reaches may be as wide as it likes."""
    gap = np.ones((32, 32))
    gap[8:20, 8:20] = 0.0
    without = patch_flow(gap).gap_cubed
    gap[12:15, 12:15] = 1e3
    assert patch_flow(gap).gap_cubed == pytest.approx(without, rel=1e-9)


def test_way_around_the_seam():
    """A channel that leaves on one side and comes back on the other spans; a spiral climbs a period per turn."""
    gap = np.zeros((16, 16))
    gap[:8, 0] = gap[7:, -1] = 1.0
    assert patch_flow(gap).gap_cubed > 0.0
    # one period on it ends in column 15 and begins in column 0, which are neighbours over the seam
    assert periodic_flow(gap).gap_cubed == 0.0
    gap[0, -1] = 1.0
    assert periodic_flow(gap).gap_cubed > 0.0
    dead = np.zeros((16, 16))
    dead[:8, 3] = 1.0
    dead[10:, 3] = 1.0
    assert periodic_flow(dead).gap_cubed == 0.0
    dead[8:10, 3] = 1.0
    assert periodic_flow(dead).gap_cubed == pytest.approx(1.0 / 16)


def test_conductances_of_many_decades_balance():
    gap = np.exp(np.random.default_rng(3).normal(0.0, 1.0, (96, 96)))
    flow = patch_flow(gap)
    assert (gap.max() / gap.min()) ** 3 > 1e9
    assert flow.imbalance < 1e-8
    # between the harmonic and the arithmetic bound of Wiener
    assert np.mean(gap**-3.0) ** -1 < flow.gap_cubed < np.mean(gap**3)


# ---------------------------------------------------------------- the whole against references


@pytest.mark.slow
def test_elastic_rows_of_the_reference():
    """direct_numerical.csv, set A512 (10 surfaces, 512^2, 8 points per shortest wave), on 256^2 with 4.

    Four points per shortest wave instead of eight enlarge the area by 6 to 9 %, here taken off, leave the gap as it is
    and let 3 to 8 % less through (`test_refined_map_is_the_same_surface`). Two samples scatter by some
    2 % in gap, by 0.1 in ln conductivity at the smaller pressure and 0.4 at the larger.
    """
    pressure = [0.01, 0.12]
    area, gap = [0.0246, 0.2505], [1.642, 0.4913]
    log_conductivity = [1.1025, -4.6109]
    runs = []
    for seed in range(2):
        h = rough(256, 64, seed)
        result = simulate(h, 1.0, pressure, effective_modulus=1.0)
        sigma = np.log(12.0 * result.flow_conductivity(1.0) / h.std() ** 3)
        runs.append([result.contact_area, result.mean_gap / h.std(), sigma])
    mean = np.mean(runs, axis=0)
    assert mean[0] == pytest.approx(np.array(area) * 1.065, rel=0.03)
    assert mean[1] == pytest.approx(np.array(gap) * 0.98, rel=0.03)
    assert mean[2] == pytest.approx(np.array(log_conductivity), abs=0.45)


def test_capped_rows_of_the_reference():
    """plastic_direct.csv, set P5 (three samples, 512^2), hardness 0.1, on 256^2 with four points per shortest wave.

    Against eight, four points let 3 to 8 % less through; a sample scatters by 2 % in gap, 10 % in conductivity. After
    unloading the reference's contact areas are 3 to 11 % above those that tamaas and this solver agree on to every
    point: its contact there is not quite converged (a tolerance of 1e-2 instead of 1e-4 gives its areas).
    """
    h = rough(256, 64, 1)
    result = simulate(h, 1.0, [0.0025, 0.01], effective_modulus=1.0, hardness=0.1, unload=[0.0025])
    assert result.contact_area == pytest.approx([0.025994, 0.10322], rel=0.03)
    assert result.yielded_area == pytest.approx([0.024031, 0.096776], rel=0.03)
    assert result.mean_gap / h.std() == pytest.approx([1.863, 1.2166], rel=0.05)
    sigma = 12.0 * result.flow_conductivity(1.0) / h.std() ** 3
    assert np.log(sigma) == pytest.approx(np.log([4.7175, 0.98733]), abs=0.25)
    back = result.unloaded
    assert back.contact_area[0] == pytest.approx(0.059807, rel=0.11)
    assert back.mean_gap[0] / h.std() == pytest.approx(1.3628, rel=0.05)
    assert 12.0 * back.flow_conductivity(1.0)[0] / h.std() ** 3 == pytest.approx(1.5236, rel=0.25)


# ---------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"heights": np.zeros((4, 5))}, "must be (n, n)"),
        ({"heights": np.full((4, 4), np.nan)}, "finite"),
        ({"size": 0.0}, "size = 0.0"),
        ({"pressures": [1e6, -1.0]}, "pressures"),
        ({"heights": "rough"}, "must be an array of numbers"),
        ({"heights": np.ma.masked_less(np.eye(4), 0.5)}, "some are masked"),
        ({"pressures": "1 MPa"}, "pressures = '1 MPa'"),
        ({"hardness": 1e6}, "pressures = 1e+06 and hardness = 1e+06"),
        ({"unload": [2e6]}, "below the largest pressure"),
    ],
)
def test_bad_input_is_named(change, words):
    arguments = {
        "heights": np.zeros((4, 4)),
        "size": 1e-3,
        "pressures": [1e6],
        "effective_modulus": 1e11,
    } | change
    with pytest.raises(leak.DirectError) as error:
        simulate(arguments.pop("heights"), arguments.pop("size"), arguments.pop("pressures"), **arguments)
    assert words in str(error.value)


def test_gas_slips_through_narrow_gaps():
    """Plates let u^3 f(D) through; far from rarefaction Maxwell's slip, 1 + 6 A/D with A = 1.0162, and none at last."""
    from leak.flow.rarefied import flow_factor

    gap = np.full((16, 16), 1e-6)
    for flight in (1e-5, 1e-6, 1e-8):
        found = patch_flow(leak.direct.rarefied_gap(gap, flight)).gap_cubed
        assert found == pytest.approx(1e-18 * float(flow_factor(1e-6 / flight)), rel=1e-9)
    slip = patch_flow(leak.direct.rarefied_gap(gap, 1e-9)).gap_cubed
    assert slip == pytest.approx(1e-18 * (1.0 + 6.0 * 1.0162 / 1000.0), rel=1e-5)
    h = rough(64, 16)
    liquid, thin = (
        simulate(h, 1.0, [0.05], effective_modulus=1.0, flight=flight) for flight in (None, 0.1 * h.std())
    )
    # near what a uniform gap u_eff would let through (leak.GasConductivityTable: R of order one); contact stays shut
    uniform = flow_factor(liquid.gap_cubed_along[0] ** (1.0 / 3.0) / (0.1 * h.std()))
    assert thin.gap_cubed_along[0] / liquid.gap_cubed_along[0] == pytest.approx(float(uniform), rel=0.15)
    assert thin.contact_area[0] == liquid.contact_area[0]
    assert leak.direct.rarefied_gap(np.zeros((4, 4)), 1e-7).max() == 0.0


# ---------------------------------------------------------------- patches and maps


def paper(high=3.1416e6):
    return leak.PowerSpectrum.self_affine(
        rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.727e4, q_high=high
    )


def test_patch_holds_the_waves_it_says():
    patch = leak.direct.Patch.of(paper(), points=128, points_per_wave=4.0)
    h = patch.heights(3)
    n, size = 128, patch.size
    q = 2.0 * np.pi * np.hypot(np.fft.fftfreq(n, size / n)[:, None], np.fft.fftfreq(n, size / n)[None, :])
    power = np.abs(np.fft.fft2(h) / n**2) ** 2
    held = (q > 0.0) & (q <= 2.0 * np.pi / patch.shortest_wavelength * 1.000001)
    assert power[~held].sum() < 1e-20 * power.sum()
    # amplitudes are the spectrum itself: C(q) (2 pi/L)^2 in each wave
    assert power[held] == pytest.approx(np.asarray(paper()(q[held])) * (2.0 * np.pi / size) ** 2, rel=1e-9)
    assert patch.shortest_wavelength == pytest.approx(4.0 * size / n)
    # the sum over the waves of the grid is the integral over the spectrum, up to the coarse ring of the first ones
    assert h.std() == pytest.approx(patch.grid_spectrum.rms_height, rel=0.02)
    assert patch.height_cut == pytest.approx(1.0 - (patch.grid_spectrum.rms_height / 1.9e-6) ** 2, rel=1e-12)
    assert 0.0 < patch.height_cut < 0.15
    assert patch.slope_cut > 0.8


def test_patch_larger_than_the_surface_cuts_nothing():
    patch = leak.direct.Patch(paper(1e5), 512, 2.0 * np.pi / 1e3)
    assert patch.height_cut == pytest.approx(0.0, abs=1e-9)
    assert patch.slope_cut == pytest.approx(0.0, abs=1e-9)
    assert patch.shortest_wavelength == pytest.approx(2.0 * np.pi / 1e5)


def test_exact_amplitudes_are_alike_and_gaussian_ones_scatter():
    patch = leak.direct.Patch.of(paper(), points=64)
    exact = [patch.heights(seed).std() for seed in range(4)]
    gaussian = [patch.heights(seed, "gaussian").std() for seed in range(4)]
    assert np.ptp(exact) < 1e-9 * exact[0]
    assert np.ptp(gaussian) > 1e-3 * gaussian[0]
    assert np.mean(gaussian) == pytest.approx(exact[0], rel=0.1)


def test_patch_without_waves_is_refused():
    with pytest.raises(leak.DirectError, match="the spectrum has"):
        leak.direct.Patch(paper(), 64, 1e-7)


def test_refined_map_is_the_same_surface():
    h = rough(64, 16)
    fine = leak.direct.refined(h, 160)
    assert fine.std() == pytest.approx(h.std(), rel=1e-12)
    assert leak.direct.refined(fine, 64) == pytest.approx(h, abs=1e-12 * h.std())
    coarse, finer = leak.direct.grid_study(h, 1.0, [0.03], [64, 128], effective_modulus=1.0)
    # grids of 4 and 8 points per shortest wave: areas fall by some per cent, gaps by one (the reference's own grids)
    assert 0.90 < finer.contact_area[0] / coarse.contact_area[0] < 1.0
    assert finer.mean_gap[0] == pytest.approx(coarse.mean_gap[0], rel=0.03)


def test_shorter_waves_hold_the_surfaces_apart():
    h = rough(128, 32)
    whole, half = leak.direct.cutoff_study(h, 1.0, [0.01], [1 / 32, 1 / 16], effective_modulus=1.0)
    assert half.contact_area[0] > 1.15 * whole.contact_area[0]
    assert half.mean_gap[0] < whole.mean_gap[0]


def test_mirrored_map_meets_itself_and_keeps_all_heights():
    rng = np.random.default_rng(2)
    x, y = np.arange(40) * 2e-6, np.arange(30) * 2e-6
    heights = 1e-7 * rng.standard_normal((40, 30)) + 0.01 * x[:, None] - 0.02 * y[None, :]
    h, size = leak.direct.periodic_map(leak.height_map(heights, (2e-6, 2e-6)))
    assert h.shape == (60, 60)
    assert size == pytest.approx(120e-6)
    # the plane is gone, and each edge is beside its own image
    assert h.std() == pytest.approx(1e-7, rel=0.05)
    assert h[0] == pytest.approx(h[-1])
    assert h[:, 29] == pytest.approx(h[:, 30])


def test_windowed_map_is_flat_at_its_border_and_as_rough():
    heights = rough(64, 16)
    h, size = leak.direct.periodic_map(leak.height_map(1e-6 * heights, (1e-6, 2e-6)), continuation="window")
    # 64 um by 128 um: the square in the middle, on the coarser of both spacings
    assert h.shape == (32, 32)
    assert size == pytest.approx(64e-6)
    assert np.abs(h[0] - h[0].mean()).max() < 0.1 * h.std()
    coarse, _ = leak.direct.periodic_map(leak.height_map(1e-6 * heights, (1e-6, 2e-6)), points=16)
    assert coarse.shape == (16, 16)


def test_streams_add_up():
    gap = np.where(np.random.default_rng(5).random((48, 48)) < 0.3, 0.0, 1e-6)
    gap *= 1.0 + 0.5 * np.random.default_rng(6).random((48, 48))
    flow = patch_flow(gap)
    found = leak.direct.streams(gap, flow)
    assert found.loss.sum() == pytest.approx(1.0)
    assert found.loss.min() >= 0.0
    assert not np.any(found.flux[gap == 0.0])
    # one narrow place in a wide channel loses nearly everything
    channel = np.zeros((16, 16))
    channel[:, 7] = 1.0
    channel[9, 7] = 0.1
    found = leak.direct.streams(channel, patch_flow(channel))
    assert found.loss[9, 7] > 0.9
    assert found.flux[:, 7] == pytest.approx(16.0)


def test_lay_along_the_flow_opens_it():
    patch = leak.direct.Patch.of(paper(), points=128, peklenik=4.0)
    result = simulate(patch.heights(1), patch.size, [5e7], effective_modulus=115e9, hardness=3.5e9)
    assert result.gap_cubed_along[0] > 2.0 * result.gap_cubed_across[0]
