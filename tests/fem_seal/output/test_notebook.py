"""A result, a model or a study says what it is in a few lines, and shows its table and picture in a notebook."""

import base64
import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
import sample_results

import fem_seal
from leak import Reading


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
        expected = [
            load.leak.leak_rate * 60e6,
            load.scenarios[Reading.CAPPED].leak.leak_rate * 60e6,
        ]
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
    # in units for people, as in the report
    assert "peak pressure [MPa]" in page
    assert f">{result.highest.contact.profile.peak_pressure / 1e6:.4g}<" in page
    assert "Leaks 23 ml/min" in page
    assert "<script" not in page
    (drawing,) = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    assert ElementTree.fromstring(base64.b64decode(drawing)).tag.endswith("svg")
    # a column without a single number says nothing
    assert "blow-off" not in page
    assert len(page) < 300_000


@pytest.mark.slow
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


def test_of_a_long_table_a_notebook_shows_the_first_and_the_last_rows():
    result = sample_results.rough_result()
    page = replace(result, loads=result.loads * 20)._repr_html_()
    assert page.partition("<tbody>")[2].count("<tr") == 21


def drawn(axes):
    """Lines of the axes by their names."""
    return {line.get_label(): line.get_xydata() for line in axes.get_lines()}


def test_plot_draws_leak_rate_interval_and_profiles():
    result = sample_results.rough_result()
    figure = result.plot()
    leak, contact = figure.axes
    ((_, points),) = drawn(leak).items()
    assert points[:, 0] == pytest.approx([2.0, 5.0, 20.0])
    unit = float(points[-1, 1]) / result.loads[-1].leak.leak_rate
    assert points[:, 1] == pytest.approx([load.leak.leak_rate * unit for load in result.loads])
    assert "[ml/min]" in leak.get_ylabel() or "[l/min]" in leak.get_ylabel()
    assert unit == pytest.approx(60e6 if "ml/min" in leak.get_ylabel() else 60e3)
    (band,) = leak.collections
    ends = [load.scenarios[Reading.CAPPED].leak.leak_rate for load in result.loads] + [
        load.leak.leak_rate for load in result.loads
    ]
    heights = band.get_paths()[0].vertices[:, 1] / unit
    assert (heights.min(), heights.max()) == pytest.approx((min(ends), max(ends)))
    assert len(drawn(contact)) == len(result.loads)
    for load, line in zip(result.loads, drawn(contact).values(), strict=True):
        assert line[:, 1].max() == pytest.approx(load.contact.profile.pressure.max() / 1e6)


def test_plot_draws_what_is_required():
    result = sample_results.rough_result()
    limit = 0.3 * result.highest.leak.leak_rate
    judged = replace(result, case=result.case.replace({"requirement.leak_rate": limit}))
    line = drawn(judged.plot().axes[0])["allowed"]
    rates = drawn(result.plot().axes[0])
    (_, points), *_ = rates.items()
    assert line[0, 1] / points[-1, 1] == pytest.approx(0.3)


def test_a_notebook_shows_a_plot_without_pyplot():
    drawing = sample_results.rough_result().plot()._repr_svg_()
    assert ElementTree.fromstring(drawing).tag.endswith("svg")


def test_plot_of_a_smooth_seal_has_the_profiles_alone_and_draws_into_a_given_figure():
    from matplotlib.figure import Figure

    given = Figure()
    result = fem_seal.run(sample_results.smooth_case(load={"fluid_pressure": "20 bar"}))
    assert result.plot(given) is given
    (axes,) = given.axes
    assert axes.get_title(loc="left") == "Contact pressure"


@pytest.mark.parametrize("name", ["leak", "contact", "gap", "surface"])
def test_a_picture_is_drawn_by_its_name_into_any_axes(name):
    from matplotlib.figure import Figure

    result = sample_results.rough_result()
    given = Figure().subplots()
    assert result.plot(name, ax=given) is given
    own = result.plot(name)
    for axes in (given, own):
        assert axes.get_lines()
        assert axes.get_title(loc="left")
    assert ElementTree.fromstring(own._repr_svg_()).tag.endswith("svg")


