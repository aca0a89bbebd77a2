"""The case file: what it accepts, what it makes of it, and what it says when something is wrong."""

import copy
import math
import pickle
import tomllib

import numpy as np
import pytest
from any_text import ANY
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sample_results import SPECTRUM, ball, cone

import fem_seal
from fem_seal import Case, InputError, Study, load_case
from fem_seal.case.case import input_tables, with_units
from fem_seal.case.material_table import LIBRARY, material
from fem_seal.case.tables import CaseTables
from fem_seal.errors import LimitLoadError, OpenSealError
from fem_seal.materials import HardeningCurve, Material, effective_modulus

CASE = {
    "closure": ball(),
    "seat": cone(),
    "roughness": {"spectrum": SPECTRUM},
    "fluid": {"viscosity": "1 mPa s"},
    "load": {"fluid_pressure": ["1 bar", "20 bar"]},
}


@pytest.fixture
def case():
    return Case(**CASE)


def wrong(changes, **tables):
    """The message for a changed case that is wrong."""
    with pytest.raises(InputError) as caught:
        # as a file says it: in code a bare number is SI
        Case(**CASE).replace_written({**(changes or {}), **tables})
    return str(caught.value)


# --- what it makes of the input ---------------------------------------------------------------------------


def test_everything_is_si_after_reading(case):
    assert case.closure.radius == 0.02
    assert case.closure.material == LIBRARY["steel"]
    assert case.seat.angle == pytest.approx(math.pi / 4, rel=1e-15)
    assert case.seat.material.hardness == 3.5e9
    assert case.roughness.spectrum.rms_height == 1.9e-6
    assert case.roughness.spectrum.q_high == 3.14159e6
    assert case.fluid.viscosity == 1e-3
    assert case.load.fluid_pressure == (1e5, 20e5)


def test_defaults_of_the_contract(case):
    assert (case.interface.law, case.interface.plastic) == ("spectrum", False)
    assert (case.load.applied_force, case.load.closing, case.load.pressure_side) == (
        0.0,
        "sealed-area",
        "outer",
    )
    assert (case.leak.plasticity, case.leak.percolation_threshold, case.leak.conductivity) == (
        True,
        0.42,
        "bruggeman",
    )
    assert case.mesh.contact_size is None
    assert case.output.folder is None


def test_touch_radius_and_effective_modulus(case):
    assert case.initial_contact_radius == pytest.approx(0.02 * math.sqrt(0.5), rel=1e-15)
    assert case.effective_modulus == pytest.approx(210e9 / (2 * (1 - 0.09)), rel=1e-15)


def test_hardness_is_that_of_the_softer_body_or_of_the_only_one_known(case):
    assert case.hardness == 3.5e9
    hard = {"youngs_modulus": "600 GPa", "poissons_ratio": 0.2, "hardness": "15 GPa"}
    assert case.replace({"closure.material": hard}).hardness == 3.5e9
    soft = {"youngs_modulus": "100 GPa", "poissons_ratio": 0.3, "hardness": "1 GPa"}
    assert case.replace({"closure.material": soft}).hardness == 1e9
    assert case.replace({"seat.material": "steel", "leak.plasticity": False}).hardness is None


@pytest.mark.parametrize(
    ("entry", "pressures"),
    [
        ("5 bar", (5e5,)),
        (["20 bar", "1 bar", "1 bar"], (20e5, 1e5, 1e5)),
        ({"start": "1 bar", "stop": "20 bar", "num": 20}, tuple(1e5 * n for n in range(1, 21))),
        ({"start": "1 bar", "stop": "100 bar", "num": 3, "spacing": "log"}, (1e5, 1e6, 1e7)),
    ],
)
def test_fluid_pressures(case, entry, pressures):
    assert case.replace({"load.fluid_pressure": entry}).load.fluid_pressure == pytest.approx(
        pressures, rel=1e-14
    )


