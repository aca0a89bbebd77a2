"""Leakage classes: the tables of the standards, read independently of the code."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import leak
from leak.standards import (
    BUBBLE_VOLUME,
    DROP_VOLUME,
    STANDARDS,
    class_per_length,
    invisible_leak_rate,
    read_nominal_size,
    standard_named,
    visible_leak_rate,
)


def limits(nominal_size: float, **options) -> dict[tuple[str, str], float]:
    return {(one.standard, one.name): one.leak_rate for one in leak.leakage_limits(nominal_size, **options)}


@pytest.mark.parametrize(
    ("name", "drops", "bubbles"),
    # ISO 5208 for DN 50 in drops/min and bubbles/min, from a table of a trade site (piping-world.com), two digits
    [
        ("AA", 0.3, 8.7),
        ("B", 0.48, 14.4),
        ("C", 1.44, 144.0),
        ("CC", 3.84, 1070.0),
        ("D", 4.8, 1440.0),
        ("E", 14.4, 14400.0),
        ("EE", 18.7, 22560.0),
        ("F", 48.0, 144000.0),
        ("G", 96.0, 288000.0),
    ],
)
def test_iso_5208(name, drops, bubbles):
    liquid, gas = limits(0.05, gas=False), limits(0.05, gas=True)
    assert leak.drops_per_minute(liquid["ISO 5208", name]) == pytest.approx(drops, rel=0.05)
    assert gas["ISO 5208", name] * 60 / DROP_VOLUME == pytest.approx(bubbles, rel=0.01)


@pytest.mark.parametrize(
    ("name", "per_second"), [("B", 0.0046), ("C", 0.0458), ("CC", 0.3407), ("E", 4.5837), ("F", 45.837)]
)
def test_a_bubble_of_iso_5208(name, per_second):
    """Bubbles/s for each mm of DN of a gas, as a comparison of the standards prints them (piping-world.com)."""
    rate = limits(0.001, gas=True)["ISO 5208", name]
    assert rate / STANDARDS["ISO 5208"].bubble_volume == pytest.approx(per_second, rel=5e-3)


def test_bubbles_are_those_of_the_standard_or_those_that_are_given():
    assert [round(one.bubble_volume * 1e6, 3) for one in STANDARDS.values()] == [
        *(0.065, 0.01, 0.15, 0.15, 0.15, 0.15),
        *(0.065, 0.04, 0.3),
    ]
    # one bubble in 15 s
    assert visible_leak_rate(gas=True) * 15e6 == pytest.approx(0.06545, rel=1e-4)
    assert visible_leak_rate(gas=True, bubble_volume=0.15e-6) * 15e6 == pytest.approx(0.15)
    # 12 bubbles/min at DN 80
    own, given_volume = (limits(0.08, gas=True, bubble_volume=one) for one in (None, 0.04e-6))
    assert own["API 598", "metal-seated"] * 60e6 == pytest.approx(0.12)
    assert given_volume["API 598", "metal-seated"] * 60e6 == pytest.approx(0.48)
    assert {key: one for key, one in own.items() if key[0] != "API 598"} == {
        key: one for key, one in given_volume.items() if key[0] != "API 598"
    }
    liquid = [limits(0.08, gas=False, bubble_volume=one) for one in (None, 0.04e-6)]
    assert liquid[0] == liquid[1]


@pytest.mark.parametrize(
    ("dn", "drops", "bubbles"), [(50, 0, 4), (65, 5, 10), (80, 6, 12), (100, 8, 16), (300, 24, 48)]
)
def test_api_598(dn, drops, bubbles):
    name = ("API 598", "metal-seated")
    assert leak.drops_per_minute(limits(dn * 1e-3, gas=False)[name]) == pytest.approx(drops)
    # 100 bubbles are 1 ml in this standard
    assert limits(dn * 1e-3, gas=True)[name] * 60e6 * 100 == pytest.approx(bubbles)


def test_fci_70_2_class_five():
    """0.0005 ml/min per inch of orifice and psi of water; 4.7 ml/min per inch of air."""
    inch, psi = 0.0254, 6894.757
    liquid = limits(0.05, gas=False, pressure_drop=100 * psi, seat_diameter=2 * inch)["FCI 70-2", "V"]
    # the metric figure of the standard, 5e-12 m3/s per mm and bar, is a rounding of the inch one (5.0e-4 -> 4.76e-12)
    assert liquid * 60e6 == pytest.approx(0.0005 * 2 * 100, rel=0.06)
    gas = limits(0.05, gas=True, seat_diameter=2 * inch)["FCI 70-2", "V"]
    assert gas * 60e6 == pytest.approx(9.4)
    assert gas * 3600 == pytest.approx(11.1e-6 * 50.8, rel=1e-3)


@pytest.mark.parametrize(
    ("mm", "rate"),
    [
        (10, 0.15),
        (25, 0.15),
        (51, 0.45),
        (76, 0.9),
        (400, 28.4),
        # a row holds within 2 mm, above and below, the last one too
        (27, 0.15),
        (36, 0.30),
        (49, 0.45),
        (53, 0.45),
        (402, 28.4),
        # between rows with the square of the diameter: 0.15 + 0.15 (31.5² - 25²)/(38² - 25²)
        (31.5, 0.217262),
        # 1.70 + 2.30 (127² - 102²)/(152² - 102²), where a straight line would allow 4 % more
        (127, 2.736811),
        (177.5, 5.276232),
    ],
)
def test_fci_70_2_class_six(mm, rate):
    found = limits(0.05, gas=True, seat_diameter=mm * 1e-3)["FCI 70-2", "VI"]
    assert leak.millilitres_per_minute(found) == pytest.approx(rate, rel=2e-6)
    assert leak.bubbles_per_minute(0.45e-6 / 60) == pytest.approx(3.0)


def test_fci_70_2_needs_its_data():
    assert ("FCI 70-2", "VI") not in limits(0.5, gas=True)
    assert ("FCI 70-2", "VI") not in limits(0.4, gas=True, seat_diameter=0.4021)
    assert not [key for key in limits(0.05, gas=False) if key[0] == "FCI 70-2"]
    shares = limits(0.05, gas=False, rated_capacity=1.0)
    assert [shares["FCI 70-2", name] for name in ("IV", "III", "II")] == [1e-4, 1e-3, 5e-3]


@given(rate=st.floats(0.0, 1e-3), dn=st.floats(0.006, 1.0), gas=st.booleans())
def test_the_class_found_is_the_tightest_met(rate, dn, gas):
    found = {one.standard: one for one in leak.leakage_class(rate, dn, gas=gas, pressure_drop=1e6)}
    for standard, one in found.items():
        rates = [
            other.leak_rate
            for other in leak.leakage_limits(dn, gas=gas, pressure_drop=1e6)
            if other.standard == standard
        ]
        met = [limit for limit in rates if rate <= (limit or invisible_leak_rate(gas=gas))]
        assert one.limit == (min(met) if met else None)
        assert (one.name is None) == (not met)


@pytest.mark.parametrize("gas", [False, True])
def test_en_12266_1_has_the_rates_of_iso_5208_with_one_letter(gas):
    found = limits(0.08, gas=gas)
    for name in "ABCDEFG":
        assert found["EN 12266-1", name] == found["ISO 5208", name]
    assert [name for standard, name in found if standard == "EN 12266-1"] == list("ABCDEFG")


def test_mss_sp_61():
    """Drops/min and bubbles/min of 0.04 ml per inch, as a comparison of standards prints them (piping-world.com)."""
    name = ("MSS SP-61", "metal-seated")
    for dn, nps in ((50, 2), (80, 3), (100, 4), (150, 6)):
        liquid, gas = (limits(dn * 1e-3, gas=gas)[name] for gas in (False, True))
        assert leak.drops_per_minute(liquid) == pytest.approx(2.66 * nps, rel=5e-3)
        assert leak.bubbles_per_minute(gas, STANDARDS[name[0]].bubble_volume) == pytest.approx(
            1180 * nps, rel=1e-3
        )
        assert liquid * 3600e6 == pytest.approx(10 * nps)
        assert gas * 3600 == pytest.approx(0.1 * 0.3048**3 * nps)


@pytest.mark.parametrize(
    ("psi", "small", "large"),
    [
        *((15, 40, 20), (1000, 40, 20), (1499, 40, 20), (1500, 60, 30), (2000, 80, 40), (2500, 100, 50)),
        *((3000, 100, 60), (4000, 100, 80), (5000, 100, 100), (6000, 100, 100)),
    ],
)
def test_api_527(psi, small, large):
    """Bubbles/min of 0.3 ml by set pressure; 0.60 ft^3 in 24 h are 40 of them to 2 %."""
    name, set_pressure = ("API 527", "metal-seated"), psi * 6894.757
    for mm, bubbles in ((15.8, small), (16.0, large)):
        rate = limits(0.05, gas=True, seat_diameter=mm * 1e-3, set_pressure=set_pressure)[name]
        assert rate == pytest.approx(bubbles * 0.3e-6 / 60)
        assert rate * 86400 == pytest.approx(bubbles / 40 * 0.60 * 0.3048**3, rel=0.02)
    for dn, inches in ((15, 1.0), (25, 1.0), (50, 2.0)):
        assert limits(dn * 1e-3, gas=False, set_pressure=set_pressure)[name] * 3600e6 == pytest.approx(
            10 * inches
        )
    assert name not in limits(0.05, gas=True)
    assert name not in limits(0.05, gas=True, set_pressure=6001 * 6894.757)
    assert name not in limits(0.05, gas=True, set_pressure=14.9 * 6894.757)


def test_the_tests_of_the_standards():
    """1.1 times the rated pressure of liquid, 6 bar of gas, 90 % of the set pressure or 5 psi below it."""
    for name in ("ISO 5208", "EN 12266-1", "API 598", "MSS SP-61"):
        liquid, gas = STANDARDS[name].tests
        assert (liquid.gas, gas.gas) == (False, True)
        assert liquid.pressure(40e5) == pytest.approx(44e5)
        assert 5e5 < gas.pressure(40e5) < 7e5
        assert gas.pressure(2e5) == pytest.approx(2.2e5)
    psi = 6894.757
    for one in STANDARDS["API 527"].tests:
        for set_pressure, test in ((100, 90), (50, 45), (30, 25), (15, 10)):
            assert one.pressure(set_pressure * psi) == pytest.approx(test * psi, rel=1e-4)
    assert {name for name, one in STANDARDS.items() if not one.tests} == {
        "VDI 2440",
        "EN 13555",
        "ISO 15848-1",
    }


@pytest.mark.parametrize("gas", [True, False])
def test_a_leak_is_called_invisible_where_nobody_sees_it(gas):
    assert leak.leakage_class(0.0, 0.025, gas=gas)[0].name == "A"
    unseen = invisible_leak_rate(gas=gas)
    assert leak.leakage_class(0.99 * unseen, 0.025, gas=gas)[0].name == "A"
    assert leak.leakage_class(1.01 * unseen, 0.025, gas=gas)[0].name == "AA"
    # of an interval both ends count
    found = leak.leakage_class(0.5 * unseen, 0.025, gas=gas, highest=2 * unseen)[0]
    assert str(found) == "ISO 5208 between A and AA"
    # in 10 min a bubble of 5 mm, or a droplet of 0.1 mm
    diameter = (600 * unseen * 6 / math.pi) ** (1 / 3)
    assert diameter == pytest.approx(5e-3 if gas else 1e-4, rel=1e-3)
    assert unseen < visible_leak_rate(gas=gas) / 30


@pytest.mark.parametrize("volume", [0.0, -1e-9, math.nan])
@pytest.mark.parametrize("rate", [invisible_leak_rate, visible_leak_rate])
def test_a_bubble_has_a_volume(rate, volume):
    with pytest.raises(leak.FluidError, match="bubble_volume"):
        rate(gas=True, bubble_volume=volume)


def test_a_leak_that_is_seen_meets_no_class():
    assert str(leak.leakage_class(1.0, 0.025, gas=False)[0]) == "ISO 5208: no class met"


def test_iso_5208_coefficients():
    """Table of ISO 5208: mm^3/s times DN, liquid and gas, as printed."""
    printed = {
        "AA": (0.006, 0.18),
        "B": (0.01, 0.3),
        "C": (0.03, 3),
        "CC": (0.08, 22.3),
        "D": (0.1, 30),
        "E": (0.3, 300),
        "EE": (0.39, 470),
        "F": (1, 3000),
        "G": (2, 6000),
    }
    for gas in (False, True):
        found = limits(0.04, gas=gas)
        for name, coefficients in printed.items():
            assert found["ISO 5208", name] == pytest.approx(40e-9 * coefficients[gas], rel=1e-12)


def test_fci_70_2_class_six_as_printed():
    """Seat diameter [mm] and ml/min of air."""
    printed = (
        "25 .15, 38 .30, 51 .45, 64 .60, 76 .90, 102 1.70, 152 4.00, 203 6.75, 250 11.1, 300 16.0, 350 21.6"
    )
    for line in printed.split(", "):
        mm, rate = map(float, line.split())
        found = limits(0.05, gas=True, seat_diameter=mm * 1e-3)["FCI 70-2", "VI"]
        assert found * 60e6 == pytest.approx(rate, rel=1e-9)


def test_units():
    assert leak.millibar_litres_per_second(0.1) == pytest.approx(1.0)
    assert leak.drops_per_minute(1e-6 / 60, 0.05e-6) == pytest.approx(20.0)
    assert pytest.approx(0.0625e-6) == DROP_VOLUME
    assert pytest.approx(0.15e-6) == BUBBLE_VOLUME


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("DN25", 0.025),
        ("dn 100", 0.1),
        ("NPS 1", 0.025),
        ("NPS 1 1/2", 0.04),
        ("NPS 2-1/2", 0.065),
        ("nps 3/4", 0.02),
        ("NPS 12", 0.3),
        ("NPS 2.5", 0.065),
        ("25 mm", None),
        ("DN", None),
        ("DN 0", None),
        ("NPS", None),
        ("NPS 1/0", None),
    ],
)
def test_nominal_sizes(text, size):
    assert read_nominal_size(text) == (size if size is None else pytest.approx(size))


def test_nominal_size_of_a_bore():
    assert [leak.nominal_size_of_bore(d) for d in (0.0265, 0.049, 0.09)] == pytest.approx([0.025, 0.05, 0.1])


def test_every_standard_names_its_source():
    limits = leak.leakage_limits(0.1, gas=True, seal_length=0.1, density=0.17, set_pressure=1e6)
    assert {one.standard for one in limits} == set(STANDARDS)
    assert all("secondary" in one.source and one.revision for one in STANDARDS.values())


@pytest.mark.parametrize(
    "change",
    [{"nominal_size": 0.0}, {"pressure_drop": -1.0}, {"rated_capacity": 0.0}, {"bubble_volume": 0.0}],
)
def test_wrong_input(change):
    given = {"nominal_size": 0.025, "gas": False} | change
    with pytest.raises(leak.FluidError, match=next(iter(change))):
        leak.leakage_limits(**given)
    with pytest.raises(leak.FluidError, match="leak_rate"):
        leak.leakage_class(-1.0, 0.025, gas=False)


def test_classes_per_length_are_rates_times_the_length():
    """1e-4 mbar l/(s m) is 1e-5 Pa m^3/(s m); 1.78e-6 mbar l/s per mm of diameter, 1e-4 mg/(s m) at 0 degC."""
    length, density = 0.25, 0.1785
    limits = leak.leakage_limits(0.1, gas=True, seal_length=length, density=density)
    found = {(one.standard, one.name): one.leak_rate for one in limits}
    assert found["VDI 2440", "TA Luft"] * 101325 == pytest.approx(1e-5 * length)
    for name, rate in (("L1.0", 1.0), ("L0.1", 0.1), ("L0.01", 0.01)):
        assert found["EN 13555", name] * density == pytest.approx(1e-6 * rate * length)
    assert found["ISO 15848-1", "BH"] * density == pytest.approx(1e-10 * length, rel=0.01)
    assert [name for standard, name in found if standard == "ISO 15848-1"] == ["AH", "BH", "CH"]
    liquid = leak.leakage_limits(0.1, gas=False, seal_length=length, density=density)
    assert not {one.standard for one in liquid} & {"VDI 2440", "EN 13555", "ISO 15848-1"}


def test_the_class_of_a_flange():
    (german, european) = class_per_length(2e-12, 0.1, density=0.17)
    assert (german.name, european.name) == ("TA Luft", "L0.01")
    (german, european) = class_per_length(2e-12, 0.1, density=0.17, highest=1e-7)
    assert (german.at_best, german.name, european.name) == ("TA Luft", None, "L1.0")
    assert standard_named("DIN EN 13555") == standard_named("EN 1591-1:2013") == "EN 13555"
    with pytest.raises(leak.FluidError, match="seal_length"):
        class_per_length(1e-9, 0.0)
