"""Leak rates of maps of contact pressure: of any finite-element code, over a face of any shape."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np

from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.map_files import PressureMap
from fem_seal.answers.profile_leak import GivenPressures, leaking, refuse_far_too_weak, with_all_scenarios
from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.case.case import Case
from fem_seal.case.tables import MapPart
from fem_seal.errors import InputError, Problem
from fem_seal.files import problem as problem_of
from fem_seal.seal.leak_model import LeakModel
from fem_seal.seal.load_result import DiscretisationError, GivenContact, LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.surface_profile import MapFace, SurfaceLeak, SurfaceProfile
from fem_seal.validity.checks import profile_validity
from leak import ContactSurface, LeakError, RoughContact
from leak.flow.turned_contact import FaceContact

Load = TypeVar("Load", bound=LoadResult)

# Fewest nodes across a contact; share of the peak below which it does not count as pressed.
_FEWEST_NODES, _PRESSED = 6.0, 1e-3
# Pressures of neighbours that alternate: correlation of their distances from those around them, and share of the peak.
_ALTERNATES, _JUMPS = -0.5, 0.05
# By which the force of a map may miss that of the case.
_OFF = 0.2


def face_of(found: PressureMap, case: Case) -> MapFace:
    """The surface of a map and where the fluid stands.

    Parameters
    ----------
    found : PressureMap
    case : Case

    Raises
    ------
    InputError
        If the surface cannot be used, or does not tell where the fluid stands.
    """
    table, side = case.map, case.load.pressure_side
    named = {} if table is None else table.parts
    if named.keys() == {"wall"}:
        raise InputError(problem_of("map_one_side"), file=case.file)
    try:
        surface = ContactSurface(found.points, found.triangles)
        masks = {name: _part(found, name, part, case) for name, part in named.items()}
        wall = masks.pop("wall", np.zeros(len(found.points), dtype=bool))
        edges = {
            name: np.setdiff1d(surface.open_edges(side), surface.open_edges(wall))
            for name, side in masks.items()
        }
        for name in {"high", "low"} - edges.keys() if edges else ():
            (given,) = masks.values()
            # between a point of the given side and one of the wall there is wall
            edges[name] = np.setdiff1d(
                np.flatnonzero(surface.edges.on_boundary), surface.open_edges(given | wall)
            )
        sides = {name: surface.edges.ends[ends].ravel() for name, ends in edges.items()}
        return MapFace(surface, *surface.sides(**sides, pressure_side=side), side == "outer")
    except LeakError as error:
        raise InputError(problem_of("map_edge", why=str(error)), file=case.file) from None


def with_lay(face: MapFace, surface: FaceContact | None, case: Case) -> MapFace:
    """A face with the direction of the lay: that of the case, or around the axis of a face that closes around one.

    Parameters
    ----------
    face : MapFace
    surface : RoughContact or TurnedContact or None
    case : Case

    Raises
    ------
    InputError
        If the case gives the direction of a lay that its roughness has not.
    """
    given, loop = None if case.map is None else case.map.lay, face.surface.points[face.surface.loops[0]]
    if given is not None:
        if surface is not None and surface.other_way is surface:
            raise InputError(problem_of("map_without_lay"), file=case.file)
        lay = np.broadcast_to(np.array(given), face.surface.normals.shape)
        # where the number of the roughness is that of flow along its lay, it conducts otherwise across it
        is_along = isinstance(surface, RoughContact) and surface.peklenik > 1.0
        return replace(face, lay=np.cross(face.surface.normals, lay) if is_along else lay)
    if not all(_closed_areas(face)):
        return face
    ends = np.stack([loop, np.roll(loop, -1, axis=0)])
    centre = np.average(ends.mean(axis=0), axis=0, weights=np.linalg.norm(ends[1] - ends[0], axis=1))
    from_axis = face.surface.points[face.surface.triangles].mean(axis=1) - centre
    return replace(face, lay=np.cross(_vector_area(loop), from_axis))


def _part(found: PressureMap, name: str, part: str | MapPart, case: Case) -> BoolArray:
    """Nodes of a part."""
    if isinstance(part, MapPart) and part.box is not None:
        low, high = np.reshape(part.box, (3, 2)).T
        return np.asarray(((found.points >= low) & (found.points <= high)).all(axis=1))
    key = part if isinstance(part, str) else f"{part.field} = {part.value:g}"
    if key not in found.parts:
        raise InputError(problem_of("map_no_part", name=name, names=", ".join(found.parts)), file=case.file)
    return found.parts[key]


def leak_of_map(
    problem: SealProblem, found: PressureMap, face: MapFace
) -> tuple[list[CaseLoad], list[Problem]]:
    """Leak rates of a map with the surface and the fluid of a problem: every fluid pressure for every step.

    Parameters
    ----------
    problem : SealProblem
    found : PressureMap
    face : MapFace

    Returns
    -------
    loads : list of CaseLoad
    remarks : list of Problem
        Why steps have none, and what the leak rates do not know.

    Raises
    ------
    InputError
        If the problem has no roughness or no fluid, or asks for what is not known of maps, or no step has a leak rate.
    """
    surface, flow = leaking(problem)
    if flow.fluid_in_gap == "local":
        raise InputError(problem_of("map_local"), file=problem.file)
    peaks = found.pressure.max(axis=1)
    every = list(dict.fromkeys(problem.loads.fluid_pressure))
    pressures = [every if own is None else [own] for own in found.fluid_pressures]
    refuse_far_too_weak(problem, peaks.tolist(), pressures)
    rough = LeakModel(surface, flow, GivenPressures(others=tuple(peaks[peaks > 0.0].tolist())))
    ways, loads, remarks = rough.ways_over(face), list[LoadResult](), list[Problem]()
    if surface.other_way is not surface and len(ways) == 1:
        remarks.append(problem_of("map_isotropic", simulated=rough.is_direct))
    for number, step in enumerate(found.steps):
        field, opening = found.pressure[number], None if found.gap is None else found.gap[number]
        bare = SurfaceProfile.of(face, field, opening)
        try:
            # on the given triangles and as of a liquid, for the places that let most through
            liquids = [flow.permeant(table.liquid, pressures[number][0]) for table, _ in ways]
            profile = SurfaceProfile.of(face, field, opening, bare.flux(*liquids))
            leaks = [rough.leak(profile, pressure) for pressure in pressures[number]]
        except LeakError as error:
            remarks.append(problem_of("map_step", step=step, why=str(error)))
            continue
        for pressure, found_leak in zip(pressures[number], leaks, strict=True):
            load = LoadResult(pressure, 0.0, GivenContact(profile, step), rough)  # type: ignore[arg-type]
            loads.append(_standing(load.with_values(leak=found_leak), None))
    if not loads:
        raise InputError(*remarks, file=problem.file)
    solved = map(_with_scenarios, with_all_scenarios(problem, loads))
    return [load.with_values(validity=profile_validity(problem, load)) for load in solved], remarks


def _standing(load: Load, sealed: float | None) -> Load:
    """A load whose profile stands for the surface in all that follows, with this share where nothing flows."""
    leak, rough, profile = load.leak, load.rough, load.whole_profile
    assert (
        isinstance(profile, SurfaceProfile) and rough is not None and isinstance(load.contact, GivenContact)
    )
    if not isinstance(leak, SurfaceLeak):
        return load
    across = rough.leak(profile.with_share(1.0), load.fluid_pressure)
    rates = leak.leak_rate, 0.0 if across is None else across.leak_rate
    share = rates[0] / rates[1] if min(rates) > 0.0 else sealed
    return load.with_values(
        contact=GivenContact(profile.with_share(share), load.contact.step),
        mesh_error=DiscretisationError(0.0, 0.0, 0.0, leak.over.error),
    )


def _with_scenarios(load: CaseLoad) -> CaseLoad:
    """A load and its scenarios, whose flow over the surface was calculated where the load itself has none."""
    others = {name: _with_scenarios(other) for name, other in load.scenarios.items()}
    return _standing(load, 1.0).with_values(scenarios=others)


# --- what is said against a map -------------------------------------------------------------------------------


def remarks_of_map(found: PressureMap, face: MapFace, case: Case) -> Iterator[Problem]:
    """What makes the pressures of a map doubtful, each for the first step of which it is true.

    Parameters
    ----------
    found : PressureMap
    face : MapFace
    case : Case
    """
    checks = (_few_nodes, _oscillates, partial(_force, case=case))
    steps = [pair for pair in zip(found.pressure, found.steps, strict=True) if pair[0].max() > 0.0]
    for check in checks:
        said = (check(face, *step) for step in steps)
        yield from [each for each in said if each is not None][:1]


def _few_nodes(face: MapFace, pressure: FloatArray, step: str) -> Problem | None:
    """A mesh too coarse across the contact."""
    i, j = _edges_across(face).T
    pressed = np.minimum(pressure[i], pressure[j]) > _PRESSED * pressure.max()
    areas, is_pressed = face.at_points(face.surface.areas), pressure > _PRESSED * pressure.max()
    row = float(np.median(np.abs(face.across[i] - face.across[j])[pressed])) if pressed.any() else 1.0
    # of a row at the edge half of the area is beyond it
    nodes = areas[is_pressed].sum() / areas.sum() / row + bool(is_pressed[face.high | face.low].any())
    return problem_of("map_few_nodes", step=step, nodes=nodes) if nodes < _FEWEST_NODES else None


def _edges_across(face: MapFace) -> IntArray:
    """Ends of the edges that lead from side to side rather than along."""
    ends = face.surface.edges.ends
    rise = np.abs(face.across[ends[:, 0]] - face.across[ends[:, 1]])
    return np.asarray(ends[face.width * rise > 0.7 * face.surface.lengths])


def _oscillates(face: MapFace, pressure: FloatArray, step: str) -> Problem | None:
    """Pressures that alternate from node to node, along the sides or across."""
    n, ends = len(pressure), face.surface.edges.ends
    i, j = ends.T
    beside, count = (
        np.bincount(i, values[j], n) + np.bincount(j, values[i], n) for values in (pressure, np.ones(n))
    )
    off = pressure - beside / np.maximum(count, 1)
    size = float(np.sqrt(np.mean(off[pressure > _PRESSED * pressure.max()] ** 2)) / pressure.max())
    for a, b in (_edges_across(face).T, ends.T):
        square = 0.5 * float((off[a] ** 2 + off[b] ** 2).sum())
        if size > _JUMPS and float(off[a] @ off[b]) < _ALTERNATES * square:
            return problem_of("map_oscillates", step=step, share=2.0 * size)
    return None


def _force(face: MapFace, pressure: FloatArray, step: str, *, case: Case) -> Problem | None:
    """A face that does not carry the force of the case along its axis."""
    surface, load = face.surface, case.load
    if "applied_force" not in load.model_fields_set:
        return None
    axis = _vector_area(surface.points[surface.loops[0]])
    carried = float(pressure[surface.triangles].mean(axis=1) @ np.abs(surface.normals @ axis))
    carried /= float(np.linalg.norm(axis))
    high, low = _closed_areas(face)
    # what presses from the outside closes; of sides that are no closed lines only the size of the face is known
    size = float(np.ptp(surface.points[np.unique(surface.triangles)], axis=0).max()) ** 2
    areas = (
        np.array([high, low] if high > low else [-high, -low]) if high and low else np.array([-size, size])
    )
    ends = [force + p * area for p, force in load.points for area in areas.tolist()]
    least, most = min(ends), max(ends)
    if (1.0 - _OFF) * least <= carried <= (1.0 + _OFF) * most:
        return None
    return problem_of("map_force", step=step, carried=carried, low=least, high=most)


def _closed_areas(face: MapFace) -> tuple[float, float]:
    """Inside the closed lines of the high and of the low side, zero of a side that has none [m^2]."""
    areas = [
        (loop, float(np.linalg.norm(_vector_area(face.surface.points[loop])))) for loop in face.surface.loops
    ]
    high, low = (sum(area for loop, area in areas if side[loop].all()) for side in (face.high, face.low))
    return high, low


def _vector_area(loop: FloatArray) -> FloatArray:
    """Of a closed line [m^2]."""
    return np.asarray(0.5 * np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0))
