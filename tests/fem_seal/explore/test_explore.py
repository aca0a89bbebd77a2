"""The session behind the live page, without a browser: what is shown is what `fem-seal run` gives."""

import json
import math
import os
import re
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import EXAMPLES
from shape_tables import tables

import fem_seal
from fem_seal.case.case import case_text, free_name, input_tables, load_case, write_case
from fem_seal.errors import InputError, LimitLoadError, SealError
from fem_seal.explore.choices import apply_choice
from fem_seal.explore.factors import factors_of
from fem_seal.explore.figures import leak_figure, section_figure
from fem_seal.explore.live import SOURCE, live_loads, live_screen, solve_live_loads
from fem_seal.explore.page import elements
from fem_seal.explore.screen import FIELDS, Screen, ShownDesign, lost_words, numbers_of, validity_words
from fem_seal.explore.session import Session
from fem_seal.explore.worker import (
    Answers,
    Calculation,
    Calculator,
    LeftError,
    LostError,
    complete_screen,
    with_sensitivities,
)
from fem_seal.output.answer_output import Tile
from fem_seal.output.report.brief import first_line
from fem_seal.seal.keyed_store import KeyedStore
from fem_seal.seal.problem import SealProblem

BALL = {
    "title": "Ball on cone",
    "closure": {"shape": "ball", "radius": "20 mm", "material": "steel"},
    "seat": {
        "shape": "cone",
        "angle": "45 deg",
        "material": {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3.5 GPa"},
    },
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "1 um",
            "hurst": 0.8,
            "q_low": "1e4 1/m",
            "q_rolloff": "5e4 1/m",
            "q_high": "1e6 1/m",
        }
    },
    "fluid": {"name": "water"},
    "load": {"fluid_pressure": ["5 bar", "20 bar"]},
}
DESIGN = {
    "fluid_pressure": "30 bar",
    "force": "200 N",
    "finish_spectrum": "0.8 um",
    "hardness": "3 GPa",
    "seat_angle": "50 deg",
    "closure_radius": "18 mm",
}


def case_with(**tables):
    return fem_seal.Case(**{**BALL, **tables})


@pytest.fixture(scope="module")
def session():
    return Session(case_with(fluid={"name": "hydraulic oil ISO VG 32"}))


@pytest.fixture(scope="module")
def live(session):
    return session.answer(DESIGN)


@pytest.fixture(scope="module")
def written(session, tmp_path_factory):
    """The design's case, through a file."""
    return load_case(write_case(session.case(DESIGN).written, tmp_path_factory.mktemp("written"), "design"))


@pytest.fixture(scope="module")
def run(written):
    return fem_seal.run(written)


def test_a_pinned_design_may_lack_a_number_of_the_complete_one():
    """Tiles of what is sampled come with the complete run, whose pinned design is not sampled yet."""
    screen = Session(case_with(requirement={"leak_rate": "1 ml/min"})).answer({})
    passes = replace(screen, tiles=(*screen.tiles, Tile("Passes", "99 %", "of the samples", 15, "valid")))
    now, pinned = ShownDesign(passes, "now", "#123456"), ShownDesign(screen, "A", "#654321")
    table = str(elements("compare", now=now, pinned=[pinned], rows={}, most=3))
    assert "Passes" in table and "99 %" in table and "–" in table


def columns(result, load):
    """What leak.csv says of a load, under the names of the screen."""
    return {name: float(result.table[name].iloc[load]) for name in FIELDS}


@pytest.mark.slow
@pytest.mark.parametrize(("rated_pressure", "word"), [("40 bar", "pass"), ("1000 bar", "fail")])
def test_service_loads_that_pass_decide_nothing_before_the_tests_of_the_standard(
    rated_pressure, word, tmp_path
):
    """At 1100 bar the test lifts the ball off, which 40 kN hold against 20 bar."""
    required = {"standard": "ISO 5208", "class": "D", "test": "standard", "rated_pressure": rated_pressure}
    load = {"fluid_pressure": "20 bar", "applied_force": "40 kN", "pressure_side": "inner"}
    session = Session(case_with(requirement=required, load=load))
    result = fem_seal.run(session.case({}))
    live, complete = session.answer({}), complete_screen({}, result)
    assert live.verdict == "" and live.remarks[0].startswith("Of the service loads only:")
    assert str(result.verdict) == "pass"
    assert complete.verdict == word
    assert not any("service loads only" in one for one in complete.remarks)
    assert any("tests of the standard itself" in one for one in complete.remarks)
    report = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    brief = report.split(f'class="verdict {word}" id="brief"')[1].split("</div>")[0]
    assert f"Tests of ISO 5208: {word}" in brief


def test_a_complete_screen_has_the_numbers_of_the_written_file(session, run):
    screen = complete_screen(session.design(DESIGN), fem_seal.run(session.case(DESIGN)))
    assert len(screen.loads) == len(run.loads) == 2
    for number, load in enumerate(screen.loads):
        expected = columns(run, number)
        for name, value in load.values.items():
            assert value == pytest.approx(expected[name], rel=1e-9), name


