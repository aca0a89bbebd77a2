"""The gmsh mesh: areas, names, grading, determinism, files, gmsh's global state."""

from __future__ import annotations

import builtins
import math
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from skfem import MeshTri

import meshes
from meshes import Ball, ConicalSeat, GeometryError, MeshingError, SealMesh, Sizing
from meshes.mesh.triangles import (
    Triangles,
    doubled_area,
    facets_between,
    section_area,
    smooth_triangles,
    triangle_shape,
)

SIZING = Sizing(20e-6, 0.3e-3, (-0.8e-3, 0.8e-3), 0.1, 0.25, 2.5e-3)
CLOSURE_NAMES = {"closure_contact", "closure_inner", "closure_outer", "closure_top", "closure_axis"}
SEAT_NAMES = {"seat_contact", "seat_inner", "seat_outer", "seat_wall", "seat_bottom"}


def make(angle: float = math.radians(45), radius: float = 0.02, sizing: Sizing = SIZING) -> SealMesh:
    return meshes.build(Ball(radius), ConicalSeat.around(angle, Ball(radius)), sizing)


# two builds are two
pytestmark = pytest.mark.usefixtures("made_anew")


@pytest.fixture(scope="module")
def seal_mesh() -> SealMesh:
    return make()


def test_names(seal_mesh: SealMesh) -> None:
    assert set(seal_mesh.mesh.subdomains) == {"closure", "seat"}
    assert set(seal_mesh.mesh.boundaries) == CLOSURE_NAMES | SEAT_NAMES
    assert set(seal_mesh.closure.boundaries) == CLOSURE_NAMES
    assert set(seal_mesh.seat.boundaries) == SEAT_NAMES


def test_boundaries_are_complete_and_disjoint(seal_mesh: SealMesh) -> None:
    named = np.concatenate(list(seal_mesh.mesh.boundaries.values()))
    assert len(np.unique(named)) == len(named)
    assert set(named) == set(seal_mesh.mesh.boundary_facets())


def test_boundary_nodes_lie_on_the_exact_curves(seal_mesh: SealMesh) -> None:
    mesh, contact = seal_mesh.mesh, seal_mesh.contact
    arcs = [n for n in CLOSURE_NAMES if n != "closure_axis"]
    for name in arcs:
        r, z = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries[name]])]
        # gmsh gets its points with eleven decimals; those of the contact line are given as they are
        digits = 1e-15 if name == "closure_contact" else 1e-11
        assert np.hypot(r, z - 0.02 * math.cos(contact.angle)) == pytest.approx(0.02, rel=digits)
    r, z = mesh.p[:, np.unique(mesh.facets[:, mesh.boundaries["seat_contact"]])]
    assert z == pytest.approx((r - contact.initial_contact_radius) * math.tan(contact.angle), abs=1e-15)


def test_contact_vertices_of_both_bodies_face_each_other(seal_mesh: SealMesh) -> None:
    contact = seal_mesh.contact
    lines = []
    for body in (seal_mesh.closure, seal_mesh.seat):
        (name,) = [n for n in body.boundaries if n.endswith("_contact")]
        lines.append(
            np.sort(contact.coordinate(*body.p[:, np.unique(body.facets[:, body.boundaries[name]])]))
        )
    assert lines[0] == pytest.approx(lines[1], abs=1e-12)
    assert lines[1] == pytest.approx(seal_mesh.sizing.contact_vertices(), abs=1e-12)


def test_area_error_falls_quadratically_with_the_size() -> None:
    errors = [
        make(sizing=Sizing(h / 4, 1e-4, (-5e-4, 5e-4), 0.2, 0.3, h)).quality.area_error
        for h in (2e-3, 1e-3, 5e-4)
    ]
    rates = np.diff(np.log(errors)) / np.log(0.5)
    assert rates == pytest.approx(2.0, abs=0.4)  # chords of a circle: the area error is of second order
    assert errors[-1] < 5e-4


def test_straight_seat_has_its_exact_area(seal_mesh: SealMesh) -> None:
    exact = next(o for o in seal_mesh.outlines if o.name == "seat").area
    assert section_area(seal_mesh.seat) == pytest.approx(exact, rel=1e-10)