def test_one_pressure_under_several_forces(case):
    forces = ["100 N", "0 N", "400 N"]
    for pressure in ("20 bar", ["20 bar"]):
        load = case.replace({"load.fluid_pressure": pressure, "load.applied_force": forces}).load
        assert load.points == ((20e5, 100.0), (20e5, 0.0), (20e5, 400.0))
        assert load.fluid_pressure == (20e5,) * 3
    # what was written is broadcast anew, not what came of it
    one = case.replace({"load.fluid_pressure": "20 bar", "load.applied_force": forces})
    assert one.replace({"load.applied_force": ["1 N", "2 N"]}).load.points == ((20e5, 1.0), (20e5, 2.0))
    assert one.replace({"load.applied_force": "5 N"}).load.fluid_pressure == (20e5,)


def test_replace_leaves_the_original_and_merges_tables(case):
    changed = case.replace({"seat.angle": "60 deg"}, closure={"radius": "10 mm"})
    assert case.seat.angle == pytest.approx(math.radians(45))
    assert changed.seat.angle == pytest.approx(math.radians(60))
    assert changed.closure.radius == 0.01
    assert changed.seat.material == case.seat.material
    assert changed.replace(seat={"angle": "45 deg"}, closure={"radius": "20 mm"}).closure == case.closure


def test_replace_of_another_kind_replaces_the_table(case, tmp_path):
    (tmp_path / "C.csv").write_text("q, C\n1e3, 1e-17\n1e5, 1e-20\n")
    changed = case.replace(roughness={"spectrum": {"kind": "table", "file": str(tmp_path / "C.csv")}})
    assert changed.roughness.spectrum.kind == "table"


def test_replace_with_none_removes_an_entry(case):
    assert case.replace({"fluid": None}).fluid is None
    assert case.replace(fluid=None).fluid is None