def test_live_numbers_are_those_of_a_run_in_the_digits_that_are_shown(live, run):
    # three digits are shown; the mesh is another one, see fem_seal.explore.live
    for number, load in enumerate(live.loads):
        expected = columns(run, number)
        for name, value in load.values.items():
            assert value == pytest.approx(expected[name], rel=2e-4), name
    assert live.load.level == str(run.highest.validity.level)


def test_between_edges_the_elements_are_far_fewer_and_the_numbers_those_of_a_run():
    case = load_case(EXAMPLES / "poppet_on_land.toml")
    run, screen = fem_seal.run(case), Session(case).answer({})
    problem = SealProblem.of(case)
    (evaluation,), _ = solve_live_loads(case, [problem], live_loads(problem))
    assert len(evaluation.model.line.x) < 0.6 * len(run.model.line.x)
    for number, load in enumerate(screen.loads):
        expected = columns(run, number)
        for name in ("leak_rate_m3_per_s", "peak_pressure_Pa", "fwhm_m"):
            assert load.values[name] == pytest.approx(expected[name], rel=4e-4), name


def test_a_gas_that_lifts_the_closure_does_not_follow_the_sliders():
    lifted = Session(load_case(EXAMPLES / "double_land.toml"))
    assert lifted.answer({}).delay.startswith("Each change takes about")


def test_all_that_was_chosen_stands_in_the_written_file(written):
    assert written.load.fluid_pressure == pytest.approx((7.5e5, 30e5), rel=1e-12)
    assert written.load.applied_force == 200.0
    assert written.roughness.spectrum.rms_height == 0.8e-6
    assert written.hardness == 3e9
    assert (written.closure.radius, math.degrees(written.seat.angle)) == (0.018, pytest.approx(50.0))
    assert written.fluid.name == "hydraulic oil ISO VG 32"


@pytest.mark.slow
def test_the_way_to_a_design_does_not_matter(session, live, monkeypatch):
    monkeypatch.setattr("fem_seal.explore.live.SOURCE", replace(SOURCE, light=KeyedStore(9)))
    for design in ({"seat_angle": "40 deg"}, {**DESIGN, "finish_spectrum": "2 um"}):
        session.answer(design)
    Session(apply_choice(session.base_design, "fluid.name", "water")).answer(DESIGN)
    again = session.answer(DESIGN)
    for one, other in zip(again.loads, live.loads, strict=True):
        assert one.values == pytest.approx(other.values, rel=1e-9, nan_ok=True)
    assert again.profile.pressure == pytest.approx(live.profile.pressure, rel=1e-9)


def test_a_pressure_moves_the_other_loads_in_proportion(session):
    low, high = session.answer({"fluid_pressure": "40 bar"}).loads
    assert low.values["fluid_pressure_Pa"] / high.values["fluid_pressure_Pa"] == pytest.approx(0.25)
    assert high.values["contact_force_N"] == pytest.approx(
        40e5 * math.pi * session.base.initial_contact_radius**2, rel=1e-9
    )


def test_the_curve_of_a_single_load_has_more_points_that_fall_with_pressure():
    screen = Session(case_with(load={"fluid_pressure": "20 bar"})).answer({})
    rates = [one.values["leak_rate_m3_per_s"] / one.values["fluid_pressure_Pa"] for one in screen.curve_loads]
    # the seat is pressed harder: what leaks per pressure falls
    assert len(rates) == 4
    assert rates == sorted(rates, reverse=True)


def test_the_verdict_follows_the_sliders_and_what_is_required_goes_with_its_load(session):
    load = session.answer({}).load
    allowed = 2 * load.values["leak_rate_high_m3_per_s"]
    required = {"leak_rate": f"{allowed!r} m^3/s", "fluid_pressure": "20 bar"}
    with_limit = Session(case_with(requirement=required, fluid={"name": "hydraulic oil ISO VG 32"}))
    before, after = (
        with_limit.answer(design) for design in ({}, {"fluid_pressure": "30 bar", "finish_spectrum": "5 um"})
    )
    assert (before.verdict, after.verdict) == ("pass", "fail")
    assert "20 bar" not in " ".join(after.remarks)
    assert after.limits == (("leak rate", pytest.approx(allowed, rel=1e-12)),)


def test_nothing_is_claimed_of_a_seal_before_all_of_it_is_known():
    words = "preliminary, inputs at their nominal values"
    finish = {"Ra": "0.4 um", "process": "lapped"}
    screen = Session(case_with(requirement={"leak_rate": "1 ml/min"}, roughness=finish)).answer({})
    assert (screen.verdict, screen.remarks, screen.widens) == ("", (), True)
    assert screen.limits
    numbers = {one.name: one for one in numbers_of(screen)}
    assert numbers["leak"].remark.endswith(words)
    assert numbers["classes"].value == "–"
    colour, validity = validity_words(screen)
    assert colour != "good"
    assert validity.endswith(words)
    assert any(
        note["text"] == words
        for note in leak_figure([ShownDesign(screen, "now", "#123456")], False).layout["annotations"]
    )


