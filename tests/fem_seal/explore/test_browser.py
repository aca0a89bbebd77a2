"""The live page in a real browser: what it shows is what `fem-seal run` gives."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time

import pytest

import fem_seal
from fem_seal.case.case import load_case

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(
    CHROMIUM is None or DRIVER is None,
    reason="needs chromium and chromedriver (Debian: chromium chromium-driver)",
)
CASE = """
title = "Ball on cone, in a browser"
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = "steel"
[roughness.spectrum]
kind = "self-affine"
rms_height = "1 um"
hurst = 0.8
q_low = "1e4 1/m"
q_rolloff = "5e4 1/m"
q_high = "1e6 1/m"
[fluid]
name = "water"
[load]
fluid_pressure = "20 bar"
[leak]
plasticity = false
[requirement]
leak_rate = "1 ml/min"
"""
SI = {
    "leak": "leak_rate_m3_per_s",
    "peak": "peak_pressure_Pa",
    "width": "fwhm_m",
    "force": "contact_force_N",
    "line": "line_load_N_per_m",
}
_PATIENCE = 180.0
# as selenium sends them
TAB, ENTER, DOWN = "\ue004", "\ue007", "\ue015"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("explored")
    (folder / "ball.toml").write_text(CASE, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def page(folder):
    """The process of the page and its address."""
    pytest.importorskip("dash", reason="the live page needs the extra [explore]")
    command = [sys.executable, "-m", "fem_seal", "explore", "ball.toml", "--port", "0", "--no-browser"]
    # tests that a shell runs in the background take no notice of Ctrl-C, and what they start would not either
    signal.signal(signal.SIGINT, signal.default_int_handler)
    page = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ}
    )
    try:
        line = page.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", line)
        assert found, line + page.stderr.read()
        yield page, found[0]
    finally:
        page.send_signal(signal.SIGINT)
        try:
            # Ctrl-C ends it, without a word
            assert (page.wait(timeout=30), page.stderr.read()) == (0, "")
        finally:
            page.kill()


@pytest.fixture(scope="module")
def address(page):
    return page[1]


@pytest.fixture(scope="module")
def browser(address):
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium drives the browser")
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1400,1000"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    # a page that draws on a busy machine answers no script meanwhile
    driver.set_script_timeout(_PATIENCE)
    driver.get(address)
    numbers(driver, pressure="20 bar", at_rest=False)
    yield driver
    driver.quit()


@pytest.fixture(autouse=True)
def begun_anew(browser, address):
    """Every test begins with the case of the page, nothing pinned, whatever others have left."""
    click(browser, "#reset")
    # a page that is opened again has the case that was there last
    waited(browser, "return document.querySelector('input[id*=seat_angle]')?.value === '45 deg'")
    numbers(browser, pressure="20 bar", at_rest=False)
    browser.execute_script("sessionStorage.clear()")
    browser.get(address)
    waited(browser, "return document.querySelector('input[id*=seat_angle]') && 1")
    numbers(browser, pressure="20 bar", at_rest=False)
    # the numbers are there before sliders and pictures
    waited(
        browser, "return document.querySelector('[role=slider]') && document.querySelector('.main-svg') && 1"
    )


def click(browser, selector):
    """Click on an element, once the page that numbers still move has it where the click goes."""
    from selenium.common.exceptions import ElementClickInterceptedException, StaleElementReferenceException

    end = time.monotonic() + _PATIENCE
    while True:
        try:
            return browser.find_element("css selector", selector).click()
        except (ElementClickInterceptedException, StaleElementReferenceException):
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


def waited(browser, script, *arguments):
    """What a script returns as soon as it returns anything."""
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        found = browser.execute_script(script, *arguments)
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"nothing came of {script}: {browser.find_element('tag name', 'body').text}")


# all at once: the page may replace its elements between two questions
_NUMBERS = """
const leak = document.getElementById("value-leak"), state = document.getElementById("state");
const at_rest = !arguments[2] || (state && state.innerText.includes("the numbers of"));
const number = name => Number(document.getElementById("value-" + name).dataset.si);
return leak && leak.parentElement.innerText.includes("at " + arguments[0]) && at_rest
    && Object.fromEntries(arguments[1].map(name => [name, number(name)]));