@pytest.mark.parametrize(
    "error",
    [
        LimitLoadError("yields through", "seat"),
        OpenSealError("is open", 2e5),
        InputError.at("k", "is wrong", "v"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_errors_come_whole_from_other_processes(error):
    other = pickle.loads(pickle.dumps(error))
    assert (str(other), vars(other)) == (str(error), vars(error))


def test_cases_are_frozen_and_can_be_pickled(case):
    with pytest.raises(Exception, match="frozen"):
        case.title = "other"
    assert pickle.loads(pickle.dumps(case)) == case
    assert pickle.loads(pickle.dumps(case)).replace({"seat.angle": "30 deg"}).seat.angle == pytest.approx(
        math.pi / 6
    )


def test_the_input_is_not_touched():
    tables = copy.deepcopy(CASE)
    Case(**tables).replace({"seat.angle": "30 deg"})
    assert tables == CASE


def test_material_objects_are_accepted_in_code():
    brass = Material("own brass", youngs_modulus=105e9, poissons_ratio=0.35)
    case = Case(**{**CASE, "closure": ball(brass)})
    assert case.closure.material is brass


def test_effective_modulus_of_unlike_bodies():
    # by hand: 1/E* = (1 - 0.09)/210e9 + (1 - 0.350^2)/100.6e9
    assert effective_modulus(material("steel"), material("brass")) == pytest.approx(76.594e9, rel=1e-4)


def test_every_material_has_a_source():
    assert all(one.source for one in LIBRARY.values())


# --- files ------------------------------------------------------------------------------------------------

TOML = """
[closure]
shape = "ball"
radius = "20 mm"
material = "steel"
[seat]
shape = "cone"
angle = "45 deg"
material = "steel 1.4122"
[roughness]
spectrum = { kind = "table", file = "spectra/C.csv" }
[load]
fluid_pressure = "5 bar"
"""


@pytest.fixture
def case_file(tmp_path):
    (tmp_path / "spectra").mkdir()
    (tmp_path / "spectra" / "C.csv").write_text(
        "# sandblasted\nq_1/m, C_m^4\n1e3, 1e-17\n1e5, 1e-20\n1e6, 1e-23\n"
    )
    path = tmp_path / "valve.toml"
    path.write_text(TOML)
    return path


def test_files_are_found_beside_the_case_and_results_are_placed_there(
    case_file, monkeypatch, tmp_path_factory
):
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    case = load_case(case_file)
    assert case.title == "valve"
    assert case.file == case_file
    assert case.output.folder == str(case_file.parent / "valve.out")
    spectrum = case.replace({"load.fluid_pressure": "6 bar"}).roughness.spectrum.build()
    assert spectrum(1e4) == pytest.approx(
        np.sqrt(1e-17 * 1e-20), rel=1e-9
    )  # log-log in the middle of a decade pair


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("q, C\n1e3, 1e-17\n1e2, 1e-18\n", "q must increase from row to row; line 3"),
        ("q, C\n1e3, 1e-17\n1e4, 0\n", "must be positive; line 3"),
        ("q, C\n1e3, 1e-17\n1e4, nan\n", "line 3"),
        ("q, C\n1e3, 1e-17\n1e4\n", "line 3"),
        ("q, C\n", "no rows"),
        ("", "is empty"),
        ("1 2 3\n4 5 6\n", "two columns"),
    ],
)
def test_wrong_spectrum_files(case_file, content, said):
    (case_file.parent / "spectra" / "C.csv").write_text(content)
    with pytest.raises(InputError, match=r"roughness\.spectrum\.file") as caught:
        load_case(case_file)
    assert said in str(caught.value)


def test_missing_and_binary_spectrum_files(case_file):
    (case_file.parent / "spectra" / "C.csv").write_bytes(b"\x89PNG\0\xff\xfe")
    with pytest.raises(InputError, match="not a text file"):
        load_case(case_file)
    (case_file.parent / "spectra" / "C.csv").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        load_case(case_file)


def test_case_files_that_are_none(tmp_path):
    for name, content, said in (
        ("a.toml", b"radius = 20 mm", "not valid TOML"),
        ("b.toml", b"\x00\xff\xfe", "not a text file"),
        ("c.toml", b"", "closure: is missing"),
        ("d.toml", b"a = [" * 5000, "d.toml"),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(InputError, match=said) as caught:
            load_case(path)
        assert name in str(caught.value)
    with pytest.raises(InputError, match="no such file"):
        load_case(tmp_path / "missing.toml")
    with pytest.raises(InputError, match="is a folder"):
        load_case(tmp_path)


def test_a_byte_order_mark_is_no_problem(tmp_path, case_file):
    case_file.write_bytes(b"\xef\xbb\xbf" + TOML.encode())
    assert load_case(case_file).closure.radius == 0.02


def test_message_names_file_key_value_and_what_is_allowed(case_file):
    case_file.write_text(TOML.replace('"45 deg"', '"95 deg"'))
    with pytest.raises(InputError) as caught:
        load_case(case_file)
    error = caught.value
    assert error.file == case_file
    assert error.key == "seat.angle"
    assert error.value == '"95 deg"'
    assert "above 0 deg and below 90 deg" in error.message
    assert error.allowed == error.message
    assert str(error) == f'{case_file}: seat.angle = "95 deg": {error.message}'


# --- messages ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("seat.angel", "45 deg", "do you mean angle?"),
        ("colsure", {}, "do you mean closure?"),
        ("roughness.spectrum.hurts", 0.5, "do you mean hurst?"),
        ("seat.material.youngs_modlus", "1 GPa", "do you mean youngs_modulus?"),
        ("closure.Radius", "1 mm", "do you mean radius?"),
        ("seat.angle", "0 deg", "above 0 deg and below 90 deg"),
        ("seat.angle", "90 deg", "above 0 deg and below 90 deg"),
        ("seat.angle", "-45 deg", "above 0 deg and below 90 deg"),
        ("seat.angle", 45, "no unit"),
        ("seat.angle", "45 mm", '"mm" does not fit'),
        ("closure.radius", "-20 mm", "from 10 um to 10 m"),
        ("closure.radius", "0 mm", "from 10 um to 10 m"),
        ("closure.radius", "20 m", "from 10 um to 10 m"),
        ("closure.radius", None, "is missing; add radius"),
        ("closure", None, "is missing; add a table [closure]"),
        ("load", None, "is missing; add a table [load] with fluid_pressure"),
        (
            "closure",
            "ball",
            'must be a table, [closure] with its keys below, or closure = { shape = "ball", radius = ',
        ),
        (
            "uncertainty.viscosity",
            "10 %",
            "[uncertainty.viscosity] with its keys below, or viscosity = { relative = ",
        ),
        ("closure.shape", "tours", 'do you mean "torus"?'),
        ("closure.shape", "egg", 'must be "ball"'),
        ("seat.shape", "conical_lands", 'do you mean "conical-land"?'),
        ("closure.material", "stel", '"steel"'),
        ("closure.material", 3, "is no material"),
        ("closure.material", {"name": "mine", "youngs_modulus": "210 GPa"}, "poissons_ratio: is missing"),
        ("seat.material.youngs_modulus", "0.5 MPa", "from 1 MPa to 2 TPa"),
        ("seat.material.youngs_modulus", "3 TPa", "from 1 MPa to 2 TPa"),
        ("seat.material.poissons_ratio", 0.5, "from 0 to 0.499"),
        ("seat.material.poissons_ratio", -0.1, "from 0 to 0.499"),
        ("seat.material.poissons_ratio", "0.3", "without quotes"),
        ("seat.material.poissons_ratio", float("nan"), "not a finite number"),
        ("seat.material.hardness", "0.5 GPa", "must not be below yield_stress"),
        ("roughness.spectrum.rms_height", "2 mm", "to 1 mm"),
        ("roughness.spectrum.hurst", 0, "above 0 to 1"),
        ("roughness.spectrum.hurst", 1.1, "above 0 to 1"),
        ("roughness.spectrum.hurst", True, "is not a number"),
        ("roughness.spectrum.hurst", 10**400, "out of range"),
        ("roughness.spectrum.q_low", "4e6 1/m", "must be below q_high"),
        ("roughness.spectrum.q_low", "3.14159e6 1/m", "must be below q_high"),
        ("roughness.spectrum.q_rolloff", "1 1/m", "must lie between q_low"),
        ("roughness.spectrum.q_rolloff", "1e8 1/m", "must lie between q_low"),
        ("roughness.spectrum.kind", "profile", 'needs file = "seat.csv"'),
        ("roughness.spectrum.kind", "tabel", '"self-affine" or "table"'),
        ("roughness.spectrum.kind", None, "write kind ="),
        ("roughness.spectrum", 5, "must be a table"),
        ("roughness", None, 'use law = "smooth"'),
        ("interface.law", "Persson", '"spectrum" or "exponential" or "smooth"'),
        ("interface.gamma", 0.4, 'only with law = "exponential"'),
        ("interface.plastic", "yes", "true or false"),
        ("fluid.viscosity", "-1 mPa s", "out of range"),
        ("fluid.viscosity", None, "is missing; add viscosity"),
        ("load.fluid_pressure", [], "1 to 1000"),
        ("load.fluid_pressure", ["1 bar", "2 mm"], 'entry 2, "2 mm"'),
        ("load.fluid_pressure", "-1 bar", "from 0 Pa to 10 GPa"),
        ("load.fluid_pressure", "20 GPa", "from 0 Pa to 10 GPa"),
        ("load.fluid_pressure", {"start": "1 bar", "stop": "2 bar"}, "num is missing"),
        ("load.fluid_pressure", {"start": "1 bar", "stop": "2 bar", "num": 2.5}, "whole number"),
        (
            "load.fluid_pressure",
            {"start": "1 bar", "stop": "2 bar", "num": 20000},
            "whole number from 2 to 1000",
        ),
        ("load.fluid_pressure", {"start": "3 bar", "stop": "2 bar", "num": 2}, "start must be below stop"),
        ("load.fluid_pressure", {"start": "3 bar", "stop": "2 bar", "nmu": 2}, 'unknown key "nmu"'),
        (
            "load.fluid_pressure",
            {"start": "0 bar", "stop": "2 bar", "num": 3, "spacing": "log"},
            'start, "0 bar", out of range',
        ),
        ("load.axial_force", "1 kN", "write applied_force"),
        ("interface.law", "persson", 'write "spectrum"'),
        ("load.applied_force", "100 MN", "effective modulus: no contact on these faces carries it"),
        ("load.fluid_pressure", 5, "no unit"),
        ("load.fluid_pressure", None, "is missing"),
        ("load.closing", "penetrating", '"sealed-area" or "penetration"'),
        ("load.applied_force", ["1 N", "2 N", "3 N"], "has 3 entries, but fluid_pressure has 2"),
        ("load.applied_force", ["1 N", "2 bar"], 'entry 2, "2 bar"'),
        ("load.target_leak_rate", "1 mm", "write a leak rate"),
        ("load.pressure_side", "left", '"outer" or "inner"'),
        ("load.applied_force", "-2 kN", "give an applied_force above -62.8319 N"),
        ("load.pressure_side", "inner", "give an applied_force above 1256.64 N"),
        ("leak.percolation_threshold", 1.5, "from 0.05 to 0.95"),
        ("leak.conductivity", "brugeman", '"bruggeman" or "direct"'),
        ("leak.conductivity", "critical-junction", "went in version 0.3.0"),
        ("leak.conductivity", "threshold-law", "went in version 0.3.0"),
        ("leak.variants", True, "went in version 0.3.0"),
        ("leak.plasticity", 1, "true or false"),
        ("seat.bore_radius", "15 mm", "would touch first at r = 15 mm, where the face of the seat ends"),
        ("seat.face_radius", "14 mm", "would touch first at r = 14 mm, where the face of the seat ends"),
        ("seat.outer_radius", "14 mm", "would touch first at r = 14 mm, where the face of the seat ends"),
        ("mesh.contact_size", "10 mm", "too coarse"),
        ("mesh.contact_size", "0 mm", "from 1 nm"),
        ("output.folder", 5, "text in quotes"),
        ("title", 5, "text in quotes"),
    ],
)
def test_message_for(key, value, said):
    message = wrong({key: value})
    assert said in message
    assert key.split(".")[0] in message