@pytest.mark.slow
def test_sensitivities_follow_the_complete_run(session, run):
    design, told = session.design(DESIGN), []
    assert complete_screen(design, run, follow=True).sensitivities == ("are being calculated ...",)
    # as in a worker, which tells each solution, so that a newer design can break them off; many share one
    with ThreadPoolExecutor(1) as beside:
        found = beside.submit(with_sensitivities, run, told.append).result()
    assert len(set(told)) == 1 and len(told) >= 3
    said = complete_screen(design, found).sensitivities
    assert any("halving the roughness heights cuts the leak by " in one for one in said)


@pytest.mark.parametrize(
    ("roughness", "path", "given"),
    [
        ("lapped Ra 0.2 to 0.4 um", "roughness.Ra", "0.283 um"),
        ({"seat": "lapped Ra 0.2 um"}, "roughness.seat.Ra", "0.2 um"),
        ({"seat": {"Rz": "1 um to 2 um"}}, "roughness.seat.Rz", "1.41 um"),
    ],
)
def test_a_finish_in_words_or_with_a_range_has_a_slider_from_its_usual_value(roughness, path, given):
    case = case_with(roughness=roughness)
    one = next(one for one in factors_of(case).sliders if one.key.startswith("finish_"))
    assert (one.paths, one.base_text) == ((path,), given)
    # not moved it leaves the case as it is, moved it is one value
    assert factors_of(case).changes(case, {one.key: given}) == {}
    assert case.replace_written({path: one.stops[0]}).roughness.parts["seat"].finish.tolerance == 1.0


def test_a_turned_face_has_sliders_for_feed_nose_radius_and_fine_roughness():
    fine = {"rms_height": "0.1 um", "hurst": 0.8, "q_rolloff": "2.5e5 1/m"}
    face = {"process": "turned", "feed": "50 um", "nose_radius": "0.4 mm", "fine": fine}
    case = case_with(roughness={"seat": face})
    sliders = {one.key: one for one in factors_of(case).sliders if one.group == "surface"}
    assert {"feed_seat", "nose_radius_seat", "finish_seat"} <= {*sliders}
    assert sliders["feed_seat"].base_text == "50 um"
    assert sliders["finish_seat"].label == "rms height on the crests, seat"
    changes = factors_of(case).changes(case, {"feed_seat": "60 um", "finish_seat": "0.2 um"})
    moved = case.replace_written(changes).roughness.turned_faces["seat"]
    assert (moved.feed, moved.nose_radius, moved.fine.rms_height) == pytest.approx((6e-5, 4e-4, 2e-7))
    # of both faces in one table
    both = case_with(roughness={**face, "fine": "lapped Ra 0.1 um"})
    sliders = {one.key: one for one in factors_of(both).sliders}
    assert sliders["feed_all"].paths == ("roughness.feed",)
    assert sliders["finish_all"].paths == ("roughness.fine.Ra",)
    assert sliders["finish_all"].label == "Ra on the crests, both faces"


@pytest.mark.slow
def test_the_interval_of_a_finish_is_that_of_a_run_in_the_end(tmp_path):
    case = case_with(roughness={"Ra": "0.4 um", "process": "lapped"}, load={"fluid_pressure": "20 bar"})
    session = Session(case)
    screen = complete_screen(session.design({}), run := fem_seal.run(session.case({})))
    row = run.table.iloc[-1]
    low, high = (screen.load.values[f"leak_rate_{end}_m3_per_s"] for end in ("low", "high"))
    assert (low, high) == (row["leak_rate_low_m3_per_s"], row["leak_rate_high_m3_per_s"])
    leak = next(one for one in numbers_of(screen) if one.name == "leak")
    said = first_line(run)
    assert leak.value in said
    assert "preliminary" not in leak.remark
    live = session.answer({}).load.values
    # what the drawing leaves open makes it wider to both sides
    assert low < 0.95 * live["leak_rate_low_m3_per_s"]
    assert high > 1.05 * live["leak_rate_high_m3_per_s"]


def test_the_curve_shows_the_whole_interval_of_the_load_that_is_shown():
    """A single load makes no band; a bar holds its interval."""
    screen = Session(case_with(load={"fluid_pressure": "20 bar"})).answer({})
    rate, low, high = (screen.load.values[f"leak_rate_{end}m3_per_s"] for end in ("", "low_", "high_"))
    (bar,) = (
        one for one in leak_figure([ShownDesign(screen, "now", "#123456")], False).data if one.get("error_y")
    )
    ends = bar["y"][0] - bar["error_y"]["arrayminus"][0], bar["y"][0] + bar["error_y"]["array"][0]
    assert [end / bar["y"][0] for end in ends] == pytest.approx([low / rate, high / rate], rel=1e-9)
    assert low < high