@pytest.mark.parametrize("degrees", [5, 20, 45, 70, 85])
@pytest.mark.parametrize("radius", [1e-3, 0.5])
def test_quality_at_every_angle_and_size(degrees: float, radius: float) -> None:
    s = radius / 400
    mesh = make(math.radians(degrees), radius, Sizing(s / 4, 2 * s, (-6 * s, 6 * s), 0.1, 0.25, radius / 8))
    assert mesh.quality.smallest > 0.2
    assert mesh.quality.mean > 0.85


def test_the_mesh_scales_with_the_seal() -> None:
    def scaled(k: float) -> SealMesh:  # k a power of two: no rounding, so the very same mesh
        return make(
            radius=0.02 * k, sizing=Sizing(20e-6 * k, 3e-4 * k, (-8e-4 * k, 8e-4 * k), 0.1, 0.25, 2.5e-3 * k)
        )

    small, large = scaled(1.0), scaled(1024.0)
    assert np.array_equal(small.mesh.t, large.mesh.t)
    assert large.mesh.p == pytest.approx(1024 * small.mesh.p, rel=1e-9, abs=1e-12)


def test_two_builds_give_the_same_mesh(seal_mesh: SealMesh) -> None:
    again = make()
    assert np.array_equal(again.mesh.p, seal_mesh.mesh.p)
    assert np.array_equal(again.mesh.t, seal_mesh.mesh.t)


def test_meshing_works_in_a_thread_and_leaves_a_users_gmsh_alone(seal_mesh: SealMesh) -> None:
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.Algorithm", 1)
        gmsh.model.add("mine")
        gmsh.model.geo.addPoint(0, 0, 0)
        done: list[SealMesh] = []
        thread = threading.Thread(target=lambda: done.append(make()))
        thread.start()
        thread.join()
        assert np.array_equal(done[0].mesh.p, seal_mesh.mesh.p)
        assert gmsh.model.getCurrent() == "mine"
        assert gmsh.option.getNumber("Mesh.Algorithm") == 1
    finally:
        gmsh.finalize()


def test_msh_file_opens_in_gmsh_with_its_groups(seal_mesh: SealMesh, tmp_path: Path) -> None:
    import gmsh

    path = seal_mesh.write(tmp_path / "mesh.msh")
    assert [p.name for p in tmp_path.iterdir()] == ["mesh.msh"]
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        groups = {gmsh.model.getPhysicalName(d, t): (d, t) for d, t in gmsh.model.getPhysicalGroups()}
        assert set(groups) == {"closure", "seat"} | CLOSURE_NAMES | SEAT_NAMES
        tags, _ = gmsh.model.mesh.getNodesForPhysicalGroup(*groups["closure"])
        assert len(tags) == seal_mesh.closure.nvertices
    finally:
        gmsh.finalize()


def test_msh_file_survives_the_round_trip_through_scikit_fem(seal_mesh: SealMesh, tmp_path: Path) -> None:
    from skfem import MeshTri

    mesh = MeshTri.load(seal_mesh.write(tmp_path / "mesh.msh"), force_meshio_type="triangle")
    assert np.allclose(mesh.p, seal_mesh.mesh.p, rtol=1e-12)
    assert mesh.nelements == seal_mesh.mesh.nelements
    for written, made in (
        (mesh.boundaries, seal_mesh.mesh.boundaries),
        (mesh.subdomains, seal_mesh.mesh.subdomains),
    ):
        assert {name: len(found) for name, found in written.items()} == {
            name: len(found) for name, found in made.items()
        }


def test_ball_that_falls_through_or_sits_on_the_edge_is_refused() -> None:
    seat = ConicalSeat(math.radians(45), 0.016, 0.02, 0.05, 0.03)
    with pytest.raises(
        GeometryError, match=r"would touch first at r = 16 mm, where the face of the seat ends"
    ):
        meshes.build(Ball(0.02), seat, SIZING)


def test_zone_beyond_the_face_is_refused() -> None:
    seat = ConicalSeat(math.radians(45), 0.0138, 0.02, 0.05, 0.03)
    with pytest.raises(GeometryError, match="does not fit"):
        meshes.build(Ball(0.02), seat, SIZING)


