"""The report is one page that stands alone, shows everything and trusts nobody's text."""

from __future__ import annotations

import base64
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from unittest.mock import Mock

import pytest
from sample_results import (
    SPECTRUM,
    case,
    cone,
    rough_result,
    run_loads,
    single_case,
    single_result,
    smooth_result,
    with_capped,
)

import fem_seal
from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.closed_forms import derive
from fem_seal.output.answer_output import Tile
from fem_seal.output.answer_outputs import OUTPUTS
from fem_seal.output.answers.leak import uncertain_in_words
from fem_seal.output.answers.target import target_in_brief
from fem_seal.output.files import summary
from fem_seal.output.pictures.style import label, logarithmic, number_dots, panels, style
from fem_seal.output.pictures.style import svg as written_svg
from fem_seal.output.report.brief import _curve, first_line, loads_in_brief
from fem_seal.output.report.page import load_table, pictures, report
from fem_seal.result import SealResult
from fem_seal.seal.findings import Level, Validity, remark
from fem_seal.units import Display
from leak import Reading

FETCHING = {"src", "href", "srcset", "data", "action", "poster", "background"}
ALL_PICTURES = {
    "contact",
    "sketch",
    "mesh",
    "profiles",
    "sizes",
    "law",
    "leak",
    "separation",
    "surface",
    "stress",
}


class Page(HTMLParser):
    """Tags, images and texts of a page; complains about tags that are not closed."""

    VOID = {"meta", "img", "br", "link", "input", "hr"}  # noqa: RUF012

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.texts.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.texts).split())

    @property
    def pictures(self) -> dict[str, bytes]:
        names = [a["id"].removeprefix("picture-") for tag, a in self.tags if tag == "figure"]
        images = [a for tag, a in self.tags if tag == "img"]
        prefix = "data:image/svg+xml;base64,"
        return {
            name: base64.b64decode(image["src"].removeprefix(prefix))
            for name, image in zip(names, images, strict=True)
        }


@cache
def told(result: Callable[[], SealResult]) -> str:
    """The report of a shared result, drawn once."""
    return report(result(), full=True)


@pytest.fixture(scope="module")
def page() -> Page:
    return Page(told(rough_result))


@pytest.mark.slow
@pytest.mark.parametrize("result", [rough_result, single_result, smooth_result])
def test_nothing_is_fetched(result):
    page = Page(told(result))
    assert not {"script", "iframe", "link", "object", "embed"} & {tag for tag, _ in page.tags}
    for _, attributes in page.tags:
        for name in FETCHING & set(attributes):
            assert re.match(r"#|data:image/svg\+xml;base64,", attributes[name] or "")
    styles = "".join(re.findall(r"<style>(.*?)</style>", told(result), flags=re.DOTALL))
    assert "url(" not in styles and "@import" not in styles
    for svg in page.pictures.values():
        for element in ET.fromstring(svg).iter():
            for name, value in element.attrib.items():
                if name.endswith("href"):
                    assert re.match(r"#|data:image/png;base64,", value)
        assert b"<script" not in svg


def test_every_picture_is_there_and_has_words(page):
    assert set(page.pictures) == ALL_PICTURES
    for svg in page.pictures.values():
        assert ET.fromstring(svg).tag.endswith("svg")
    alts = [a["alt"] for tag, a in page.tags if tag == "img"]
    assert all(len(alt) > 20 for alt in alts) and len(set(alts)) == len(alts)
    assert page.text.count("Used for:") == len({a for a in re.findall(r"Used for: ([^.]+)\.", page.text)})


@pytest.mark.usefixtures("unrendered")
def test_every_picture_that_is_drawn_has_a_place_on_the_page(page):
    result = rough_result()
    drawn = pictures(result, derive(result.case))
    assert {picture.name for picture in drawn} == set(page.pictures)


