"""Profiles as programs export them: whatever the columns are, the same points of the same seat, or a reason why not."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import fem_seal
from fem_seal.answers.chain import solve_profiles
from fem_seal.answers.leakage_class import nominal_size
from fem_seal.answers.profile_files import ImportedProfile, read_profiles
from fem_seal.answers.profile_leak import leak_of_profiles
from fem_seal.case.case import case_of
from fem_seal.errors import InputError
from fem_seal.files import read_toml
from fem_seal.output.report.brief import first_line
from fem_seal.output.report.page import report
from fem_seal.output.tables import write_profile_csv
from fem_seal.seal.problem import SealProblem

EXAMPLES = Path(__file__).parents[3] / "examples"
STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3.5 GPa"}
TABLES = {
    "closure": {"shape": "ball", "radius": "20 mm", "material": STEEL},
    "seat": {"shape": "cone", "angle": "45 deg", "material": STEEL},
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
# First touch at R sin(45 deg), and a contact 0.2 mm wide on it [mm], [MPa].
R0 = 20.0 / math.sqrt(2.0)
X = np.linspace(-0.3, 0.3, 61)
P = 100.0 * np.exp(-0.5 * (X / 0.08) ** 2)
R, Z = R0 + X / math.sqrt(2.0), X / math.sqrt(2.0)


@cache
def problem(**load: str | tuple[str, ...]) -> SealProblem:
    return SealProblem.of(case_of({**TABLES, "load": load or TABLES["load"]}))


def written(header: str, *columns: np.ndarray, separator: str = ",") -> str:
    rows = "".join(
        separator.join(f"{value:.9g}" for value in row) + "\n" for row in zip(*columns, strict=True)
    )
    return f"{header}\n{rows}"


@pytest.fixture
def read(tmp_path: Path):
    def profiles(content: str | bytes, of: SealProblem | None = None) -> tuple[ImportedProfile, ...]:
        path = tmp_path / "profile.txt"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return read_profiles(path, (of or problem()).contact)

    return profiles


MIXED = np.random.default_rng(3).permutation(len(X))
ZERO = np.zeros_like(X)
TURN = 0.3
# Names, rotated coordinates, encodings: the same points on the same seat.
SAME = {
    "arc length": written("x [mm],p [MPa]", X, P),
    "arc length in metres and pascals": written("x_m,contact_pressure_Pa", X * 1e-3, P * 1e6),
    "a path from zero": written("Length (mm)\tValue (MPa)", X + 0.3, P, separator="\t").encode("utf-16"),
    "radius alone": written("r [mm],CPRESS [MPa]", R, P),
    "radius beside the arc length": written("x [mm],r [mm],p [MPa]", X, R, P),
    "radius beside a path": written("s [mm],r [mm],p [MPa]", X + 7.0, R, P),
    "one radius for all points": written("x [mm],r [mm],p [MPa]", X, ZERO + 14.0, P),
    "X and Y": written("X [mm],Y [mm],CPRESS [MPa]", R, Z + 5.0, P),
    "X and Y, axis upside down": written("X [mm],Y [mm],CPRESS [MPa]", R, 5.0 - Z, P),
    "X and Z": written("X [mm],Y [mm],Z [mm],CPRESS [MPa]", R, ZERO, Z, P),
    "a meridian turned around the axis": written(
        "X [mm],Y [mm],Z [mm],CPRESS [MPa]", R * math.cos(TURN), Z, R * math.sin(TURN), P
    ),
    "COORD without units": written("Node,COORD.COOR1,COORD.COOR2,CPRESS", np.arange(61), R, Z, P),
    "COORD in SI without units": written("Node,COOR1,COOR2,CPRESS", np.arange(61), R / 1e3, Z / 1e3, P * 1e6),
    "arc length and points": written("arc_length [mm],Points:0 [mm],Points:1 [mm],p [MPa]", X + 0.3, R, Z, P),
    "ParaView without units": written(
        '"p","Points:0","Points:1","arc_length"', P * 1e6, R / 1e3, Z / 1e3, (X + 0.3) / 1e3
    ),
    "ParaView, all at one radius": written(
        '"CPRESS","Points:0","Points:1","arc_length"', P, 0 * R + R0, 0 * Z, X + 0.3
    ),
    "COMSOL": written(
        "% Length unit:        mm\n% x                       y (MPa)", X, P, separator="        "
    ),
    "in no order": written("x [mm],p [MPa]", X[MIXED], P[MIXED]),
    "points twice": written("x [mm],p [MPa]", np.repeat(X, 2), np.repeat(P, 2) * np.tile([0.99, 1.01], 61)),
    "decimal commas": written("x [mm];p [MPa]", X, P, separator=";").replace(".", ","),
    "Latin-1": written("Länge [mm];Anpressdruck [MPa]", X + 0.3, P, separator=";").encode("latin-1"),
    "other columns of the program": written("x [mm],CPRESS [MPa],COPEN [mm],CSHEAR1 [MPa]", X, P, -ZERO, P),
}


@pytest.mark.parametrize("name", SAME)
def test_the_same_points_however_they_are_written(name: str, read) -> None:
    (found,) = read(SAME[name])
    assert found.x == pytest.approx(X * 1e-3, abs=2e-9)
    assert found.pressure == pytest.approx(P * 1e6, rel=1e-7)
    assert found.fluid_pressure is None


@pytest.mark.parametrize("name", ["radius alone", "X and Y", "a path from zero", "one radius for all points"])
def test_they_leak_as_much(name: str, read) -> None:
    """r for x would be 1.4 times the width on this seat, and far more on one that is steeper."""
    (wanted,), (found,) = (
        [load.leak.leak_rate for load in leak_of_profiles(problem(), read(SAME[one]))]
        for one in ("arc length", name)
    )
    # 14 mm in place of 14.142 mm around the axis; r changes along x, which adds the square of width over radius
    assert found == pytest.approx(wanted * (14.0 / R0 if "one radius" in name else 1.0), rel=(0.2 / R0) ** 2)


CIRCLE = np.linspace(0.0, 2 * np.pi, 12, endpoint=False)
R_OVER, TURNED = (one.ravel() for one in np.meshgrid(R, CIRCLE))
P_OVER, Z_OVER = np.tile(P, 12) * (1.0 + 0.5 * np.cos(TURNED)), np.tile(Z, 12)
# What is refused, and what of it is understood.
CONTRADICTIONS = {
    "x is a radius": (
        written("x [mm],p [MPa]", R, P),
        'highest at x = 14.14 mm, and zero at x = 0; .*"x \\[mm\\]" is the arc',
    ),
    "m read as mm": (
        written("x [m],p [MPa]", X, P),
        "reaches .290 mm, the contact circle has a radius of 14.14 mm: is the unit right",
    ),
    "mm read as um": (
        written("x [um],p [MPa]", 1e-3 * X, P),
        "contact circle has a radius of 14.14 mm: is the unit right",
    ),
    "another radius": (
        written("r [mm],p [MPa]", R - 5.0, P),
        "highest at r = 9.14. mm, closure and seat of the case touch first at 14.1",
    ),
    "a radius beside the face": (
        written("x [mm],r [mm],p [MPa]", X, R + 90.0, P),
        "the face of the seat from 7.07. mm to 22.6. mm",
    ),
    "one wrong radius": (
        written("x [mm],r [mm],p [MPa]", X, ZERO + 10.0, P),
        "from 10 mm to 10 mm, the seat at these x from 13.9",
    ),
    "x is no arc length beside r": (
        written("x [mm],r [mm],p [MPa]", 3.0 * X, R, P),
        "r contradicts the case: along the seat",
    ),
    "points of another seat": (
        written("X [mm],Y [mm],p [MPa]", R, 0.2 * Z, P),
        "do not lie on the face of the seat",
    ),
    "a text between numbers": (
        written("r,CPRESS", R, P).replace(f"{R[3]:.9g},{P[3]:.9g}", "14.0,abc"),
        r'line 5 \("14.0,abc"\) is no row like line 2',
    ),
    "a map in space": (
        written("X,Y,Z,CPRESS", R_OVER * np.cos(TURNED), Z_OVER, R_OVER * np.sin(TURNED), P_OVER),
        "over a surface",
    ),
    "a map in a plane": (
        written("X,Y,CPRESS", R_OVER * np.cos(TURNED), R_OVER * np.sin(TURNED), P_OVER),
        "over a surface",
    ),
    "a map with angles": (written("r [mm],theta [deg],p [MPa]", R_OVER, TURNED, P_OVER), "over a surface"),
    "a map without angles": (written("r [mm],p [MPa]", R_OVER[::-1], P_OVER[::-1]), "over a surface"),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_contradictions_are_told(name: str, read) -> None:
    text, said = CONTRADICTIONS[name]
    with pytest.raises(InputError, match=said):
        read(text)


def test_a_radius_alone_gives_the_place_on_a_land_with_walls_beside_it(read) -> None:
    seat = {"shape": "flat-land", "land_inner_diameter": "38 mm", "land_outer_diameter": "46 mm"}
    closure = {"shape": "disc", "diameter": "60 mm", "material": STEEL}
    land = SealProblem.of(case_of({**TABLES, "closure": closure, "seat": seat | {"material": STEEL}}))
    r = np.linspace(19.2, 22.8, 61)
    (found,) = read(written("r [mm],CPRESS [MPa]", r, 30.0 + np.abs(r - 21.0)), land)
    assert found.x == pytest.approx((r - 21.0) * 1e-3, abs=1e-9)


@pytest.mark.parametrize(("unit", "said"), [("Pa", "right"), ("GPa", None)])
def test_pressures_far_below_that_of_the_fluid_ask_for_the_unit(unit: str, said: str | None, read) -> None:
    profiles = read(written(f"x [mm],p [{unit}]", X, P if said else 1e-3 * P))
    if said:
        with pytest.raises(InputError, match="lift the seal open: is the unit of the contact pressure right"):
            leak_of_profiles(problem(), profiles)
    else:
        (load,) = leak_of_profiles(problem(), profiles)
        assert np.isfinite(load.leak.leak_rate)


def test_points_on_both_sides_of_zero_are_no_radii(read) -> None:
    """A field export along X, in the order of its nodes, with texts beside it and no units."""
    lines = [
        f"seat.odb, Step-1, Increment 12: Step Time = 1.000, SEAT-1, {n}, {X[n]:.6E}, 0.0, 0.0, {P[n]:.6E}"
        for n in MIXED
    ]
    header = "ODB Name, Step, Frame, Part Instance Name, Node Label, X, Y, Z, CPRESS General_Contact_Domain"
    (found,) = read("\n".join([header, *lines]))
    assert found.x == pytest.approx(X * 1e-3, abs=1e-8)
    assert found.pressure == pytest.approx(P * 1e6, rel=1e-6)
    assert "mm and MPa" in found.remark


REPORT = """
Field Output Report, written Tue Jan 12 14:20:33 2016

   Step: {step}
   Frame: Increment     12: Step Time =    1.000