@pytest.mark.parametrize(
    ("design", "words"),
    [
        ({"fluid_pressure": "20 mm"}, "does not fit"),
        ({"fluid_pressure": "much"}, "fluid pressure"),
        ({"seat_angle": "89 deg"}, "the slider goes from 30 deg to 60 deg"),
        ({"closure_radius": "-3 mm"}, "the slider goes from"),
    ],
)
def test_what_cannot_be_is_said_in_a_sentence(session, design, words):
    screen = session.answer(design)
    assert words in screen.problem
    assert not screen.loads


def test_an_impossible_geometry_is_said_in_a_sentence():
    session = Session(load_case(EXAMPLES / "tilted_poppet.toml"))
    screen = session.answer({"seat_bore_radius": "6 mm", "seat_face_radius": "6.2 mm"})
    assert "face" in screen.problem or "bore" in screen.problem


def alone(session):
    """Answers without processes beside them, so that nothing becomes complete."""
    answers = Answers(session, live_screen)
    answers.close()
    return answers


def test_outdated_questions_are_dropped(session):
    answers = alone(session)
    assert answers.answer({}, "page", 2).load is not None
    assert answers.answer(DESIGN, "page", 1) is None
    assert answers.answer(DESIGN, "another page", 1) is not None


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_written_case_is_the_case(example, tmp_path):
    case = load_case(example)
    again = load_case(write_case(case.written, tmp_path, "again"))
    tables, others = input_tables(case), input_tables(again)
    for one in (tables, others):
        one.pop("output")
    assert str(tables) == str(others)


def test_files_beside_the_case_are_named_from_there(tmp_path):
    text = case_text(load_case(EXAMPLES / "profile_from_drawing.toml").written, EXAMPLES.absolute())
    assert 'file = "seat.dxf"' in text


def test_nothing_is_written_over(tmp_path, session):
    first, second = (write_case(session.case({}).written, tmp_path, "mine.toml") for _ in range(2))
    assert (first.name, second.name) == ("mine.toml", "mine-2.toml")
    for name in ("../mine", "a/b", "", ".hidden", "C:\\x"):
        with pytest.raises(InputError, match="file name"):
            free_name(tmp_path, name, ".toml")


def test_what_takes_longer_than_a_slider_may_says_how_long():
    case = load_case(EXAMPLES / "hot_valve.toml")
    screen = Session(case).answer({})
    assert "Each change takes about" in screen.delay
    assert not screen.loads


TOKEN, HERE = "the-token", {"Host": "127.0.0.1:8050"}


def client_of(session, title="case", *, opened=True, failed=None, answers=None):
    """Who asks the page of a session, with the cookie of its address if it has been opened."""
    pytest.importorskip("dash")
    from fem_seal.explore.gate import guard
    from fem_seal.explore.page import page_of

    page = page_of(answers or alone(session), EXAMPLES, title)
    guard(page, 8050, TOKEN, ([] if failed is None else failed).append)
    client = page.server.test_client()
    if opened:
        assert (
            client.get(f"/?token={TOKEN}", headers=HERE, base_url="http://127.0.0.1:8050").status_code == 200
        )
    return client


def asked(client, path="/", **more):
    headers = {**HERE, **more.pop("headers", {})}
    return client.open(path, base_url="http://127.0.0.1:8050", headers=headers, **more)