def test_pictures_carry_their_axes_as_text(page):
    texts = {name: svg.decode() for name, svg in page.pictures.items()}
    for name, words in {
        "profiles": ("contact pressure", "crossover", "Gaussian", "Hertz", "calculated"),
        "leak": ("leak rate", "ml/min", "volume conserved"),
        "separation": ("u_c",),
        "surface": ("magnification", "wavelength", "wavenumber", "after yielding"),
        "stress": ("von Mises stress", "MPa"),
        "law": ("mean gap u", "yielded"),
        "contact": ("pressure drop",),
    }.items():
        for word in words:
            assert word in texts[name], f"{word} in {name}"


@pytest.mark.parametrize("result", [rough_result, single_result, smooth_result])
def test_the_short_report_says_nothing_that_the_full_one_does_not(result):
    page, whole = Page(report(result())), Page(told(result))
    assert set(page.pictures) <= set(whole.pictures) and {"sketch", "contact"} <= set(page.pictures)
    words = [word for word in page.text.split() if re.search(r"\w", word)]
    assert len(words) < 1200 and len(page.pictures) <= 5
    tiles = re.findall(r'<span class="value">(.*?)</span>', report(result()))
    assert 0 < len(tiles) <= 6 and set(tiles) <= set(re.findall(r'class="value">(.*?)</span>', told(result)))
    ids = [attributes["id"] for _, attributes in page.tags if "id" in attributes]
    assert len(ids) == len(set(ids))


@pytest.mark.usefixtures("unrendered")
def test_user_text_is_escaped():
    warning = 'seat <img src="http://example.org/x.png" onerror="boom"> & more'
    text = report(replace(rough_result(), warnings=(warning,)), full=True)
    page = Page(text)
    assert 'Ball & cone <script>alert("x")</script>' in page.text
    assert "steel <1.4122>" in page.text
    assert warning in page.text
    assert "example.org" not in "".join(str(a) for _, a in page.tags)


@pytest.mark.usefixtures("unrendered")
def test_warnings_stand_at_the_top_and_absence_is_said(page):
    warned = Page(
        report(replace(rough_result(), warnings=("the seat yields", "mesh too coarse")), full=True)
    ).text
    assert warned.index("2 warnings") < warned.index("the seat yields") < warned.index("The case")
    assert "No warnings" in page.text


def test_headline_and_table_say_the_same_as_the_result(page):
    result = rough_result()
    highest = result.loads[-1]
    for end in highest.leak_range:
        assert Display().leak_range(end, 2, beside=highest.leak_range) in page.text
    assert f"{highest.leak.leak_rate * 6e7:.4g}" in page.text
    assert f"{highest.contact.profile.peak_pressure / 1e6:.1f} MPa" in page.text
    least, most = (
        highest.scenarios[Reading.ELASTIC].leak.leak_rate / rate for rate in reversed(highest.leak_range)
    )
    assert f"would leak {least:.1f} to {most:.1f} times as much" in page.text
    assert "elastic p(u) (used)" in page.text and "plastic p(u)" in page.text


def test_links_lead_somewhere(page):
    ids = [a["id"] for _, a in page.tags if "id" in a]
    assert len(ids) == len(set(ids))
    targets = {a["href"].removeprefix("#") for tag, a in page.tags if tag == "a"}
    assert targets <= set(ids)


def test_a_smooth_contact_has_no_leak_section():
    page = Page(told(smooth_result))
    assert set(page.pictures) == {"contact", "sketch", "mesh", "profiles", "sizes", "stress"}
    assert "There is no leak rate because the case has no roughness" in page.text
    assert "Tables [roughness] and [fluid] in the case give it a leak rate" in page.text
    assert b"Gaussian" not in page.pictures["profiles"]


def test_a_single_load_is_shown_without_curves_over_pressure():
    page = Page(told(single_result))
    assert "sizes" not in page.pictures
    assert b"Leak rate at 20 bar" in page.pictures["leak"]


