"""Contact pressure profiles in files of any finite-element program, and where their points lie on the seat."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.arrays import BoolArray, FloatArray, IntArray
from fem_seal.errors import InputError, QuantityError, TextTableError
from fem_seal.files import column, drop_extremes, name_and_unit, problem, read_any_text
from fem_seal.units import parse_quantity
from fem_seal.wording import Quantity
from leak.errors import TableError
from meshes import ContactGeometry

if TYPE_CHECKING:
    from leak.text_tables import TextTable

# A profile with fewer points has no shape to integrate over.
_FEWEST_ROWS = 5
_HIGHEST_PRESSURE = 1e12
# Less than this is no contact [Pa], and less than this share of the contact circle no width.
_LOWEST_PRESSURE, _NARROWEST = 1e-3, 1e-4
# Where the contact pressure is above this share of its peak, the faces are pressed on each other.
_PRESSED_SHARE = 1e-3

# What the word of a column's name says, the first that fits.
_ROLES = {
    "fluid_pressure": r"fluid_pressure",
    "bulk_strain_meridional": r"bulk_strain_meridional",
    "bulk_strain_hoop": r"bulk_strain_hoop",
    "elastic_area_strain": r"elastic_area_strain",
    "gap": r"gap|copen|cshear|largest|.*(separation|stress|strain|force)",
    "pressure": r"(contact_?)?pressure(\b|_)|cpress|cont_?pres|lags_c|pres(\b|_)|p(?![a-z:.])",
    "angle": r"(theta|phi|angle|azimuth)(\b|_|$)",
    "arc": r"(s|arc_?length|arc|distance|true_distance.*|path.*|length|position)$",
    "radius": r"(r|radius|radial_.*|r_coord.*)$",
    "x": r"(x|x_?(coord|loc).*|(coord\.?)?coor1|coord_?1|points?[:_]0|coordinates?[:_]0)$",
    "y": r"(y|y_?(coord|loc).*|(coord\.?)?coor2|coord_?2|points?[:_]1|coordinates?[:_]1)$",
    "z": r"(z|z_?(coord|loc).*|(coord\.?)?coor3|coord_?3|points?[:_]2|coordinates?[:_]2)$",
    "step": r"(load_?)?(step|case)|frame|increment|substep|time(\b|_|$)|part_instance|set$",
}
_LENGTHS = ("arc", "radius", "x", "y", "z")
_STRAINS = ("bulk_strain_meridional", "bulk_strain_hoop")
_ELASTIC = "elastic_area_strain"
# Of which each load step may have its own.
_OF_STEPS = ("pressure", "step", *_STRAINS, _ELASTIC)
# Programs that know no units call the contact pressure so; a peak above this is one in Pa, not in MPa.
_WITHOUT_UNITS, _IN_PASCAL = re.compile(r"cpress|cont_?pres|pres(\b|_)"), 1e5
_POINTS = re.compile(r"points?[:_]0")
_LENGTH_UNIT = re.compile(r"length unit\W+(\w+)", re.IGNORECASE)
_LOAD = re.compile(r"(\d+(?:[.,]\d+)?)\s*_?(bar|kpa|mpa|psi|pa)(?![a-z])", re.IGNORECASE)
# Distances between points and the seat's face, and of radii from those of the case, that are none.
_ON_FACE, _SAME_RADIUS, _TOLERANCE = 0.1, 0.02, 0.05
# Scatter of pressures at one point over the peak; distance from a curve over the length, of points along one.
_SAME_PRESSURE, _ON_CURVE = 0.2, 0.05


@dataclass(frozen=True)
class ImportedProfile:
    """A contact pressure profile across a seal, from a file.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Arc length across the contact [m], increasing towards larger radius.
    pressure : ndarray, shape (n,)
        Contact pressure [Pa], not negative.
    radius : ndarray, shape (n,), or None
        Distance from the axis [m]; None if the file has no such column.
    fluid_pressure : float or None
        Fluid pressure that belongs to the profile [Pa]; None if the file does not say.
    remark : str, optional
        What the columns were taken for, a sentence.
    strain : ndarray, shape (n, 3), or None, optional
        Of the metal under the faces, along them and around the axis [-]; None if the file has no such columns.
    """

    x: FloatArray
    pressure: FloatArray
    radius: FloatArray | None
    fluid_pressure: float | None
    remark: str = ""
    strain: FloatArray | None = None


def read_profiles(
    file: str | Path, contact: ContactGeometry | None, axis: str | None = None
) -> tuple[ImportedProfile, ...]:
    """Contact pressure profiles of a text file, on the seat of a case.

    Parameters
    ----------
    file : path
        Tables with a header, see `leak.text_tables.read_tables`, with a column of contact pressure ("CPRESS [MPa]") and
        the places of the points: arc length, radius, or the coordinates of points along one meridian, in any order.
        Several load steps stand beside each other, each with its column of pressure; below each other, with a column
        that tells them apart, of the fluid pressure or the step; or in tables of their own.
    contact : ContactGeometry or None
        On whose seat the points lie. An arc length is zero at first touch, or where its path begins. None: without
        shapes, where the file tells arc length and radius.
    axis : {"x", "y", "z"}, optional
        Without shapes: the coordinate along the axis of the seal; of two columns the second one unless given.

    Returns
    -------
    tuple of ImportedProfile

    Raises
    ------
    InputError
        If the file is no such table, or contradicts the case; the message says what was understood.
    """
    from leak.text_tables import read_tables

    try:
        steps = [step for table in read_tables(read_any_text(file)) for step in _steps(table)]
        in_contact = [step for step in steps if step.pressure.max() > _LOWEST_PRESSURE]
        if not in_contact:
            raise TextTableError(problem("profile_no_contact"))
        count = len(steps) - len(in_contact)
        remark = f"; {count} load step{'s' * (count > 1)} without contact pressure left out" if count else ""
        return tuple(_place(replace(step, remark=step.remark + remark), contact, axis) for step in in_contact)
    except (TableError, TextTableError, QuantityError) as error:
        raise InputError.at("", str(error), file=file) from None


@dataclass(frozen=True)
class _Step:
    """Points of one load step as the file has them, in SI."""

    places: dict[str, tuple[str, FloatArray]]
    pressure: FloatArray
    pressure_name: str
    fluid_pressure: float | None
    remark: str
    strain: FloatArray | None

    def rows(self, selection: IntArray | BoolArray) -> _Step:
        places = {role: (name, values[selection]) for role, (name, values) in self.places.items()}
        strain = None if self.strain is None else self.strain[selection]
        return replace(self, places=places, pressure=self.pressure[selection], strain=strain)


# --- columns ------------------------------------------------------------------------------------------------


def _steps(table: TextTable) -> Iterator[_Step]:
    """The load steps of a table."""
    roles = column_roles(table)
    check_rows(table, roles)
    header = table.header
    table = drop_extremes(_with_units(table, roles))
    units = [name_and_unit(name)[1] for name, old in zip(table.header, header, strict=True) if name != old]
    is_assumed = table.header[roles["pressure"][0]] != header[roles["pressure"][0]]
    remark = f"; the file states no units, read in {' and '.join(dict.fromkeys(units))}" if is_assumed else ""
    _check_angles(table, roles)
    places = {
        role: (header[roles[role][0]], column(table, roles[role][0], "length"))
        for role in _LENGTHS
        if role in roles
    }
    loads = fluid_pressures(table, roles)
    strains = _strains(table, roles)
    for place, strain in zip(roles["pressure"], strains, strict=True):
        pressure = column(table, place, "pressure")
        _check_pressure(table, pressure)
        for rows in _groups(table, roles, loads, next(iter(places.values()))[1]):
            load = load_in(table.header[place]) if loads is None else float(loads[rows[0]])
            yield _Step(places, pressure, header[place], load, remark, strain).rows(rows)


def check_rows(table: TextTable, roles: dict[str, list[int]]) -> None:
    """TextTableError if a line under a table is no row of it, or a row lacks a number that is read."""
    if table.stray is not None:
        number, line = table.stray
        raise TextTableError(problem("profile_row", number=number, line=line[:40], first=table.lines[0]))
    numbers = [
        place
        for role in (*_LENGTHS, "pressure", "fluid_pressure", *_STRAINS, _ELASTIC)
        for place in roles.get(role, ())
    ]
    bad_rows = np.flatnonzero(~np.isfinite(table.values[:, numbers]).all(axis=1))
    if bad_rows.size:
        line, row = table.lines[bad_rows[0]], table.rows[bad_rows[0]]
        raise TextTableError(f'line {line} ("{row[:40]}"): must hold {len(numbers)} finite numbers')


def fluid_pressures(table: TextTable, roles: dict[str, list[int]]) -> FloatArray | None:
    """The column of fluid pressures [Pa], if there is one."""
    if "fluid_pressure" not in roles:
        return None
    loads = column(table, roles["fluid_pressure"][0], "pressure")
    if not (loads > 0).all():
        lowest = Quantity(float(loads.min()), "given fluid pressure")
        raise TextTableError(f"fluid pressure must be positive, it holds {lowest}")
    return loads


def _strains(table: TextTable, roles: dict[str, list[int]]) -> Sequence[FloatArray | None]:
    """Strains that belong to each column of contact pressures."""
    names = (*_STRAINS, _ELASTIC) if _ELASTIC in roles else _STRAINS
    steps, counts = len(roles["pressure"]), [len(roles.get(name, ())) for name in names]
    if not any(counts):
        return [None] * steps
    if counts != [steps] * len(names):
        fewer = names[int(np.argmin(counts))]
        raise TextTableError(problem("profile_strains", column=fewer, count=min(counts), steps=steps))
    columns = ([column(table, place, "strain") for place in roles[name]] for name in names)
    strains = [np.stack(parts, axis=1) for parts in zip(*columns, strict=True)]
    for number, strain in enumerate(strains):
        if not (is_inside := np.abs(strain) < 1.0).all():
            row, part = np.argwhere(~is_inside)[0].tolist()
            words = {"line": table.lines[row], "column": table.header[roles[names[part]][number]]}
            raise TextTableError(problem("profile_strain", strain=float(strain[row, part]), **words))
    # nothing is known of the elastic part, whose sign makes asperities softer or harder
    return [np.pad(strain, ((0, 0), (0, 3 - len(names)))) for strain in strains]


def column_roles(table: TextTable) -> dict[str, list[int]]:
    """Places of the columns whose names are known, by what they hold; several of contact pressures only."""
    example = 'such as "x [mm], contact_pressure [MPa]"'
    if not table.header:
        columns = table.values.shape[1]
        context = f" (the line above them is {table.lines_above[-1][1][:60]!r})" if table.lines_above else ""
        raise TextTableError(problem("profile_header", columns=columns, context=context, example=example))
    words = [name_and_unit(name)[0] for name in table.header]
    roles: dict[str, list[int]] = {}
    for place, word in enumerate(words):
        role = role_of(word)
        if role is not None and (role in _OF_STEPS or role not in roles):
            roles.setdefault(role, []).append(place)
    numeric = np.flatnonzero(~np.isnan(table.values).all(axis=0)).tolist()
    if len(numeric) == 2 == len(table.header) and not ("pressure" in roles and roles.keys() & {*_LENGTHS}):
        return {"arc": [0], "pressure": [1]}
    # of a profile that was written without them
    for name in _STRAINS:
        roles[name] = [place for place in roles.get(name, ()) if place in numeric]
    names = ", ".join(table.header)
    if "pressure" not in roles:
        raise TextTableError(f"has no column contact_pressure; its columns are {names}")
    if not roles.keys() & {*_LENGTHS}:
        raise TextTableError(f"has no column x (arc length) or r (radius); its columns are {names}")
    # where the program's own name stands, other pressures are others
    named = [place for place in roles["pressure"] if is_of_program(words[place])]
    return roles | {"pressure": named or roles["pressure"]}


def role_of(word: str) -> str | None:
    """What a column or a field holds, one of `_ROLES`, by the word of its name; see `fem_seal.files.name_and_unit`."""
    return next((role for role, pattern in _ROLES.items() if re.match(pattern, word)), None)


def is_of_program(word: str) -> bool:
    """Whether a finite-element program calls its contact pressure so."""
    return _WITHOUT_UNITS.match(word) is not None


def _with_units(table: TextTable, roles: dict[str, list[int]]) -> TextTable:
    """The table with units of columns that have none where their program says or cannot say them."""
    header = list(table.header)
    lengths = [place for role in _LENGTHS for place in roles.get(role, ())]
    unit = next((match[1] for _, line in table.lines_above if (match := _LENGTH_UNIT.search(line))), None)
    pressures = roles["pressure"]
    bare = [place for place in (*lengths, *pressures) if not name_and_unit(header[place])[1]]
    words = [name_and_unit(name)[0] for name in header]
    unknown = any(map(_POINTS.match, words)) or all(is_of_program(words[place]) for place in pressures)
    consistent = unknown and len(bare) == len(lengths) + len(pressures)
    if consistent:
        in_pascal = float(np.nanmax(np.abs(table.values[:, pressures]))) > _IN_PASCAL
        unit = unit or ("m" if in_pascal else "mm")
        for place in pressures:
            header[place] += " [Pa]" if in_pascal else " [MPa]"
    for place in lengths:
        if place in bare and unit is not None:
            header[place] += f" [{unit}]"
    return replace(table, header=tuple(header))


def _check_angles(table: TextTable, roles: dict[str, list[int]]) -> None:
    for place in roles.get("angle", ()):
        if np.ptp(table.values[:, place]) > 0.0:
            raise TextTableError(f'column "{table.header[place]}": {_MAP}')


_MAP = (
    "the points lie over a surface, not along one meridian; give those of one meridian, or read them as a map"
)


def _check_pressure(table: TextTable, pressure: FloatArray) -> None:
    is_inside = (pressure >= 0) & (pressure <= _HIGHEST_PRESSURE)
    if not is_inside.all():
        row = int(np.argmin(is_inside))
        raise TextTableError(
            problem("profile_pressure", line=table.lines[row], pressure=float(pressure[row]))
        )


def load_in(name: str) -> float | None:
    """Fluid pressure in the name of a column, "p at 20 bar [MPa]" [Pa]."""
    match = _LOAD.search(re.sub(r"[\[(][^\])]*[\])]\s*$", "", name))
    spelling = {"kpa": "kPa", "mpa": "MPa", "pa": "Pa"}
    unit = spelling.get(match[2].lower(), match[2].lower()) if match else ""
    return parse_quantity(f"{match[1].replace(',', '.')} {unit}", "pressure") if match else None


def _groups(
    table: TextTable, roles: dict[str, list[int]], loads: FloatArray | None, x: FloatArray
) -> list[IntArray]:
    """Rows of each load step, in their order."""
    groups = [part for rows in labelled_rows(table, roles, loads).values() for part in _begun_anew(x, rows)]
    return sorted(groups, key=lambda rows: int(rows[0]))


def labelled_rows(
    table: TextTable, roles: dict[str, list[int]], loads: FloatArray | None
) -> dict[tuple[str, ...], IntArray]:
    """Rows of a table by what its columns say of their load step, which is nothing where there are none."""
    keys = [table.texts(place) for place in roles.get("step", ())]
    if loads is not None:
        keys.append([f"{load!r}" for load in loads.tolist()])
    labels = list(zip(*keys, strict=True)) if keys else [()] * len(table.rows)
    rows: dict[tuple[str, ...], list[int]] = {}
    for number, label in enumerate(labels):
        rows.setdefault(label, []).append(number)
    return {label: np.array(numbers) for label, numbers in rows.items()}


def _begun_anew(x: FloatArray, rows: IntArray) -> list[IntArray]:
    """Rows of each step where one begins again at the first x; all of them where they are in no order."""
    blocks = np.split(rows, np.flatnonzero(x[rows] <= x[rows[0]])[1:])
    in_order = all(len(block) >= _FEWEST_ROWS and (np.diff(x[block]) > 0).all() for block in blocks)
    return blocks if in_order else [rows]


# --- places -------------------------------------------------------------------------------------------------


def _place(step: _Step, contact: ContactGeometry | None, axis: str | None) -> ImportedProfile:
    """A load step on the seat, its points in order."""
    if len(step.pressure) < _FEWEST_ROWS:
        raise TextTableError(f"a profile needs at least {_FEWEST_ROWS} rows, it has {len(step.pressure)}")
    x, radius, remark = _by_themselves(step, axis) if contact is None else _locate(step, contact)
    remark += step.remark
    columns = [each for each in (step.pressure, radius, step.strain) if each is not None]
    finite = np.isfinite(x)
    x, values = _merge_places(x[finite], np.column_stack(columns)[finite])
    pressure = values[:, 0]
    radius = None if radius is None else values[:, 1]
    strain = None if step.strain is None else values[:, -3:]
    if len(x) < _FEWEST_ROWS:
        raise TextTableError(f"a profile needs at least {_FEWEST_ROWS} rows, it has {len(x)}")
    pressed_x = x[pressure > _PRESSED_SHARE * pressure.max()]
    low, high = float(pressed_x[0]), float(pressed_x[-1])
    touch = float(radius.mean()) if contact is None else contact.initial_contact_radius  # type: ignore[union-attr]
    length = np.inf if contact is None else contact.seat_face.length
    if high - low > 1.05 * length or x[-1] - x[0] < _NARROWEST * touch:
        end = max(low, high, key=abs) if high - low > length else x[-1] - x[0]
        verb = "reaches" if high - low > length else "goes over"
        raise TextTableError(
            problem("profile_reach", verb=verb, end=_mm(end), touch=_mm(touch), remark=remark)
        )
    ends = None if contact is None else contact.reach
    if ends and (low < ends[0] - _TOLERANCE * length or high > ends[1] + _TOLERANCE * length):
        words = dict(
            zip(("low", "high", "start", "end", "touch"), map(_mm, (low, high, *ends, touch)), strict=True)
        )
        raise TextTableError(problem("profile_beside_faces", **words, remark=remark))
    return ImportedProfile(x, pressure, radius, step.fluid_pressure, remark, strain)


def _by_themselves(step: _Step, axis: str | None) -> tuple[FloatArray, FloatArray, str]:
    """x, zero at the centre of pressure, and r of points that tell both, and what the columns were taken for."""
    places = step.places
    named = [role for role in ("x", "y", "z") if role in places]
    height = axis or ("" if len(named) == 3 or not named else named[-1])
    radius, arc = places.get("radius"), next((places[role] for role in ("arc", "x") if role in places), None)
    if radius is None and len(named) > 1:
        if height not in named:
            raise TextTableError(problem("profile_axis", names=", ".join(places[role][0] for role in named)))
        sides = [places[role] for role in named if role != height]
        x, y = (sides[0][1], sides[1][1] if sides[1:] else np.zeros(1))
        if np.ptp(np.unwrap(np.arctan2(y, x))) > _TOLERANCE:
            raise TextTableError(_MAP)
        radius, arc = (" and ".join(name for name, _ in sides), np.hypot(x, y)), None
    if radius is None or (arc is None and height not in places):
        given = " and ".join(f'"{name}"' for name, _ in places.values())
        raise TextTableError(problem("profile_needs_shape", given=given))
    (name, r), (line, x) = radius, arc or places[height]
    if not (r > 0).all():
        raise TextTableError(f'radius must be positive; {_mm(float(r.min()))} in column "{name}" is not')
    if arc is None:
        x = _way_along(r, x)
    x = x if np.polyfit(x, r, 1)[0] >= 0.0 else -x
    words = "lies along the axis" if arc is None else "is their arc length"
    tail = f'"{line}" {words}, "{step.pressure_name}" is their contact pressure'
    return x - _centre(x, step.pressure), r, f'"{name}" gives the radius of the points, {tail}'


def _way_along(r: FloatArray, z: FloatArray) -> FloatArray:
    """Arc length of points on one curve, in any order."""
    if not on_one_curve(r, z):
        raise TextTableError(_MAP)
    points = np.stack([r - r.mean(), z - z.mean()])
    order = np.argsort(np.linalg.svd(points, full_matrices=False)[0][:, 0] @ points, kind="stable")
    x = np.zeros(len(r))
    x[order[1:]] = np.cumsum(np.hypot(np.diff(r[order]), np.diff(z[order])))
    return x


def _locate(step: _Step, contact: ContactGeometry) -> tuple[FloatArray, FloatArray | None, str]:
    """x and r of the points, NaN of x beside the face, and what the columns were taken for."""
    places, tail = step.places, f'"{step.pressure_name}" is their contact pressure'
    if "radius" in places:
        name, r = places["radius"]
        arc = next((places[role] for role in ("arc", "x") if role in places), None)
        if not (r > 0).all():
            raise TextTableError(f'radius must be positive; {_mm(float(r.min()))} in column "{name}" is not')
        if arc is not None:
            remark = f'"{arc[0]}" is the arc length of the points, "{name}" their radius, {tail}'
            return _arc_with_radius(arc[1], r, step.pressure, contact, remark), r, remark
        remark = f'"{name}" is the radius of points on the {contact.seat.label}, {tail}'
        return _on_seat(r, step.pressure, contact, remark), None, remark
    points = [places[role] for role in ("x", "y", "z") if role in places]
    if len(points) > 1:
        return _of_points(points, step, contact, tail)
    name, x = places["arc"] if "arc" in places else points[0]
    remark = f'"{name}" is the arc length of the points, {tail}'
    x, remark = _from_touch(x, step.pressure, remark)
    return x, None, remark


def _arc_with_radius(
    x: FloatArray, r: FloatArray, pressure: FloatArray, contact: ContactGeometry, remark: str
) -> FloatArray:
    """x on the seat, from an arc length and the radius that belongs to it."""
    mask = pressure > _PRESSED_SHARE * pressure.max()
    if np.ptp(r[mask]) > 0.0 and _x_of_radius(contact, r[:1]) is not None:
        by_radius = _on_seat(r, pressure, contact, remark)
        offset = (by_radius - x)[mask]
        width = float(np.ptp(x[mask]))
        if np.ptp(offset) > _TOLERANCE * width + _NARROWEST * contact.initial_contact_radius:
            words = {"seat": contact.seat.label, "by_radius": _mm(float(np.ptp(by_radius[mask])))}
            raise TextTableError(problem("profile_radius_and_arc", **words, width=_mm(width), remark=remark))
        return x if _touches_at_zero(x, pressure) else x + float(np.median(offset))
    x, _ = _from_touch(x, pressure, remark)
    radii = contact.radius(x[mask])
    # one radius for all points will do
    if abs(r[mask].mean() / radii.mean() - 1.0) > _SAME_RADIUS:
        words = {"radius": _from_to(r[mask]), "seat": contact.seat.label, "face": _from_to(radii)}
        raise TextTableError(problem("profile_radius", **words, remark=remark))
    return x


def _of_points(
    points: Sequence[tuple[str, FloatArray]], step: _Step, contact: ContactGeometry, tail: str
) -> tuple[FloatArray, None, str]:
    """From the coordinates of points along a meridian, whichever way its axis lies."""
    largest = max(float(np.ptp(values)) for _, values in points)
    coords = [point for point in points if np.ptp(point[1]) > 1e-6 * largest]
    names = " and ".join(f'"{name}"' for name, _ in points)
    if len(coords) < 2:
        name, x = (coords or points)[0]
        if "arc" in step.places or x.min() < 0.0 or not _fits(x, contact):
            arc_name, x = step.places.get("arc", (name, x))
            x, remark = _from_touch(x, step.pressure, f'"{arc_name}" is the arc length of the points, {tail}')
            return x, None, remark
        remark = f'"{name}" is the radius of points on the {contact.seat.label}, {tail}'
        return _on_seat(x, step.pressure, contact, remark), None, remark
    mask = step.pressure > _PRESSED_SHARE * step.pressure.max()
    if len(coords) == 2 and not on_one_curve(coords[0][1][mask], coords[1][1][mask]):
        raise TextTableError(f"{names}: {_MAP}")
    best, over_a_surface = None, False
    for axis, r, turn in _meridians([values for _, values in coords]):
        distance = _distance(r[mask], coords[axis][1][mask], step.pressure[mask], contact)
        if distance < _ON_FACE:
            over_a_surface |= turn > _TOLERANCE
            if turn <= _TOLERANCE and (best is None or distance < best[0]):
                best = distance, axis, r
    if best is None:
        spans = ", ".join(f"{name} from {_from_to(v)}" for name, v in points)
        face = contact.seat_face.point(np.array([0.0, contact.seat_face.length]))[0]
        if over_a_surface:
            raise TextTableError(f"{names}: {_MAP}")
        words = {"seat": contact.seat.label, "face": _from_to(face)}
        raise TextTableError(problem("profile_off_face", names=names, spans=spans, **words))
    _, axis, r = best
    others = " and ".join(f'"{name}"' for n, (name, _) in enumerate(coords) if n != axis)
    gives = "give" if len(coords) > 2 else "gives"
    remark = (
        f"{others} {gives} the radius of points on the {contact.seat.label}, "
        f'"{coords[axis][0]}" lies along the axis, {tail}'
    )
    return _on_seat(r, step.pressure, contact, remark), None, remark


def _meridians(coords: Sequence[FloatArray]) -> Iterator[tuple[int, FloatArray, float]]:
    """Each coordinate as the one along the axis: its number, the radius, and the turn around the axis [rad]."""
    for axis in reversed(range(len(coords))):
        others = [coord for n, coord in enumerate(coords) if n != axis]
        r = np.abs(others[0]) if len(others) == 1 else np.hypot(*others)
        angle = np.unwrap(np.arctan2(*others[:2])) if len(others) == 2 else np.zeros(1)
        yield axis, r, float(np.ptp(angle))


def on_one_curve(*coords: FloatArray) -> bool:
    """Whether points lie along one curve: they leave a parabola over their longer side by little."""
    if len(coords[0]) < _FEWEST_ROWS:
        return True
    points = np.stack([coord - coord.mean() for coord in coords])
    major, *others = np.linalg.svd(points, full_matrices=False)[0].T @ points
    if not np.ptp(major) > 0.0:
        return False
    u = major / np.ptp(major)
    deviations = [other - np.polynomial.Polynomial.fit(u, other, 2)(u) for other in others]
    return all(bool(np.ptp(deviation) < _ON_CURVE * np.ptp(major)) for deviation in deviations)


def _distance(r: FloatArray, z: FloatArray, pressure: FloatArray, contact: ContactGeometry) -> float:
    """Largest axial distance of points from the seat's face over their own extent; the origin of z is not known."""
    x = _x_of_radius(contact, r)
    if x is None or not np.isfinite(x).all():
        return np.inf
    height, extent = contact.height(x), float(np.hypot(np.ptp(r), np.ptp(z)))
    offsets = [side - np.average(side, weights=pressure) for side in (z - height, z + height)]
    return min(float(np.abs(offset).max()) for offset in offsets) / extent


