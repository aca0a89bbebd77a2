"""Rough faces over a bulk that is strained: limits, symmetries, and direct simulation of von Mises' metal."""

from __future__ import annotations

import csv
import math

import bulk_flow
import bulk_stress
import numpy as np
import pytest
from places import SHARED

import leak

REFERENCE = SHARED / "reference" / "bulk_flow_direct.csv"
PRESSURE = np.array([0.5e8, 1e8, 2e8])


def face(scale: float = 1.0, **changes) -> leak.RoughContact:
    spectrum = leak.PowerSpectrum.self_affine(
        rms_height=0.5e-6 * scale, hurst=0.8, q_low=2e4, q_rolloff=8e4, q_high=3e6
    )
    given = {"effective_modulus": 115e9, "hardness": 1e9, "theory": "corrected"} | changes
    return leak.RoughContact(spectrum, **given)


def test_without_strain_nothing_changes():
    rest = face()
    assert rest.strained(0.0, 0.0) == rest
    assert rest.strained(0.02, 0.01).strained(0.0, 0.0) == rest
    nearly = rest.strained(1e-9, 0.0)
    assert nearly.flow_conductivity(PRESSURE, 1e-3) == pytest.approx(
        rest.flow_conductivity(PRESSURE, 1e-3), rel=1e-9
    )


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
def test_more_strain_flattens_more(way):
    strained = [face().strained(e * way[0], e * way[1]) for e in np.linspace(0.0, 0.06, 7)]
    area = np.array([surface.contact_area(PRESSURE) for surface in strained])
    sigma = np.array([surface.flow_conductivity(PRESSURE, 1e-3) for surface in strained])
    gap = np.array([surface.mean_separation(PRESSURE) for surface in strained])
    assert (np.diff(area, axis=0) > 0.0).all()
    assert all(one <= strained[-1].most_contact_area(p) for one, p in zip(area[-1], PRESSURE, strict=True))
    assert (np.diff(area, axis=1) > 0.0).all()
    assert (np.diff(sigma, axis=0)[sigma[:-1] > 0.0] < 0.0).all()
    assert (np.diff(sigma, axis=1) <= 0.0).all()
    assert (np.diff(gap, axis=0) <= 0.0).all()
    sealing = [surface.sealing_pressure for surface in strained]
    assert (np.diff(sealing) < 0.0).all()


def test_strain_counts_over_the_slope():
    """Twice as high, twice as steep: the same with twice the strain, hardness and pressure."""
    one, two = face().strained(0.01, 0.002), face(2.0, hardness=2e9).strained(0.02, 0.004)
    assert two.contact_area(2.0 * PRESSURE) == pytest.approx(one.contact_area(PRESSURE), rel=1e-9)
    assert two.flow_conductivity(2.0 * PRESSURE, 1e-3) == pytest.approx(
        8.0 * np.asarray(one.flow_conductivity(PRESSURE, 1e-3)), rel=1e-6
    )


def test_fluid_flows_more_easily_along_the_strain():
    along, across, both = (
        np.asarray(face().strained(*way).flow_conductivity(PRESSURE, 1e-3))
        for way in ((0.02, 0.0), (0.0, 0.02), (0.02, 0.02))
    )
    assert (along > across).all()
    # all but sealed at the largest pressure
    assert (across >= both).all()
    assert across[0] > both[0] > 0.0


def test_table_law_and_memory_are_those_of_the_strained_face():
    surface = face().strained(0.02, 0.0)
    table = surface.conductivity_table(1e6, 2e8)
    assert table.conductivity(PRESSURE, 1e-3) == pytest.approx(
        surface.flow_conductivity(PRESSURE, 1e-3), rel=2e-3
    )
    gap = surface.mean_separation(PRESSURE)
    assert surface.interface_law(plastic=True).pressure(gap) == pytest.approx(PRESSURE, rel=1e-2)
    later = surface.mean_separation(PRESSURE[0], largest=PRESSURE[2])
    assert surface.mean_separation(PRESSURE[2]) < later < surface.mean_separation(PRESSURE[0])
    assert surface.elastic == face().elastic


def test_softer_asperities_sink_more():
    hard, soft = (face().strained(0.02, 0.0, yield_stress=stress) for stress in (1e9 / 2.9, 1e9 / 4.0))
    assert (np.asarray(soft.contact_area(PRESSURE)) > hard.contact_area(PRESSURE)).all()


