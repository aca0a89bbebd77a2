"""Every family of shapes through the whole chain, from a case file to its results."""

from __future__ import annotations

import inspect
import json
import math

import pytest
from pydantic import ValidationError
from sample_results import run_loads
from shape_tables import CLOSURES, PAIRS, SHAPES, STEEL, dimensions_of, tables

from fem_seal import Case, InputError, load_case, run
from fem_seal.answers.closed_forms import derive
from fem_seal.case.case import with_units
from fem_seal.case.notation import choices, tables_of
from fem_seal.case.shapes import FLANGES, _model
from fem_seal.cli.terminal import show_derived
from fem_seal.output.case_words import chosen_dimensions, dimensions
from fem_seal.output.files import derived_numbers
from fem_seal.output.report.page import report
from meshes import Ball, ConicalSeat, Shape


@pytest.mark.parametrize("table", SHAPES)
def test_every_dimension_of_a_table_is_one_of_its_shape(table):
    assert dimensions_of(table) == set(inspect.signature(table.makes).parameters) - {"closure"}


@pytest.mark.parametrize("table", SHAPES)
def test_a_dimension_is_a_length_unless_its_key_says_angle(table):
    """Terminal and report choose the unit by the key."""
    keys = dimensions_of(table)
    units = {key: "1.0 rad" if key.endswith("angle") else "1.0 m" for key in keys}
    assert with_units(table, dict.fromkeys(keys, 1.0)) == units


def test_a_table_follows_from_the_parameters_of_a_maker_whatever_they_are() -> None:
    def cut(throat_angle: float, closure: Shape, *, throat_radius: float = 0.01) -> Shape:
        return ConicalSeat.around(throat_angle, closure, bore_radius=throat_radius)

    table = _model("Cut", "cut", cut)
    made = table(shape="cut", throat_angle="30 deg", throat_radius="8 mm", material="steel").body(Ball(0.02))
    assert made == ConicalSeat.around(math.radians(30), Ball(0.02), bore_radius=0.008)
    with pytest.raises(ValidationError, match="above 0 deg and below 90 deg"):
        table(shape="cut", throat_angle="95 deg", material="steel")


def test_every_shape_is_in_a_pair() -> None:
    for key, column in (("closure", 0), ("seat", 1)):
        tables = set(tables_of(Case.model_fields[key])) - set(FLANGES)  # which need a gasket
        assert {pair[column] for pair in PAIRS} == {
            word for table in tables for word in choices(table, "shape")
        }