@pytest.mark.slow
def test_sensitivities_are_bars_from_one_to_what_is_left_of_the_leak():
    result = fem_seal.run(sample_results.rough_result().case, sensitivities=True)
    axes = result.plot("sensitivities")
    strongest = result.sensitivities[0]
    ends = [bar.get_x() + bar.get_width() for bar in axes.patches[:2]]
    assert sorted(ends) == pytest.approx(sorted(strongest.ratio))


@pytest.mark.slow
def test_a_seal_that_is_not_round_is_drawn_around_its_axis():
    oval = {"seat": {"harmonics": [{"waves": 2, "amplitude": "1 um"}]}}
    result = sample_results.run_loads(
        sample_results.smooth_case(form=oval, load={"fluid_pressure": "20 bar"})
    )
    axes = result.plot("around")
    assert axes.get_xlim() == (0.0, 360.0)
    assert axes.get_lines()


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("leek", "leak, contact, gap, around, surface, sensitivities"),
        (None, "leak, contact, gap, around, surface, sensitivities"),
        ("around", "the seal is round"),
        ("surface", "no roughness"),
        ("leak", "no leak rate"),
        ("sensitivities", "were not calculated"),
    ],
)
def test_a_picture_that_is_not_there_says_why(name, told):
    from matplotlib.figure import Figure

    result = fem_seal.run(sample_results.smooth_case(load={"fluid_pressure": "20 bar"}))
    with pytest.raises(fem_seal.InputError, match=told):
        result.plot(name, ax=Figure().subplots())


def test_a_column_is_found_with_and_without_its_unit():
    result = sample_results.rough_result()
    for name in ("leak_rate", "leak_rate_m3_per_s"):
        assert result[name].equals(result.table["leak_rate_m3_per_s"])
    with pytest.raises(KeyError, match='no column "leek_rate"; do you mean leak_rate'):
        result["leek_rate"]
    with pytest.raises(KeyError, match="no column"):
        result[0]


def test_a_load_is_shown_line_by_line():
    page = sample_results.rough_result().loads[-1]._repr_html_()
    assert "<b>CaseLoad at 20 bar" in page
    assert "<br>FWHM" in page


def test_the_report_is_written_alone(tmp_path):
    path = sample_results.rough_result().report(tmp_path / "own.html")
    assert path == tmp_path / "own.html"
    assert path.read_text(encoding="utf-8").startswith("<!")


def test_completion_of_a_result_offers_what_is_public():
    names = dir(sample_results.rough_result())
    assert {"loads", "table", "plot", "report", "write"} <= set(names)
    assert not [name for name in names if name.startswith("_")]


CASE = {
    "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
    "seat": {"shape": "cone", "angle": "45 deg", "material": "steel"},
    "interface": {"law": "smooth"},
    "load": {"fluid_pressure": "10 bar"},
}
STUDY = {"parameters": {"seat.angle": ["40 deg", "50 deg"]}, "responses": ["peak_pressure_Pa"]}


def test_a_study_is_made_of_a_dict_as_of_its_parts():
    parts = fem_seal.Study(fem_seal.Case(**CASE), **STUDY)
    for study in (fem_seal.Study({"base": CASE, **STUDY}), fem_seal.Study(CASE, **STUDY)):
        assert repr(study) == repr(parts)
        assert study.points.tolist() == parts.points.tolist()
    assert fem_seal.Study({"base": fem_seal.Case(**CASE), **STUDY}).points.tolist() == parts.points.tolist()


def test_a_study_of_a_dict_says_what_is_wrong():
    with pytest.raises(
        fem_seal.InputError, match='responses: is not allowed together with a dict with "base"'
    ):
        fem_seal.Study({"base": CASE, **STUDY}, responses=["fwhm_m"])
    with pytest.raises(fem_seal.InputError, match="angel"):
        fem_seal.Study({**CASE, "seat": {"shape": "cone", "angel": "45 deg", "material": "steel"}}, **STUDY)