def test_largest_load_is_what_the_whole_face_carries_with_a_quarter_of_the_modulus(case):
    # F_N = f_N 2 pi r0 cos(theta) with r0 = R sin(45 deg), cos(theta) the same: pi R^2 f_N/R
    start, end = case.contact.reach
    force = case.effective_modulus / 4 * (end - start) * 2 * math.pi * 0.02 / 2
    spring = force - math.pi * case.initial_contact_radius**2 * 20e5
    message = wrong({"load.applied_force": f"{spring * 1.001} N"})
    assert "effective modulus" in message and f"calculated is {force / 1e6:.4g} MN" in message
    case.replace({"load.applied_force": f"{spring * 0.999} N"})


def test_needed_applied_force_is_the_one_that_just_closes(case):
    inner = {"load.pressure_side": "inner", "load.fluid_pressure": "20 bar"}
    needed = math.pi * case.initial_contact_radius**2 * 20e5
    assert "open" in wrong({**inner, "load.applied_force": f"{needed * (1 - 1e-12)!r} N"})
    case.replace({**inner, "load.applied_force": f"{needed * (1 + 1e-12)!r} N"})


def test_missing_hardness_names_both_bodies_and_the_remedy():
    message = wrong({"seat.material": "brass"})
    assert 'closure.material = "steel"' in message
    assert 'seat.material = "brass"' in message
    assert 'hardness = "3.5 GPa"' in message
    assert "plasticity = false" in message
    assert "interface.plastic" in wrong(
        {"seat.material": "brass", "leak.plasticity": False, "interface.plastic": True}
    )


