"""The command line through real files: what it prints, what it writes, how it leaves."""

import csv
import json
import os
import subprocess
import sys
from unittest.mock import Mock

import numpy as np
import pytest
from places import EXAMPLES

import fem_seal
import leak
from fem_seal.cli import app as cli
from fem_seal.errors import ConvergenceError
from fem_seal.output.columns import columns_of

CASE = EXAMPLES / "ball_cone.toml"
PROFILE = EXAMPLES / "profile_from_another_code.csv"


def program(*arguments, **options):
    """Run the program in a process of its own."""
    command = [sys.executable, "-m", "fem_seal", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False, **options)


@pytest.fixture
def call(capsys):
    """Run the command line in this process; exit code, stdout, stderr."""

    def run(*arguments):
        code = cli.main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        return code, out, err

    return run


@pytest.fixture
def changed(tmp_path):
    """Write the main example with replaced text."""

    def write(old, new, name="case.toml"):
        text = CASE.read_text()
        assert old in text
        path = tmp_path / name
        path.write_text(text.replace(old, new))
        return path

    return write


# --- start ------------------------------------------------------------------------------------------------


def test_version():
    done = program("--version")
    assert (done.returncode, done.stdout, done.stderr) == (0, f"fem-seal {fem_seal.__version__}\n", "")


# What reading a case takes no longer than it must: units that nearly every case is written in need no pint, the few
# numbers of the closed forms no scipy, and nothing of the finite elements is loaded before there is a mesh.
HEAVY = {"gmsh", "pyvista", "vtk", "skfem", "meshio", "matplotlib", "pandas"}
ALSO_HEAVY = {
    "pint",
    "scipy",
    "numpy.ma",
    "jinja2",
    "concurrent.futures",
    "fem_seal.bodies.constrained_body",
    "leak.direct",
}
# Commands in their order, and what none of them has loaded up to its end.
LOADED_BY = """
import sys
from fem_seal.cli.app import main
for words, heavy in {asked!r}:
    code = main(words)
    print("loaded:", code, *sorted(heavy & set(sys.modules)))
# what the live page shows, before there is a page
import fem_seal.explore.live
print("loaded:", *sorted({{"dash", "plotly", "flask"}} & set(sys.modules)))
"""


def test_commands_load_no_more_than_they_need(tmp_path):
    """Asked of one process: what a command has loaded stays, so that those that may load least come first."""
    asked = [
        (["--version"], HEAVY | ALSO_HEAVY | {"numpy"}),
        (["check", str(CASE)], HEAVY | ALSO_HEAVY),
        (["schema"], HEAVY),
        # its report is drawn
        (["leak", str(PROFILE), str(CASE), "-o", str(tmp_path / "leak")], HEAVY - {"matplotlib"}),
        # gmsh is there; meshio would load eighty readers and writers of other formats first
        (["mesh", str(CASE), "-o", str(tmp_path / "mesh")], {"gmsh", "meshio"}),
    ]
    code = LOADED_BY.format(asked=asked)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    loaded = [line for line in done.stdout.splitlines() if line.startswith("loaded:")]
    assert loaded == [*["loaded: 0"] * 4, "loaded: 0 gmsh", "loaded:"], done.stderr


def test_usage_errors_leave_with_2(call):
    assert program("no-such-command").returncode == 2
    # what `main` returns the process leaves with
    assert call("run")[0] == 2
    assert call("run", CASE, "--no-such-option")[0] == 2


# --- check and schema -------------------------------------------------------------------------------------


def test_check_prints_the_derived_numbers(call):
    code, out, err = call("check", CASE)
    assert code == 0
    assert "is valid" in out
    assert "14.14 mm" in out  # R sin(theta)
    assert "115.4 GPa" in out  # E*
    assert "191.6" in out  # Hertz p0 at 20 bar
    assert err == ""


def test_check_json_is_si(call):
    code, out, _ = call("check", "--json", CASE)
    numbers = json.loads(out)
    assert code == 0
    assert numbers["touch_radius_m"] == pytest.approx(0.0141421, rel=1e-5)
    assert numbers["loads"][-1]["line_load_N_per_m"] == pytest.approx(20e3)
    assert numbers["loads"][-1]["hertz_peak_pressure_Pa"] == pytest.approx(191.646e6, rel=1e-5)