def test_missing_system_library_names_the_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def broken(name: str, *args: Any, **kwargs: Any) -> Any:
        if name == "gmsh":
            raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", broken)
    with pytest.raises(MeshingError, match=r"libGLU\.so\.1.*apt-get install .*libglu1-mesa"):
        make()


def test_a_contact_line_of_too_many_elements_is_refused() -> None:
    with pytest.raises(MeshingError, match=r"would need \d+ elements, allowed are 1599"):
        make(sizing=Sizing(1e-7, 0.3e-3, (-0.8e-3, 0.8e-3), 0.1, 0.25, 2.5e-3))


def test_an_edge_that_gmsh_left_out_is_told(seal_mesh: SealMesh) -> None:
    body = seal_mesh.seat
    edges = body.facets.T[::-1, ::-1]  # in any order and direction
    np.testing.assert_array_equal(facets_between(body, {"all": edges})["all"], np.arange(body.nfacets)[::-1])
    across = np.array(
        [[0, int(np.setdiff1d(np.arange(body.nvertices), body.facets[:, (body.facets == 0).any(0)])[0])]]
    )
    with pytest.raises(MeshingError, match="gmsh merged neighbouring vertices"):
        facets_between(body, {"all": edges, "across": across})


def test_edges_are_numbered_as_scikit_fem_does(seal_mesh: SealMesh) -> None:
    for mesh in (seal_mesh.mesh, seal_mesh.closure, seal_mesh.seat):
        plain = MeshTri(mesh.p, mesh.t)
        np.testing.assert_array_equal(mesh.facets, plain.facets)
        np.testing.assert_array_equal(mesh.t2f, plain.t2f)


def test_a_body_cut_out_is_what_scikit_fem_cuts_out(seal_mesh: SealMesh) -> None:
    for name in ("closure", "seat"):
        body, plain = getattr(seal_mesh, name), seal_mesh.mesh.restrict(name)
        np.testing.assert_array_equal(body.p, plain.p)
        np.testing.assert_array_equal(body.t, plain.t)
        for boundary, facets in body.boundaries.items():
            np.testing.assert_array_equal(facets, plain.boundaries[boundary])


def test_smoothing_makes_triangles_better_and_turns_none() -> None:
    rng = np.random.default_rng(0)
    mesh = Triangles.init_tensor(np.linspace(0, 1, 12), np.linspace(0, 1, 12))
    inside = ~np.isin(np.arange(mesh.nvertices), mesh.facets[:, mesh.boundary_facets()])
    shaken = mesh.p + 0.04 * inside * rng.uniform(-1, 1, mesh.p.shape)
    rough = Triangles(shaken, mesh.t)
    p = smooth_triangles(rough).p
    np.testing.assert_array_equal(p[:, ~inside], shaken[:, ~inside])
    assert np.all(doubled_area(p, mesh.t) * doubled_area(shaken, mesh.t) > 0)
    before, after = triangle_shape(shaken, mesh.t), triangle_shape(p, mesh.t)
    assert after.min() >= min(before.min(), 0.6)
    assert after.mean() > before.mean() + 0.05


def test_smoothing_leaves_even_triangles_alone() -> None:
    mesh = Triangles.init_tensor(np.linspace(0, 2, 9), np.linspace(0, 1, 5))
    np.testing.assert_allclose(smooth_triangles(mesh).p, mesh.p, atol=1e-15)


def test_a_body_of_a_known_mesh_is_that_which_would_be_made(seal_mesh: SealMesh) -> None:
    ball = Ball(0.02)
    seat = ConicalSeat.around(math.radians(45), ball)
    wider = ConicalSeat.around(math.radians(45), ball, outer_radius=2 * seat.outer_radius)
    contact = meshes.ContactGeometry.of(ball.outline, wider.outline)
    anew, known = meshes.build_contact(contact, SIZING), meshes.build_contact(contact, SIZING, seal_mesh)
    np.testing.assert_array_equal(known.mesh.p, anew.mesh.p)
    np.testing.assert_array_equal(known.mesh.t, anew.mesh.t)
    finer = meshes.build_contact(contact, SIZING.refined(1.5), seal_mesh)
    assert finer.closure.nelements > 1.5 * known.closure.nelements
