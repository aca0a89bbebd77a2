"""A number has the digits that the mesh leaves it wherever it is told, and enough of them beside a limit."""

from __future__ import annotations

import html
import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st
from judged_loads import SURFACE, judged
from judged_loads import load as judged_load
from sample_results import case, rough_result, tiles_of, with_capped

from fem_seal.answers.closed_forms import derive
from fem_seal.cli import app as cli
from fem_seal.explore.screen import leak_words, shown_load
from fem_seal.output.answer_outputs import pages_of
from fem_seal.output.answers.contact import _width_reason
from fem_seal.output.answers.leak import leakage_lines
from fem_seal.output.answers.variants import variant_table
from fem_seal.output.columns import COLUMNS, in_words
from fem_seal.output.pictures.surface import surface_picture
from fem_seal.output.report.brief import first_line
from fem_seal.output.report.page import comparison_table
from fem_seal.seal.findings import Bounds, Level, Validity, remark
from fem_seal.seal.load_result import DiscretisationError
from fem_seal.seal.problem import SealProblem
from fem_seal.units import LIQUID, Display, digits_at_limit, digits_within, format_digits, round_digits
from fem_seal.validity.checks import contact_cautions

ERRORS = st.floats(1e-6, 2.0)
# Sizes of units in sentences and tables.
UNITS = {
    **{"GPa": 1e9, "MPa": 1e6, "kPa": 1e3, "mm": 1e-3, "µm": 1e-6, "um": 1e-6, "nm": 1e-9},
    **{f"{prefix}l/min": size / 60e3 for prefix, size in (("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9))},
}
_NUMBER = re.compile(r"(?<![\w.])(\d+(?:\.\d+)?)(?: to (\d+(?:\.\d+)?))? (" + "|".join(UNITS) + r")(?!\w)")


def significant(written: str) -> int:
    """Significant digits at least: zeros before the point may be none."""
    whole = written.lstrip("0.").replace(".", "")
    return len(whole if "." in written else whole.rstrip("0"))


def with_too_many_digits(text: str, value: float, digits: int) -> list[str]:
    """Numbers of a text that are this value, written with more digits."""
    found = []
    for *numbers, unit in _NUMBER.findall(text):
        for written in filter(None, numbers):
            last = 10.0 ** -len(written.partition(".")[2])
            is_it = abs(float(written) - value / UNITS[unit]) <= 0.5001 * last
            if is_it and significant(written) > digits:
                found.append(f"{written} {unit}")
    return found


def of_mesh(peak: float, fwhm: float, std: float, leak_rate: float):
    """A result as a mesh this bad would give it."""
    error, result = DiscretisationError(peak, fwhm, std, leak_rate), rough_result()
    loads = tuple(load.with_values(mesh_error=error) for load in result.loads)
    return replace(result.with_answers(accuracy=replace(result.accuracy, error=error)), loads=loads)


def all_words(result) -> str:
    """What is said of a result, sentences and tables."""
    case, load = result.case, result.highest
    cautions = contact_cautions(result.problem, result.loads)
    drawn = surface_picture(result, load)
    assert drawn is not None
    return "\n".join(
        (
            first_line(result),
            *(f"{one.value}; {one.remark}" for one in tiles_of(result).values()),
            *(reason for page in pages_of(result) for reason in page.why),
            *leakage_lines(case, load, result.loads),
            *(f"{one.text()}; {one.reason()}" for one in cautions),
            *(" | ".join(row) for row in variant_table(result).rows),
            *(str(one.in_brief) for one in result.loads),
            *(leak_words(shown_load(one, case), LIQUID) for one in result.loads),
            drawn.caption,
        )
    )


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(peak=ERRORS, fwhm=ERRORS, std=ERRORS, leak_rate=ERRORS)
@example(peak=0.083, fwhm=0.06, std=0.06, leak_rate=0.3)
def test_no_sentence_has_more_digits_than_the_table(peak, fwhm, std, leak_rate):
    result = of_mesh(peak, fwhm, std, leak_rate)
    told = all_words(result)
    for load in result.loads:
        for name in ("peak_pressure_Pa", "fwhm_m", "leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s"):
            column = COLUMNS[name]
            assert not with_too_many_digits(told, column.number(load), column.digits(load))
        assert COLUMNS["peak_pressure_Pa"].digits(load) == digits_within(peak)
        assert COLUMNS["max_von_mises_Pa"].digits(load) == min(3, digits_within(peak))
        assert COLUMNS["leak_rate_high_m3_per_s"].digits(load) == digits_within(leak_rate)


def test_what_is_looked_for_is_found():
    """Otherwise the tests here could not fail."""
    assert with_too_many_digits("it peaks at 7.21 GPa", 7.213e9, 2) == ["7.21 GPa"]
    assert with_too_many_digits("23.1 to 117 ml/min", 117.2e-6 / 60, 2) == ["117 ml/min"]
    assert not with_too_many_digits("it peaks at 7200 MPa, 7.2 GPa or 7.22 GPa", 7.213e9, 2)
    result = of_mesh(0.083, 0.06, 0.06, 0.3)
    peak, width = result.highest.contact.profile.peak_pressure, result.highest.contact.profile.fwhm
    told = all_words(result)
    assert (
        Display().quantity(peak, "worth contact pressure 2") in told
        and Display().quantity(width, "worth length 2") in told
    )
    assert in_words(Display(), result.highest, "peak_pressure_Pa") == Display().quantity(
        peak, "worth contact pressure 2"
    )


def test_a_difference_from_a_closed_form_has_no_more_decimals_than_the_mesh_leaves():
    result, measures = of_mesh(0.02, 4e-3, 1e-5, 0.1), ("peak_pressure", "fwhm", "std")
    sizes = {
        name: SimpleNamespace(**dict.fromkeys(measures, np.full(len(result.loads), size)))
        for name, size in (("calculated", 1.0712), ("hertz", 1.0))
    }
    row = comparison_table(result, sizes).rows[0]
    assert row[1:] == ("+7", "+7.1", "+7.120")


@given(
    value=st.floats(1e-6, 1e9),
    apart=st.floats(-0.5, 0.5),
    digits=st.integers(1, 4),
)
@example(value=7213.0, apart=-0.0018, digits=2)
@example(value=0.99998, apart=0.0, digits=1)
def test_beside_a_limit_a_number_stands_on_its_side_of_it(value, apart, digits):
    limit = float(f"{value * (1 + apart):.4g}")
    # what is nearer has no side, see below
    assume(abs(value - limit) >= 1e-5 * limit)
    shown = digits_at_limit(value, limit, digits)
    assert shown >= digits
    told = round_digits(value, shown)
    assert (told > limit) == (value > limit) and (told < limit) == (value < limit)
    # and no digit more than that takes
    if shown > digits:
        less = round_digits(value, shown - 1)
        assert (less > limit) != (value > limit) or (less < limit) != (value < limit)


@given(limit=st.floats(1e-3, 9e5), apart=st.floats(-9e-6, 9e-6), digits=st.integers(2, 3))
def test_what_nobody_can_tell_from_its_limit_has_no_more_digits_than_that(limit, apart, digits):
    limit = float(f"{limit:.2g}")
    assert format_digits(
        limit * (1 + apart), digits_at_limit(limit * (1 + apart), limit, digits)
    ) == format_digits(limit, digits)


@given(value=st.floats(1e-3, 9e5), error=ERRORS)
def test_of_an_error_the_last_digit_is_wrong_by_at_most_five(value, error):
    written = format_digits(value, digits_within(error))
    if digits_within(error) < 4:
        assert significant(written) <= digits_within(error)
        size = 10.0 ** (math.floor(math.log10(round_digits(value, digits_within(error))) + 1e-12))
        place = size / 10.0 ** (digits_within(error) - 1)
        assert error * size <= 5.0001 * place or digits_within(error) == 1


@pytest.mark.parametrize("share", [1.0004, 1.004, 1.2])
def test_a_peak_just_above_the_hardness_is_not_told_as_the_hardness(share):
    hardness = SealProblem.of(case()).hardness
    assert hardness is not None
    load = judged_load(peak=share * hardness)
    load = load.with_values(mesh_error=DiscretisationError(0.08, 0.08, 0.08, None))
    (found,) = judged("hardness", load)
    times = re.findall(r"pressure ([\d.]+) of the hardness", found.text())[0]
    stress = re.findall(r"is ([\d.]+) MPa\)", found.text())[0]
    assert float(stress) > hardness / 1e6 and float(times) > 1
    # where two digits tell them apart there are no more
    assert share < 1.2 or significant(stress) == 2


def test_a_peak_just_above_the_sealing_pressure_is_above_it_as_written():
    sealing = SURFACE.sealing_pressure
    load = judged_load(peak=1.001 * sealing, leak_rate=0.0)
    load = load.with_values(mesh_error=DiscretisationError(0.08, 0.08, 0.08, None))
    (found,) = judged("sealed", load)
    peak, limit = re.findall(r"peak pressure ([\d.]+) MPa is above ([\d.]+) MPa", found.text())[0]
    assert float(peak) > float(limit)


COARSE = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"

[seat]
shape = "cone"
angle = "45 deg"
material = "steel"

[interface]
law = "smooth"

[load]
fluid_pressure = "20 bar"

[mesh]
contact_size = "33 um"
"""


@pytest.mark.usefixtures("unrendered")
def test_a_run_on_a_coarse_mesh_tells_the_digits_of_its_table_everywhere(tmp_path, capsys):
    """Smooth bodies on as few elements as are allowed: the width of their contact is good to some per cent."""
    path, out = tmp_path / "coarse.toml", tmp_path / "out"
    path.write_text(COARSE)
    assert cli.main(["run", "--details", str(path), "-o", str(out)]) == 0
    said = json.loads((out / "summary.json").read_text())
    error = said["discretisation_error"]
    page = html.unescape(re.sub(r"<[^>]+>", " ", (out / "report.html").read_text()))
    told = "".join(capsys.readouterr()) + page
    (row,) = said["loads"]
    assert error["fwhm"] > 5e-3 and error["peak_pressure"] > 5e-3
    for name, share in (
        ("fwhm_m", error["fwhm"]),
        ("peak_pressure_Pa", error["peak_pressure"]),
        ("max_von_mises_Pa", error["peak_pressure"]),
    ):
        assert not with_too_many_digits(told, row[name], digits_within(share))


def doubted(kind: str, leak_error: float) -> Validity:
    return Validity.of([remark(kind, Level.DOUBTFUL, "few channels", Bounds.factor_bounds(1 + leak_error))])


@pytest.mark.parametrize(("error", "digits"), [(0.0, 4), (0.02, 3), (0.7, 1), (2.3, 1), (math.inf, 1)])
def test_a_leak_rate_has_the_digits_that_its_theory_leaves(error, digits):
    load = rough_result().highest.with_values(validity=doubted("few channels", error))
    for name in ("leak_rate_m3_per_s", "leak_rate_high_m3_per_s", "leak_rate_elastic_m3_per_s"):
        assert COLUMNS[name].digits(load) == digits == load.leak_digits
    # pressures do not follow from the theory of flow, and a force for a target from that of another contact
    assert COLUMNS["peak_pressure_Pa"].digits(load) == 4 == load.digits_of("force_for_target")
    result = replace(rough_result(), loads=(*rough_result().loads[:-1], load))
    told = (
        first_line(result) + tiles_of(result)["Leak rate"].value + leakage_lines(result.case, load, [load])[0]
    )
    for leak_rate in load.leak_range:
        assert not with_too_many_digits(told, leak_rate, digits)


def test_few_channels_say_how_far_the_leak_rate_may_be_off():
    (found,) = judged("few channels", judged_load(peak=0.75 * SURFACE.sealing_pressure))
    factor = float(re.findall(r"factor ([\d.]+) off", found.reason())[0])
    assert found.leak_error == pytest.approx(factor - 1)
    (found,) = judged("nearly sealed", judged_load(peak=0.99 * SURFACE.sealing_pressure))
    assert found.leak_error == math.inf and "orders of magnitude" in found.reason()
    # where channels are narrower than the molecules, the seal is tight in reality: next to nothing may leak
    (found,) = judged("molecules", judged_load(critical_separation=1e-10))
    assert found.leak_factor == (1e-3, 1.0)


@pytest.mark.parametrize(
    ("level", "said"), [(Level.DOUBTFUL, "none, sealed"), (Level.OUTSIDE, "zero, as calculated")]
)
def test_nothing_is_no_number_with_a_unit(level, said):
    """Outside the theory a zero is no claim, in whatever unit."""
    validity = Validity.of([remark("hardness", level, "reason")])
    load = rough_result().highest
    nothing = load.leak.scaled(0.0)
    tight = with_capped(load.with_values(leak=nothing, validity=validity), nothing)
    (first, *_) = leakage_lines(rough_result().case, tight, [tight])
    assert first.startswith(f"Leak rate at 20 bar: {said} ({level}")


def test_of_a_contact_that_reaches_its_ends_hertz_is_no_measure(monkeypatch):
    """On a land narrower than Hertz's contact the peak is higher than his, which no roughness does."""
    result = rough_result()
    derived = derive(result.case)
    assert "width of the contact" in _width_reason(result, result.case.display, result.highest)
    smooth = derived.loads[-1].hertz
    higher = smooth.peak_pressure / (result.highest.contact.profile.peak_pressure / 1.2)
    flatter = replace(smooth, radius=smooth.radius * higher**2)
    narrow = replace(derived, loads=(*derived.loads[:-1], replace(derived.loads[-1], hertz=flatter)))
    monkeypatch.setattr("fem_seal.output.answers.contact.derive_beside", lambda result: narrow)
    told = _width_reason(result, result.case.display, result.highest)
    assert "beyond the curvature at the contact circle" in told and "govern" not in told
