"""What an assistant gets: scripted tasks over standard input and output, by the client of the SDK.

Each ends with the right verdict or the right refusal. One server answers them all.
"""

import base64
import math
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import anyio
import pytest
from anyio.from_thread import start_blocking_portal
from mcp import Client
from mcp.client.stdio import StdioServerParameters
from places import EXAMPLES, ROOT

import fem_seal
from fem_seal.answers.testplan import plan_leak_test
from fem_seal.errors import InputError
from fem_seal.mcp.folder import MOST_BYTES, Folder, folder_at
from fem_seal.mcp.manual import explain, search
from fem_seal.mcp.server import Worker

SMOOTH = """\
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"

[seat]
shape = "cone"
angle = "45 deg"
material = "steel"

[load]
fluid_pressure = "20 bar"
"""
LEAKS = f"""\
{SMOOTH}
[roughness.spectrum]
kind = "self-affine"
rms_height = "1 um"
hurst = 0.8
q_low = "1e4 1/m"
q_rolloff = "5e4 1/m"
q_high = "1e6 1/m"

[leak]
plasticity = false

[fluid]
name = "water"
"""
HARD = f'{SMOOTH}\n[interface]\nlaw = "smooth"\n'
ANGLES = 'responses = ["peak_pressure_Pa"]\n[parameters]\n"seat.angle" = ["40 deg", "50 deg"]\n'
TOOLS = {
    "new_case",
    "check_case",
    "run_case",
    "leak_of_profile",
    "study",
    "calibrate",
    "testplan",
    "explain",
    "search_manual",
}


def required(rate: str) -> str:
    return f'{LEAKS}\n[requirement]\nleak_rate = "{rate}"\n'


class Assistant:
    """Asks a server, and keeps what it is told meanwhile."""

    def __init__(self, portal, client, folder):
        self.portal, self.client, self.folder = portal, client, folder
        self.told = []

    def ask(self, tool, **arguments):
        """The answer; it is never a refusal."""
        result = self.call(tool, arguments)
        assert not result.is_error, result.content[0].text
        return result.structured_content

    def refused(self, tool, **arguments):
        """Why nothing is answered."""
        result = self.call(tool, arguments)
        assert result.is_error
        return result.structured_content["refused"]

    def call(self, tool, arguments, patience=60.0):
        async def progress(done, total, message):
            self.told.append(message)

        async def call():
            with anyio.move_on_after(patience):
                return await self.client.call_tool(tool, arguments, progress_callback=progress)

        self.told.clear()
        return self.portal.call(call)


