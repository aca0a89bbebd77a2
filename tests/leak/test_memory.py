"""A contact that was pressed harder before: the pressure of first loading that stands for it, and the leak integral."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from paper_surface import HARDNESS, spectrum, surface

import leak

READINGS = ("conserved", "capped")
X = np.linspace(-1e-3, 1e-3, 201)
ETA, DROP, R0 = 1e-3, 2e6, 0.014


@cache
def rough(yielding: str) -> leak.RoughContact:
    return surface(hardness=HARDNESS, yielding=yielding)


@cache
def table(yielding: str) -> leak.ConductivityTable:
    return rough(yielding).conductivity_table(1e2, 1e9, 80)


def gaussian(peak: float, width: float = 2e-4) -> np.ndarray:
    return peak * np.exp(-((X / width) ** 2))


def leak_rate(yielding: str, p: np.ndarray, largest: np.ndarray | None) -> float:
    sigma = table(yielding).at(ETA)
    return leak.leak_flow(X, p, sigma, DROP, R0, largest_pressure=largest).leak_rate


def first_loading(yielding: str, p: object, largest: object) -> np.ndarray:
    found = table(yielding).first_loading(np.log(np.asarray(p)), np.log(np.asarray(largest)))
    return np.exp(found)


# ------------------------------------------------------------------ the pressure of first loading


@pytest.mark.parametrize("yielding", READINGS)
@pytest.mark.parametrize("largest", [3e6, 6e7, 7e8])
def test_lets_as_much_through_as_the_contact_itself(yielding: str, largest: float) -> None:
    p = largest * np.exp(-np.array([0.02, 0.3, 1.0, 3.0, 7.0, 12.0]))
    direct = np.asarray(rough(yielding).effective_separation(p, largest=largest))
    mapped = table(yielding).effective_separation(first_loading(yielding, p, np.full(p.shape, largest)))
    # of the table of the memory and of that of u_eff
    np.testing.assert_allclose(mapped, direct, rtol=5e-4)


@pytest.mark.parametrize("yielding", READINGS)
def test_is_first_loading_where_nothing_larger_was_carried(yielding: str) -> None:
    p = np.geomspace(1e3, 9e8, 40)
    for earlier in (p, 0.5 * p):
        np.testing.assert_array_equal(table(yielding).first_loading(np.log(p), np.log(earlier)), np.log(p))
    u = np.asarray(rough(yielding).effective_separation(p[:8]))
    np.testing.assert_array_equal(u, rough(yielding).effective_separation(p[:8], largest=0.5 * p[:8]))


@pytest.mark.parametrize("yielding", READINGS)
def test_rises_with_both_pressures_and_stays_between_them(yielding: str) -> None:
    p, largest = np.geomspace(1e2, 9e8, 60)[:, None], np.geomspace(1e5, 9.9e8, 50)[None, :]
    found = first_loading(yielding, p, largest)
    most = np.maximum(p, largest)
    assert np.all((found >= p * (1 - 1e-12)) & (found <= most * (1 + 1e-12)))
    assert np.all(np.diff(np.log(found), axis=0) > 0)
    assert np.all(np.diff(np.log(found), axis=1) > -1e-7)


@pytest.mark.parametrize("yielding", READINGS)
def test_no_energy_is_gained_over_a_loop(yielding: str) -> None:
    p = np.geomspace(1e5, 5e8, 8)
    loading = np.asarray(rough(yielding).mean_separation(p))
    unloading = np.asarray(rough(yielding).mean_separation(p, largest=p[-1]))
    assert np.all(unloading[:-1] < loading[:-1])
    assert unloading[-1] == pytest.approx(loading[-1], rel=1e-7)
    assert np.all(np.diff(unloading) < 0)


def test_knows_no_lengths_and_no_pressures_of_its_own() -> None:
    length, pressure = 7.0, 0.1
    q = {"q_low": 1e3 / length, "q_rolloff": 37268.0 / length, "q_high": 3141592.6 / length}
    larger = spectrum(rms_height=1.9e-6 * length, **q)
    for yielding in READINGS:
        scaled = leak.RoughContact(
            larger, effective_modulus=115e9 * pressure, hardness=HARDNESS * pressure, yielding=yielding
        )
        p, most = np.array([1e6, 3e7, 2e8]), 4e8
        u = np.asarray(rough(yielding).effective_separation(p, largest=most))
        other = scaled.effective_separation(pressure * p, largest=pressure * most)
        np.testing.assert_allclose(other, length * u, rtol=1e-9)
        # p* of tables over the same range in units of the modulus
        memory = scaled.conductivity_table(1e2 * pressure, 1e9 * pressure, 80).memory
        assert memory is not None
        found = np.exp(memory.first_loading(np.log(pressure * p), np.log(pressure * most)))
        np.testing.assert_allclose(found, pressure * first_loading(yielding, p, most), rtol=1e-7)


def test_elastic_asperities_remember_nothing() -> None:
    elastic = surface()
    p = np.array([1e6, 1e7])
    np.testing.assert_array_equal(
        elastic.effective_separation(p), elastic.effective_separation(p, largest=1e9)
    )
    memory = elastic.conductivity_table(1e4, 1e8, 16).memory
    assert memory is not None
    np.testing.assert_array_equal(memory.first_loading(np.log(p), np.log(1e9)), np.log(p))


@pytest.mark.parametrize("yielding", READINGS)
def test_pressed_flat_it_stays_shut(yielding: str) -> None:
    assert rough(yielding).effective_separation(1e6, largest=1.01 * HARDNESS) == 0.0
    found = first_loading(yielding, 1e6, 1.01 * HARDNESS)
    # a table of the elastic surface of equal gaps is asked at the pressure that acts on that one
    assert table(yielding).table_log_p(np.log(found)) > np.log(table(yielding).sealing_pressure)
    assert table(yielding).effective_separation(found) == 0.0
    wide = rough(yielding).conductivity_table(1e2, HARDNESS).at(ETA)
    p, earlier = gaussian(5e7), gaussian(1.1 * HARDNESS)
    assert leak.leak_flow(X, p, wide, DROP, R0, largest_pressure=earlier).leak_rate == 0.0


@pytest.mark.parametrize("yielding", READINGS)
def test_seals_at_less_pressure_than_the_first_time(yielding: str) -> None:
    contact = rough(yielding)
    largest = 1.01 * contact.sealing_pressure
    pressure = contact.sealing_pressure * np.array([1e-8, 0.95])
    first = np.asarray(contact.effective_separation(pressure))
    after = np.asarray(contact.effective_separation(pressure, largest=largest))
    assert first[0] > after[0] > 0.0 and first[1] > 0.0 == after[1]


def test_both_readings_spring_back_alike() -> None:
    """Of what does not come back C_pl says nothing: both have it of direct simulation."""
    p, most = np.geomspace(1e5, 1e8, 7), 3e8
    same = [np.asarray(rough(one).equivalent_first_loading_pressure(p, most)) for one in READINGS]
    np.testing.assert_array_equal(*same)
    capped = rough("capped")
    np.testing.assert_allclose(
        capped.equivalent_pressure(same[0]), capped._equivalent(p, np.full(p.shape, most)), rtol=1e-12
    )


# ------------------------------------------------------------------ the leak integral


@pytest.mark.parametrize("yielding", READINGS)
def test_equals_first_loading_bit_by_bit_where_nothing_larger_was_carried(yielding: str) -> None:
    p = gaussian(5e7)
    for earlier in (0.4 * p, np.zeros_like(p)):
        assert leak_rate(yielding, p, earlier) == leak_rate(yielding, p, None)
    assert leak_rate(yielding, p, p) == pytest.approx(leak_rate(yielding, p, None), rel=1e-12)


@pytest.mark.parametrize("yielding", READINGS)
def test_leaks_less_the_harder_it_was_pressed(yielding: str) -> None:
    p = gaussian(5e7)
    rates = [leak_rate(yielding, p, gaussian(earlier, 2.2e-4)) for earlier in (4e7, 6e7, 1e8, 2e8, 4e8)]
    assert rates[0] <= leak_rate(yielding, p, None)
    assert np.all(np.diff(rates) < 0)
    after = [leak_rate(yielding, gaussian(peak), gaussian(2e8, 2.2e-4)) for peak in (1e7, 3e7, 9e7, 2e8)]
    assert np.all(np.diff(after) < 0)


@pytest.mark.parametrize("yielding", READINGS)
def test_integrates_the_conductivity_of_every_place(yielding: str) -> None:
    """An earlier contact that was wider on one side, and did not reach the other one."""
    p = gaussian(4e7)
    earlier = 1.2e8 * np.exp(-(((X - 1.5e-4) / 3e-4) ** 2))
    found = leak.leak_flow(X, p, table(yielding).at(ETA), DROP, R0, largest_pressure=earlier)
    # the same places, each by the theory itself; ends far out, where the gap resists nothing
    fine = np.linspace(-1.8e-3, 1.8e-3, 361)
    here = 4e7 * np.exp(-((fine / 2e-4) ** 2))
    most = np.maximum(here, 1.2e8 * np.exp(-(((fine - 1.5e-4) / 3e-4) ** 2)))
    u = np.asarray(rough(yielding).effective_separation(np.maximum(here, 1e-30), largest=most))
    resistance = np.trapezoid(12 * ETA / (2 * np.pi * R0 * u**3), fine)
    assert found.resistance == pytest.approx(
        resistance, rel=3e-3
    )  # the trapezoidal rule where both loads cross


def test_a_uniform_contact_is_that_of_first_loading_at_its_pressure() -> None:
    flat, most = np.full(5, 2e7), np.full(5, 9e7)
    x = np.linspace(0, 1e-3, 5)
    equal = np.full(5, float(first_loading("capped", 2e7, 9e7)))
    sigma = table("capped").at(ETA)
    after = leak.leak_flow(x, flat, sigma, DROP, R0, largest_pressure=most)
    assert after.leak_rate == pytest.approx(leak.leak_flow(x, equal, sigma, DROP, R0).leak_rate, rel=1e-12)
    helium, contact = leak.gas("helium"), rough("capped")
    of_gas = [
        leak.gas_leak_flow(x, p, contact, helium, 2e5, 0.0, R0, largest_pressure=largest)
        for p, largest in ((flat, most), (equal, None))
    ]
    assert of_gas[0].mass_flow == pytest.approx(of_gas[1].mass_flow, rel=1e-6)  # tables of two ranges
    assert of_gas[0].knudsen_number == pytest.approx(of_gas[1].knudsen_number, rel=1e-6)


@pytest.mark.parametrize(
    ("largest", "said"),
    [
        (np.full(3, 1e7), r"largest_pressure has shape \(3,\)"),
        (np.where(X == 0, np.nan, 1e7), r"largest_pressure\[100\] = nan"),
        (-gaussian(1e7), r"largest_pressure\[0\] = -"),
        ("high", "largest_pressure must be"),
    ],
)
def test_refuses_pressures_that_are_none(largest: object, said: str) -> None:
    with pytest.raises(leak.ProfileError, match=said):
        leak.leak_flow(X, gaussian(1e7), table("capped").at(ETA), DROP, R0, largest_pressure=largest)  # type: ignore[arg-type]


def test_refuses_a_conductivity_that_knows_no_memory() -> None:
    p = gaussian(1e7)
    with pytest.raises(leak.ProfileError, match="says nothing of a contact that was pressed harder"):
        leak.leak_flow(X, p, lambda p: 1e-9 / p, DROP, R0, largest_pressure=2 * p)
    known = table("capped")
    bare = leak.ConductivityTable(known.pressure, known.separation, known.sealing_pressure, known.p_max)
    with pytest.raises(leak.ConductivityError, match="memory = None"):
        leak.leak_flow(X, p, bare.at(viscosity=ETA), DROP, R0, largest_pressure=2 * p)
