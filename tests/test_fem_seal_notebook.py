"""A result, a model or a study says what it is in a few lines, and shows its table and picture in a notebook."""

import base64
import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
import sample_results

import fem_seal


def few_lines(thing):
    text = repr(thing)
    return len(text) < 800 and text.count("\n") < 8


def test_a_result_is_a_few_lines_with_the_numbers_of_each_load():
    result = sample_results.rough_result()
    text = repr(result)
    assert few_lines(result)
    for load, pressure in zip(result.loads, ("2 bar", "5 bar", "20 bar"), strict=True):
        (line,) = [line for line in text.splitlines() if line.startswith(f"  {pressure}:")]
        (shown,) = re.findall(r"peak ([\d.]+) MPa", line)
        assert float(shown) == pytest.approx(load.contact.profile.peak_pressure / 1e6, rel=5e-3)
        (shown,) = re.findall(r"leak rate ([\d.]+) to ([\d.]+) (ml|l)/min", line)
        # two digits of each end
        expected = [load.leak_conserved.leak_rate * 60e6, load.leak_capped.leak_rate * 60e6]
        unit = 1e3 if shown[2] == "l" else 1.0
        assert [float(one) * unit for one in shown[:2]] == pytest.approx(expected, rel=5e-2)


@pytest.mark.parametrize("what", ["model", "seal_mesh"])
def test_what_a_result_holds_is_a_few_lines(what):
    assert few_lines(getattr(sample_results.rough_result(), what))


def test_loads_and_contacts_are_a_line_each():
    result = sample_results.rough_result()
    for thing in (*result.loads, *result.contact):
        assert few_lines(thing)
    assert "20 bar" in repr(result.loads[-1])


def test_of_many_loads_the_first_and_the_last_are_named():
    result = sample_results.rough_result()
    many = replace(result, loads=result.loads * 20)
    assert few_lines(many)
    assert "55 loads more" in repr(many)
    assert repr(many).splitlines()[-1].startswith("  20 bar")


def test_a_notebook_shows_the_table_and_the_pressure_profiles():
    result = sample_results.rough_result()
    page = result._repr_html_()
    assert page.partition("<tbody>")[2].count("<tr") == len(result.loads)
    assert "peak_pressure_Pa" in page
    assert "<script" not in page
    (drawing,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    assert ElementTree.fromstring(base64.b64decode(drawing)).tag.endswith("svg")
    # a column without a single number says nothing
    assert "blow_off_pressure_Pa" not in page
    assert len(page) < 300_000


def test_a_study_and_its_result_are_a_few_lines_and_a_notebook_shows_its_designs():
    study = fem_seal.Study(
        sample_results.smooth_case(load={"fluid_pressure": "20 bar"}),
        parameters={"seat.angle": ["40 deg", "50 deg"]},
        responses=["peak_pressure_Pa"],
    )
    assert few_lines(study)
    assert "2 designs over seat.angle; peak_pressure_Pa" in repr(study)
    result = study.run(workers=0)
    assert few_lines(result)
    assert "2 done" in repr(result)
    page = result._repr_html_()
    assert page.partition("<tbody>")[2].count("<tr") == 2
    (drawing,) = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    assert base64.b64decode(drawing).startswith(b"\x89PNG")
    assert "<script" not in page
