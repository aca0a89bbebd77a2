"""Quantities with units against hand-converted values."""

import contextlib
import math

import pytest
from any_text import ANY
from hypothesis import given
from hypothesis import strategies as st

from fem_seal import units
from fem_seal.errors import QuantityError
from fem_seal.units import DIMENSIONS, parse_quantity


@pytest.mark.parametrize(
    ("text", "dimension", "si"),
    [
        ("20 mm", "length", 0.02),
        ("1.9 um", "length", 1.9e-6),
        ("1.9 µm", "length", 1.9e-6),  # micro sign
        ("1.9 μm", "length", 1.9e-6),  # Greek mu
        ("0.5in", "length", 0.0127),
        ("1 1/2 in", "length", 0.0381),
        ("1-1/2 inch", "length", 0.0381),
        ('3/8"', "length", 0.009525),
        ('2"', "length", 0.0508),
        ("0 K", "temperature", 0.0),
        ("  20   mm ", "length", 0.02),
        ("1e3 1/m", "wavenumber", 1e3),
        ("3.1 1/um", "wavenumber", 3.1e6),
        ("5 m^-1", "wavenumber", 5.0),
        ("5 rad/m", "wavenumber", 5.0),
        ("45 deg", "angle", math.pi / 4),
        ("45°", "angle", math.pi / 4),
        ("20 bar", "pressure", 20e5),
        ("1 N/mm^2", "pressure", 1e6),
        ("1 kgf/cm^2", "pressure", 98066.5),
        ("1 psi", "pressure", 6894.757293168361),
        ("1 atm", "pressure", 101325.0),
        ("1 mPa s", "viscosity", 1e-3),
        ("46 cP", "viscosity", 0.046),
        ("1 kg/(m s)", "viscosity", 1.0),
        ("-1.5 kN", "force", -1500.0),
        ("−1.5 kN", "force", -1500.0),  # the minus of print, as messages and reports have it
        ("−40 °C", "temperature", 233.15),
        ("1 lbf", "force", 4.4482216152605),
        ("1e6 nm^4", "spectral density", 1e-30),
        ("1 micron", "length", 1e-6),
        ("1 angstrom", "length", 1e-10),
        ("1 Å", "length", 1e-10),
        ("1 cm", "length", 0.01),
        ("1 ft", "length", 0.3048),
        ("1 hPa", "pressure", 100.0),
        ("1 kPa", "pressure", 1e3),
        ("3.5 GPa", "pressure", 3.5e9),
        ("1 TPa", "pressure", 1e12),
        ("1 ksi", "pressure", 6894757.293168361),
        ("1 kgf", "force", 9.80665),
        ("1 P", "viscosity", 0.1),
        ("1 l/s", "leak rate", 1e-3),
        ("60 ml/min", "leak rate", 1e-6),
        ("3.6 L/h", "leak rate", 1e-6),
        ("1 mm^3/s", "leak rate", 1e-9),
        ("1 mm3/s", "leak rate", 1e-9),
        ("1 cm3/s", "leak rate", 1e-6),
        ("60 cc/min", "leak rate", 1e-6),
        ("2 W/(m2 K)", "heat transfer", 2.0),
        ("20 degC", "temperature", 293.15),
        ("-40 °C", "temperature", 233.15),
        ("-40 degF", "temperature", 233.15),
        ("-40 °F", "temperature", 233.15),
        ("212 degF", "temperature", 373.15),
        ("32 °F", "temperature", 273.15),
        ("-459.67 degF", "temperature", 0.0),
        ("77.36 K", "temperature", 77.36),
    ],
)
def test_value_in_si(text, dimension, si):
    # one rounding of the decimal text, none of the factor
    assert parse_quantity(text, dimension) == pytest.approx(si, rel=2e-16)


@pytest.mark.parametrize(
    ("text", "dimension", "said"),
    [
        ("20", "length", "no unit"),
        (20, "length", "no unit"),
        (20.5, "pressure", "no unit"),
        (True, "length", "not a quantity"),
        (None, "length", "not a quantity"),
        ([1], "length", "not a quantity"),
        ("20 mm", "pressure", "does not fit"),
        ("20 mpa", "pressure", "mPa or MPa"),
        ("1,5 mm", "length", "decimal comma"),
        ("nan mm", "length", "not a finite number"),
        ("inf mm", "length", "not a finite number"),
        ("1e999 mm", "length", "not a finite number"),
        ("mm", "length", "does not begin with a number"),
        ("", "length", "does not begin with a number"),
        ("45 mm/m", "angle", "does not fit"),
        ("0.7", "angle", "no unit"),
        ("20", "temperature", "no unit"),
        ("1e3", "temperature", "no unit"),
        ("20 bar", "temperature", 'unit "bar" is no temperature'),
        ("9**9**9 m", "length", "not a number followed by a unit"),
        ("2 m^9^9", "length", "not a number followed by a unit"),
        ("1/0 m", "length", "not a number followed by a unit"),
        ("1 " + "m" * 100000, "length", "not a number followed by a unit"),
    ],
)
def test_message_names_what_is_wrong_and_what_is_allowed(text, dimension, said):
    with pytest.raises(QuantityError) as caught:
        parse_quantity(text, dimension)
    assert said in str(caught.value)
    assert DIMENSIONS[dimension].examples[0] in str(caught.value)


@given(
    st.text(ANY, max_size=80)
    | st.from_regex(r"[0-9.e+-]{1,6} ?[a-zA-Z^*/()· 0-9°µ-]{0,20}", fullmatch=True, alphabet=ANY)
)
def test_any_text_is_a_number_or_a_quantity_error(text):
    for dimension in DIMENSIONS:
        with contextlib.suppress(QuantityError):
            assert math.isfinite(parse_quantity(text, dimension))


@given(st.floats(-1e30, 1e30, allow_subnormal=False))
def test_si_text_round_trips(value):
    assert parse_quantity(f"{value!r} m", "length") == value


@pytest.mark.parametrize("dimension", sorted(units._TABLES["plain"]))
def test_usual_units_are_those_of_the_registry(dimension):
    for unit in units._TABLES["plain"][dimension]:
        assert units._factor(unit, dimension) == units._registered_factor(unit, dimension), unit