"""


def numbers(browser, *, pressure, at_rest=True):
    """Numbers of the page in SI, once they are those of a pressure and, at rest, of a complete run."""
    return waited(browser, _NUMBERS, pressure, list(SI), at_rest)


def written_case(browser, folder):
    """The case of the file that the page says to have written."""
    said = waited(browser, "return document.getElementById('said').innerText")
    return load_case(folder / re.search(r"ball-explored(-\d+)?\.toml", said)[0])


def shown_by(result):
    row = result.table.iloc[-1]
    return {name: float(row[column]) for name, column in SI.items()}


def test_the_page_shows_what_a_run_gives_and_writes_it(browser, folder):
    first = numbers(browser, pressure="20 bar", at_rest=False)
    click(browser, "#pin")
    waited(browser, "return document.querySelector('#slider-fluid_pressure [role=slider]') && 1")
    thumb = browser.find_element("css selector", "#slider-fluid_pressure [role=slider]")
    for _ in range(5):
        thumb.send_keys("\ue014")  # arrow to the right
    moved = numbers(browser, pressure="24.5 bar")
    assert moved["force"] == pytest.approx(first["force"] * 24.5 / 20, rel=1e-9)

    # the pinned design stands beside it
    rows = waited(browser, "return [...document.querySelectorAll('#compare tr')].map(row => row.innerText)")
    assert any("24.5 bar" in row and "20 bar" in row for row in rows)

    click(browser, "#write")
    written = fem_seal.run(written_case(browser, folder))
    assert moved == pytest.approx(shown_by(written), rel=1e-9)
    word = browser.execute_script("return document.getElementById('verdict-word').textContent")
    assert word == str(written.judgement.verdict)


def test_the_page_is_whole_without_a_network_and_says_nothing_in_the_console(browser, address):
    resources = browser.execute_script(
        "return performance.getEntriesByType('resource').map(entry => entry.name)"
    )
    assert len(resources) > 5
    assert [one for one in resources if not one.startswith((address.split("?")[0], "data:"))] == []
    assert [entry["message"] for entry in browser.get_log("browser")] == []


def wrong_fields(browser):
    """Messages at fields, by their keys, and the keys of the fields that are marked."""
    script = """
    const rows = [...document.querySelectorAll(".row.not-taken")];
    return Object.fromEntries(rows.map(row =>
        [JSON.parse(row.id).key, row.querySelector(".wrong").innerText]));
    """
    return browser.execute_script(script)


def enter(browser, key, text):
    browser.find_element("css selector", f"input[id*={key}]").send_keys("\ue009a\ue000", text + "\n")


def test_a_typed_value_is_taken_and_a_wrong_one_explained(browser):
    field = browser.find_element("css selector", "input[id*=seat_angle]")
    field.send_keys("\ue009a\ue000", "85 deg\n")
    problem = waited(browser, "return document.getElementById('problem').innerText")
    assert problem == 'Not taken: angle, seat = "85 deg". The numbers belong to angle, seat = 45 deg.'
    assert wrong_fields(browser) == {
        "seat_angle": "the slider goes from 30 deg to 60 deg; further away start from another case"
    }
    field.send_keys("\ue009a\ue000", "50.5 deg\n")
    waited(browser, "return document.getElementById('problem').innerText === ''")
    assert "contact angle 50.5°" in waited(
        browser,
        "const g = document.getElementById('graph-section').innerText; return g.includes('50.5') && g",
    )


def test_each_wrong_field_keeps_its_text_and_its_message(browser, folder):
    enter(browser, "fluid_pressure", "24.5 bar")
    before = numbers(browser, pressure="24.5 bar", at_rest=False)
    for key, text in (("fluid_pressure", "20 mm"), ("finish_spectrum", "fine"), ("closure_radius", "3 m")):
        enter(browser, key, text)
    waited(browser, "return document.querySelectorAll('.row.not-taken').length === 3")
    found = wrong_fields(browser)
    assert {
        key: words in found[key]
        for key, words in (
            ("fluid_pressure", 'unit "mm" does not fit'),
            ("finish_spectrum", "does not begin with a number"),
            ("closure_radius", "the slider goes from"),
        )
    } == dict.fromkeys(found, True)
    said = browser.find_element("id", "problem").text
    assert said == (
        'Not taken: fluid pressure = "20 mm"; rms height, both faces = "fine"; radius, closure = "3 m". '
        "The numbers belong to fluid pressure = 24.5 bar; rms height, both faces = 1 um; radius, closure = 20 mm."
    )
    assert numbers(browser, pressure="24.5 bar", at_rest=False)["force"] == pytest.approx(
        before["force"], rel=1e-9
    )

    # what is written is what the numbers belong to, and says so
    click(browser, "#write")
    assert written_case(browser, folder).load.fluid_pressure == (24.5e5,)
    written = browser.find_element("id", "said").text
    assert 'Not taken: fluid pressure = "20 mm"' in written

    # a field is mended, a slider moved, and the third is left as it is
    enter(browser, "fluid_pressure", "30 bar")
    thumb = browser.find_element("css selector", "#slider-closure_radius [role=slider]")
    thumb.send_keys("\ue014")
    waited(browser, "return document.querySelectorAll('.row.not-taken').length === 1")
    assert list(wrong_fields(browser)) == ["finish_spectrum"]
    numbers(browser, pressure="30 bar", at_rest=False)
    field = browser.find_element("css selector", "input[id*=finish_spectrum]")
    assert field.get_attribute("value") == "fine"
    click(browser, "#reset")
    waited(browser, "return document.getElementById('problem').innerText === ''")
    assert wrong_fields(browser) == {}
    # the controls are made anew
    waited(browser, "return document.querySelector('input[id*=finish_spectrum]').value === '1 um'")


def chosen(browser, body):
    """Name of the shape that the page shows as chosen."""
    one = "document.querySelector(`.shape.chosen[id*='\"${arguments[0]}.']`)"
    return waited(browser, f"return {one} && {one}.innerText", body)


@pytest.mark.slow
def test_a_case_is_made_by_choosing_and_taken_back(browser):
    numbers(browser, pressure="20 bar")
    click(browser, "#pin")
    assert (chosen(browser, "closure"), chosen(browser, "seat")) == ("ball", "cone")
    click(browser, "button[id*='seat.sharp-edge']")
    waited(browser, "return document.querySelector('.shape.chosen[id*=sharp-edge]')")
    waited(browser, "return document.querySelector('#slider-seat_bore_radius') && 1")
    choice = "window.dash_clientside.set_props({kind: 'choice', key: 'report.units'}, {value: 'US'})"
    browser.execute_script(choice)
    waited(browser, "return document.getElementById('numbers').innerText.includes('ksi')")
    field = browser.find_element("css selector", "input[id*=fluid_pressure]")
    assert field.get_attribute("value") == "290.075 psi"
    click(browser, "#undo")
    waited(browser, "return document.querySelector('input[id*=fluid_pressure]').value === '20 bar'")
    assert chosen(browser, "seat") == "edge of the bore"
    click(browser, "#undo")
    waited(browser, "return document.querySelector('.shape.chosen[id*=\"seat.cone\"]') && 1")
    waited(browser, "return document.querySelector('input[id*=fluid_pressure]').value === '20 bar'")
    click(browser, "#redo")
    waited(browser, "return document.querySelector('.shape.chosen[id*=sharp-edge]')")
    click(browser, "#reset")
    waited(browser, "return document.querySelector('.shape.chosen[id*=\"seat.cone\"]') && 1")


_PINNED = "document.querySelectorAll('#pinned button[id*=remove]').length"
# every control that can be seen, and whatever has the focus, by its kind and the name of its place
_CONTROLS = """
const place = one => [one.tagName, (one.closest("[id]") || {id: ""}).id].join(" ");
if (arguments[0]) {
    const all = "button, input[type=text], summary, [role=slider]";
    return [...document.querySelectorAll(all)].filter(one => one.checkVisibility() && !one.disabled).map(place);
}
const one = document.activeElement, outline = getComputedStyle(one);
return [place(one), outline.outlineStyle === "solid" && parseFloat(outline.outlineWidth) >= 2];
"""


def pressed(browser, *keys):
    from selenium.webdriver.common.action_chains import ActionChains

    for key in keys:
        ActionChains(browser).send_keys(key).perform()


def focus(browser, selector):
    browser.execute_script("document.querySelector(arguments[0]).focus()", selector)


def test_every_control_is_reached_by_the_tabulator_with_a_focus_that_can_be_seen(browser):
    numbers(browser, pressure="20 bar", at_rest=False)
    browser.execute_script("const h = document.querySelector('h1'); h.tabIndex = -1; h.focus()")
    controls, reached = browser.execute_script(_CONTROLS, True), []
    for _ in range(len(controls) + 10):
        pressed(browser, TAB)
        place, seen = browser.execute_script(_CONTROLS, False)
        if place.startswith("BODY"):
            break
        assert seen, place
        reached.append(place)
    assert set(controls) - set(reached) == set()


@pytest.mark.slow
def test_controls_are_used_by_keyboard_and_each_undo_counts(browser):
    numbers(browser, pressure="20 bar", at_rest=False)
    material = "document.querySelector(\"button[id*='seat.material']\")?.innerText"
    first = waited(browser, f"return {material}")
    focus(browser, "button[id*='seat.sharp-edge']")
    pressed(browser, ENTER)
    waited(browser, "return document.querySelector('.shape.chosen[id*=sharp-edge]') && 1")
    # made anew, it still has the focus
    waited(browser, "return document.activeElement.id.includes('seat.sharp-edge')")
    numbers(browser, pressure="20 bar", at_rest=False)
    edge = waited(browser, "return window.present.case")
    focus(browser, "button[id*='seat.material']")
    pressed(browser, ENTER)
    # the list has the focus a moment after it is there, and goes to its next row when that is drawn
    option = "document.activeElement.closest('.dash-dropdown-content label')?.innerText"
    chosen = waited(browser, f"return {option}")
    while browser.execute_script(f"return {option}") == chosen:
        pressed(browser, DOWN)
        time.sleep(0.2)
    pressed(browser, ENTER)
    waited(browser, f"return {material} !== arguments[0]", first)
    # the list shows what is chosen before the page has its case, and only then is there something to undo
    waited(browser, "return window.present.case !== arguments[0]", edge)
    focus(browser, "#undo")
    # the second one before the first is answered
    pressed(browser, ENTER, ENTER)
    waited(browser, "return document.querySelector('.shape.chosen[id*=\"seat.cone\"]') && 1")
    waited(browser, f"return {material} === arguments[0]", first)
    focus(browser, "#redo")
    pressed(browser, " ", " ")
    waited(browser, "return document.querySelector('.shape.chosen[id*=sharp-edge]') && 1")
    waited(browser, f"return {material} !== arguments[0]", first)
    # there is nothing to be done again: the focus is on its neighbour
    waited(browser, "return document.activeElement.id === 'undo'")
    focus(browser, "#pin")
    pressed(browser, ENTER)
    waited(browser, f"return {_PINNED} === 1")
    focus(browser, "#reset")
    pressed(browser, " ")
    waited(browser, "return document.querySelector('.shape.chosen[id*=\"seat.cone\"]') && 1")
    # while answers still make the button anew
    numbers(browser, pressure="20 bar", at_rest=False)
    focus(browser, "#pinned button[id*=remove]")
    pressed(browser, ENTER)
    waited(browser, f"return {_PINNED} === 0")


# a button is clicked while the page asks for another drawing, which comes before the answer to the click
_MEANWHILE = """
const ask = window.fetch, button = document.getElementById(arguments[0]), after = time =>
    new Promise(done => setTimeout(done, time));