@pytest.mark.parametrize(
    ("changes", "strain", "words"),
    [
        ({"hardness": None}, 0.01, "hardness"),
        ({"theory": "paper"}, 0.01, "corrected"),
        ({}, 1.5, "meridional"),
        ({}, math.nan, "meridional"),
    ],
)
def test_impossible_strains_are_refused(changes, strain, words):
    with pytest.raises(leak.SurfaceError, match=words):
        face(**changes).strained(strain, 0.0)


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


MEANS = [state for state in bulk_flow.states() if state.is_mean]


@pytest.mark.parametrize("part", ["all", "held out"])
def test_means_of_four_maps_are_met(part: str):
    """Areas within 15 %; conductivities, rms of ln, 0.35 above a hundredth and 0.7 above a thousandth."""
    of = [state for state in MEANS if part == "all" or state.path[-1] == "1"]
    error, left = np.array([bulk_flow.log_misses(state)[:2] for state in of]), np.array([s.mean for s in of])
    assert len(of) > 70
    assert np.abs(np.expm1(error[:, 0])).max() < 0.15
    assert rms(error[left > 1e-2, 1]) < 0.35
    assert rms(error[left > 1e-3, 1]) < 0.7


def test_the_mean_gap_is_that_at_rest_where_as_much_flows():
    """While more than a hundredth is left, over the gap without strain."""
    still_open = [state for state in MEANS if state.mean > 1e-2]
    misses = np.array([bulk_flow.gap_at_rest(state) - state.gap for state in still_open])
    assert len(misses) > 90
    assert rms(misses) < 0.05
    assert np.abs(misses).max() < 0.13


@pytest.mark.parametrize("level", [1e-3, 1e-6])
def test_seals_where_the_simulation_does(level: float):
    """Strain that leaves a thousandth and a millionth, means of four maps, within a factor 1.3."""
    paths = [[state for state in MEANS if state.path == path] for path in bulk_flow.paths_of(MEANS)]
    ratios = [ratio for ratio in (bulk_flow.sealing_strain(path, level) for path in paths) if ratio]
    assert len(ratios) > 7
    assert min(ratios) > 1.0 / 1.3
    assert max(ratios) < 1.3


@pytest.mark.slow
def test_faces_with_a_lay_are_met():
    """Strained along the lay and across it, three and five times as long as wide: areas within 15 %."""
    of = [state for state in bulk_flow.states() if state.path[0] != "1"]
    error = np.array([bulk_flow.log_misses(state) for state in of])
    left = np.array([[state.mean, state.along, state.across] for state in of])
    assert len(of) > 50
    assert np.abs(np.expm1(error[:, 0])).max() < 0.15
    for i in range(3):
        assert rms(error[left[:, i] > 1e-2, 1 + i]) < 0.35


def test_lay_and_strain_may_be_turned_together():
    along, across = (face(peklenik=ratio) for ratio in (5.0, 0.2))
    for way in ((0.02, 0.0), (-0.02, 0.0), (0.02, -0.02)):
        area = along.strained(*way).contact_area(PRESSURE)
        assert area == pytest.approx(across.strained(*way[::-1]).contact_area(PRESSURE), rel=1e-9)
    # the crests of a lay sink more easily under strain across it
    assert (
        along.strained(0.0, 0.02).contact_area(PRESSURE) > along.strained(0.02, 0.0).contact_area(PRESSURE)
    ).all()


def test_much_strain_seals_for_good():
    """Each step of strain closes further, up to a face that is flat."""
    for peklenik in (0.1, 1.0, 10.0):
        for way in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)):
            strain = np.outer(np.linspace(0.0, 0.9, 200), way)
            surface = face(peklenik=peklenik)
            at_rest = surface.pressure_at_rest(np.full(200, 5e7), *strain.T)
            assert (np.diff(at_rest) >= 0.0).all()
            assert at_rest[-1] > surface.sealing_pressure