def test_only_the_page_itself_is_answered(session):
    client = client_of(session)
    text = asked(client).text
    assert "http://" not in text.replace("http://127.0.0.1", "")
    assert "https://" not in text
    for headers in (
        {"Host": "evil.example:8050"},
        {"Host": "127.0.0.1:8051"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
    ):
        refused = asked(client, headers=headers)
        assert (refused.status_code, refused.text) == (403, "this page answers only itself\n")


@pytest.mark.parametrize(
    "path", ["/", "/?token=", "/?token=another", "/_dash-layout", "/report/0", "/nothing"]
)
def test_without_the_token_nothing_is_answered(session, path):
    refused = asked(client_of(session, opened=False), path)
    assert refused.status_code == 403
    assert (
        refused.text == "open the address that fem-seal explore printed: it carries the token of the page\n"
    )
    assert "Set-Cookie" not in refused.headers


def test_the_token_is_exchanged_for_a_cookie_of_this_page_alone(session):
    client = client_of(session, opened=False)
    # the token itself, which other users may see among the arguments of a browser, is no cookie
    assert asked(client, "/_dash-layout", headers={"Cookie": f"fem-seal-8050={TOKEN}"}).status_code == 403
    cookie = asked(client, f"/?token={TOKEN}").headers["Set-Cookie"]
    assert all(word in cookie for word in ("fem-seal-8050=", "HttpOnly", "SameSite=Strict"))
    assert TOKEN not in cookie
    assert asked(client, "/_dash-layout").status_code == 200


def test_a_connection_of_another_user_is_told_from_ones_own(monkeypatch, tmp_path):
    pytest.importorskip("dash")
    from fem_seal.explore import gate

    row = "   1: 0100007F:{:04X} 0100007F:1F72 01 00000000:00000000 00:00000000 00000000 {:5d}        0 1 1 0 20\n"
    table = tmp_path / "tcp"
    others = os.getuid() + 1
    table.write_text("  sl\n" + row.format(40001, os.getuid()) + row.format(40002, others), encoding="ascii")
    monkeypatch.setattr(gate, "_SOCKETS", table)
    assert gate.own_connection(40001, 8050)
    assert not gate.own_connection(40002, 8050)
    # where nothing is known the token alone decides
    assert gate.own_connection(40003, 8050)
    assert gate.own_connection(None, 8050)


HOSTILE = "</title><script>alert(document.domain)</script>{%config%}"


def test_a_hostile_title_is_text_in_the_head(session):
    text = asked(client_of(session, HOSTILE)).text
    assert "<script>alert" not in text
    assert "<title>&lt;/title&gt;&lt;script&gt;" in text
    assert text.count("_dash-config") == 1


@pytest.mark.parametrize("text", [HOSTILE, "12", "null", '{"kind": "pin"}', "a & b", "one\x1btwo\x00\ud800"])
def test_texts_of_a_case_are_texts_in_its_elements(session, text):
    pytest.importorskip("dash")
    from fem_seal.explore.page import elements

    said = {
        "factors": session.factors,
        "remarks": [text],
        "meta": {},
        "pictures": {},
        "empty": {},
        "height": 1,
        "begins": {},
        "most": 4,
    }
    (page,) = elements("page", title=text, name=text, own_input=False, **said)
    shown = text.translate(dict.fromkeys([0x1B, 0x00, 0xD800]))
    assert page["name"].value == text
    texts = [one.children for one in page._traverse() if getattr(one, "className", "") == "note"]
    titles = [one.children for one in page._traverse() if type(one).__name__ == "H1"]
    assert (texts[0], titles) == ([shown], [[shown]])


def test_the_page_says_what_may_run_in_it_and_is_never_in_a_frame(session):
    import base64
    import hashlib

    answer = asked(client_of(session))
    policy = dict(part.strip().split(" ", 1) for part in answer.headers["Content-Security-Policy"].split(";"))
    assert policy["default-src"] == policy["frame-ancestors"] == "'none'"
    assert "unsafe" not in policy["script-src"]
    # all that stands in the page itself has its hash
    for script in re.findall(
        r"<script(?: id=\"_dash-renderer\"[^>]*)?>(.+?)</script>", answer.text, re.DOTALL
    ):
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy["script-src"]
    for name, value in (
        ("X-Frame-Options", "DENY"),
        ("X-Content-Type-Options", "nosniff"),
        ("Referrer-Policy", "no-referrer"),
    ):
        assert answer.headers[name] == value
        assert asked(client_of(session, opened=False)).headers[name] == value


def line_and_silence(answer, capfd, *codes):
    """One line for who asks, none on the terminal of the page."""
    assert answer.status_code in codes, answer.text
    assert answer.text.count("\n") == 1
    assert answer.mimetype == "text/plain"
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "path",
    [
        "/_dash-component-suites/nothing/x.js",
        "/_dash-component-suites/dash/nothing.js",
        "/_dash-component-suites/dash/../../../etc/passwd",
        "/_dash-component-suites/../../etc/passwd",
        "/_dash-component-suites/dash/%2e%2e%2f%2e%2e%2fetc/passwd",
        "/_dash-component-suites/dash/%00",
        "/_dash-component-suites/os/path.py",
        "/assets/../page.py",
        "/report/0",
        "/report/99999999999999999999",
    ],
)
def test_odd_paths_end_in_one_line(session, path, capfd):
    line_and_silence(asked(client_of(session), path), capfd, 404)


CALLBACK = {
    "output": "pins.data",
    "outputs": {"id": "pins", "property": "data"},
    "inputs": [{"id": "pin", "property": "n_clicks", "value": 1}],
    "changedPropIds": ["pin.n_clicks"],
    "state": [
        {"id": "pins", "property": "data", "value": []},
        {"id": "present", "property": "data", "value": {"page": "1", "number": 1, "design": {}}},
    ],
}


def test_a_question_of_the_page_is_answered(session):
    answer = asked(client_of(session), "/_dash-update-component", method="POST", json=CALLBACK)
    assert answer.status_code == 200
    assert answer.json["response"]["pins"]["data"] == [session.factors.base_design]


def broken_questions():
    yield b'{"a":', "application/json"
    yield b"[" * 100_000, "application/json"
    yield b"\xff\xfe", "application/json"
    yield b"1" * 10_000, "application/json"
    yield b"x", "text/plain"
    yield b"a=1", "application/x-www-form-urlencoded"
    yield json.dumps(CALLBACK).encode(), "text/plain"
    for sent in (
        {},
        [],
        1,
        None,
        "text",
        {"output": "nothing.data"},
        {"output": 1},
        {"output": ["pins.data"]},
    ):
        yield json.dumps(sent).encode(), "application/json"
    for key in ("outputs", "inputs", "state", "changedPropIds"):
        for sent in (1, [1], [[[]]], [{"id": 1}]):
            yield json.dumps({**CALLBACK, key: sent}).encode(), "application/json"
    for which, sent in (
        (0, 1),
        (0, [1]),
        (0, [{}] * 99),
        (1, 1),
        (1, {}),
        (1, {"number": "1", "design": {}}),
    ):
        state = [dict(one) for one in CALLBACK["state"]]
        state[which]["value"] = sent
        yield json.dumps({**CALLBACK, "state": state}).encode(), "application/json"