def nothing(load):
    """A leak of nothing at all."""
    return replace(load.leak, leak_rate=0.0, resistance=float("inf"))


def sealed(result: SealResult, above: float) -> SealResult:
    """The result with every load above a fluid pressure sealed."""
    return replace(
        result,
        loads=tuple(
            with_capped(load.with_values(leak=nothing(load), critical_separation=0.0), nothing(load))
            if load.fluid_pressure > above
            else load
            for load in result.loads
        ),
    )


@pytest.mark.slow
def test_a_sealed_contact_says_so():
    page = Page(report(sealed(rough_result(), 0.0), full=True))
    assert "Sealed at 20 bar" in page.text
    partly = Page(report(sealed(rough_result(), 10e5), full=True))
    assert b"sealed: nothing leaks" in partly.pictures["leak"]
    assert "Sealed at 20 bar" in partly.text


@pytest.mark.slow
def test_many_loads_do_not_make_many_legend_entries():
    result, pressures = rough_result(), range(20, 60)
    many = replace(
        result,
        case=result.case.replace({"load.fluid_pressure": [f"{bar} bar" for bar in pressures]}),
        loads=tuple(replace(result.loads[-1], fluid_pressure=bar * 1e5) for bar in pressures),
    )
    page = Page(report(many, full=True))
    svg = page.pictures["profiles"].decode()
    assert "All 40 loads" in svg
    assert 2 <= len(re.findall(r">\d+ bar<", svg)) <= 6


def test_numbers_of_dots_that_lie_on_each_other_stand_together():
    _, (axes,) = panels(1)
    x, y = [1.0, 100.0, 1.0, 1.0], [5.0, 1.0, 4.9, 2.0]
    axes.plot(x, y, "o-")
    logarithmic(axes, "x", "y")
    number_dots(axes, x, y, range(1, 5))
    assert [text.get_text() for text in axes.texts] == ["1, 3", "2", "4"]
    number_dots(axes, x, [math.nan] * 4, range(5, 9))
    assert len(axes.texts) == 3


def test_drawing_leaves_the_settings_of_matplotlib_alone():
    import matplotlib

    before = dict(matplotlib.rcParams)
    report(smooth_result(), full=True)
    assert dict(matplotlib.rcParams) == before