def test_check_quiet_prints_nothing(call):
    assert call("check", "--quiet", CASE) == (0, "", "")


@pytest.mark.parametrize(("words", "title"), [([], "fem-seal case"), (["--study"], "fem-seal study")])
def test_schema_is_printed(call, words, title):
    """What it says of cases and slips: tests/fem_seal/case/test_schema.py."""
    code, out, _ = call("schema", *words)
    schema = json.loads(out)
    assert code == 0
    assert schema["title"] == title
    # definitions are called by their subject: no name changes when a file moves
    assert not [name for name in schema["$defs"] if "fem_seal" in name]


# --- wrong input ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["run", "check", "mesh"])
@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('angle = "45 deg"', 'angle = "95 deg"', "seat.angle"),
        ('angle = "45 deg"', 'angel = "45 deg"', "do you mean angle?"),
        ('radius = "20 mm"', "radius = 20", "closure.radius"),
        ('radius = "20 mm"', "radius = 20 mm", "not valid TOML"),
        ('radius = "20 mm"', "radius = 20 mm", "need quotes"),
        ('radius = "20 mm"', 'radius = "20 bar"', "closure.radius"),
        (', hardness = "3.5 GPa"', "", "needs a hardness"),
        ('q_low = "1e3 1/m"', 'q_low = "1e9 1/m"', "q_low"),
        ('name = "water"', 'name = "watre"', "fluid"),
    ],
)
def test_wrong_input_leaves_with_2_and_names_file_and_key(call, changed, command, old, new, said):
    path = changed(old, new)
    code, out, err = call(command, path)
    assert code == 2
    assert out == ""
    assert str(path) in err
    assert said in err
    assert "Traceback" not in err


def test_missing_case_file_and_unusable_output_folder(call, tmp_path):
    code, _, err = call("run", tmp_path / "none.toml")
    assert code == 2
    assert "none.toml: cannot be read (no such file or directory)" in err
    (tmp_path / "taken").write_text("")
    code, _, err = call("run", CASE, "-o", tmp_path / "taken")
    assert code == 2
    assert "--output" in err
    assert "taken" in err


# --- failures ---------------------------------------------------------------------------------------------


def fail_with(monkeypatch, error):
    from fem_seal import result as seal_result

    monkeypatch.setattr(seal_result, "run", Mock(side_effect=error))


def test_no_convergence_leaves_with_3(call, monkeypatch, tmp_path):
    fail_with(monkeypatch, ConvergenceError("20 bar: residual 1e-3 after 50 steps; try a finer mesh"))
    code, out, err = call("run", "--quiet", CASE, "-o", tmp_path)
    assert (code, out) == (3, "")
    assert err == "error: 20 bar: residual 1e-3 after 50 steps; try a finer mesh\n"


@pytest.mark.parametrize(
    "error", [ZeroDivisionError("division by zero"), ValueError("bad"), MemoryError(), KeyError("k")]
)
def test_the_unexpected_is_one_line_and_leaves_with_1(call, monkeypatch, tmp_path, error):
    fail_with(monkeypatch, error)
    code, _, err = call("run", "--quiet", CASE, "-o", tmp_path)
    assert code == 1
    assert len(err.splitlines()) == 1
    assert "Traceback" not in err


def test_debug_shows_the_traceback(monkeypatch, tmp_path):
    fail_with(monkeypatch, ZeroDivisionError("division by zero"))
    with pytest.raises(ZeroDivisionError):
        cli.main(["run", "--debug", str(CASE), "-o", str(tmp_path)])


def test_a_full_disk_is_named(call, monkeypatch, tmp_path):
    fail_with(monkeypatch, OSError(28, "No space left on device", "out/leak.csv"))
    code, _, err = call("run", "--quiet", CASE, "-o", tmp_path)
    assert (code, err) == (1, "error: out/leak.csv: cannot be written (no space left on device)\n")


def test_interrupt_leaves_with_130(monkeypatch, tmp_path, call):
    fail_with(monkeypatch, KeyboardInterrupt())
    code, _, err = call("run", "--quiet", CASE, "-o", tmp_path)
    assert (code, err) == (130, "interrupted\n")