@pytest.mark.skipif(
    not REFERENCE.exists(), reason="the reference bulk_flow_direct.csv is not here (../shared/reference)"
)
def test_another_code_flattens_alike():
    """Areas over those without strain of nine paths of another code, mean of both directions of the flow."""
    with REFERENCE.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["n"] == "64"]
    first: dict[tuple[str, ...], tuple[float, float]] = {}
    area, flow = [], []
    for row in rows:
        path = (row["seed"], row["H_over_Eh"], row["p_over_H"])
        strain, touched, k = (
            float(row[name]) for name in ("strain_over_slope", "area_fraction", "conductivity_over_hrms3")
        )
        if strain == 0.0:
            first[path] = touched, k
        if strain == 0.0 or path not in first or k < 1e-2 * first[path][1]:
            continue
        shape, ratio = ("1", "16", "0.8", "4", *path[1:], "x", "1"), k / first[path][1]
        state = bulk_flow.State(
            shape, 1, first[path][1], strain, touched / first[path][0], ratio, ratio, math.nan
        )
        of_area, of_flow, *_ = bulk_flow.log_misses(state)
        area.append(of_area)
        flow.append(of_flow)
    assert len(area) > 30
    assert rms(area) < 0.15
    assert rms(flow) < 0.35


def test_pressure_at_rest_lets_as_much_through_at_many_places_at_once() -> None:
    surface = face()
    p, meridional, hoop = np.array([2e7, 1e8, 2e8, 1e8]), np.array([0.01, -0.02, 0.0, 0.0]), np.zeros(4)
    at_rest = surface.pressure_at_rest(p, meridional, hoop)
    for place in range(4):
        strained = surface.strained(meridional[place], hoop[place])
        assert surface.flow_conductivity(at_rest[place], 1e-3) == pytest.approx(
            float(strained.flow_conductivity(p[place], 1e-3)), rel=1e-12
        )
    assert at_rest[2:].tolist() == p[2:].tolist()
    elastic = surface.elastic
    assert elastic.pressure_at_rest(p, meridional, hoop).tolist() == p.tolist()


def test_area_at_rest_is_interpolated_closely() -> None:
    for hardness in (1e8, 1e9, 2e10):
        surface = leak.RoughContact(
            face().spectrum, effective_modulus=115e9, hardness=hardness, theory="corrected"
        )
        p = hardness * np.geomspace(1e-7, 0.999, 50)
        area = np.exp(surface._area_curve.value(np.log(p / hardness)))
        assert area == pytest.approx(np.asarray(surface.contact_area(p)), rel=1e-4)


STRESSED = [state for state in bulk_stress.states() if state.face == "random"]


def test_elastic_strain_that_comes_with_the_pressure_is_met():
    """40 states of random faces, stretched or pressed together up to half of the yield strain and more."""
    errors = [bulk_stress.theory(state) - state.change for state in STRESSED]
    assert len(errors) == 40
    assert rms(errors) < 0.06
    without = bulk_stress.BULK_FLOW._replace(tension=0.0)
    assert rms([bulk_stress.theory(state, without) - state.change for state in STRESSED]) > 0.15


def test_crests_soften_like_random_asperities():
    """Pressed together, where nothing flows; the same 0.1 within a factor of two and a half."""
    turned = [state for state in bulk_stress.states() if state.face == "turned"]
    for mode in ("-x", "-y"):
        found = [bulk_stress.softening(state) for state in turned if state.mode == mode]
        assert len(found) > 8
        assert min(found) > 0.06 and max(found) < 0.25
    assert all(bulk_stress.softening(state) > 0.06 for state in turned)


def test_stretched_metal_has_softer_asperities_up_to_its_yield_stress():
    surface, strains = face(), np.linspace(-0.02, 0.02, 41)
    acts = surface.pressure_at_rest(1e8, 0.0, 0.0, strains)
    assert (np.diff(acts) >= 0.0).all()
    assert acts[20] == 1e8
    assert acts[[0, -1]] == pytest.approx([0.9e8, 1.1e8], rel=1e-9)
    yield_strain = 1e9 / 2.9 / 115e9
    assert surface.pressure_at_rest(1e8, 0.0, 0.0, 0.5 * yield_strain) == pytest.approx(1.05e8, rel=1e-9)
    one = surface.strained(0.0, 0.0, elastic=0.5 * yield_strain)
    assert one.flow_conductivity(1e8, 1e-3) == pytest.approx(
        float(surface.flow_conductivity(1.05e8, 1e-3)), rel=1e-9
    )
    assert surface.elastic.pressure_at_rest(1e8, 0.0, 0.0, 0.001) == 1e8