@pytest.mark.usefixtures("unrendered")
def test_all_result_files_are_written(tmp_path: Path):
    mine = tmp_path / "notes.txt"
    mine.write_text("mine")
    rough_result().write(tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {
        "leak.csv",
        "contacts.csv",
        "profile.csv",
        "summary.json",
        "report.html",
        "result.bin",
        "mesh.msh",
        "contact.pvd",
        "contact_line.pvd",
        "notes.txt",
        *(f"contact_{n:03}.vtu" for n in range(3)),
        *(f"contact_line_{n:03}.vtp" for n in range(3)),
    }
    assert mine.read_text() == "mine"


# ---------------------------------------------------------------- how far it can be trusted


def judged(result, *levels):
    """A result with loads of these levels."""
    return replace(
        result,
        loads=tuple(
            load.with_values(validity=Validity(() if level is Level.VALID else (said(level),)))
            for load, level in zip(result.loads, levels, strict=True)
        ),
    )


def said(level):
    return remark("kind", level, "seat: 7.4 times its yield stress")


def leakless(result):
    """The same loads, none of which leaks."""
    return replace(
        result,
        loads=tuple(
            with_capped(load.with_values(leak=nothing(load), critical_separation=0.0), nothing(load))
            for load in result.loads
        ),
    )


def tiles_of(result: SealResult) -> list[Tile]:
    """Tiles of contact and leak rate."""
    pages = [one.page_of(result, result.case.display) for one in OUTPUTS]
    return [tile for page in pages for tile in page.tiles]


@pytest.mark.usefixtures("unrendered")
def test_tiles_carry_the_validity_and_no_class_is_claimed_outside_the_theory():
    outside = judged(leakless(rough_result()), Level.VALID, Level.DOUBTFUL, Level.OUTSIDE)
    tiles = tiles_of(outside)
    assert {tile.level for tile in tiles} == {Level.OUTSIDE}
    assert not any("sealed" in tile.value or "ISO" in tile.value + tile.remark for tile in tiles)
    (of_class,) = [tile for tile in tiles if tile.name.startswith("Leakage class")]
    assert of_class.value == "none stated"
    page = Page(report(outside, full=True))
    classes = [attributes.get("class") for tag, attributes in page.tags if tag == "li"]
    assert classes.count("outside") == len(tiles)
    assert page.text.count("outside theory") == 0 and page.text.count("outside the theory") > len(tiles)
    doubtful = tiles_of(judged(rough_result(), Level.VALID, Level.VALID, Level.DOUBTFUL))
    assert {tile.level for tile in doubtful} == {Level.DOUBTFUL}
    assert any("ISO 5208" in tile.value + tile.remark for tile in doubtful)


def test_the_first_line_claims_nothing_outside_the_theory():
    result = leakless(rough_result())
    assert first_line(result).startswith("Sealed at 20 bar")
    some = first_line(judged(result, Level.VALID, Level.DOUBTFUL, Level.OUTSIDE))
    assert "Sealed" not in some and "outside the theory (seat: 7.4 times its yield stress)" in some
    assert "doubt" not in first_line(rough_result())


def test_loads_and_their_reasons_stand_in_the_tables():
    page = Page(report(judged(rough_result(), Level.VALID, Level.DOUBTFUL, Level.OUTSIDE), full=True))
    assert "Validity of each load" in page.text
    table = load_table(rough_result())
    assert [row[0] for row in table.rows] == ["2", "5", "20"]
    marked = judged(rough_result(), Level.VALID, Level.DOUBTFUL, Level.OUTSIDE)
    table = load_table(marked)
    assert [row[0] for row in table.rows] == ["2", "5 ?", "20 !"]
    assert "in leak.csv. ? doubtful, ! outside the theory." in page.text
    assert "How far each load can be trusted" not in Page(told(rough_result)).text


def test_summary_claims_no_class_outside_the_theory():
    told = summary(judged(rough_result(), Level.VALID, Level.DOUBTFUL, Level.OUTSIDE))
    assert [one["validity"] for one in told["loads"]] == ["valid", "doubtful", "outside the theory"]
    assert told["loads"][2]["validity_reasons"] == ["seat: 7.4 times its yield stress"]
    assert set(told["leakage"][1]["classes"]) == {"ISO 5208", "API 598", "FCI 70-2"}
    assert told["leakage"][2]["classes"] == {}
    assert told["leakage"][2]["validity"] == "outside the theory"


# ---------------------------------------------------------------- faces that fit each other


@pytest.fixture(scope="module")
def fitting():
    """Cones of the same angle, with smooth faces: quick, and without any closed form."""
    fitting_cone = cone(outer_radius="10 mm", inner_radius="8 mm")
    return fem_seal.run(case(closure=fitting_cone, load={"fluid_pressure": ["5 bar", "20 bar"]}))


@pytest.mark.slow
def test_where_no_closed_form_exists_none_is_announced(fitting, page):
    fit = Page(report(fitting, full=True))
    profiles = fit.pictures["profiles"].decode()
    assert "closed forms" not in profiles and "Hertz" not in profiles
    assert "closed forms for half-spaces" not in fit.text and "Near Hertz" not in fit.text
    assert "closed forms" in page.pictures["profiles"].decode()
    assert "closed forms for half-spaces" in page.text and "Near Hertz" in page.text


def test_peak_pressure_is_the_largest_of_the_profile(fitting):
    for result in (fitting, rough_result(), smooth_result()):
        for load in result.loads:
            assert load.contact.profile.peak_pressure >= load.contact.profile.pressure.max()


def test_critical_separation_and_interface_laws_are_told_in_both_readings(page):
    load = rough_result().highest
    low, high = load.critical_separation, load.scenarios[Reading.CAPPED].critical_separation
    assert low < high < load.scenarios[Reading.ELASTIC].critical_separation
    assert high == load.scenarios[Reading.CAPPED].critical_separation
    assert f"{low * 1e6:.1f} to {high * 1e6:.1f} µm" in page.text
    for variant in rough_result().interface_variants:
        assert variant.leak_rate < variant.others[Reading.CAPPED]
    used = rough_result().interface_variants[0]
    assert (used.leak_rate, used.others[Reading.CAPPED]) == pytest.approx(load.leak_range)


def _figure():
    figure, (one, two) = panels(2)
    one.plot([1.0, 10.0, 100.0], [3.0, 4.0, 3.5], label="a line")
    one.legend(title="which", loc="best")
    logarithmic(one, "x")
    label(one, "Left", "x  [mm]", "σ'  [MPa]")
    two.plot([0.0, 1.0], [1.0, 0.0], rasterized=True)
    two.text(0.5, 0.5, "$h^2$\nand more", rotation=30.0, weight="bold", fontsize=11)
    figure.suptitle("both")
    return figure


def test_legends_stand_below_their_panels():
    with style():
        figure = _figure()
        written_svg(figure)
    one = figure.axes[0]
    assert one.get_legend().get_window_extent().y1 < one.get_window_extent().y0


def test_pictures_are_written_as_matplotlib_writes_them(monkeypatch):
    with style():
        out = BytesIO()
        _figure().savefig(out, format="svg", metadata={"Date": None, "Creator": None}, dpi=170)
        monkeypatch.setattr("fem_seal.output.pictures.style._put_legends_below", lambda figure: None)
        monkeypatch.setattr("fem_seal.output.pictures.style._draw_ticks", lambda axes: None)
        monkeypatch.setattr("fem_seal.output.pictures.style._recolour_for_dark", lambda drawing: drawing)
        monkeypatch.setattr("fem_seal.output.pictures.style._FONTS", "'DejaVu Sans'")
        assert written_svg(_figure()) == out.getvalue()


@pytest.mark.slow
def test_a_leak_rate_that_nobody_can_measure_has_its_report() -> None:
    """A fine surface pressed hard, all but sealed: one text stands for the leak rate, in no other unit."""
    spectrum = {**SPECTRUM, "rms_height": "0.15 um"}
    result = fem_seal.run(
        case(
            roughness={"spectrum": spectrum},
            load={"fluid_pressure": "20 bar", "applied_force": "32 kN"},
            leak={"plasticity": False},
            interface={"law": "spectrum"},
        )
    )
    assert 0.0 < result.loads[0].leak.leak_rate < 1e-30
    page = report(result, full=True)
    assert "none measurable" in page
    # what leaks if no place is pressed harder than direct simulations reach is an upper end that has a number
    low, high = result.loads[0].leak_interval
    assert low < 1e-30 < high == pytest.approx(3.3 * 1.2 * result.loads[0].leak_before_sealing, rel=0.02)


def test_the_legend_of_one_load_leaves_its_bar_free():
    result = run_loads(case(load={"fluid_pressure": "20 bar"}))
    axes = result.plot("leak")
    axes.figure.canvas.draw()
    box = axes.get_legend().get_window_extent().transformed(axes.transData.inverted())
    (ends,) = result.leak_ranges
    assert ends is not None and max(ends) > min(ends)
    assert box.y0 > max(ends) / Display().unit_for("flow", result.loads[0].leak.leak_rate).size


def test_the_first_lines_say_the_force_for_the_target_and_how_sure_it_is():
    load = single_result().highest.with_values(
        force_for_target=6e3, contact_force_for_target=5e3, target_validity=Validity(())
    )
    target = single_case().replace({"load.target_leak_rate": "1 ml/min"})
    result = Mock(highest=load, loads=[load], case=target, display=Display())
    # one direction with the line load of the tables: normal to the seat's 45 deg
    per_length = 5.0 / (2 * math.pi * load.contact.model.initial_contact_radius * math.sqrt(0.5))
    assert load.line_load / load.contact_force == pytest.approx(1e3 * per_length / 5e3)
    told = target_in_brief(result, Display())
    assert told.startswith("Target of 1 ml/min at 20 bar")
    assert told.endswith(f"of 6000 N ({per_length:.3g} N/mm normal to the contact)")
    crushed = remark("yield stress", Level.OUTSIDE, "seat yields")
    result.loads = [load.with_values(target_validity=Validity((crushed,)))]
    assert target_in_brief(result, Display()).endswith("; outside the theory: seat yields")


def test_the_force_for_the_target_is_that_of_the_load_that_needs_most():
    """A fluid behind the closure presses it on its seat, and the spring has to do most at the lowest pressure."""
    chosen = single_case().replace({"load.target_leak_rate": "1 ml/min"})
    high = single_result().highest.with_values(
        force_for_target=300.0, contact_force_for_target=5e3, target_validity=Validity(())
    )
    low = replace(high, fluid_pressure=0.1 * high.fluid_pressure).with_values(
        force_for_target=1.2e3, contact_force_for_target=5e3, target_validity=Validity(())
    )
    told = target_in_brief(Mock(highest=high, loads=[low, high], case=chosen, display=Display()), Display())
    assert "of 1200 N" in told and "at 2 bar" in told


def test_a_load_that_coins_is_sent_to_the_land_and_not_to_a_curve():
    """212 N/mm over three times 200 MPa are 0.35 mm: far for an edge of 0.2 mm, little for one of 2 mm."""
    load = Mock(line_load=212e3, sample_ends=None)
    load.validity = Validity((remark("yield stress", Level.OUTSIDE, "seat yields"),))
    result = Mock(display=Display(), case=Mock(gasket=None))
    result.problem.materials = {"closure": Mock(yield_stress=None), "seat": Mock(yield_stress=200e6)}
    load.contact.model.relative_radius = 0.2e-3
    assert "0.35 mm wide" in _curve(result, load) and "howto/needle" in _curve(result, load)
    load.contact.model.relative_radius = 2e-3
    assert _curve(result, load).startswith("A stress_strain curve")


def test_outside_the_theory_no_leak_of_zero_stands_in_the_first_table():
    load = single_result().highest
    outside = Validity((remark("yield stress", Level.OUTSIDE, "seat yields"),))
    for validity, some in ((load.validity, True), (outside, False)):
        sealed = load.with_values(validity=validity, leak=replace(load.leak, leak_rate=0.0))
        table, _ = loads_in_brief(single_case(), [CaseLoad.of(sealed)])
        assert any(heading.startswith("leak rate [") for heading in table.headings) is some


def test_the_first_lines_say_that_no_force_meets_the_target():
    """It was asked for in so many words; among three warnings of many it may not be shown at all."""
    result = run_loads(case(load={"fluid_pressure": "20 bar", "target_leak_rate": "1e3 m^3/s"}))
    assert result.highest.force_for_target is None
    told = next(one for one in result.warnings if one.startswith("load.target_leak_rate"))
    assert (
        target_in_brief(result, Display())
        == f"Target leak rate {told.removeprefix('load.target_leak_rate = ')}"
    )


def test_the_interval_names_inputs_besides_the_finish():
    known = case(roughness={"Ra": "0.4 um", "process": "lapped"})
    both = known.replace({"uncertainty": {"hardness": {"relative": 0.1}}})
    kinds = [uncertain_in_words(one, single_result().highest) for one in (known, both, single_case())]
    assert kinds == ["finish", "mixed", "inputs"]