@pytest.mark.slow
@pytest.mark.parametrize(("closure", "seat"), PAIRS)
def test_family_from_case_to_results(closure: str, seat: str, tmp_path) -> None:
    case = Case(**tables(closure, seat))
    result = run(case)
    contact = result.loads[0].contact
    assert contact.force_error == pytest.approx(0.0, abs=1e-9)
    assert contact.profile.peak_pressure > 1e6
    shares = contact.whole_profile.pressure[[0, -1]] / contact.whole_profile.pressure.max()
    ends = [abs(a - b) < 1e-9 for a, b in zip(result.seal_mesh.sizing.zone, case.contact.reach, strict=True)]
    assert all(share < 1e-6 or at_the_end for share, at_the_end in zip(shares, ends, strict=True))
    assert not [one for one in result.warnings if "could not be calculated" in one]
    result.write(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    for name in ("closure", "seat"):
        assert summary["input"][name].items() >= chosen_dimensions(case, name).items()
    page = (tmp_path / "report.html").read_text()
    assert f"closure of shape {closure} on a seat of shape {seat}" in page
    assert "(chosen)" in page or seat == "profile"


def test_dimensions_that_are_left_open_are_listed() -> None:
    case = Case(**tables("cone", "conical-land"))
    assert set(chosen_dimensions(case, "closure")) == {"inner_radius", "mean_radius", "edge_radius", "height"}
    seat = dimensions(case, "seat")
    assert seat["angle"] == pytest.approx(math.pi / 4)
    assert seat["land_radius"] == pytest.approx(case.initial_contact_radius, rel=1e-9)
    assert "interference" not in seat


@pytest.mark.parametrize(
    ("closure", "seat", "change", "said"),
    [
        ("ball", "cone", {"seat.shape": "conical"}, 'do you mean "conical-land"?'),
        ("ball", "cone", {"seat.interference": "20 um"}, 'only with wall = "fixed"'),
        ("ball", "cone", {"seat.wall": "fixd"}, '"free" or "fixed"'),
        (
            "ball",
            "cone",
            {"seat.wall": "fixed", "seat.interference": "0.5 mm", "seat.outer_radius": "40 mm"},
            "seat.interference = 0.5 mm: is 1.2 % of the radius of the wall, 40 mm; the theory is for small strains "
            "and allows up to 1 %, 0.4 mm",
        ),
        (
            "ball",
            "cone",
            {"closure.cavity_radius": "25 mm"},
            "closure.cavity_radius = 25 mm: must be below",
        ),
        ("ball", "conical-land", {"seat.land_width": "80 mm"}, "seat.land_width = 80 mm: the land"),
        ("ball", "conical-land", {"seat.land_width": 1}, "no unit"),
        ("ball", "conical-land", {"seat.land_wdth": "1 mm"}, "do you mean land_width?"),
        ("ball", "conical-land", {"seat.edge_radius": "1.5 mm"}, "allowed is up to"),
        ("cone", "cone", {"closure.outer_radius": None}, "one or two of outer_radius"),
        ("cone", "cone", {"closure.mean_radius": "12 mm", "closure.inner_radius": "9 mm"}, "all three"),
        ("ball", "sphere", {"seat.radius": "18 mm"}, "radius of the seat larger"),
        ("ball", "flat", {"seat.bore_radius": None}, "bore_radius is missing"),
        ("profile", "cone", {"closure.file": "a.dxf"}, "both are given"),
        ("profile", "cone", {"closure.outline": None, "closure.file": "a.dwg"}, "must end with .dxf"),
        ("profile", "cone", {"closure.outline": None, "closure.file": "a.dxf"}, "no such file"),
        ("profile", "cone", {"closure.outline": [{"to": ["0 mm", 3]}]}, "closure.outline[1].to"),
        ("profile", "cone", {"closure.outline": CLOSURES["profile"]["outline"][:-1]}, "is open"),
    ],
)
def test_wrong_shapes_name_the_key_and_the_remedy(closure: str, seat: str, change, said: str) -> None:
    with pytest.raises(InputError) as caught:
        # as a file says it: in code a bare number is SI
        Case(**tables(closure, seat)).replace_written(change)
    assert said in str(caught.value)


@pytest.mark.slow
def test_files_stand_beside_the_case(tmp_path) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=4)
    drawing.modelspace().add_lwpolyline([(10, 0), (40, 0), (40, 30), (30, 30)], close=True)
    drawing.saveas(tmp_path / "seat.dxf")
    (tmp_path / "case.toml").write_text(
        '[closure]\nshape = "ball"\nradius = "26 mm"\nmaterial = "steel"\n'
        '[seat]\nshape = "profile"\nfile = "seat.dxf"\nmaterial = "steel"\n'
        '[interface]\nlaw = "smooth"\n[load]\nfluid_pressure = "5 bar"\n'
    )
    case = load_case(tmp_path / "case.toml")
    # a line from (10, 0) to (30, 30): tan(theta) = 1.5
    assert math.tan(case.contact.angle) == pytest.approx(1.5, rel=1e-9)
    assert case.initial_contact_radius == pytest.approx(0.026 * math.sin(math.atan(1.5)), rel=1e-9)


@pytest.mark.slow
def test_ready_mesh_is_used_as_it_is_and_its_error_is_estimated(tmp_path) -> None:
    """The mesh of a parametric case, read back, gives the same contact; its error is that of a coarse mesh."""
    coarse = {"contact_size": "100 um"}
    parametric = Case(**tables("ball", "cone", mesh=coarse))
    known = run(parametric)
    known.seal_mesh.write(tmp_path / "seal.msh")
    source = {"shape": "profile", "file": str(tmp_path / "seal.msh"), "material": STEEL}
    case = Case(**{**tables("ball", "cone", mesh=coarse), "closure": source, "seat": source})
    result = run(case)
    assert case.initial_contact_radius == pytest.approx(parametric.initial_contact_radius, rel=1e-9)
    ours, theirs = result.loads[0].contact.profile, known.loads[0].contact.profile
    # the very same elements, but for the outermost ones of the contact line, where a millionth of the peak is left
    assert ours.peak_pressure == pytest.approx(theirs.peak_pressure, rel=1e-5)
    assert ours.std == pytest.approx(theirs.std, rel=1e-5)
    exact = run_loads(Case(**tables("ball", "cone"))).loads[0].contact.profile
    assert result.discretisation_error.std > 0
    assert abs(ours.std / exact.std - 1) < 3 * result.discretisation_error.std


def highest_stress(result) -> float:
    return float(result.table["max_von_mises_Pa"].iloc[0])