def test_exponential_law_without_roughness_needs_its_numbers(case):
    law = {"roughness": None, "interface.law": "exponential"}
    message = wrong(law)
    assert "interface.u0: is missing" in message
    assert "interface.p_c: is missing" in message
    exponential = case.replace({**law, "interface.u0": "0.76 um", "interface.p_c": "10 GPa"})
    assert exponential.interface.u0 == 0.76e-6
    assert "remove one of them" in wrong(
        {"interface.law": "exponential", "interface.u0": "0.76 um", "interface.gamma": 0.4}
    )


def test_several_problems_are_all_listed():
    message = wrong(
        {"closure.radius": "20", "seat.angel": "45 deg", "load.applied_force": 3, "fluid.viscosity": "1 Pa"}
    )
    assert [line.split(":")[0].split(" =")[0] for line in message.splitlines()] == [
        "closure.radius",
        "seat.angel",
        "fluid.viscosity",
        "load.applied_force",
    ]


def test_input_error_is_a_value_error():
    with pytest.raises(ValueError, match="closure"):
        Case()


# --- anything may come in ---------------------------------------------------------------------------------

leaves = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(ANY, max_size=20)
    | st.sampled_from(
        ["20 mm", "45 deg", "1 bar", "-3 GPa", "1e3 1/m", "ball", "cone", "steel", "table", "spectrum"]
    )
)
anything = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(ANY, max_size=8), inner, max_size=3),
    max_leaves=6,
)


