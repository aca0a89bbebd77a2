"""Units of the field: normal volumes, bubbles, gauge and absolute pressures; conversions calculated by hand."""

from __future__ import annotations

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sample_results import case

from fem_seal.case.fields import Bubbles, LeakRate, NormalVolume, Throughput
from fem_seal.case.notation import as_differences
from fem_seal.errors import InputError

RATE = LeakRate("leak rate", "1e-30 m^3/s", "1e3 m^3/s")


def required(text, fluid=None, **table):
    return case(fluid=fluid or {"name": "nitrogen"}, requirement={"leak_rate": text, **table}).requirement


def refused(**tables):
    with pytest.raises(InputError) as caught:
        case(**tables)
    return {one.key: one.message for one in caught.value.problems}


@pytest.mark.parametrize(
    ("text", "millilitres_per_minute"),
    # at 0 °C
    [
        ("1 sccm", 1.0),
        ("1 SCCM", 1.0),
        ("2 sccs", 120.0),
        ("0.5 slm", 500.0),
        ("0.5 slpm", 500.0),
        ("1 Nml/min", 1.0),
        ("1 N ml/min", 1.0),
        ("6 Nl/h", 100.0),
        ("0.06 Nm^3/h", 1000.0),
        ("0.06 Nm3/h", 1000.0),
        ("3 standard ml/min", 3.0),
        ("3 normal cm^3/min", 3.0),
    ],
)
def test_n_is_normal_and_a_standard_volume_is_that_at_0_degc(text, millilitres_per_minute):
    found = RATE.read(text)
    assert isinstance(found, NormalVolume)
    assert found.normal * 60e6 == pytest.approx(millilitres_per_minute, rel=1e-12)
    # 20 °C: 293.15/273.15 of the volume; 200 °C: 473.15/273.15
    for degc, ratio in ((0, 1.0), (20, 1.0732199), (200, 1.7321984)):
        fluid = {"name": "nitrogen", "temperature": f"{degc} degC"}
        limit = required(text, fluid).leak_rate
        assert limit * 60e6 == pytest.approx(millilitres_per_minute * ratio, rel=1e-7)


def test_newton_is_no_leak_rate():
    for text in ("1 N/s", "1 N m/min", "1 Nm/s", "1 kN/min", "1 sccm/min", "1 N"):
        with pytest.raises(ValueError, match="leak rate"):
            RATE.read(text)


@given(number=st.floats(1e-6, 1e6), degc=st.floats(-20, 200))
def test_a_normal_volume_comes_back_from_any_temperature(number, degc):
    read = RATE.read(f"{number!r} sccm")
    warm = NormalVolume.at(read.normal, degc + 273.15)
    assert warm * 273.15 / (degc + 273.15) * 60e6 == pytest.approx(number, rel=1e-12)
    assert pickle.loads(pickle.dumps(warm)).normal == read.normal
    # the same flow as pressure times volume: 101325 Pa times the volume at the gas's temperature
    throughput = RATE.read(f"{float(warm) * 101325!r} Pa m^3/s")
    assert isinstance(throughput, Throughput) and throughput == pytest.approx(float(warm), rel=1e-12)


@given(count=st.integers(1, 10_000), volume=st.floats(0.01, 1.0))
def test_bubbles_have_the_volume_of_the_requirement(count, volume):
    read = RATE.read(f"{count} bubbles/min")
    assert isinstance(read, Bubbles)
    told = Bubbles.of(read.count, volume * 1e-6)
    assert told * 60e6 == pytest.approx(count * volume, rel=1e-12)