def parameters(folder):
    environment = {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    return StdioServerParameters(
        command=sys.executable, args=["-m", "fem_seal", "mcp", "--folder", str(folder)], env=environment
    )


@pytest.fixture(scope="module")
def places(tmp_path_factory):
    """The folder of the server, and one beside it."""
    place = tmp_path_factory.mktemp("assistant")
    inside, outside = place / "inside", place / "outside"
    inside.mkdir()
    outside.mkdir()
    (outside / "case.toml").write_text(LEAKS)
    (outside / "seat.csv").write_text("plastic_strain,stress [MPa]\n0,250\n0.1,350\n")
    (inside / "case.toml").write_text(LEAKS)
    (inside / "away").symlink_to(outside)
    return inside, outside


@pytest.fixture(scope="module")
def assistant(places):
    inside, _ = places
    with (
        start_blocking_portal() as portal,
        portal.wrap_async_context_manager(Client(parameters(inside))) as client,
    ):
        yield Assistant(portal, client, inside)
    # what was written meanwhile goes with the server
    assert not list(inside.glob(".fem-seal-*"))


# --- a case, from the drawing to the verdict --------------------------------------------------------------


def test_the_tools_are_there_and_say_what_they_are_for(assistant):
    tools = {tool.name: tool for tool in assistant.portal.call(assistant.client.list_tools).tools}
    assert set(tools) == TOOLS
    assert all(tool.description for tool in tools.values())
    harmless = {name for name, tool in tools.items() if tool.annotations.read_only_hint}
    assert harmless == {"check_case", "explain", "search_manual"}
    assert "case_toml" in tools["run_case"].input_schema["properties"]


def test_what_a_tool_does_not_know_is_refused(assistant):
    said = assistant.refused("run_case", case_path="case.toml", force="900 N")
    assert said.startswith("force: is no argument of run_case, which has case_path, case_toml")
    assert assistant.ask("search_manual", words="qqqq zzzz")["next"]["tool"] == "search_manual"


def test_a_case_from_the_words_of_a_drawing(assistant):
    first = assistant.ask("new_case")
    assert "ball-valve" in first["templates"] and "case.toml" in first["files"]
    made = assistant.ask(
        "new_case",
        template="ball-valve",
        answers={"bore": "20 mm", "fluid": "nitrogen", "ra": "0.2 um"},
        entries={"seat.land_width": "1 mm"},
    )
    tables = tomllib.loads(made["case_toml"])
    assert tables["fluid"]["name"] == "nitrogen" and tables["leak"]["nominal_size"] == "20 mm"
    assert tables["roughness"]["Ra"] == "0.2 um" and tables["seat"]["land_width"] == "1 mm"
    assert made["next"]["tool"] == "check_case"
    checked = assistant.ask("check_case", case_toml=made["case_toml"])
    assert checked["judged"][0].startswith("ISO 5208 D") and checked["case_toml"] == made["case_toml"]


def test_a_template_without_such_an_entry_is_refused(assistant):
    assert "--torque: is not in the template needle" in assistant.refused(
        "new_case", template="needle", answers={"torque": "3 N m"}
    )
    assert "gasket" in assistant.refused("new_case", template="gaskett")


def test_a_new_file_is_written_once(assistant):
    made = assistant.ask("new_case", template="check-valve", file="valve.toml")
    assert (assistant.folder / made["file"]).read_text() == made["case_toml"]
    assert "nothing is written over" in assistant.refused(
        "new_case", template="check-valve", file="valve.toml"
    )


def test_check_has_the_closed_forms_and_a_picture(assistant):
    result = assistant.call("check_case", {"case_toml": HARD, "picture": True})
    (load,) = result.structured_content["loads_SI"]
    # r0 = R sin(theta), F = pi r0^2 p
    assert load["contact_force_N"] == pytest.approx(math.pi * 2e-4 * 2e6)
    assert load["hertz_peak_pressure_Pa"] == pytest.approx(191.646e6, rel=1e-5)
    _, picture = result.content
    assert picture.mime_type == "image/png" and base64.b64decode(picture.data).startswith(b"\x89PNG")


def test_a_number_without_a_unit_is_refused_and_explained(assistant):
    text = HARD.replace('"20 mm"', "20")
    result = assistant.call("check_case", {"case_toml": text}).structured_content
    (wrong,) = result["problems"]
    assert wrong["key"] == "closure.radius" and "has no unit" in wrong["message"]
    assert result["case_toml"] == text
    assert result["next"] == {"tool": "explain", "why": "key: closure.radius"}
    (found, *_) = assistant.ask("explain", kind="key", name="closure.radius")["found"]
    assert "radius R of the ball" in found["text"]


def test_a_misspelt_key_is_refused_with_the_nearest(assistant):
    assert "angle" in assistant.refused("run_case", case_toml=HARD.replace("angle =", "angel ="))


def test_a_seal_that_passes_as_in_python(assistant):
    (assistant.folder / "passes.toml").write_text(required("10 l/min"))
    answer = assistant.ask("run_case", case_path="passes.toml")
    assert answer["verdict"] == "pass" and answer["case_toml"] == required("10 l/min")
    assert answer["next"]["tool"] == "calibrate"
    low, high = answer["interval_m3_per_s"]
    assert low <= answer["loads_SI"][0]["leak_rate_m3_per_s"] <= high
    load = fem_seal.run(assistant.folder / "passes.toml", sensitivities=False).loads[0]
    assert (low, high) == pytest.approx(load.leak_interval, rel=1e-9)
    assert not list(assistant.folder.glob("*.out"))


def test_a_seal_that_fails_and_what_helps(assistant):
    answer = assistant.ask("run_case", case_toml=required("1 ul/min"))
    assert answer["verdict"] == "fail" and answer["says"].startswith("Fail")
    assert answer["decides"] and answer["next"]["tool"] == "study"


def test_a_limit_within_the_interval_decides_nothing(assistant):
    low, high = assistant.ask("run_case", case_toml=LEAKS)["interval_m3_per_s"]
    assert high > 1.01 * low
    answer = assistant.ask("run_case", case_toml=required(f"{math.sqrt(low * high)} m^3/s"))
    assert answer["verdict"] not in ("pass", "fail", None)


def test_outside_the_theory_is_said_and_explained(assistant):
    soft = required("10 l/min").replace(
        'material = "steel"\n\n[load]',
        'material = { youngs_modulus = "210 GPa", poissons_ratio = 0.3, yield_stress = "5 MPa" }\n\n[load]',
    )
    answer = assistant.ask("run_case", case_toml=soft)
    assert answer["validity"]["level"] == "outside the theory"
    assert answer["verdict"] not in ("pass", "fail") and answer["next"]["tool"] == "explain"
    (found,) = assistant.ask("explain", kind="validity", name=answer["validity"]["reasons"][0])["found"]
    assert found["name"] == "yield stress"


def test_a_seal_that_opens_is_refused(assistant):
    opens = HARD.replace("[load]", '[load]\npressure_side = "inner"\napplied_force = "100 N"')
    assert "open" in assistant.refused("run_case", case_toml=opens)


def test_without_roughness_there_is_no_leak_rate(assistant):
    answer = assistant.ask("run_case", case_toml=HARD)
    assert answer["verdict"] is None and answer["interval_m3_per_s"] is None
    assert "no leak rate" in answer["says"]


def test_results_and_picture_where_they_are_asked_for(assistant):
    arguments = {"case_path": "case.toml", "results_folder": "runs/first", "picture": True}
    result = assistant.call("run_case", arguments)
    files = result.structured_content["files"]
    assert "runs/first/report.html" in files and all((assistant.folder / file).is_file() for file in files)
    assert [part.type for part in result.content] == ["text", "image"]
    assert "meshing closure and seat" in assistant.told
    assert "nothing is written over" in assistant.refused("run_case", **arguments)


# --- profiles, studies, readings --------------------------------------------------------------------------


def test_a_pressure_of_another_program_seals_better_where_it_is_higher(assistant):
    def high(peak):
        rows = "".join(f"{x / 100:g},{peak * (1 - (x / 20) ** 2):g}\n" for x in range(-20, 21))
        table = f"x [mm],contact_pressure [MPa]\n{rows}"
        answer = assistant.ask("leak_of_profile", profile_csv=table, case_path="case.toml")
        return answer["interval_m3_per_s"][1]

    assert 0.0 < high(200) < high(100)


def test_a_study_of_two_angles(assistant):
    answer = assistant.ask("study", study_toml=ANGLES, case_toml=HARD)
    # those of the example of StudyResult
    assert [round(row["peak_pressure_Pa"], -6) for row in answer["designs_SI"]] == [176e6, 209e6]
    assert assistant.told == ["1 of 2 designs", "2 of 2 designs"]
    many = ANGLES.replace('["40 deg", "50 deg"]', '{ start = "40 deg", stop = "50 deg", num = 501 }')
    assert "has 501 designs" in assistant.refused("study", study_toml=many, case_toml=HARD)


def test_a_reading_that_contradicts_the_case_is_told(assistant):
    # no seal of this case leaks a thousand times more at a tenth of the pressure
    table = "fluid_pressure [bar],leak_rate [ml/min],uncertainty [%]\n2,1e6,5\n"
    answer = assistant.ask("calibrate", measured_csv=table, case_path="case.toml")
    assert answer["summary_SI"]["conflict"] is not None and answer["verdict"] is None
    assert "leak_rate" in assistant.refused(
        "calibrate", measured_csv="fluid_pressure [bar]\n2\n", case_path="case.toml"
    )


def test_a_leak_test_is_planned_and_its_table_written(assistant):
    answer = assistant.ask("testplan", case_path="case.toml", results_folder="planned")
    plan = plan_leak_test(fem_seal.load_case(assistant.folder / "case.toml"))
    expected = [reading.load.leak_interval for reading in plan.readings]
    assert [reading["expected_m3_per_s"] for reading in answer["loads_SI"]] == [
        pytest.approx(interval, rel=1e-9) for interval in expected
    ]
    assert answer["decides"] and answer["next"]["tool"] == "calibrate"
    assert answer["files"] == ["planned/protocol.md", "planned/readings.csv"]
    assert "case.toml" in (assistant.folder / answer["files"][0]).read_text()


# --- nothing outside of the folder, and nothing without end ------------------------------------------------


@pytest.mark.parametrize("path", ["../outside/case.toml", "away/case.toml", "/etc/hostname", "a\0b"])
def test_a_case_outside_is_refused(assistant, path):
    assert "leads out of the folder" in assistant.refused("run_case", case_path=path)
    assert "leads out of the folder" in assistant.refused("check_case", case_path=path)


SEAT = 'material = "steel"\n\n[load]'
CURVE = 'material = {{ name = "steel", stress_strain = {{ file = "{}" }} }}\n\n[load]'
DRAWN = f'shape = "profile"\nfile = "{EXAMPLES / "seat.dxf"}"'
OUTSIDE = {
    "a stress-strain curve by ..": HARD.replace(SEAT, CURVE.format("../outside/seat.csv")),
    "a stress-strain curve by a link": HARD.replace(SEAT, CURVE.format("away/seat.csv")),
    "a drawing by its path": HARD.replace('shape = "cone"\nangle = "45 deg"', DRAWN),
    "scans": f'{SMOOTH}\n[roughness]\nfiles = ["scan.csv", "../outside/scan.csv"]\n',
    "the results": f'{HARD}\n[output]\nfolder = "../outside/results"\n',
    "a key that is not known": f'{HARD}\n[later]\nplace = "away/x"\n',
}


@pytest.mark.parametrize("text", OUTSIDE.values(), ids=OUTSIDE)
def test_a_file_of_a_case_outside_is_refused(assistant, text):
    before = set(assistant.folder.parent.rglob("*"))
    assert "leads out of the folder" in assistant.refused("check_case", case_toml=text)
    assert set(assistant.folder.parent.rglob("*")) == before


def test_a_study_outside_is_refused(assistant):
    assert "leads out" in assistant.refused("study", study_toml=f'base = "../outside/case.toml"\n{ANGLES}')
    (assistant.folder / "list.csv").write_text("seat.angle [deg],closure.file\n40,/etc/hostname\n")
    listed = 'base = "case.toml"\n[design]\nkind = "list"\nfile = "list.csv"\n'
    assert "leads out" in assistant.refused("study", study_toml=listed)
    (assistant.folder / "bad.toml").write_text(OUTSIDE["the results"])
    assert "leads out" in assistant.refused("study", study_toml=f'base = "bad.toml"\n{ANGLES}')
    assert "leads out" in assistant.refused(
        "study", study_toml=ANGLES, case_toml=HARD, results_folder="away/study"
    )


@pytest.mark.parametrize("given", ["answers", "entries"])
def test_a_new_case_with_a_file_outside_is_refused(assistant, given):
    name = {"answers": "seat-material", "entries": "seat.material"}[given]
    value = '{ name = "steel", stress_strain = { file = "../outside/seat.csv" } }'
    others = {"answers": {"class": "C"}, "entries": {}}
    arguments = others | {given: others[given] | {name: value}}
    assert "leads out" in assistant.refused("new_case", template="ball-valve", **arguments)


def test_nothing_is_written_outside(assistant, places):
    _, outside = places
    before = sorted(outside.iterdir())
    for name in ("../outside/new", "away/new", str(outside / "new")):
        assert "leads out" in assistant.refused("run_case", case_toml=HARD, results_folder=name)
        assert "leads out" in assistant.refused("new_case", template="needle", file=f"{name}.toml")
    assert sorted(outside.iterdir()) == before


def test_sizes_are_limited_and_one_case_is_meant(assistant):
    long = f"{HARD}# {'x' * MOST_BYTES}\n"
    assert "is longer than 256 kB" in assistant.refused("check_case", case_toml=long)
    (assistant.folder / "long.toml").write_text(long)
    assert "case_path: is longer than 256 kB" in assistant.refused("check_case", case_path="long.toml")
    assert "none.toml: cannot be read" in assistant.refused("check_case", case_path="none.toml")
    assert "are both given" in assistant.refused("check_case", case_path="case.toml", case_toml=HARD)
    assert "is missing" in assistant.refused("run_case")
    assert "list of other files" in assistant.refused(
        "leak_of_profile", profile_path="steps.pvd", case_path="case.toml"
    )


def test_a_run_that_is_cancelled_makes_room_for_the_next(assistant):
    # takes minutes
    text = (EXAMPLES / "relief_valve_350_bar.toml").read_text()
    assert assistant.call("run_case", {"case_toml": text}, patience=2.0) is None
    assert assistant.told
    assert assistant.ask("check_case", case_toml=HARD)["says"].startswith("valid")


class Deaf:
    """A client that asks for no progress."""

    async def report_progress(self, *arguments, **options):
        pass


def test_an_answer_has_a_time_limit(tmp_path):
    worker = Worker(folder_at(tmp_path), str(tmp_path), 0.2)

    async def ask():
        return await worker.ask(
            Deaf(), "run_case", case_path="", case_toml=HARD, results_folder="", picture=False
        )

    try:
        result = anyio.run(ask)
    finally:
        worker.end()
    assert result.is_error and "was ended" in result.structured_content["refused"]
    assert result.structured_content["case_toml"] == HARD


# --- what the program knows of itself ---------------------------------------------------------------------


def test_columns_and_keys_are_explained(assistant):
    (found, *_) = assistant.ask("explain", kind="column", name="leak_rate_high")["found"]
    assert found["name"] == "leak_rate_high_m3_per_s" and "upper end" in found["text"]
    assert "seat.angle" in assistant.refused("explain", kind="key", name="seat.angel")
    hits = assistant.ask("search_manual", words="which key holds the roughness of a drawing, Ra?")["found"]
    assert any(hit["name"].endswith(".Ra") for hit in hits)


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("angle of the seat", "seat.angle"),
        ("poppet on the edge of a bore held by a spring", "relief-valve"),
        ("viton", ""),
        ("von Mises stress above yield stress", "yield stress"),
        ("helium", "helium"),
    ],
)
def test_words_find_what_they_are_about(words, name):
    assert name in [entry.name for entry in search(words)] or (not name and not search(words))


def test_what_is_explained_comes_with_an_installed_program():
    package = Path(fem_seal.__file__).parent
    assert all("docs" not in str(path) for path in (package / "mcp").glob("*.py"))
    assert "180 deg minus" not in explain("key", "seat.angle")[0].text
    with pytest.raises(InputError, match=r"near it are .*margin"):
        explain("column", "margins")


def test_a_drawing_word_is_the_key_that_it_stands_for():
    assert explain("key", "seat.bore_diameter") == explain("key", "seat.bore_radius")


def test_a_folder_has_to_be_there(tmp_path):
    with pytest.raises(InputError, match="--folder"):
        folder_at(tmp_path / "missing")
    assert Folder(tmp_path).inside("a/../b", "key") == tmp_path / "b"


def test_without_the_extra_the_command_says_how_to_install_it():
    code = "import sys; sys.modules['mcp'] = None; from fem_seal.cli.app import main; sys.exit(main(['mcp']))"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False, env=environment
    )
    assert done.returncode == 2 and "pip install fem-seal[mcp]" in done.stderr
