"""From a map of contact pressure to a leak rate: the same contact by other ways, bad inputs, the command."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from typer.testing import CliRunner

import fem_seal
from fem_seal.answers.chain import solve_profiles
from fem_seal.answers.profile_files import read_profiles
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.cli.app import app
from fem_seal.errors import InputError
from fem_seal.output.pictures.contact import draw_profiles
from fem_seal.output.tables import write_profile_csv

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3.5 GPa"}
TABLES: dict[str, Any] = {
    "closure": {"material": STEEL},
    "seat": {"material": STEEL},
    "roughness": {
        "spectrum": {
            "kind": "self-affine",
            "rms_height": "0.5 um",
            "hurst": 0.8,
            "q_low": "5e3 1/m",
            "q_rolloff": "4e4 1/m",
            "q_high": "3.1416e6 1/m",
        }
    },
    "fluid": {"name": "nitrogen"},
    "load": {"fluid_pressure": "20 bar"},
}


def grid(rows: int, columns: int, *, closed: bool = False) -> IntArray:
    """Triangles of points in rows."""
    i = np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    i = i if closed else i[:, :-1]
    j = i - i % columns + (i + 1) % columns
    return np.concatenate(
        [np.stack([i, j, i + columns], -1), np.stack([j, j + columns, i + columns], -1)]
    ).reshape(-1, 3)


def ring(r: FloatArray, z: FloatArray, angles: int = 90) -> FloatArray:
    """Points of circles [m]."""
    turn = 2.0 * np.pi * np.arange(angles) / angles
    return np.stack(
        [np.outer(r, np.cos(turn)), np.outer(r, np.sin(turn)), np.outer(z, np.ones(angles))], -1
    ).reshape(-1, 3)


def written_mesh(path: Path, points: FloatArray, triangles: IntArray, **fields: FloatArray) -> Path:
    """In millimetres and megapascals, as from a program that knows no units."""
    meshio.Mesh(1e3 * points, [("triangle", triangles)], point_data=fields).write(path)
    return path


def written_points(path: Path, points: FloatArray, pressure: FloatArray) -> Path:
    header = "x [mm],y [mm],z [mm],CPRESS [MPa]"
    np.savetxt(path, np.column_stack([1e3 * points, pressure]), delimiter=",", header=header, comments="")
    return path


UNITS = {"pressure_unit": "MPa", "length_unit": "mm"}


@cache
def ball_on_cone() -> fem_seal.SealResult:
    closure = {"shape": "ball", "radius": "20 mm", "material": STEEL}
    seat = {"shape": "cone", "angle": "45 deg", "material": STEEL}
    return fem_seal.run(TABLES | {"closure": closure, "seat": seat})


# 14 to 14.6 mm; a contact 0.2 mm wide in its middle.
R = np.linspace(14e-3, 14.6e-3, 25)
P = 100.0 * np.exp(-0.5 * ((R - 14.3e-3) / 0.08e-3) ** 2)
FLAT, TRIANGLES = ring(R, 0.0 * R), grid(25, 90, closed=True)


@pytest.mark.slow
def test_same_contact_by_run_profile_and_map(tmp_path: Path) -> None:
    solved = ball_on_cone()
    (load,) = solved.loads
    profile = load.whole_profile
    write_profile_csv(solved, tmp_path / "profile.csv")
    profiles = read_profiles(tmp_path / "profile.csv", solved.case.contact)
    (by_profile,) = solve_profiles(solved.case, profiles).loads
    points = ring(profile.radius, solved.case.contact.height(profile.x))
    pressure = np.repeat(profile.pressure * 1e-6, 90)
    mesh = written_mesh(tmp_path / "map.vtu", points, grid(len(profile.x), 90, closed=True), CPRESS=pressure)
    table = written_points(tmp_path / "map.csv", points, pressure)
    assert by_profile.leak.leak_rate == pytest.approx(load.leak.leak_rate, rel=1e-3)
    for source, units in ((mesh, UNITS), (table, {})):
        found = fem_seal.leak_of_pressure_map(source, TABLES, **units)
        (by_map,) = found.loads
        assert by_map.leak.leak_rate == pytest.approx(load.leak.leak_rate, rel=0.01)
        assert by_map.leak_interval == pytest.approx(by_profile.leak_interval, rel=0.02)
        assert found.table["worst_tenth_share"][0] == pytest.approx(0.1, abs=2e-3)
        assert found.warnings == ()


def ring_file(folder: Path, pressure: FloatArray, every: int = 1) -> Path:
    """The ring with every so many of its circles."""
    r, values = R[::every], pressure.reshape(25, 90)[::every].ravel()
    return written_mesh(folder / "ring.vtu", ring(r, 0.0 * r), grid(len(r), 90, closed=True), CPRESS=values)


def strip_file(folder: Path) -> Path:
    """The ring cut open and laid flat: field `side` is 1 at its inner side, 2 at its outer, 3 at the ends."""
    along = np.linspace(0.0, 2.0 * np.pi * 14.3e-3, 91)
    points = np.stack([*np.broadcast_arrays(along[None, :], R[:, None], 0.0)], -1).reshape(-1, 3)
    side = np.zeros((25, 91))
    side[:, [0, -1]], side[0], side[-1] = 3, 1, 2
    return written_mesh(
        folder / "strip.vtu", points, grid(25, 91), CPRESS=np.repeat(P, 91), side=side.ravel()
    )


INNER = {"load": {"fluid_pressure": "20 bar", "pressure_side": "inner"}}


def test_strip_with_named_sides_leaks_like_the_ring(tmp_path: Path) -> None:
    of_ring = fem_seal.leak_of_pressure_map(ring_file(tmp_path, np.repeat(P, 90)), TABLES | INNER, **UNITS)
    strip, high = strip_file(tmp_path), {"field": "side", "value": 1}
    low = {"box": ["0 mm", "1 m", "14.59 mm", "1 m", "-1 mm", "1 mm"]}
    sides = [{"high": high, "low": low}, {"high": high, "wall": {"field": "side", "value": 3}}]
    for given in sides:
        found = fem_seal.leak_of_pressure_map(strip, TABLES | {"map": given}, **UNITS)
        assert found.loads[0].leak.leak_rate == pytest.approx(of_ring.loads[0].leak.leak_rate, rel=0.01)


ENDS = {"high": {"field": "side", "value": 1}, "low": {"field": "side", "value": 2}}
LAID = TABLES["roughness"] | {"peklenik": 0.2}


def test_lay_of_a_strip_and_of_a_ring(tmp_path: Path) -> None:
    """Across and along the flow as a number and its inverse; oblique as both side by side, by a concave function."""
    water = INNER | {"fluid": {"name": "water"}}

    def rate(file: Path, number: float, **of_map: Any) -> float:
        tables = TABLES | water | {"roughness": LAID | {"peklenik": number}, "map": of_map or None}
        found = fem_seal.leak_of_pressure_map(file, tables, field="CPRESS", **UNITS)
        assert not [text for text in found.warnings if "lay gives its direction" in text]
        return float(found.table["leak_rate_m3_per_s"][0])

    strip, band = strip_file(tmp_path), ring_file(tmp_path, np.repeat(P, 90))
    across, along = rate(band, 0.2), rate(band, 5.0)
    assert along > 5.0 * across
    assert rate(strip, 0.2, lay=[1, 0, 0], **ENDS) == pytest.approx(across, rel=0.01)
    for number in (0.2, 5.0):
        assert rate(strip, number, lay=[0, -2, 0], **ENDS) == pytest.approx(along, rel=0.01)
    mean = 0.5 * (across + along)
    for oblique in (rate(strip, 0.2, lay=[1, 1, 0], **ENDS), rate(band, 0.2, lay=[1, 0, 0])):
        assert mean < oblique < 1.03 * mean


def test_a_lay_without_a_direction_is_told(tmp_path: Path) -> None:
    found = fem_seal.leak_of_pressure_map(
        strip_file(tmp_path), TABLES | {"roughness": LAID, "map": ENDS}, field="CPRESS", **UNITS
    )
    assert [text for text in found.warnings if "[map] lay gives its direction" in text]
    with pytest.raises(InputError, match=r"map.*lay must be a direction"):
        fem_seal.Case(**TABLES | {"map": {"lay": [0, 0, 0]}})


@pytest.mark.slow
def test_steps_and_uneven_pressure(tmp_path: Path) -> None:
    """Pressure that varies around a narrow ring: each angle leaks by itself; the interval holds the other theory."""
    turn = 2.0 * np.pi * np.arange(90) / 90
    uneven = np.outer(P, 1.0 + 0.3 * np.cos(turn)).ravel()
    fields = {"CPRESS_1": np.repeat(P, 90), "CPRESS_2": uneven, "CPRESS_3": np.zeros(len(FLAT))}
    file = written_mesh(tmp_path / "ring.vtu", FLAT, TRIANGLES, **fields)
    tables = TABLES | {"load": {"fluid_pressure": ["10 bar", "20 bar"], "pressure_side": "inner"}}
    found = fem_seal.leak_of_pressure_map(file, tables, field="CPRESS", **UNITS)
    table = found.table
    assert list(table["step"]) == ["CPRESS_1", "CPRESS_1", "CPRESS_2", "CPRESS_2"]
    assert list(table["fluid_pressure_Pa"]) == [1e6, 2e6] * 2
    assert len([text for text in found.warnings if "CPRESS_3: left out" in text]) == 1
    at_angles = [
        fem_seal.leak_of_pressure_map(
            ring_file(tmp_path, np.repeat(P, 90) * (1.0 + 0.3 * math.cos(angle))), TABLES | INNER, **UNITS
        ).table["leak_rate_m3_per_s"][0]
        for angle in np.pi * (np.arange(4) + 0.5) / 4
    ]
    assert table["leak_rate_m3_per_s"][3] == pytest.approx(np.mean(at_angles), rel=0.01)
    assert 0.12 < table["worst_tenth_share"][3] < 0.2
    assert (table["error"] < 0.05).all()
    # what the profile stands for: other surfaces leak over the map as much more than through it
    share, other = (
        load.whole_profile.share for load in (found.loads[3], found.loads[3].scenarios["elastic"])
    )
    assert share == pytest.approx(other, rel=0.01)
    assert (table["leak_rate_low_m3_per_s"] < table["leak_rate_m3_per_s"]).all()
    assert (table["leak_rate_high_m3_per_s"] > table["leak_rate_m3_per_s"]).all()


def test_files_of_the_recipes(tmp_path: Path) -> None:
    """A field report of Abaqus, a list of Ansys and a mesh of Code_Aster leak like the same mesh."""
    pressure = np.repeat(P, 90)
    expected = fem_seal.leak_of_pressure_map(ring_file(tmp_path, pressure), TABLES | INNER, **UNITS)
    rows = np.column_stack([np.arange(1.0, len(FLAT) + 1.0), 1e3 * FLAT, pressure])
    abaqus, ansys, aster = (tmp_path / name for name in ("abaqus.rpt", "ansys.txt", "aster.med"))
    np.savetxt(abaqus, rows, header="Node Label  COORD.COOR1  COORD.COOR2  COORD.COOR3  CPRESS", comments="")
    places = "X Location (mm)\tY Location (mm)\tZ Location (mm)\tPressure (MPa)"
    np.savetxt(ansys, rows, delimiter="\t", header=f"Node Number\t{places}", comments="")
    meshio.Mesh(1e3 * FLAT, [("triangle", TRIANGLES)], point_data={"LAGS_C": -pressure}).write(aster)
    for file, options in ((abaqus, UNITS), (ansys, {}), (aster, UNITS | {"field": "LAGS_C"})):
        found = fem_seal.leak_of_pressure_map(file, TABLES | INNER, **options)
        assert found["leak_rate"][0] == pytest.approx(expected["leak_rate"][0], rel=5e-3)
    mesh = fem_seal.leak_of_pressure_map(expected.mesh, TABLES | INNER, length_unit="m")
    assert mesh["leak_rate"][0] == pytest.approx(expected["leak_rate"][0], rel=1e-6)
    assert [axes.get_title(loc="left") for axes in expected.plot().axes][1] == "Where it leaks"
    expected.write(tmp_path / "out")
    assert (tmp_path / "out" / "pressure_map_000.vtu").is_file()


def checker() -> FloatArray:
    rows = np.arange(25) % 2
    return np.repeat(P * (1.0 + 0.4 * rows), 90)


WARNINGS = {
    "nodes lie across": (np.repeat(P, 90), {}, 4),
    "up and down from node to node": (checker(), {}, 1),
    "the map carries": (np.repeat(P, 90), {"applied_force": "20 kN"}, 1),
}


@pytest.mark.parametrize("words", WARNINGS)
def test_doubtful_maps_are_said_so(tmp_path: Path, words: str) -> None:
    pressure, load, every = WARNINGS[words]
    tables = TABLES | {"load": INNER["load"] | load}
    found = fem_seal.leak_of_pressure_map(ring_file(tmp_path, pressure, every), tables, **UNITS)
    assert [text for text in found.warnings if words in text]
    assert not [text for other in WARNINGS if other != words for text in found.warnings if other in text]


# Of 1.80 kN on the strip. With its ends joined fluid acts on the 616 to 670 mm2 inside, against the force; with open
# ends on an area that is not known, at most 90 mm squared.
CARRIED = {
    ("ring", "3 kN"): False,
    ("ring", "2.2 kN"): True,
    ("strip", "2 kN"): False,
    ("strip", "20 kN"): True,
}


@pytest.mark.parametrize("form, force", CARRIED)
def test_a_map_with_named_sides_that_does_not_carry_the_load(tmp_path: Path, form: str, force: str) -> None:
    file = strip_file(tmp_path)
    if form == "ring":
        side = {"side": np.repeat([1, *[0] * 23, 2], 90)}
        file = written_mesh(tmp_path / "sides.vtu", FLAT, TRIANGLES, CPRESS=np.repeat(P, 90), **side)
    tables = TABLES | {"map": ENDS, "load": {"fluid_pressure": "20 bar", "applied_force": force}}
    found = fem_seal.leak_of_pressure_map(file, tables, field="CPRESS", **UNITS)
    assert any("the map carries" in text for text in found.warnings) == CARRIED[form, force]


BAD: dict[str, dict[str, Any]] = {
    "its parts are side = 0, side = 1": {"map": {"high": "inlet"}},
    "a wall alone": {"map": {"wall": {"field": "side", "value": 3}}},
    "closed lines": {},
    "box": {"map": {"high": {"box": ["0 mm"]}}},
    'is "local"': {"leak": {"fluid_in_gap": "local"}, "fluid": {"name": "water"}, "map": ENDS},
    "have no shape": {"form": {"seat": {"tolerance": "1 um"}}},
    "the roughness has none": {"map": ENDS | {"lay": [1, 0, 0]}},
    "roughness: is missing": {"roughness": None, "map": ENDS},
    "flows past": {"map": {"high": {"field": "side", "value": 1}}},
}


@pytest.mark.parametrize("words", BAD)
def test_bad_input_is_one_sentence(tmp_path: Path, words: str) -> None:
    tables = {key: table for key, table in (TABLES | BAD[words]).items() if table is not None}
    with pytest.raises(InputError) as caught:
        fem_seal.leak_of_pressure_map(strip_file(tmp_path), tables, **UNITS)
    assert words in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_case_without_shapes_is_for_maps_alone(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="shapes a case only serves"):
        fem_seal.run(TABLES)
    assert fem_seal.load_case(TABLES).replace({"fluid.name": "helium"}).fluid.name == "helium"


def test_a_case_without_shapes_misses_its_material() -> None:
    with pytest.raises(InputError, match=r"seat\.material: is missing") as error:
        fem_seal.Case(**TABLES | {"seat": {}})
    assert "shape" not in str(error.value)


def test_peak_of_the_mean_is_not_taken_for_the_peak_of_the_map(tmp_path: Path) -> None:
    turn = 2.0 * np.pi * np.arange(90) / 90
    uneven = np.outer(P, 1.0 + 0.5 * np.cos(turn)).ravel()
    result = fem_seal.leak_of_pressure_map(ring_file(tmp_path, uneven), TABLES, **UNITS)
    (remark,) = {found.remark for found in result.answers["profiles"]}
    assert result.loads[0].peak_pressure < 0.8 * 150e6
    assert remark.endswith("the highest pressure of the map is 150 MPa")
    # x begins at the inner edge: the picture has the whole face and little beside it
    draw_profiles(axes := Figure().subplots(), result)
    low, high = axes.get_xlim()
    x = 1e3 * result.loads[0].profiles[0].x
    assert low <= x[0] and high >= x[-1] and high - low < 1.5 * np.ptp(x)


def test_command(tmp_path: Path) -> None:
    case = tmp_path / "strip.toml"
    case.write_text(
        str(fem_seal.load_case(TABLES | {"map": ENDS} | {"requirement": {"leak_rate": "1 l/min"}}))
    )
    strip_file(tmp_path)
    command = ["leak", str(tmp_path / "strip.vtu"), str(case), "--length-unit", "mm"]
    runner = CliRunner()
    assert "--pressure-unit MPa" in str(runner.invoke(app, command).exception)
    done = runner.invoke(app, [*command, "--pressure-unit", "MPa", "--field", "CPRESS"])
    assert done.exit_code == 0, done.output
    folder = tmp_path / "strip.leak"
    rows = pd.read_csv(folder / "leak.csv")
    assert list(rows["verdict"]) == ["pass"]
    assert json.loads((folder / "summary.json").read_text())["loads"][0]["step"] == "CPRESS"
    flow = meshio.read(folder / "pressure_map_000.vtu")
    assert flow.point_data["contact_pressure_Pa"].max() == pytest.approx(1e8)
    assert flow.point_data["fluid_pressure_Pa"].min() == pytest.approx(0.0, abs=1.0)
    # what flows across the strip at any place, per width and over all
    flux, length = flow.cell_data["flux_kg_per_m_s"][0][:, 1], 2.0 * np.pi * 14.3e-3
    assert length * flux.mean() == pytest.approx(rows["leak_rate_kg_per_s"][0], rel=1e-3)
    assert (folder / "map.svg").read_bytes().startswith(b"<?xml")
    assert runner.invoke(app, ["report", str(folder), "--full"]).exit_code == 0
    assert "picture-pressure_map" in (folder / "report.html").read_text()
    for other in (["run", str(case)], ["check", str(case)], [*command[:3], "--profile"]):
        assert isinstance(runner.invoke(app, other).exception, InputError)