# --- leak of a given profile ------------------------------------------------------------------------------


def test_leak_of_a_profile_from_another_code(call, tmp_path):
    code, out, err = call("leak", PROFILE, CASE, "-o", tmp_path)
    assert code == 0 and "warning" not in err
    assert "leak.csv" in out and "is the arc length of the points" in out
    rows = list(csv.DictReader((tmp_path / "leak.csv").open()))
    assert len(rows) == 20
    plastic, elastic = (
        np.array([float(row[key]) for row in rows])
        for key in ("leak_rate_m3_per_s", "leak_rate_elastic_m3_per_s")
    )
    pressures = np.array([float(row["fluid_pressure_Pa"]) for row in rows])
    # one profile: the leak rate is proportional to the pressure difference over the viscosity, to the ten digits of the
    # file; water becomes 0.08 % thinner and denser over 20 bar
    water = leak.liquid("water").pressure_law
    driven = pressures / [leak.effective_viscosity_ratio(water, pressure) for pressure in pressures]
    assert plastic / driven == pytest.approx(plastic[0] / driven[0], rel=1e-9)
    assert driven[-1] / driven[0] == pytest.approx(20 * 1.0007, rel=2e-4)
    # about 8 in the paper, 8.1 by an independent calculation
    assert elastic / plastic == pytest.approx(8.1, abs=0.1)


def test_leak_takes_units_from_the_header_and_groups_by_fluid_pressure(call, tmp_path):
    x, p = np.loadtxt(PROFILE, delimiter=",", skiprows=2).T
    rows = [(load, a * 1e-3, 14e-3, b * 1e6) for load in (1e5, 2e5) for a, b in zip(x, p, strict=True)]
    own = tmp_path / "profile.csv"
    np.savetxt(own, rows, delimiter=",", header="fluid_pressure_Pa,x_m,r_m,contact_pressure_Pa", comments="")
    code, out, _ = call("leak", own, CASE, "--json")
    loads = json.loads(out)["loads"]
    assert code == 0
    assert [load["fluid_pressure_Pa"] for load in loads] == [1e5, 2e5]
    assert (tmp_path / "profile.leak" / "leak.csv").exists()
    other = tmp_path / "other.csv"
    np.savetxt(
        other, np.c_[x * 1e3, p * 10], delimiter=";", header="Arc length [um]; CPRESS (bar)", comments=""
    )
    code, out, _ = call("leak", other, CASE, "--json")
    first = json.loads(out)["loads"][0]
    assert first["peak_pressure_Pa"] == pytest.approx(loads[0]["peak_pressure_Pa"], rel=1e-9)
    # r = 14 mm there, r0 = 14.142 mm and r(x) here
    assert first["leak_rate_m3_per_s"] == pytest.approx(
        loads[0]["leak_rate_m3_per_s"] * 14.142 / 14, rel=1e-3
    )


GOOD_ROWS = [f"{x},{10 - x * x}" for x in (-3, -2, -1, 0, 1, 2, 3)]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "is empty"),
        (["x_mm,p_MPa"], "no rows"),
        (GOOD_ROWS, "has no header"),
        (["x,p", *GOOD_ROWS], 'column "x" has no unit'),
        (["x_mm,p_kg", *GOOD_ROWS], "no unit"),
        (["x_MPa,p_mm", *GOOD_ROWS], 'column "x_MPa"'),
        (["x_mm,p_MPa", *GOOD_ROWS, "4,nan"], "line 9"),
        (["x_mm,p_MPa", *GOOD_ROWS, "4,-1"], "line 9 has −1 MPa"),
        (["x_mm,p_MPa", *GOOD_ROWS, "4"], "line 9"),
        (["x_mm,p_MPa", *GOOD_ROWS, "4,five"], "line 9"),
        (["x_mm,p_MPa", *GOOD_ROWS[:3]], "at least 5 rows"),
        (["x_mm,p_MPa", *(f"{n},0" for n in range(6))], "do not touch"),
        (["x_mm,p_MPa", *(f"{n},1e9" for n in range(6))], "line 2 has 1·10⁶ GPa: is the unit right?"),
        (["a_mm,b_MPa,c_mm", *(f"{n},1,2" for n in range(6))], "has no column contact_pressure"),
        (["x_mm,p_MPa,r_mm", *(f"{n},1,{n - 2}" for n in range(6))], "radius must be positive; −2"),
    ],
)
def test_wrong_profiles_leave_with_2_and_name_the_line(call, tmp_path, lines, said):
    path = tmp_path / "profile.csv"
    path.write_text("\n".join(lines))
    code, out, err = call("leak", path, CASE, "-o", tmp_path / "out")
    assert (code, out) == (2, "")
    assert said in err
    assert str(path) in err