def test_a_bubble_needs_a_volume():
    assert required("5 bubbles/min", bubble_volume="0.15 ml").leak_rate * 60e6 == pytest.approx(0.75)
    # that of the standard beside it
    both = required("1 bubble/min", standard="API 598")
    assert both.leak_rate * 60e6 == pytest.approx(0.01)
    wrong = refused(fluid={"name": "air"}, requirement={"leak_rate": "5 bubbles/min"})
    assert "requirement.bubble_volume" in wrong["requirement.leak_rate"]
    # a target alone has no limit beside it, and no table that could hold the volume
    alone = refused(
        fluid={"name": "air"}, load={"fluid_pressure": "5 bar", "target_leak_rate": "5 bubbles/min"}
    )
    assert 'give a volume over time, such as "0.1 ml/min"' in alone["load.target_leak_rate"]
    assert "bubble_volume" not in alone["load.target_leak_rate"]
    # of a liquid it is the bubbles that are wrong, not their volume
    assert (
        "the fluid is a liquid"
        in refused(requirement={"leak_rate": "5 bubbles/min"})["requirement.leak_rate"]
    )
    water = refused(requirement={"leak_rate": "5 bubbles/min", "bubble_volume": "0.1 ml"})
    assert {"requirement.leak_rate", "requirement.bubble_volume"} <= water.keys()
    assert (
        "and the fluid is a liquid" in refused(requirement={"leak_rate": "1 sccm"})["requirement.leak_rate"]
    )


def test_a_limit_in_normal_volume_follows_the_temperature_of_a_changed_case():
    cold = case(fluid={"name": "nitrogen", "temperature": "0 degC"}, requirement={"leak_rate": "1 Nml/min"})
    hot = cold.replace({"fluid.temperature": "273.15 degC"})
    assert cold.requirement.leak_rate * 60e6 == pytest.approx(1.0, rel=1e-12)
    assert hot.requirement.leak_rate * 60e6 == pytest.approx(2.0, rel=1e-12)
    film = case(
        closure={"shape": "ball", "radius": "20 mm", "material": "316L"},
        seat={"shape": "cone", "angle": "45 deg", "material": "316L"},
        fluid={"name": "nitrogen"},
        temperature={"uniform": "200 degC"},
        load={"fluid_pressure": "5 bar", "target_leak_rate": "1 sccm"},
        requirement={"leak_rate": "1 sccm"},
    )
    for limit in (film.requirement.leak_rate, film.load.target_leak_rate):
        assert limit * 60e6 == pytest.approx(473.15 / 273.15, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "outlet", "pascal"),
    [
        ("20 barg", None, 20e5),
        ("20 bar(g)", "1 bar", 20e5),
        ("20 bar g", "14.7 psia", 20e5),
        # 300 x 6894.757
        ("300 psig", None, 2068427.19),
        ("21 bara", None, 21e5 - 101325),
        ("21 bar(a)", "1 bar", 20e5),
        ("20 bara", "0 Pa", 20e5),
        # 314.7 x 6894.757 - 14.7 x 6894.757
        ("314.7 psia", "14.7 psia", 2068427.19),
        ("2 MPa(a)", "100 kPa(a)", 1.9e6),
    ],
)
def test_gauge_and_absolute_pressures_become_the_difference_across_the_seal(text, outlet, pascal):
    fluid = {"name": "nitrogen"} if outlet is None else {"name": "nitrogen", "outlet_pressure": outlet}
    found = case(fluid=fluid, load={"fluid_pressure": text}).load.fluid_pressure
    assert found == pytest.approx((pascal,), rel=1e-8)


def test_lists_and_ranges_of_absolute_pressures():
    fluid = {"name": "helium", "outlet_pressure": "1 bara"}
    found = case(fluid=fluid, load={"fluid_pressure": ["2 bara", "5 barg", "6 bar"]}).load.fluid_pressure
    assert found == pytest.approx((1e5, 5e5, 6e5))
    spaced = {"start": "2 bara", "stop": "4 bara", "num": 3}
    assert case(fluid=fluid, load={"fluid_pressure": spaced}).load.fluid_pressure == pytest.approx(
        (1e5, 2e5, 3e5)
    )


def test_a_changed_outlet_changes_what_an_absolute_pressure_is():
    one = case(fluid={"name": "helium"}, load={"fluid_pressure": "20 bara"})
    assert one.replace({"fluid.outlet_pressure": "5 bar"}).load.fluid_pressure == pytest.approx((15e5,))
    assert one.load.fluid_pressure == pytest.approx((20e5 - 101325,))


