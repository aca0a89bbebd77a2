"""Particles in the leaking fluid: counts, gaps that stop them, what still leaks, and how fast it clogs."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

import leak

SPECTRUM = leak.PowerSpectrum.self_affine(
    rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
)
YIELDING = leak.RoughContact(SPECTRUM, effective_modulus=115e9, hardness=3.5e9)
SURFACES = {
    "yielding": YIELDING,
    "elastic": YIELDING.elastic,
    "across the lay": leak.RoughContact(SPECTRUM, effective_modulus=115e9, hardness=3.5e9, peklenik=0.25),
}
each_surface = pytest.mark.parametrize("surface", SURFACES.values(), ids=SURFACES)
PEAK = 57e6


# ---------------------------------------------------------------- counts


def test_scale_numbers_are_the_ranges_of_the_standard():
    # 18: more than 1300 up to 2500 per ml; 16: 320 to 640; 13: 40 to 80 (ISO 4406, table 1)
    found = leak.ParticleCounts.of_iso_4406("18/16/13")
    assert found.sizes == (4e-6, 6e-6, 14e-6)
    at = found.at_least(found.sizes)
    assert at.low == pytest.approx([1300e6, 320e6, 40e6], rel=1e-12)
    assert at.high == pytest.approx([2500e6, 640e6, 80e6], rel=1e-12)
    assert at.likely == pytest.approx(np.sqrt(at.low * at.high), rel=1e-12)


def test_every_scale_number_begins_where_the_one_before_ends_and_is_about_twice_as_large():
    ranges = [leak.ParticleCounts.of_iso_4406(f"28/28/{n}") for n in range(29)]
    low, high = np.array([(one.low[-1], one.high[-1]) for one in ranges]).T
    assert low[1:].tolist() == high[:-1].tolist()
    # 0.64 to 1.3 and 1.3 to 2.5 are the standard's own roundings of a doubling
    assert np.all((high / low > 1.9) & (high / low < 2.1))
    # one hundredth of a power of two per ml, rounded
    assert high / 1e4 == pytest.approx(2.0 ** np.arange(29), rel=0.08)


def test_a_microscope_counts_from_five_and_fifteen_micrometres():
    found = leak.ParticleCounts.of_iso_4406(" -/16/13 ")
    assert found.sizes == (5e-6, 15e-6)
    assert found.at_least(5e-6).high == pytest.approx([640e6])


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("18/16", "three scale numbers"),
        ("a/b/c", "three scale numbers"),
        ("13/16/18", "exceed"),
        ("29/16/13", "from 0 to 28"),
        ("-/-/13", "three scale numbers"),
        ("", "three scale numbers"),
    ],
)
def test_a_wrong_code_is_refused(code, says):
    with pytest.raises(leak.FluidError, match=says):
        leak.ParticleCounts.of_iso_4406(code)


@pytest.mark.parametrize(
    ("sizes", "counts", "says"),
    [
        ([1e-6], [1.0], "at least 2"),
        ([1e-6, 2e-6], [1.0], "needs as many"),
        ([2e-6, 1e-6], [2.0, 1.0], "increase"),
        ([1e-6, 2e-6], [1.0, 2.0], "rise"),
        ([1e-6, 2e-6], [1.0, 0.0], "positive"),
    ],
)
def test_wrong_counts_are_refused(sizes, counts, says):
    with pytest.raises(leak.FluidError, match=says):
        leak.ParticleCounts.of_counts(sizes, counts)


def test_a_power_law_is_continued_exactly():
    sizes = np.array([2e-6, 5e-6, 15e-6])
    dust = leak.ParticleCounts.of_counts(sizes, 1e-7 * sizes**-2.8)
    d = np.geomspace(0.2e-6, 80e-6, 9)
    for numbers in dust.at_least(d):
        assert numbers == pytest.approx(1e-7 * d**-2.8, rel=1e-12)


def test_the_extrapolation_of_a_code_holds_every_line_through_its_ranges():
    code = leak.ParticleCounts.of_iso_4406("17/15/11")
    rng = np.random.default_rng(3)
    d = np.array([0.5e-6, 1e-6, 2e-6, 4e-6, 14e-6, 30e-6])
    inside = code.at_least(d)
    at_ends = np.exp(rng.uniform(np.log(code.low), np.log(code.high), (200, 3)))[:, [0, 2]]
    slope = np.log(at_ends[:, 0] / at_ends[:, 1]) / np.log(14 / 4)
    lines = at_ends[:, :1] * (d / 4e-6) ** -slope[:, None]
    assert np.all(lines >= inside.low * (1 - 1e-12)) and np.all(lines <= inside.high * (1 + 1e-12))
    # and is less sure the further it goes
    spread = inside.high / inside.low
    assert np.all(np.diff(spread[:4]) < 0) and spread[-1] > spread[-2]
    assert np.all(np.diff(inside.low) < 0) and np.all(np.diff(inside.high) < 0)


def test_nothing_is_said_of_particles_far_below_those_that_were_counted():
    code = leak.ParticleCounts.of_iso_4406("17/15/11")
    assert code.smallest == pytest.approx(0.4e-6)
    assert np.isnan(code.at_least([0.39e-6, 0.4e-6, 0.41e-6]).high).tolist() == [True, False, False]
    sizes, share = [0.1e-6, 0.3e-6, 1e-6], [0.999, 0.5, 0.0]
    assert math.isnan(leak.stopped(code, sizes, share).likely[0])
    # a per mille of the leak below is not missed
    assert leak.stopped(code, sizes, [1.0, 0.999, 0.0]).likely[0] > 0


def test_a_filter_takes_the_larger_particles_from_all_counts():
    sizes = np.array([2e-6, 15e-6])
    dust, filtered = (
        leak.ParticleCounts.of_counts(sizes, 1e-7 * sizes**-2.8, largest) for largest in (math.inf, 4e-6)
    )
    d = np.array([1e-6, 3e-6, 4e-6, 9e-6])
    left = dust.at_least(d).likely - dust.at_least(4e-6).likely
    assert filtered.at_least(d).likely == pytest.approx(np.maximum(left, 0.0), rel=1e-9)
    assert filtered.at_least(d).likely[2:].tolist() == [0.0, 0.0]


# ---------------------------------------------------------------- gaps that are shut


def gaps_of(cells, contact, threshold, peklenik=1.0):
    """A distribution of a few gaps, each with its share of the area."""
    u, weight = (np.array([row]) for row in zip(*cells, strict=True))
    edges = np.concatenate([[[0.0]], 0.5 * (u[:, 1:] + u[:, :-1]), 1.5 * u[:, -1:]], axis=1)
    return leak.GapDistribution(np.array([1e6]), edges, u, weight, np.array([contact]), threshold, peklenik)


@pytest.mark.parametrize("threshold", [0.42, 0.5])
@pytest.mark.parametrize("contact", [0.0, 0.1])
def test_two_gaps_of_which_one_is_shut_have_a_closed_form(threshold, contact):
    n, narrow, wide, share = 1.0 / (1.0 - threshold), 1e-6, 2e-6, 0.2
    gaps = gaps_of([(narrow, share), (wide, 1.0 - share - contact)], contact, threshold)
    # all open: Bruggeman's balance times both denominators is a quadratic in the conductivity; shut: linear
    a, b, k = narrow**3 / wide**3, 1.0, n - 1.0
    quadratic = (
        share * np.polymul([-1.0, a], [k, b])
        + (1.0 - share - contact) * np.polymul([-1.0, b], [k, a])
        - contact / k * np.polymul([k, a], [k, b])
    )
    open_ = np.roots(quadratic).max()
    shut = 1.0 - (contact + share) * n / k
    assert gaps.remaining_share(1.5e-6)[0] == pytest.approx(shut / open_, rel=1e-9)
    assert gaps.area_below(1.5e-6)[0] == pytest.approx(contact + share, rel=1e-12)


def test_shut_gaps_that_percolate_let_nothing_through():
    gaps = gaps_of([(1e-6, 0.45), (2e-6, 0.55)], 0.0, 0.42)
    assert gaps.remaining_share(1.45e-6)[0] == 0.0
    # as soon as 42 of the 45 per cent are shut, which lie between zero and the middle between both gaps
    assert gaps.largest_passing[0] == pytest.approx(1.5e-6 * 0.42 / 0.45, rel=1e-12)


def lattice_conductance(right, down):
    """Conductance of a square lattice of bonds between its left and right side, over that of unit bonds."""
    n, m = down.shape
    node = np.arange(n * m).reshape(n, m)
    i = np.concatenate([node[:, :-1].ravel(), node.ravel()])
    j = np.concatenate([node[:, 1:].ravel(), np.roll(node, -1, axis=0).ravel()])
    g = np.concatenate([right.ravel(), down.ravel()]) / right.max()
    rows, columns = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
    matrix = coo_matrix((np.concatenate([g, g, -g, -g]), (rows, columns))).tocsr()
    # islands without a bond would make it singular
    matrix += coo_matrix((np.full(n * m, 1e-13), (node.ravel(), node.ravel()))).tocsr()
    inside, left = node[:, 1:-1].ravel(), node[:, 0]
    p = np.zeros(n * m)
    p[left] = 1.0
    p[inside] = spsolve(matrix[inside][:, inside], -matrix[inside][:, left].sum(axis=1).A1)
    flow = (right[:, 0] * (p[node[:, 0]] - p[node[:, 1]])).sum()
    return flow * (m - 1) / n


@pytest.mark.parametrize("hardness", [3.5e9, None], ids=["yielding", "elastic"])
def test_a_lattice_of_random_bonds_loses_as_much_when_its_narrow_ones_are_blocked(hardness):
    # the bonds of a square lattice percolate at one half, where the effective medium is exact for symmetry
    surface = leak.RoughContact(
        SPECTRUM, effective_modulus=115e9, hardness=hardness, percolation_threshold=0.5
    )
    gaps = leak.GapDistribution.of(surface, [PEAK])
    inside, rng = np.concatenate([[0.0], np.cumsum(gaps.weight[0])]), np.random.default_rng(1)
    u = [
        np.interp(rng.random(shape) - gaps.contact[0], inside, gaps.edges[0], left=0.0)
        for shape in ((90, 89), (90, 90))
    ]
    whole = lattice_conductance(*(one**3 for one in u))
    assert whole == pytest.approx(float(surface.effective_separation(PEAK)) ** 3, rel=0.04)
    # a mean-field theory: good to some tenths of a per cent where little is lost, to some per cent where a fifth is;
    # towards the threshold the lattice falls with a higher power of what is missing to it
    for over_largest, tolerance in ((0.3, 0.002), (0.5, 0.007), (0.7, 0.04), (0.85, 0.14)):
        size = over_largest * gaps.largest_passing[0]
        left = lattice_conductance(*(np.where(one > size, one, 0.0) ** 3 for one in u)) / whole
        assert gaps.remaining_share(size)[0] == pytest.approx(left, rel=tolerance)


@each_surface
def test_the_largest_particle_that_passes_is_the_quantile_at_the_threshold(surface):
    gaps = leak.GapDistribution.of(surface, [1e6, PEAK])
    for p, largest in zip(gaps.pressure, gaps.largest_passing, strict=True):
        u, density = surface.separation_distribution(float(p))
        above = np.trapezoid(np.where(u >= largest, density, 0.0), u)
        # a step of the grid on which the density is summed here
        assert 1.0 - above == pytest.approx(surface.percolation_threshold, abs=5e-3)
    assert np.all(gaps.remaining_share(float(1.001 * gaps.largest_passing.max())) == 0.0)
    # the critical junction is another reading of the same place
    assert gaps.largest_passing == pytest.approx(surface.critical_separation(gaps.pressure), rel=0.2)


@each_surface
def test_shutting_nothing_changes_nothing_and_shutting_all_seals(surface):
    table = surface.conductivity_table(1e3, 1e8)
    assert leak.shut_conductivity(table, surface, 0.0) is table
    p = np.array([1e5, 1e7, PEAK])
    whole = np.asarray(table.effective_separation(p))
    tiny = leak.shut_conductivity(table, surface, 1e-9)
    assert np.asarray(tiny.effective_separation(p)) == pytest.approx(whole, rel=1e-6)
    assert np.all(np.asarray(leak.shut_conductivity(table, surface, 1e-4).effective_separation(p)) == 0.0)
    # and never more flows when more is shut
    sizes = np.geomspace(0.2e-6, 20e-6, 8)
    shut = [np.asarray(leak.shut_conductivity(table, surface, d).effective_separation(p)) for d in sizes]
    assert np.all(np.diff(shut, axis=0) <= 1e-6 * whole)


@each_surface
def test_the_shut_table_is_the_effective_medium_at_each_pressure(surface):
    table, p = surface.conductivity_table(1e3, 1e8), np.array([3e5, 3e6, 2.1e7, 5.3e7])
    gaps = leak.GapDistribution.of(surface, p)
    for size in (1e-6, 2e-6):
        shut = leak.shut_conductivity(table, surface, size)
        share = (np.asarray(shut.effective_separation(p)) / np.asarray(table.effective_separation(p))) ** 3
        # linear in steps of 0.15 in ln p, between which the share moves by some per cent
        assert share == pytest.approx(gaps.remaining_share(size), abs=2e-3)


def test_longer_and_higher_roughness_stops_larger_particles_in_proportion():
    # lengths ten times as large at the same slopes
    larger = leak.PowerSpectrum.self_affine(
        rms_height=1.9e-5, hurst=0.6, q_low=1e2, q_rolloff=3.7268e3, q_high=3.1415926e5
    )
    surface = leak.RoughContact(larger, effective_modulus=115e9, hardness=3.5e9)
    small, large = (leak.GapDistribution.of(one, [PEAK]) for one in (YIELDING, surface))
    assert large.largest_passing == pytest.approx(10 * small.largest_passing, rel=1e-6)
    assert large.remaining_share(15e-6) == pytest.approx(small.remaining_share(1.5e-6), rel=1e-6)


def test_stiffness_and_pressure_count_only_in_proportion():
    softer = leak.RoughContact(SPECTRUM, effective_modulus=115e8, hardness=3.5e8)
    hard, soft = leak.GapDistribution.of(YIELDING, [PEAK]), leak.GapDistribution.of(softer, [0.1 * PEAK])
    assert soft.remaining_share(1.5e-6) == pytest.approx(hard.remaining_share(1.5e-6), rel=1e-9)


def test_a_gas_loses_as_much_conductivity_as_a_liquid():
    table = leak.gas_conductivity_table(YIELDING, 1e4, 1e8, num=16)
    shut = leak.shut_conductivity(table, YIELDING, 1.5e-6)
    liquid = leak.shut_conductivity(table.liquid, YIELDING, 1.5e-6)
    log_p = np.log([1e6, PEAK])
    assert shut.at_log_pressure(log_p).tolist() == liquid.at_log_pressure(log_p).tolist()
    assert np.all(shut.at_log_pressure(log_p) < table.at_log_pressure(log_p))
    x = np.linspace(-4, 4, 101) * 0.139e-3
    p = PEAK * np.exp(-0.5 * (x / 0.139e-3) ** 2)
    nitrogen = leak.gas("nitrogen")
    flows = [leak.gas_leak_flow(x, p, one, nitrogen, 2.1e6, 1e5, 0.014).leak_rate for one in (table, shut)]
    liquids = [leak.leak_rate(x, p, one.liquid.at(1e-3), 2e6, 0.014) for one in (table, shut)]
    # rarefaction favours narrow gaps a little
    assert flows[1] / flows[0] == pytest.approx(liquids[1] / liquids[0], rel=0.02)


@pytest.mark.parametrize("size", [-1e-6, math.nan, math.inf])
def test_a_wrong_size_is_refused(size):
    with pytest.raises(leak.ConductivityError, match="size"):
        leak.shut_conductivity(YIELDING.conductivity_table(1e5, 1e8), YIELDING, size)


# ---------------------------------------------------------------- how fast it clogs


def test_particles_that_are_stopped_are_counted_where_the_leak_falls():
    # Q(d)/Q0 = 1 - (d/D)^4 and N = K/d^3: c = int N d(d^4)/D^4 = 4 K/D^3
    D, K = 3e-6, 1e-9
    sizes = np.geomspace(0.01 * D, D, 200)
    dust = leak.ParticleCounts.of_counts([1e-7, 1e-5], K / np.array([1e-7, 1e-5]) ** 3)
    found = leak.stopped(dust, sizes, 1.0 - (sizes / D) ** 4)
    by_quadrature = quad(lambda d: K / d**3 * 4 * d**3 / D**4, 0.01 * D, D)[0]
    # all that is lost below the first size is counted there
    assert found.likely[0] == pytest.approx(by_quadrature + 0.01 * K / D**3, rel=1e-3)
    assert found.likely[0] == pytest.approx(4 * K / D**3, rel=0.01)
    assert found.low == found.high


def test_half_the_leak_is_gone_where_the_differential_equation_says_so():
    clogging = leak.Clogging(leak_rate=3e-9, rate=4e5)
    done = solve_ivp(
        lambda t, V: 3e-9 * np.exp(-4e5 * V), (0.0, clogging.time_to(0.25)), [0.0], rtol=1e-10, atol=1e-18
    )
    assert done.y[0, -1] == pytest.approx(clogging.volume_to(0.25), rel=1e-6)
    assert 3e-9 * np.exp(-4e5 * done.y[0, -1]) == pytest.approx(0.25 * 3e-9, rel=1e-6)
    assert leak.Clogging(3e-9, 0.0).time_to(0.5) == leak.Clogging(3e-9, 0.0).volume_to(0.5) == math.inf


def test_particles_that_land_anywhere_shut_the_nth_part_of_what_is_open():
    # the law behind k = 1/N, by drawing: N places, of which each particle finds one, shut already or not
    places, particles, rng = 2000, 3000, np.random.default_rng(2)
    shut = np.unique(rng.integers(places, size=particles)).size
    law = leak.Clogging(leak_rate=1.0, rate=1.0 / places)
    # standard deviation of the number of open places, 442 of 2000: 14
    assert law.volume_to(1.0 - shut / places) == pytest.approx(particles, rel=0.1)


def test_the_bounds_of_the_decay_are_those_of_counts_and_places():
    paths = leak.parallel_paths(0.09, 4e-4, 2e-6)
    assert paths == pytest.approx((225.0, 45000.0))
    few = leak.Concentration(*(np.array([one]) for one in (1e9, 2e9, 4e9)))
    slow, fast = leak.cloggings(1e-9, few, paths)
    assert slow.volume_to(0.5) == pytest.approx(math.log(2) * 45000 / 1e9)
    assert fast.volume_to(0.5) == pytest.approx(math.log(2) * 225 / 4e9)
    # no fewer than one place, however short the seal
    assert leak.parallel_paths(1e-6, 1e-3, 1e-2) == (1.0, 1.0)


def test_a_profile_throttles_like_its_peak_over_the_throttling_length():
    table = YIELDING.conductivity_table(1e1, 1e9)
    x = np.linspace(-6, 6, 241) * 0.139e-3
    p = PEAK * np.exp(-0.5 * (x / 0.139e-3) ** 2)
    length = leak.throttling_length(x, p, table)
    rate = leak.leak_rate(x, p, table.at(1e-3), 2e6, 0.014)
    uniform = leak.leak_rate([0.0, 0.5 * length, length], [PEAK] * 3, table.at(1e-3), 2e6, 0.014)
    assert rate == pytest.approx(uniform, rel=1e-9)