def test_binary_and_missing_profiles_leave_with_2(call, tmp_path):
    path = tmp_path / "profile.csv"
    path.write_bytes(bytes(range(256)))
    assert call("leak", path, CASE)[0] == 2
    assert call("leak", tmp_path / "none.csv", CASE)[0] == 2


def test_a_leak_rate_needs_roughness_and_fluid(call, tmp_path):
    code, _, err = call("leak", PROFILE, EXAMPLES / "smooth.toml", "-o", tmp_path)
    assert code == 2
    assert "[roughness]" in err
    assert "[fluid]" in err


# --- run and mesh -----------------------------------------------------------------------------------------


def test_mesh_writes_the_mesh_and_prints_its_quality(call, tmp_path):
    code, out, _ = call("mesh", CASE, "-o", tmp_path)
    assert code == 0
    assert "triangles" in out
    assert (tmp_path / "mesh.msh").stat().st_size > 1000


@pytest.fixture(scope="module")
def main_job(tmp_path_factory):
    folder = tmp_path_factory.mktemp("main job") / "results"
    # every import is a line on stderr
    return program("run", CASE, "-o", folder, env={**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}), folder


def test_a_run_loads_nothing_that_only_other_results_need(main_job):
    done, _ = main_job
    loaded = {line.rsplit("|", 1)[-1].strip() for line in done.stderr.splitlines() if "import time:" in line}
    assert {"numpy", "gmsh", "fem_seal.answers.chain"} <= loaded
    heavy = {
        "matplotlib.pyplot",
        "pandas",
        "pint",
        "pyvista",
        "scipy.interpolate",
        "scipy.optimize",
        "scipy.ndimage",
        "scipy.stats",
        "leak.direct",
        "leak.flow.particles",
        "fem_seal.output.pictures.three_d",
    }
    assert not heavy & loaded


def test_run_prints_the_table_and_where_the_files_are(main_job):
    done, folder = main_job
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert "leak rate" in done.stdout
    assert str(folder) in done.stdout


def test_run_writes_the_files_of_the_contract(main_job):
    _, folder = main_job
    names = {path.name for path in folder.iterdir()}
    contract = {
        "leak.csv",
        "contacts.csv",
        "profile.csv",
        "summary.json",
        "contact.pvd",
        "contact_line.pvd",
        "report.html",
        "mesh.msh",
    }
    assert contract <= names
    assert not [name for name in names if name.endswith((".part", ".tmp"))]
    header = (folder / "leak.csv").read_text().splitlines()[0]
    assert header == ",".join(one.name for one in columns_of(fem_seal.load_case(CASE)))


def test_leak_of_the_own_profile_is_the_leak_of_the_run(main_job, call, tmp_path):
    _, folder = main_job
    code, out, _ = call("leak", folder / "profile.csv", CASE, "-o", tmp_path, "--json")
    assert code == 0
    again = [load["leak_rate_m3_per_s"] for load in json.loads(out)["loads"]]
    rows = list(csv.DictReader((folder / "leak.csv").open()))
    # the same integral over the written points: the difference is that of the quadrature
    assert again == pytest.approx([float(row["leak_rate_m3_per_s"]) for row in rows], rel=2e-3)


def test_run_json(call, tmp_path):
    code, out, _ = call("run", "--json", EXAMPLES / "smooth.toml", "-o", tmp_path)
    assert code == 0
    result = json.loads(out)
    assert result["folder"] == str(tmp_path)
    assert len(result["loads"]) == 2
    # smooth bodies without a fluid have no leak rate
    assert "leak_rate_m3_per_s" not in result["loads"][0]