let clicked, drawn;
const click = new Promise(done => { clicked = done; }), drawing = new Promise(done => { drawn = done; });
window.fetch = async (...asked) => {
    const body = String((asked[1] || {}).body), answer = await ask(...asked);
    if (body.includes('"dark.data"')) { button.click(); await click; drawn(); }
    if (body.includes(`"${arguments[0]}.n_clicks"`)) { clicked(); await drawing; await after(1000); }
    return answer;
};
window.dash_clientside.set_props("dark", {data: arguments[1]});
"""


def test_no_click_is_lost_when_pinned_designs_are_drawn_anew(browser):
    click(browser, "#pin")
    waited(browser, f"return {_PINNED} === 1")
    enter(browser, "fluid_pressure", "24 bar")
    numbers(browser, pressure="24 bar", at_rest=False)
    browser.execute_script(_MEANWHILE, "pin", True)
    waited(browser, f"return {_PINNED} === 2")
    browser.execute_script(_MEANWHILE, "reset", False)
    waited(browser, "return document.querySelector('input[id*=fluid_pressure]').value === '20 bar'")


def test_buttons_of_pinned_designs_stay_while_the_table_follows(browser):
    """Made anew between press and release they would get no click."""
    click(browser, "#pin")
    waited(browser, f"return {_PINNED} === 1")
    browser.execute_script("window.held = document.querySelector('#pinned button[id*=take]')")
    enter(browser, "fluid_pressure", "24 bar")
    waited(browser, "return document.getElementById('compare').innerText.includes('24 bar')")
    assert browser.execute_script("return window.held.isConnected")
    click(browser, "#pinned button[id*=take]")
    waited(browser, "return document.querySelector('input[id*=fluid_pressure]').value === '20 bar'")
    click(browser, "#pinned button[id*=remove]")
    waited(browser, f"return {_PINNED} === 0")


def test_a_case_file_is_that_of_the_sliders_before_they_are_answered(browser, folder):
    """It was that of the design asked for last."""
    browser.execute_script("window.onItsWay = {number: 1e9, since: Date.now() + 1e9, answered: 0}")
    enter(browser, "fluid_pressure", "24 bar")
    waited(browser, "return window.present.fluid_pressure === '24 bar'")
    click(browser, "#write")
    said = waited(browser, "return document.getElementById('said').innerText")
    browser.execute_script("window.onItsWay = undefined")
    assert '"24 bar"' in (folder / re.search(r"Written: (.+?\.toml)", said)[1]).read_text(encoding="utf-8")


def test_a_design_is_undone_before_it_is_answered(browser):
    browser.execute_script("window.onItsWay = {number: 1e9, since: Date.now() + 1e9, answered: 0}")
    enter(browser, "fluid_pressure", "24 bar")
    waited(
        browser,
        "return window.present.fluid_pressure === '24 bar' && !document.getElementById('undo').disabled",
    )
    click(browser, "#undo")
    waited(browser, "return window.present.fluid_pressure === '20 bar'")
    waited(
        browser,
        "return document.getElementById('undo').disabled && !document.getElementById('redo').disabled",
    )
    browser.execute_script("window.onItsWay = undefined")
    click(browser, "#redo")
    numbers(browser, pressure="24 bar", at_rest=False)


@pytest.mark.parametrize("width", [1400, 400])
def test_the_page_is_for_everybody_wide_and_narrow(browser, width):
    axe = pytest.importorskip("axe_core_python.selenium", reason="axe-core judges the page")
    numbers(browser, pressure="20 bar", at_rest=False)
    size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    try:
        # pictures take their new width in a moment
        waited(browser, "return document.documentElement.scrollWidth <= arguments[0]", width)
        found = axe.Axe().run(browser)["violations"]
        assert [(one["id"], [node["html"] for node in one["nodes"]]) for one in found] == []
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def workers(page):
    listed = subprocess.run(
        ["ps", "-ww", "--ppid", str(page.pid), "-o", "pid=,args="], capture_output=True, text=True, check=True
    )
    # one that was killed stays on the list until it is next asked for something
    others = ("resource_tracker", "<defunct>")
    return [
        int(line.split()[0]) for line in listed.stdout.splitlines() if not any(map(line.__contains__, others))
    ]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="processes are killed with SIGKILL")
def test_killed_processes_are_replaced_and_a_report_is_made_all_the_same(browser, page, folder):
    killed = workers(page[0])
    assert len(killed) == 2
    click(browser, "#report")
    waited(browser, "return document.getElementById('report-said').innerText.includes('is being made')")
    for one in killed:
        os.kill(one, signal.SIGKILL)
    said = waited(browser, "return document.getElementById('lost').innerText")
    assert "was killed (SIGKILL)" in said
    assert "Another one has taken its place" in said
    waited(browser, "return document.getElementById('report-said').innerText.startsWith('Report in')")
    written = re.search(r"Report in (.+):", browser.find_element("id", "report-said").text)[1]
    assert (folder / written / "report.html").stat().st_size > 10_000
    assert set(workers(page[0])).isdisjoint(killed)


def test_a_material_is_found_by_typing_and_chosen_by_keyboard(browser):
    numbers(browser, pressure="20 bar", at_rest=False)
    material = "(document.querySelector(\"button[id*='seat.material']\") || {}).innerText"
    first = waited(browser, f"return {material}")
    focus(browser, "button[id*='seat.material']")
    # the number of 316L in EN 10088: the first key opens the search
    pressed(browser, *"1.4404")
    waited(browser, "return document.querySelectorAll('.dash-options-list-option').length === 1")
    pressed(browser, ENTER)
    assert waited(browser, f"return {material} !== arguments[0] && {material}", first).startswith("316L")
    # the picker closes, and the numbers are those of the new seat
    waited(browser, "return !document.querySelector('.dash-dropdown-content')")
    numbers(browser, pressure="20 bar", at_rest=False)
    click(browser, "#undo")
    waited(browser, f"return {material} === arguments[0]", first)


def test_of_two_choices_at_once_both_are_taken(browser):
    """Dash takes no notice of the answer to the first when it asks for the second."""
    material = "(document.querySelector(\"button[id*='seat.material']\") || {}).innerText"
    choice = "window.dash_clientside.set_props({{kind: 'choice', key: '{}'}}, {{value: '{}'}});"
    script = [
        "const ask = window.fetch;",
        "window.fetch = (...asked) => { window.fetch = ask; const answer = ask(...asked);",
        choice.format("report.units", "US"),
        choice.format("fluid.name", "diesel"),
        "return answer; };",
        choice.format("seat.material", "316L"),
    ]
    browser.execute_script("".join(script))
    waited(browser, "return document.getElementById('numbers').innerText.includes('ksi')")
    assert waited(browser, f"return {material}").startswith("316L")
    assert browser.find_element("css selector", "button[id*='fluid.name']").text == "diesel"
    click(browser, "#undo")
    waited(browser, "return document.querySelector('input[id*=fluid_pressure]').value === '20 bar'")