def test_malformed_questions_end_in_one_line(session, capfd):
    client = client_of(session)
    for body, kind in broken_questions():
        answer = asked(client, "/_dash-update-component", method="POST", data=body, content_type=kind)
        line_and_silence(answer, capfd, 400, 415)


def test_a_huge_question_is_refused(session, capfd):
    body = b'{"output": "' + b"x" * 2_000_000 + b'"}'
    answer = asked(
        client_of(session),
        "/_dash-update-component",
        method="POST",
        data=body,
        content_type="application/json",
    )
    line_and_silence(answer, capfd, 413)


def test_a_defect_of_the_page_is_told_where_it_runs(session, monkeypatch):
    failed = []
    client = client_of(session, failed=failed)
    monkeypatch.setattr(session, "design", lambda design: {}["gone"])
    answer = asked(client, "/_dash-update-component", method="POST", json=CALLBACK)
    said = "unexpected KeyError: 'gone'. This is a defect of fem-seal; --debug shows the traceback\n"
    assert (answer.status_code, answer.text) == (500, said)
    assert [type(one) for one in failed] == [KeyError]


def test_a_port_in_use_is_an_error_with_advice(session):
    import socket

    from fem_seal.explore.server import serve

    pytest.importorskip("dash")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        with pytest.raises(InputError, match="choose another one"):
            serve(session.base_design, EXAMPLES, taken.getsockname()[1], print, print)


def test_missing_packages_are_named_in_one_sentence(session, monkeypatch):
    from fem_seal.explore.server import serve

    monkeypatch.setitem(sys.modules, "dash", None)
    for name in ("page", "gate", "elements"):
        monkeypatch.delitem(sys.modules, f"fem_seal.explore.{name}", raising=False)
    with pytest.raises(
        InputError, match=r"needs dash, which is not installed; install it with: .*\[explore\]"
    ):
        serve(session.base_design, EXAMPLES, 0, print, print)