def keys_of(tables, path=()):
    for key, value in tables.items():
        yield (*path, key)
        if isinstance(value, dict):
            yield from keys_of(value, (*path, key))


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    path=st.sampled_from(sorted(keys_of(CASE))),
    extra=st.text(ANY, max_size=8),
    value=anything,
    delete=st.booleans(),
)
def test_a_damaged_case_is_a_case_or_an_input_error(path, extra, value, delete):
    tables = copy.deepcopy(CASE)
    table = tables
    for key in path[:-1]:
        table = table[key]
    if delete:
        del table[path[-1]]
        table[extra] = value
    else:
        table[path[-1]] = value
    try:
        assert math.isfinite(Case(**tables).initial_contact_radius)
    except InputError as error:
        assert str(error)


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(tables=st.dictionaries(st.sampled_from([*CASE, "interface", "mesh", "leak", "output", "x"]), anything))
def test_any_tables_are_a_case_or_an_input_error(tables):
    try:
        Case(**tables)
    except InputError as error:
        assert str(error)


def test_public_names_load_on_first_use():
    assert fem_seal.load_case is load_case
    with pytest.raises(AttributeError, match="no_such_name"):
        fem_seal.no_such_name  # noqa: B018


def test_a_case_is_loaded_from_a_dict_of_its_tables_as_from_a_file():
    tables = copy.deepcopy(CASE)
    assert load_case(tables) == Case(**CASE)
    assert load_case(tables).file is None
    # read as a file is: nobody could tell whether 20 meant metres or millimetres
    tables["closure"]["radius"] = 0.02
    with pytest.raises(InputError, match=r"closure.radius = 0.02: has no unit"):
        load_case(tables)
    with pytest.raises(InputError, match="keys must be words"):
        load_case({1: {}})