Loc 1 : Nodal values from source 1

Field Output reported at nodes for part: SEAT-1

            Node     COORD.COOR1     COORD.COOR2          CPRESS
           Label          @Loc 1          @Loc 1          @Loc 1
-----------------------------------------------------------------
{rows}

  Minimum     13.9      -.2   0.
      At Node    1       1    1
"""


def field_report(step: str, pressure: np.ndarray) -> str:
    rows = "\n".join(
        f"{n:16d} {r:15.8E} {z:15.8E} {p:15.8E}"
        for n, (r, z, p) in enumerate(zip(R, Z, pressure, strict=True))
    )
    return REPORT.format(step=step, rows=rows)


# Two load steps, with twice the pressure in the second, and the fluid pressures that the file states [bar].
STEPS = {
    "below each other, by fluid pressure": (
        written(
            "fluid_pressure [bar],x [mm],p [MPa]", np.repeat([20, 40], 61), np.tile(X, 2), np.append(P, 2 * P)
        ),
        (20, 40),
    ),
    "below each other, by step": (
        written(
            "Step,x [mm],p [MPa]",
            np.repeat([1, 2], 61),
            np.tile(X[MIXED], 2),
            np.append(P, 2 * P)[np.append(MIXED, 61 + MIXED)],
        ),
        (),
    ),
    "below each other, beginning anew": (written("x [mm],p [MPa]", np.tile(X, 2), np.append(P, 2 * P)), ()),
    "beside each other": (written("x [mm],p at 20 bar [MPa],p at 40 bar [MPa]", X, P, 2 * P), (20, 40)),
    "beside each other without fluid pressure": (written("X,CPRESS step 1,CPRESS step 2", X, P, 2 * P), ()),
    "in tables of a report": (field_report("Step-1", P) + field_report("Step-2", 2 * P), ()),
    "after one without contact": (
        field_report("Step-0", ZERO) + field_report("Step-1", P) + field_report("Step-2", 2 * P),
        (),
    ),
}


@pytest.mark.parametrize("name", STEPS)
def test_load_steps(name: str, read) -> None:
    text, stated = STEPS[name]
    found = read(text)
    assert [one.fluid_pressure for one in found] == pytest.approx([1e5 * bar for bar in stated] or [None] * 2)
    for one, times in zip(found, (1.0, 2.0), strict=True):
        assert one.x == pytest.approx(X * 1e-3, abs=2e-9)
        assert one.pressure == pytest.approx(times * P * 1e6, rel=1e-7)


# A strain along the face that tells the points apart, and one around the axis.
ALONG, HOOP = 0.02 + 0.01 * X, -0.003 + ZERO
STRAINED = "x [mm],p [MPa],bulk_strain_meridional,bulk_strain_hoop"
# The same strains, whatever else is in the file.
STRAINS = {
    "plain numbers": written(STRAINED, X, P, ALONG, HOOP),
    "per cent, in no order": written(
        "bulk_strain_hoop [%],x [mm],bulk_strain_meridional (%),p [MPa]",
        *(values[MIXED] for values in (100 * HOOP, X, 100 * ALONG, P)),
    ),
    "points twice": written(
        STRAINED, *(np.repeat(values, 2) for values in (X, P)), np.repeat(ALONG, 2) * np.tile([0.9, 1.1], 61),
        np.repeat(HOOP, 2),
    ),
    "of the second of two steps": written(
        "fluid_pressure [bar]," + STRAINED,
        np.repeat([20, 40], 61), np.tile(X, 2), np.append(2 * P, P), np.append(ZERO, ALONG), np.append(ZERO, HOOP),
    ),
    "of each step beside its pressure": written(
        "x [mm],p at 20 bar [MPa],bulk_strain_meridional,bulk_strain_hoop,p at 40 bar [MPa],"
        "bulk_strain_meridional at 40 bar [-],bulk_strain_hoop at 40 bar [-]",
        X, 2 * P, ZERO, ZERO, P, ALONG, HOOP,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", STRAINS)
def test_strains_stay_with_their_points(name: str, read) -> None:
    found = read(STRAINS[name])[-1]
    assert found.x == pytest.approx(X * 1e-3, abs=2e-9)
    assert found.pressure == pytest.approx(P * 1e6, rel=1e-7)
    assert found.strain == pytest.approx(np.stack([ALONG, HOOP, ZERO], axis=1), rel=1e-7)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (written("x [mm],p [MPa],bulk_strain_hoop", X, P, HOOP), "no columns bulk_strain_meridional, and 1"),
        (written(STRAINED[:-17], X, P, ALONG), "no columns bulk_strain_hoop, and 1 of contact pressure"),
        (written(STRAINED + ",p at 40 bar [MPa]", X, P, ALONG, HOOP, P), "1 column bulk_strain_meridional, and 2"),
        (written(STRAINED, X, P, ALONG, HOOP - X**2 * 20), '"bulk_strain_hoop" must .* line 2 has -1.803: is'),
        (written(STRAINED, X, P, ALONG, np.where(X > -0.3, HOOP, np.inf)), "line 2 .*finite numbers"),
        (written(STRAINED + " [mm]", X, P, ALONG, HOOP), 'unit "mm" does not fit a strain'),
    ],
    ids=["no meridional", "no hoop", "one for two steps", "too large", "infinite", "a length"],
)  # fmt: skip
def test_strains_that_are_none_are_told(text: str, said: str, read) -> None:
    with pytest.raises(InputError, match=said):
        read(text)


def test_columns_of_strains_without_numbers_say_nothing(read) -> None:
    """So they stand in profile.csv of a profile that had none."""
    rows = "".join(f"{x:.9g},{p:.9g},,,\n" for x, p in zip(X, P, strict=True))
    (found,) = read(f"{STRAINED},elastic_area_strain\n{rows}")
    assert found.strain is None and found.pressure == pytest.approx(P * 1e6, rel=1e-7)


def test_the_elastic_part_may_stand_beside_the_strains(read) -> None:
    (found,) = read(written(f"{STRAINED},elastic_area_strain", X, P, ALONG, HOOP, 1e-3 + ZERO))
    assert found.strain == pytest.approx(np.stack([ALONG, HOOP, 1e-3 + ZERO], axis=1), rel=1e-7)


def test_strained_metal_leaks_as_unstrained_metal_that_is_pressed_harder(read) -> None:
    """The same numbers from the pressures at rest, written into a file; twice the strain leaks less."""
    of = problem()
    plain, strained, more = (
        read(text)
        for text in (
            SAME["arc length"],
            STRAINS["plain numbers"],
            written(STRAINED, X, P, 2 * ALONG, 2 * HOOP),
        )
    )
    rest = of.surface.pressure_at_rest(P * 1e6, ALONG, HOOP) / 1e6
    harder = read(written("x [mm],p [MPa]", X, rest))
    rates = [leak_of_profiles(of, profiles)[0].leak.leak_rate for profiles in (plain, strained, more, harder)]
    assert rates[1] == pytest.approx(rates[3], rel=1e-5)
    assert rates[0] > 1.1 * rates[1] > 1.1**2 * rates[2]


def test_metal_that_may_flow_asks_for_its_strain(read) -> None:
    """The lower end opens from half the yield stress on, by orders of magnitude where it flows; the upper one stays."""
    flows = 3.5e9 / 2.9
    found = []
    for share in (0.49, 0.501, 0.75, 1.0, 1.2):
        profiles = read(written("x [mm],p [MPa]", X, P / P.max() * share * flows / 1e6))
        (load,) = leak_of_profiles(problem(), profiles)
        found.append([one for one in load.validity.cautions if one.kind == "bulk strain"])
        zero = np.zeros((len(profiles[0].x), 3))
        (known,) = leak_of_profiles(problem(), [replace(profiles[0], strain=zero)])
        assert not any(one.kind == "bulk strain" for one in known.validity.cautions)
        assert load.leak_interval.high == known.leak_interval.high
        assert (load.leak_interval.low < known.leak_interval.low) == (share > 0.5)
    assert not found[0]
    lows = [one.leak_factor.low for (one,) in found[1:]]
    assert lows == pytest.approx([1e-3**0.002, 1e-3**0.5, 1e-3, 1e-3], rel=1e-3)
    assert "bulk_strain_meridional and bulk_strain_hoop" in found[-1][0].text()
    elastic = SealProblem.of(case_of({**TABLES, "leak": {"plasticity": False}}))
    (load,) = leak_of_profiles(elastic, profiles)
    assert not any(one.kind == "bulk strain" for one in load.validity.cautions)


@pytest.mark.slow
def test_the_profile_of_a_yielding_run_leaks_as_the_run(tmp_path: Path) -> None:
    """As closely as one without strain; without its strains 2 % more."""
    tables = read_toml(EXAMPLES / "copper_ring.toml", "case")
    tables["load"]["applied_force"] = "2 kN"
    ring = fem_seal.run(case_of(tables))
    profiles = read_profiles(write_profile_csv(ring, tmp_path / "profile.csv"), ring.problem.contact)
    (load,) = leak_of_profiles(ring.problem, profiles)
    (without,) = leak_of_profiles(ring.problem, [replace(profiles[0], strain=None)])
    rate = ring.loads[0].leak.leak_rate
    assert load.leak.leak_rate == pytest.approx(rate, rel=2e-3)
    assert without.leak.leak_rate > 1.015 * rate
    assert without.leak_interval.low < 0.01 * load.leak_interval.low


def test_load_steps_meet_the_fluid_pressures_of_the_case(read) -> None:
    """In their order where they are as many, and never each with all."""
    two, three = (
        problem(fluid_pressure=("20 bar", "40 bar")),
        problem(fluid_pressure=("20 bar", "40 bar", "60 bar")),
    )
    profiles = read(STEPS["beside each other without fluid pressure"][0])
    loads = leak_of_profiles(two, profiles)
    assert [load.fluid_pressure for load in loads] == [2e6, 4e6]
    assert loads[1].peak_pressure == pytest.approx(2 * loads[0].peak_pressure, rel=1e-6)
    with pytest.raises(
        InputError, match="2 load steps and does not say their fluid pressures, the case has 3"
    ):
        leak_of_profiles(three, profiles)


def test_the_verdict_is_that_of_each_steps_own_pressure(read) -> None:
    """The chain of a run: requirement, first line at the load that decides, and a report without bodies."""
    profiles = read(STEPS["beside each other"][0])
    rates = [load.leak.leak_rate for load in leak_of_profiles(problem(), profiles)]
    assert rates[1] > rates[0]
    limit = f"{0.5 * (rates[0] + rates[1])} m^3/s"
    case = case_of({**TABLES, "load": {"fluid_pressure": "30 bar"}, "requirement": {"leak_rate": limit}})
    found = solve_profiles(case, profiles)
    assert [load.fluid_pressure for load in found.loads] == [2e6, 4e6]
    assert [load.leak.leak_rate for load in found.loads] == pytest.approx(rates, rel=1e-9)
    assert [str(load.verdict) for load in found.loads] == ["pass", "fail"]
    assert first_line(found).startswith("Fail at 40 bar")
    page = report(found, full=True)
    assert 'id="picture-leak"' in page and 'id="accuracy"' not in page
    assert "is their contact pressure" in page


BARE = {
    "arc length and radius": (written("x [mm],r [mm],p [MPa]", 5.0 - X, R, P), None),
    "radius and height": (written("r [mm],z [mm],p [MPa]", R[MIXED], Z[MIXED], P[MIXED]), None),
    "two coordinates": (written("X [mm],Y [mm],CPRESS [MPa]", R, -Z, P), None),
    "the first along the axis": (written("X [mm],Y [mm],CPRESS [MPa]", Z, R, P), "x"),
    "in space": (written("X,Y,Z,CPRESS", 0.6 * R, Z, 0.8 * R, P), "y"),
}


@pytest.mark.parametrize("name", BARE)
def test_a_case_without_shapes_takes_a_profile_with_its_radii(name: str, tmp_path: Path) -> None:
    text, axis = BARE[name]
    (file := tmp_path / "profile.csv").write_text(text)
    profiles = read_profiles(file, None, axis)
    expected = solve_profiles(case_of(TABLES), [ImportedProfile(X * 1e-3, P * 1e6, R * 1e-3, None)])
    found = solve_profiles(
        case_of({**TABLES, "closure": {"material": STEEL}, "seat": {"material": STEEL}}), profiles
    )
    assert profiles[0].x == pytest.approx(X * 1e-3, abs=1e-9)
    # the seat of the case ends, and beyond the points of the other profile the pressure goes on falling
    rate = expected.loads[0].leak.leak_rate
    assert found.loads[0].leak.leak_rate == pytest.approx(rate, rel=2e-4)
    assert found.loads[0].leak_interval == pytest.approx(expected.loads[0].leak_interval, rel=2e-4)
    assert found.warnings == expected.warnings
    assert "x = 0 is its centre" in report(found, full=True)


def test_the_nominal_size_without_shapes_is_that_of_the_inner_edge_of_the_contact() -> None:
    r = np.linspace(20e-3, 40e-3, 201)
    pressure = np.maximum(150e6 * (1.0 - ((r - 30e-3) / 10e-3) ** 2), 0.0)
    profile = ImportedProfile(r - r[0], pressure, r, None)
    bare = case_of({**TABLES, "closure": {"material": STEEL}, "seat": {"material": STEEL}})
    size = nominal_size(solve_profiles(bare, [profile]).case)
    assert (size.size, size.circle) == (40e-3, "inner edge of the contact")
    assert size.diameter == pytest.approx(40e-3, rel=0.01)


NEEDS = {
    r'seat\.shape: is missing, and "x \[mm\]" alone': written("x [mm],p [MPa]", X, P),
    r'seat\.shape: is missing, and "r \[mm\]" alone': written("r [mm],p [MPa]", R, P),
    "such as --axis z": written("X [mm],Y [mm],Z [mm],p [MPa]", R, ZERO, Z, P),
    "radius must be positive": written("x [mm],r [mm],p [MPa]", X, X, P),
}


@pytest.mark.parametrize("said", NEEDS)
def test_what_a_profile_without_shapes_lacks(said: str, tmp_path: Path) -> None:
    (file := tmp_path / "profile.csv").write_text(NEEDS[said])
    with pytest.raises(InputError, match=said):
        read_profiles(file, None)


def test_a_form_error_is_refused(read) -> None:
    """A scratch would leak beside the given contact, unseen."""
    tilted = SealProblem.of(case_of({**TABLES, "form": {"tilt": "0.01 deg"}}))
    with pytest.raises(InputError, match="a given contact is that of a round seal"):
        leak_of_profiles(tilted, read(SAME["arc length"]))


@pytest.mark.slow
def test_samples_keep_the_given_contact(read) -> None:
    """Each sample leaks as the same profile on the surface of that sample does."""
    profiles = read(SAME["arc length"])
    spread = {"samples": 16, "rms_height": {"relative": 0.2}}
    found = solve_profiles(case_of({**TABLES, "uncertainty": spread}), profiles)
    interval = found.uncertainty
    assert interval is not None and found.loads[0].sample_ends is not None
    factors = interval.values["rms_height"]
    for number in (int(np.argmin(factors)), int(np.argmax(factors))):
        spectrum = TABLES["roughness"]["spectrum"] | {"rms_height": f"{0.5 * float(factors[number])} um"}
        other = SealProblem.of(case_of({**TABLES, "roughness": {"spectrum": spectrum}}))
        (load,) = leak_of_profiles(other, profiles)
        # samples have tables from that of the case
        assert interval.leak_rate[0, number] == pytest.approx(load.leak.leak_rate, rel=0.01)