@pytest.mark.parametrize(
    ("fluid", "text", "remedy"),
    [
        ({"name": "helium", "outlet_pressure": "0 Pa"}, "20 barg", "give the difference"),
        ({"name": "helium", "outlet_pressure": "5 bar"}, "20 barg", "or the absolute pressure in bara"),
        ({"name": "water"}, "20 bara", "give the difference"),
        ({"name": "helium"}, "0.5 bara", "below fluid.outlet_pressure"),
    ],
)
def test_what_has_no_difference_is_refused_with_its_remedy(fluid, text, remedy):
    assert remedy in refused(fluid=fluid, load={"fluid_pressure": text})["load.fluid_pressure"]


def test_the_outlet_is_absolute():
    for text, remedy in (
        ("1 barg", '"2.01325 bara"'),
        ("-0.5 barg", '"0.51325 bara"'),
        ("-2 barg", "no pressure below 0 bara"),
        ("-1 bar", '"0.01325 bar"'),
        ("-3 bar", 'vacuum is "0 bar"'),
    ):
        with pytest.raises(InputError) as caught:
            case(fluid={"name": "helium", "outlet_pressure": text})
        (wrong,) = caught.value.problems
        assert wrong.key == "fluid.outlet_pressure" and wrong.value == f'"{text}"' and remedy in wrong.message
    # a liquid's difference is a gauge pressure where it flows into the open
    assert case(load={"fluid_pressure": "20 barg"}).load.fluid_pressure == (20e5,)


def test_a_gauge_pressure_stays_as_it_is_written():
    written = case(load={"fluid_pressure": "700 barg"})
    assert written.written["load"]["fluid_pressure"] == "700 barg"
    for text in ("2e7 barg", ["6 bar", "2e7 barg"]):
        with pytest.raises(InputError) as caught:
            case(load={"fluid_pressure": text})
        (wrong,) = caught.value.problems
        assert "barg" in wrong.value and '2e7 bar"' not in f"{wrong.value} {wrong.message}"


@given(bar=st.floats(0.1, 1000.0), outlet=st.floats(0.0, 50.0))
def test_an_absolute_pressure_is_the_outlet_and_the_difference(bar, outlet):
    tables, wrong = as_differences(
        {"load": {"fluid_pressure": f"{bar + outlet!r} bara"}},
        {"name": "helium", "outlet_pressure": f"{outlet!r} bar"},
    )
    assert not wrong
    number, unit = tables["load"]["fluid_pressure"].split()
    assert unit == "Pa" and float(number) == pytest.approx(bar * 1e5, rel=1e-9, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "fluid", "name"),
    [
        ("1 mm^3/min", "water", "mm³/min"),
        ("0.3 cm**3/h", "air", "cm³/h"),
        ("3 drops/min", "water", "drops/min"),
        ("5 bubbles/h", "air", "bubbles/min"),
        ("1e-5 Pa m3/s", "helium", "Pa m³/s"),
        ("2 mbar*l/s", "helium", "mbar l/s"),
    ],
)
def test_leak_rates_have_the_unit_of_their_limit(text, fluid, name):
    """However far apart they are, in one unit: that in which the user has written the limit."""
    bubble = {"bubble_volume": "0.15 ml"} if "bubble" in text else {}
    given = case(fluid={"name": fluid}, requirement={"leak_rate": text, **bubble})
    count = float(text.split()[0]) / (60.0 if "bubbles" in text else 1.0)
    display, limit = given.display, given.requirement.leak_rate
    assert display.leak_range(limit, 5).split(maxsplit=1) == [display.leak_range(limit, 5).split()[0], name]
    assert display.unit_for("flow", 1.0).of(limit) == pytest.approx(count, rel=1e-11)
    wide = display.leak_range((1e-7 * limit, 1e7 * limit))
    assert wide.count(name) == 1 and wide.endswith(name)


def test_a_normal_volume_and_a_system_of_units_keep_their_own():
    normal = case(fluid={"name": "air"}, requirement={"leak_rate": "1 Nml/min"})
    us = case(requirement={"leak_rate": "1 mm^3/min"}, report={"units": "US"})
    number = case().replace({"requirement.leak_rate": 2e-9})
    assert [one.display.of_flow for one in (normal, us, number)] == [None] * 3
    of_class = case(
        load={"fluid_pressure": "5 bar", "target_leak_rate": "1 mm^3/min"},
        requirement={"standard": "FCI 70-2", "class": "V"},
    )
    assert of_class.display.of_flow.name == "mm³/min"