def test_replace_takes_si_numbers_as_well_as_texts():
    case = Case(**CASE)
    same = {
        "closure.radius": ("25 mm", 0.025),
        "seat.angle": ("60 deg", math.radians(60)),
        "load.fluid_pressure": (["1 bar", "7 bar"], np.array([1e5, 7e5])),
        "seat.material": (
            {"youngs_modulus": "200 GPa", "poissons_ratio": 0.3, "hardness": "3 GPa"},
            {"youngs_modulus": 200e9, "poissons_ratio": 0.3, "hardness": 3_000_000_000},
        ),
        "seat.bore_radius": ("10 mm", np.float64(0.01)),
        "roughness.spectrum.rms_height": ("1.5 um", 1.5e-6),
    }
    for key, (text, number) in same.items():
        written, si = case.replace({key: text}), case.replace({key: number})
        assert si.closure == written.closure
        assert si.seat == written.seat
        assert si.load == written.load
        assert si.roughness == written.roughness
    # beside texts, in a list and in a range, and once more on top
    both = case.replace({"load.fluid_pressure": [1e5, "7 bar"]})
    assert both.load.fluid_pressure == (1e5, 7e5)
    ranged = both.replace(load={"fluid_pressure": {"start": 1e5, "stop": 3e5, "num": 3}})
    assert ranged.load.fluid_pressure == (1e5, 2e5, 3e5)
    drawn = [{"to": [0.0, 0.0]}, {"to": [0.02, "0 mm"]}, {"to": ["20 mm", 0.02], "radius": 0.03}]
    assert with_units(CaseTables, {"seat": {"shape": "profile", "outline": drawn}}) == {
        "seat": {
            "shape": "profile",
            "outline": [
                {"to": ["0.0 m", "0.0 m"]},
                {"to": ["0.02 m", "0 mm"]},
                {"to": ["20 mm", "0.02 m"], "radius": "0.03 m"},
            ],
        }
    }


def test_a_case_takes_si_numbers_and_is_written_as_its_file():
    tables = copy.deepcopy(CASE)
    tables["closure"]["radius"] = np.float64(0.02)
    tables["roughness"]["spectrum"]["hurst"] = np.float64(0.6)
    case = Case(**tables, gasket=None)
    assert case.closure.radius == 0.02
    for one in (case, Case(**CASE), Case(**CASE).replace({"seat.angle": 0.8})):
        again = load_case(tomllib.loads(str(one)))
        assert input_tables(again) == input_tables(one)
        assert str(again) == str(one)
    assert "None" not in str(case)
    assert "<Case" in repr(case)
    assert len(repr(case)) < 100


def test_a_material_made_in_code_is_written_with_its_numbers():
    own = Material("own", 105e9, 0.35, hardness=1e9, hardening=HardeningCurve((0.0, 0.1), (250e6, 350e6)))
    case = Case(**{**CASE, "closure": ball(own)})
    again = load_case(tomllib.loads(str(case))).closure.material
    assert (again.youngs_modulus, again.poissons_ratio, again.hardness) == (105e9, 0.35, 1e9)
    assert again.hardening.stress == own.hardening.stress


def test_a_notebook_shows_a_case_without_markup_of_the_user():
    page = Case(**CASE, title="<script>")._repr_html_()
    assert "&lt;script&gt;" in page
    assert "<script" not in page
    assert len(page) < 3000


def test_completion_of_a_case_offers_its_tables():
    names = dir(Case(**CASE))
    assert {"closure", "seat", "load", "replace", "written"} <= set(names)
    assert not [name for name in names if name.startswith(("_", "model_"))]
    assert all(hasattr(Case(**CASE), name) for name in names)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (25, "out of range"),
        (math.nan, "not a finite number"),
        (True, "not a quantity"),
        (10**400, "has no unit"),
    ],
)
def test_numbers_that_may_not_stand_there_are_refused(value, message):
    with pytest.raises(InputError, match=message):
        Case(**CASE).replace({"closure.radius": value})


def test_a_study_file_needs_units_all_the_same():
    with pytest.raises(InputError, match=r"changes.closure.radius = 0.02: has no unit"):
        Study(
            Case(**CASE),
            changes={"closure.radius": 0.02},
            parameters={"seat.angle": ["40 deg", "50 deg"]},
            responses=["peak_pressure_Pa"],
        )


def test_replace_keeps_what_it_does_not_change():
    # the contact geometry takes longest, and studies change other entries thousands of times
    case = Case(**CASE)
    assert case.replace({"load.fluid_pressure": 3e5}).contact is case.contact