def _x_of_radius(contact: ContactGeometry, r: FloatArray) -> FloatArray | None:
    """x on the seat's face, NaN beside it; None where a radius does not tell the place."""
    face = contact.seat_face
    s = np.linspace(0.0, face.length, 20_001)
    radii = face.point(s)[0]
    origin = face.project_radius(contact.initial_contact_radius)
    at, growth = int(np.searchsorted(s, origin, "right")) - 1, np.diff(radii) / s[1]
    if growth[at] < 1e-3:
        return None
    # around first touch as far as radii do not fall; beside a land the face goes on over its walls
    falls = np.flatnonzero(growth < -1e-6)
    part = slice(falls[falls < at].max(initial=-1) + 1, falls[falls > at].min(initial=len(s)) + 1)
    return np.interp(r, radii[part], s[part], left=np.nan, right=np.nan) - origin


def _fits(r: FloatArray, contact: ContactGeometry) -> bool:
    x = _x_of_radius(contact, r)
    return x is not None and bool(np.isfinite(x).any())


def _on_seat(r: FloatArray, pressure: FloatArray, contact: ContactGeometry, remark: str) -> FloatArray:
    """x of radii on the seat; points beside its face may carry nothing."""
    x = _x_of_radius(contact, r)
    if x is None:
        raise TextTableError(problem("profile_place", seat=contact.seat.label, remark=remark))
    mask = pressure > _PRESSED_SHARE * pressure.max()
    if np.isnan(x[mask]).any():
        face = contact.seat_face.point(np.array([0.0, contact.seat_face.length]))[0]
        words = {"radius": _from_to(r[mask]), "seat": contact.seat.label, "face": _from_to(face)}
        words |= {"touch": _mm(contact.initial_contact_radius), "remark": remark}
        raise TextTableError(problem("profile_off_contact", **words))
    peak = int(np.argmax(pressure))
    gap, touch = contact.gap(x[peak : peak + 1]), contact.initial_contact_radius
    if abs(r[peak] / touch - 1.0) > _TOLERANCE and not gap[0] < 1e-3 * touch:
        words = {"closure": contact.closure.label, "seat": contact.seat.label, "remark": remark}
        raise TextTableError(problem("profile_peak", peak=_mm(float(r[peak])), touch=_mm(touch), **words))
    return x