@pytest.mark.slow
def test_ball_of_splines_is_pushed_like_a_ball(tmp_path) -> None:
    """A spline becomes many arcs, of which the last one is tiny: it must not carry the whole closing force."""
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=4)
    space = drawing.modelspace()
    angles = [math.radians(angle) for angle in range(-90, 91, 5)]
    space.add_spline([(20 * math.cos(angle), 20 * math.sin(angle)) for angle in angles])
    space.add_line((0, 20), (0, -20))
    drawing.saveas(tmp_path / "ball.dxf")
    solid = {"shape": "ball", "radius": "20 mm", "material": STEEL}
    source = {"shape": "profile", "file": str(tmp_path / "ball.dxf"), "material": STEEL}
    expected, found = (
        run_loads(Case(**{**tables("ball", "cone"), "closure": body})) for body in (solid, source)
    )
    peaks = [result.loads[0].contact.profile.peak_pressure for result in (found, expected)]
    # fit points leave the circle by micrometres; the force acts above the widest place and not above 120 degrees
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-3)
    assert highest_stress(found) == pytest.approx(highest_stress(expected), rel=1e-2)


def top_of(result) -> tuple[float, float]:
    """Smallest and largest radius on which the closing force acts [m]."""
    mesh = result.seal_mesh.closure
    r = mesh.p[0, mesh.facets[:, mesh.boundaries["closure_top"]]]
    return r.min(), r.max()


@pytest.mark.parametrize("source", ["outline", "mesh"])
def test_flat_top_in_pieces_is_pushed_as_a_whole(source, tmp_path) -> None:
    coarse = {"contact_size": "50 um"}
    known = Case(**tables("spherical-tip", "cone", mesh=coarse))
    expected = run_loads(known)
    if source == "outline":
        pieces = known.bodies[0].outline.segments
        entries = [{"to": [f"{1e3 * c!r} mm" for c in pieces[0].start]}]
        for s in pieces:
            if s.name == "closure_top":
                entries.append({"to": ["21.9 mm", f"{1e3 * s.end[1]!r} mm"]})
            centre = {} if s.centre is None else {"centre": [f"{1e3 * c!r} mm" for c in s.centre]}
            entries.append({"to": [f"{1e3 * c!r} mm" for c in s.end], **centre})
        profile = {"outline": entries}
    else:
        path = expected.seal_mesh.write(tmp_path / "seal.msh")
        text = path.read_text()
        for part in ("top", "axis"):
            text = text.replace(f'"closure_{part}"', f'"elsewhere_{part}"')
        path.write_text(text)
        profile = {"file": str(path)}
    closure = {"shape": "profile", "material": STEEL, **profile}
    found = run_loads(Case(**{**tables("spherical-tip", "cone", mesh=coarse), "closure": closure}))
    peaks = [result.loads[0].contact.profile.peak_pressure for result in (found, expected)]
    assert top_of(found) == pytest.approx(top_of(expected), rel=1e-9)
    # the same body, with other triangles around the new corner and, opposite the facets of a file, in the seat
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-4)
    assert highest_stress(found) == pytest.approx(highest_stress(expected), rel=1e-3)


def test_bodies_from_files_are_named_with_what_was_read(tmp_path, capsys) -> None:
    ezdxf = pytest.importorskip("ezdxf", reason="DXF files need ezdxf")
    drawing = ezdxf.new(units=1)
    points = [(10, 0), (40, 0), (40, 30), (30, 30)]
    drawing.modelspace().add_lwpolyline(
        [(r / 25.4, z / 25.4) for r, z in points], close=True, dxfattribs={"layer": "RING"}
    )
    drawing.saveas(tmp_path / "seat.dxf")
    seat = {"shape": "profile", "file": str(tmp_path / "seat.dxf"), "layer": "ring", "material": STEEL}
    case = Case(**{**tables("profile", "cone"), "seat": seat})
    numbers = derived_numbers(case, derive(case))
    assert numbers["sections"]["seat"]["length_unit_m"] == 0.0254
    # extents as drawn, an arc included
    assert numbers["sections"]["closure"]["r_m"] == pytest.approx((0, 0.017))
    assert numbers["sections"]["closure"]["file"] is None
    show_derived(case, numbers | {"contact_size_m": None})
    shown = capsys.readouterr().out
    assert "  closure   r 0 to 17 mm, z 0 to 25 mm\n" in shown
    assert "  seat      seat.dxf, layer ring, unit 25.4 mm, r 10 to 40 mm, z 0 to 30 mm\n" in shown
    page = report(run(case), full=True).replace("\xa0", " ")
    assert '<th scope="row">seat, file</th><td>seat.dxf, layer ring, unit 25.4 mm</td>' in page
    assert '<th scope="row">seat, extent</th><td>r 10 to 40 mm, z 0 to 30 mm</td>' in page


def test_tolerance_of_a_mesh_is_refused(tmp_path) -> None:
    seat = {"shape": "profile", "file": str(tmp_path / "seat.msh"), "tolerance": "10 nm", "material": STEEL}
    with pytest.raises(InputError, match=r"seat.tolerance = 10 nm: a .msh has no curves"):
        Case(**{**tables("ball", "cone"), "seat": seat})
