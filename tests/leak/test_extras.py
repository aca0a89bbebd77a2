"""What is said where the packages of an extra are missing: their names, and a command that installs them."""

import json
import shlex
import subprocess
import sys
from importlib import metadata

import pytest
from places import ROOT

from leak import extras
from leak.extras import command, extra_with, say_absent, say_missing


class Installed:
    """A distribution that tells where it was installed from."""

    def __init__(self, url):
        self.url = url

    def read_text(self, name):
        return None if self.url is None else json.dumps({"url": self.url})


def missing(monkeypatch, *names, url=None):
    """As if some packages were not installed, and the program from a place."""
    installed = metadata.distribution

    def distribution(name):
        if name in names:
            raise metadata.PackageNotFoundError(name)
        return Installed(url) if name == "fem-seal" and url else installed(name)

    monkeypatch.setattr(metadata, "distribution", distribution)


def test_what_is_missing_is_named_and_only_that(monkeypatch):
    if not metadata.requires("fem-seal"):
        pytest.skip("the metadata of the installed program name no extras")
    missing(monkeypatch, "dash")
    assert say_missing("explore").startswith("needs dash, which is not installed; install it with: ")
    missing(monkeypatch, "dash", "plotly")
    assert say_missing("explore").startswith(
        "needs dash and plotly, which are not installed; install them with: "
    )
    missing(monkeypatch, "SALib", "optuna", "plotly", "xarray")
    assert "needs SALib, optuna, plotly and xarray, which" in say_missing("studies")


@pytest.mark.parametrize(
    ("module", "extra"),
    [
        ("dash", "explore"),
        ("dask.distributed", "studies"),
        ("SALib.sample", "studies"),
        ("ezdxf", "drawings"),
        ("CoolProp", "coolprop"),
        ("SurfaceTopography.IO", "surfaces"),
        ("numpy", ""),
        (None, ""),
    ],
)
def test_the_extra_that_brings_a_module(module, extra):
    assert extra_with(module) == extra


def test_a_package_that_a_light_install_leaves_out_is_named():
    from fem_seal.errors import error_text

    for module in ("pandas", "pyvista.plotting", "matplotlib.figure"):
        name = module.split(".")[0]
        said = say_absent(module)
        assert said.startswith(f"needs {name}, which is not installed; install it with: ")
        assert said.endswith(f"install {name}") and error_text(ModuleNotFoundError(name=module)) == said
    # of an extra another sentence is said, and what is no package of ours is a defect
    for module in ("dash", "no_such_module", None):
        assert say_absent(module) == ""
    assert "a defect" in error_text(ModuleNotFoundError(name="no_such_module"))


@pytest.mark.parametrize(
    ("package", "arguments"),
    [
        ("pandas", ["study", str(ROOT / "examples" / "studies" / "angle_and_roughness.toml"), "-o"]),
        ("pyvista", ["view", "--png", "seal.png"]),
    ],
)
def test_a_light_install_is_told_before_anything_is_calculated(
    package, arguments, monkeypatch, capfd, tmp_path
):
    from fem_seal.cli.app import main

    monkeypatch.setitem(sys.modules, package, None)
    assert main([*arguments, str(tmp_path / "results")]) == 2
    assert capfd.readouterr().err.split("; ")[0] == f"error: this needs {package}, which is not installed"
    assert not list(tmp_path.iterdir())


def test_the_command_installs_from_where_the_program_came(monkeypatch, tmp_path):
    folder = tmp_path / "a folder"
    folder.mkdir()
    missing(monkeypatch, url=folder.as_uri())
    words = shlex.split(command("explore"), posix=sys.platform != "win32")
    assert words[0] in (sys.executable, "uv")
    assert words[-1].strip('"') == f"{folder}[explore]"
    # the folder is gone, and there is none around the files either
    folder.rmdir()
    monkeypatch.setattr(extras, "__file__", str(tmp_path / "site-packages" / "leak" / "extras.py"))
    assert command("explore").endswith('install ".[explore]" in the folder of fem-seal')


STUDY = """
base = "BASE"
responses = ["peak_pressure_Pa"]
[parameters]
"seat.angle" = { distribution = "uniform", low = "40 deg", high = "50 deg" }
"closure.radius" = { distribution = "uniform", low = "19 mm", high = "21 mm" }
[design]
kind = "morris"
num = 2
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hidden", "arguments", "extra"),
    [
        ("dash", ["explore", "examples/ball_cone.toml", "--no-browser", "--port", "0"], "explore"),
        ("ezdxf", ["check", "examples/profile_from_drawing.toml"], "drawings"),
        (
            "dask",
            [
                "study",
                "examples/studies/angle_and_roughness.toml",
                "-o",
                "OUT",
                "--scheduler",
                "tcp://127.0.0.1:1",
            ],
            "studies",
        ),
        ("optuna", ["study", "examples/studies/conical_land.toml", "-o", "OUT"], "studies"),
        ("SALib", ["study", "STUDY", "-o", "OUT"], "studies"),
    ],
)
def test_each_command_says_it_in_one_line(hidden, arguments, extra, tmp_path):
    code = f"import sys; sys.modules[{hidden!r}] = None; from fem_seal.cli.app import main; sys.exit(main())"
    study = tmp_path / "study.toml"
    study.write_text(
        STUDY.replace("BASE", (ROOT / "examples" / "ball_cone.toml").as_posix()), encoding="utf-8"
    )
    places = {"OUT": str(tmp_path / "out"), "STUDY": str(study)}
    done = subprocess.run(
        [sys.executable, "-c", code, *(places.get(word, word) for word in arguments)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.splitlines()
    assert f"needs {hidden}" in line
    assert f"install it with: {command(extra)}" in line