def _touches_at_zero(x: FloatArray, pressure: FloatArray) -> bool:
    """Whether x = 0 lies between places that are pressed."""
    pressed_x = x[pressure > _PRESSED_SHARE * pressure.max()]
    return bool(pressed_x.min() <= 0.0 <= pressed_x.max())


def _from_touch(x: FloatArray, pressure: FloatArray, remark: str) -> tuple[FloatArray, str]:
    """Arc length from first touch; of a path that begins at zero, with its centre of pressure there."""
    if _touches_at_zero(x, pressure):
        return x, remark
    if abs(x.min()) > 1e-6 * np.ptp(x):
        raise TextTableError(problem("profile_arc", peak=_mm(float(x[np.argmax(pressure)])), remark=remark))
    centre = _centre(x, pressure)
    return x - centre, f"{remark}; x = {_mm(centre)}, the centre of pressure, is taken as first touch"


def _centre(x: FloatArray, pressure: FloatArray) -> float:
    """Where the contact pressure has its centre [m]."""
    order = np.argsort(x, kind="stable")
    area, moment = (float(np.trapezoid(values[order], x[order])) for values in (pressure, pressure * x))
    return moment / area


def _merge_places(x: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points in order, those at one place as one with the mean of each column of values, of which pressure is first."""
    order = np.argsort(x, kind="stable")
    x, values = x[order], values[order]
    begins = np.diff(x, prepend=-np.inf) > 1e-9 * np.ptp(x)
    if begins.all():
        return x, values
    starts, pressure = np.flatnonzero(begins), values[:, 0]
    counts = np.diff(starts, append=len(x))
    lowest, highest = np.minimum.reduceat(pressure, starts), np.maximum.reduceat(pressure, starts)
    worst = int(np.argmax(highest - lowest))
    if highest[worst] - lowest[worst] > _SAME_PRESSURE * pressure.max():
        words = {"low": float(lowest[worst]), "high": float(highest[worst]), "map": _MAP}
        raise TextTableError(problem("profile_several_steps", x=_mm(float(x[starts[worst]])), **words))
    return x[starts], np.add.reduceat(values, starts) / counts[:, None]


def _mm(length: float) -> str:
    return str(Quantity(length, ".4g mm")).replace("-", "−")


def _from_to(lengths: FloatArray) -> str:
    return f"{_mm(float(lengths.min()))} to {_mm(float(lengths.max()))}"