def callback(client, output, values, changed="asked.data"):
    """Answer of a callback of the page: those of its inputs that are named, and nothing else."""
    asks = asked(client, "/_dash-dependencies").json
    one = next(one for one in asks if output in one["output"] and not one["clientside_function"])

    def filled(part):
        return {**part, "value": values.get(part["id"])}

    def named(each):
        name, key = each.rsplit(".", 1)
        if not name.startswith("{"):
            return {"id": name, "property": key}
        kind = json.loads(name)["kind"]
        keys = [factor.key for factor in values["factors"].sliders]
        return [{"id": {"kind": kind, "key": key_}, "property": key} for key_ in keys]

    body = {
        "output": one["output"],
        "outputs": [named(each) for each in one["output"].strip(".").split("...")],
        "inputs": [filled(part) for part in one["inputs"]],
        "state": [filled(part) for part in one["state"]],
        "changedPropIds": [changed],
    }
    answer = asked(client, "/_dash-update-component", method="POST", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json["response"]


@pytest.mark.slow
def test_a_design_that_cannot_be_names_its_fields_and_whose_numbers_are_left():
    session = Session(load_case(EXAMPLES / "tilted_poppet.toml"))
    client = client_of(session)

    def follow(design, shown=None, wrong=None):
        question = {"page": "1", "number": 1, "design": session.design(design), "wrong": wrong or {}}
        values = {"asked": question, "dark": False, "pins": [], "shown": shown, "factors": session.factors}
        return callback(client, "graph-section.figure", values)

    first = follow({})
    assert first["results"]["className"] == "results"
    refused = follow({"seat_bore_radius": "6 mm", "seat_face_radius": "6.2 mm"}, first["shown"]["data"])
    assert refused["results"]["className"] == "results stale"
    assert "graph-section" not in refused
    said = refused["problem"]["children"]
    given = session.factors.base_design
    assert said.endswith(
        "The faded numbers and pictures still belong to bore radius, seat = "
        f"{given['seat_bore_radius']}; face radius, seat = {given['seat_face_radius']}."
    )
    marked = {
        json.loads(name)["key"]: part["children"]
        for name, part in refused.items()
        if '"wrong"' in name and part["children"]
    }
    assert marked == {
        key: f"What is shown belongs to {given[key]}." for key in ("seat_bore_radius", "seat_face_radius")
    }
    # one that could not be taken at all is named beside it
    design = {"seat_bore_radius": "6 mm", "seat_face_radius": "6.2 mm"}
    both = follow(design, first["shown"]["data"], {"fluid_pressure": "ten bar"})["problem"]["children"]
    assert both == (
        f'{said} Not taken: fluid pressure = "ten bar". '
        f"The numbers belong to fluid pressure = {given['fluid_pressure']}."
    )
    # and the page goes on from there
    assert follow({}, refused["shown"]["data"])["results"]["className"] == "results"


def test_a_page_begins_with_the_first_numbers_and_draws_them_once(session):
    answers = alone(session)
    client = client_of(session, answers=answers)
    assert '"value-leak"' not in asked(client, "/_dash-layout").text
    first = answers.screen({})
    answers._first_thread.start()
    begun = asked(client, "/_dash-layout")
    parts = {str(part["props"].get("id")): part["props"] for part in parts_of(begun.json)}
    assert parts["value-leak"]["data-si"] == str(first.load.values["leak_rate_m3_per_s"])
    assert parts["graph-leak"]["figure"]["data"]
    question = {"page": "1", "number": 1, "design": session.design({}), "wrong": {}}
    values = {"asked": question, "pins": [], "shown": parts["shown"]["data"], "factors": session.factors}
    again = callback(client, "graph-section.figure", {**values, "dark": False})
    assert [*again] == ["shown"]
    assert "graph-section" in callback(client, "graph-section.figure", {**values, "dark": True})


def test_a_page_that_is_opened_again_has_the_case_of_its_controls(session):
    answers = alone(session)
    client, other = client_of(session, answers=answers), answers.open_case(case_with(title="other"))
    present = {"page": "1", "number": 1, "design": session.design({}), "wrong": {}}
    callback(client, "controls.children", {"back": other.design({}), "present": present}, "back.data")
    assert answers.newest is other
    callback(client, "controls.children", {"reset": 1, "present": present}, "reset.n_clicks")
    assert answers.newest is session
    # what was asked of the other case before may come later
    answers.answer(other.design({}), "1", 1)
    assert answers.newest is session


def parts_of(element):
    """All elements of a layout."""
    if isinstance(element, list):
        for one in element:
            yield from parts_of(one)
    elif isinstance(element, dict):
        yield element
        yield from parts_of(element["props"].get("children"))


def test_wrong_texts_are_all_named(session):
    given = session.factors.base_design
    with pytest.raises(InputError) as raised:
        session.case({"fluid_pressure": "20 mm", "hardness": "hard", "seat_angle": "50 deg"})
    assert [one.key for one in raised.value.problems] == ["highest fluid pressure", "hardness, seat"]
    assert set(session.factors.find_errors({**given, "fluid_pressure": "20 mm", "hardness": "hard"})) == {
        "fluid_pressure",
        "hardness",
    }


def dying_work():
    """What some designs kill, and one hangs."""

    def calculate(calculation, left):
        what = calculation.design["what"]
        if what == "deadly" or (Path(what).is_file() and not Path(what).unlink()):
            os.kill(os.getpid(), signal.SIGKILL)
        if what == "wrong":
            raise LimitLoadError("bears no more", "seat")
        while what == "waits":
            time.sleep(0.01)
            if left():
                raise LeftError
        while what == "hangs":
            time.sleep(1.0)
        yield Screen(calculation.design, complete=True)

    return calculate


@pytest.fixture
def told():
    return []


@pytest.fixture
def calculator(told):
    calculator = Calculator(dying_work, told.append)
    yield calculator
    calculator.close()


def done(calculator, session, what, **more):
    (screen,) = calculator.screens(Calculation(session.base_design, {"what": what}), **more)
    return screen.design["what"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="processes are killed with SIGKILL")
def test_work_of_a_killed_process_is_done_by_another_one_and_given_up_after_two(
    session, calculator, told, tmp_path
):
    once = tmp_path / "once"
    once.touch()
    assert done(calculator, session, str(once)) == str(once)
    assert len(told) == 1 and "was killed (SIGKILL)" in told[0] and "Another one" in told[0]
    with pytest.raises(LostError) as raised:
        done(calculator, session, "deadly")
    assert told[1:] == [told[1], str(raised.value)]
    assert "Another one" in told[1] and "not tried again" in told[2]
    # the next one finds a process, and so does one that comes when it was killed with nothing to do
    for _ in range(2):
        assert done(calculator, session, "alive") == "alive"
        calculator._process.kill()
    with pytest.raises(SealError, match="bears no more"):
        done(calculator, session, "wrong")
    assert done(calculator, session, "alive") == "alive"


@pytest.mark.slow
def test_a_calculation_that_hangs_is_stopped_and_one_is_left_when_another_is_asked_for(
    session, calculator, told
):
    with pytest.raises(LostError, match="was stopped"):
        done(calculator, session, "hangs", limit=1.5)
    with ThreadPoolExecutor(1) as beside:
        waits = beside.submit(done, calculator, session, "waits")
        while not waits.done():
            time.sleep(0.1)
            calculator.leave()
        with pytest.raises(LeftError):
            waits.result()
    assert done(calculator, session, "alive") == "alive"
    assert len(told) == 1


class Dying:
    """A calculator whose processes end."""

    def leave(self):
        pass

    def screens(self, calculation):
        raise LostError(lost_words(-9, has_successor=False))


def test_what_was_given_up_is_refused_and_not_begun_again(session):
    answers, design = Answers(session, live_screen), session.design({})
    answers._runs = Dying()
    answers.settle(design)
    answers.report(design, Path("report.out"))
    answers._queue.shutdown()
    why = answers.failure_reason(design)
    assert "was killed (SIGKILL)" in why and "not tried again" in why
    assert answers.report_problem(Path("report.out"))[-30:] == why[-30:]
    news = answers.news
    answers.settle(design)
    assert not answers._run_design and answers.news == news


def test_neighbours_of_a_design_at_rest_are_calculated_ahead(session):
    answers, asked = Answers(session, live_screen), []
    answers._runs = Dying()
    answers._calculate = lambda case, design: asked.append(design) or Screen(design)
    assert answers.answer({}, "page", 1) == answers.screen({})
    answers.work_ahead({}, "page", 1)
    assert len(asked) == 41
    # those of surfaces, whose conductivities take longest, the nearest first
    stops = session.factors.sliders[-1].stops
    assert all(one["fluid_pressure"] == session.factors.base_design["fluid_pressure"] for one in asked)
    assert asked[1]["finish_spectrum"] == "1.04 um" and len(stops) > 40
    answers.work_ahead(asked[1], "page", 1)
    answers.answer({"fluid_pressure": "21 bar"}, "page", 2)
    answers.work_ahead({}, "page", 1)
    assert asked[-1]["fluid_pressure"] == "21 bar"


def test_pictures_hold_what_is_on_the_screen_and_are_figures_of_plotly(session, live):
    graph_objects = pytest.importorskip("plotly.graph_objects")
    from fem_seal.explore.figures import designs_shown, figures

    drawn = figures(designs_shown(live, [session.answer({})]), dark=True)
    assert set(drawn) == {"section", "leak", "profile", "gap"}
    for figure in drawn.values():
        graph_objects.Figure(figure.plain())  # which checks every entry
    now = next(trace for trace in drawn["profile"].data if trace["name"] == "now")
    assert max(now["y"]) == pytest.approx(max(live.profile.pressure) / 1e6, rel=1e-12)
    # the point of the load on its curve
    marked = [trace for trace in drawn["leak"].data if trace["mode"] == "markers"]
    assert marked[-1]["x"] == [pytest.approx(30.0)]


def test_a_body_that_a_slider_leaves_as_it_is_is_not_condensed_again(monkeypatch):
    session = Session(load_case(EXAMPLES / "tilted_poppet.toml"))
    heights, found = ["12.2 mm", "12.4 mm"], []
    for before in ([], heights[:1]):
        source = replace(SOURCE, light=KeyedStore(9))
        monkeypatch.setattr("fem_seal.explore.live.SOURCE", source)
        found.append([session.answer({"seat_height": height}) for height in [*before, heights[1]]][-1])
    assert found[0].loads == found[1].loads
    closures = [model.harmonics[0] for model in source.light._values.values()]
    assert len(closures) == 2 and closures[0] is closures[1]


def test_a_load_that_comes_again_is_solved_once():
    case = load_case(EXAMPLES / "relief_valve.toml")
    problem = SealProblem.of(case)
    (evaluation,), own = solve_live_loads(case, [problem], live_loads(problem))
    contacts, loads = evaluation.solved_loads.contacts[:own], evaluation.loads[:own]
    for first, again in ((0, 4), (1, 3)):
        assert contacts[first] is contacts[again] and loads[first] is loads[again]
    assert len({id(one) for one in contacts}) == 3


def test_all_lands_are_on_the_page():
    load = {"fluid_pressure": "20 bar", "applied_force": "1 kN"}
    case = fem_seal.Case(**tables("ball", "lands", load=load))
    screen = Session(case).answer({})
    profile, (r, z, half) = screen.profile, screen.section.window
    ((inner, _), (_, outer)) = (land.ends for land in case.bodies[1].lands)
    # both lands in the enlarged picture, which is little more than them
    assert r - half < inner[0] < outer[0] < r + half < outer[0] + 0.5 * (outer[0] - inner[0])
    x, pressure = np.array(profile.x), np.array(profile.pressure)
    (chamber,) = case.contact.chambers
    pressed = pressure > 1e-3 * pressure.max()
    for land in (pressed & (x < chamber), pressed & (x > chamber)):
        assert land.any() and (np.abs(np.array(profile.places)[:, land] - [[r], [z]]) < half).all()
    numbers = {one.name: one for one in numbers_of(screen)}
    assert numbers["peak"].remark == f"on land {1 + (x[pressure.argmax()] > chamber)} from the axis"
    # the line that carries is interrupted between the lands
    lines = section_figure(screen.section, False, profile).data
    (carries,) = (one["x"] for one in lines if one.get("hovertemplate", "").startswith("carries over"))
    assert [one is not None for one in carries] == pressed.tolist()
