"""A case in words and numbers: dimensions, sections, finishes, temperatures, closed forms, requirement."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.answers.closed_forms import ClosedForms, derive, widths
from fem_seal.answers.leakage_class import limits
from fem_seal.case.drawn import ProfileSource
from fem_seal.case.notation import words_of
from fem_seal.files import own_tables, worded_rows
from fem_seal.units import attributes, trim_zeros

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.fields import Table
    from fem_seal.case.roughness import FinishTable
    from fem_seal.case.tables import Load
    from fem_seal.contact.conduction import TemperatureField
    from fem_seal.seal.problem import SealProblem
    from fem_seal.units import Display
    from leak import RoughContact, TurnedContact
    from leak.surfaces.finish import Spread


BODIES = ("closure", "seat")
# Lengths that are no dimensions of the body.
_NOT_A_DIMENSION = ("interference", "tolerance")


def law_word(case: Case) -> str:
    """Key of the interface law in words.toml.

    Parameters
    ----------
    case : Case
    """
    law = case.interface.law
    return "corrected" if law == "spectrum" and case.leak.theory == "corrected" else law


def dimensions(case: Case, name: str) -> dict[str, float]:
    """Dimensions of a body by key.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        Lengths [m] and angles [rad], without keys that do not apply, such as the cavity of a solid ball.
    """
    table = case.table_of(name)
    lands = {
        f"land_{number}_{key.removeprefix('land_')}": entry
        for number, land in enumerate(getattr(table, "lands", ()), start=1)
        for key, entry in land
    }
    given = {
        key: entry
        for key, entry in {**lands, **dict(table)}.items()
        if isinstance(entry, float) and key not in _NOT_A_DIMENSION
    }
    return given | chosen_dimensions(case, name)


def listed_dimensions(case: Case, name: str) -> dict[str, tuple[float, bool]]:
    """The `dimensions` in the words of the case.

    Radii are diameters where the case writes diameters; the angle of a cone is followed by its included angle.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        By key or word: length [m] or angle [rad], and whether the program chose it.
    """
    table: type[Table] = type(case.table_of(name))
    words = {word.key: word for word in words_of(table).values()}
    chosen, listed = chosen_dimensions(case, name), {}
    for key, value in dimensions(case, name).items():
        word = words.get(key)
        in_diameters = word is not None and word.marker.dimension == "length" and case.in_diameters(name)
        if word is None or not in_diameters:
            listed[key] = value, key in chosen
        if word is not None and (in_diameters or word.marker.dimension == "angle"):
            listed[word.name] = word.of_key(value), key in chosen
    return listed


def chosen_dimensions(case: Case, name: str) -> dict[str, float]:
    """The `dimensions` that the case does not give and the program chose."""
    table = case.table_of(name)
    body = case.bodies[0 if name == "closure" else 1]
    values = {key: getattr(body, key, None) for key, entry in table if entry is None}
    return {
        key: float(value)
        for key, value in values.items()
        if isinstance(value, (int, float)) and value and key not in _NOT_A_DIMENSION
    }


def former_load_rows(display: Display, load: Load) -> list[tuple[str, str]]:
    """What the report says of a load before those of the case."""
    earlier = earlier_load(display, load)
    return [("largest earlier load", earlier)] if earlier else []


def earlier_load(display: Display, load: Load) -> str:
    """The largest earlier load in words: "a load of 2 kN", or empty where none is given."""
    if load.largest_earlier_force is not None:
        return f"a load of {display.quantity(load.largest_earlier_force, 'given force')}"
    if load.largest_earlier_pressure is not None:
        return f"a load of {display.quantity(load.largest_earlier_pressure, 'given fluid pressure')}"
    return ""


def section(case: Case, name: str) -> dict[str, Any]:
    """Source and extent of a body of shape "profile" in SI, empty for the other shapes.

    Parameters
    ----------
    case : Case
    name : str
        "closure" or "seat".

    Returns
    -------
    dict
        "file" and "layer", or None; "length_unit_m", the unit of the file, None for an outline in the case and for
        STEP; "joined_m", the widest gap of the drawing that was closed; "r_m" and "z_m", smallest and largest
        coordinate as drawn.
    """
    table = case.table_of(name)
    if not isinstance(table, ProfileSource):
        return {}
    body = case.bodies[0 if name == "closure" else 1]
    r, z = body.outline.extent
    return {
        "file": Path(table.file).name if table.file else None,
        "layer": table.layer,
        "length_unit_m": getattr(body, "file_unit", None),
        "joined_m": getattr(body, "joined", 0.0),
        "r_m": r,
        "z_m": z,
    }


def section_text(display: Display, section: Mapping[str, Any]) -> dict[str, str]:
    """A `section` in words: its source, if it is a file, and its extent."""
    return dict(worded_rows(display, "section", section=section))


def finish_numbers(case: Case) -> dict[str, dict[str, Any]]:
    """Each face with a finish by its key in [roughness], SI.

    Parameters
    ----------
    case : Case
    """
    faces = {} if case.roughness is None else case.roughness.finishes
    return {key: _numbers(face) for key, face in faces.items()}


def _numbers(table: FinishTable) -> dict[str, Any]:
    finish, face = table.finish, table.surface()
    spectrum = face.across
    return {
        "process": finish.process.name,
        "parameter": finish.parameter,
        "value_m": finish.value,
        **attributes(face.expected, "Ra_m", "Rq_m", "Rz_m"),
        **attributes(finish.band, "lambda_c_m", "lambda_s_m"),
        **attributes(face.spectrum, "rms_height_m", "rms_slope"),
        "hurst": face.hurst,
        "q_low_per_m": spectrum.q_low,
        "q_rolloff_per_m": face.q_rolloff,
        "q_high_per_m": spectrum.q_high,
        "lay": face.lay,
        "lay_aspect": face.aspect,
        "peklenik": face.peklenik,
        **(
            {}
            if face.texture is None
            else attributes(face.texture, "feed_m", "nose_radius_m", "crest_height_m")
        ),
        "ranges": {name: list(spread) for name, spread in finish.spreads.items()},
    }


def finish_rows(case: Case) -> list[tuple[str, str]]:
    """Rows of the finishes and of turned faces: name and value; equal finishes are listed once.

    Parameters
    ----------
    case : Case
    """
    faces: dict[FinishTable, list[str]] = {}
    for part in case.parts:
        for key, table in ({} if part.roughness is None else part.roughness.finishes).items():
            name, names = part.label_of(key), faces.setdefault(table, [])
            names += [] if name in names else [name]
    alike = len(faces) == 1 and len(*faces.values()) > 1
    rows = [
        row
        for table, names in faces.items()
        for row in _rows(case.display, table, "each face" if alike else " and ".join(names))
    ]
    for part in case.parts:
        for key, face in ({} if part.roughness is None else part.roughness.turned_faces).items():
            whose, texture = part.label_of(key), face.texture()
            rows += worded_rows(case.display, "turned", whose=whose, face=face, texture=texture)
    return rows


def crest_rows(
    display: Display, surface: RoughContact | TurnedContact | None, forms: ClosedForms, *, leaks: bool
) -> list[tuple[str, str]]:
    """Rows of a turned face in the contacts that the closed forms expect; none of another one.

    Parameters
    ----------
    display : Display
    surface : RoughContact, TurnedContact or None
    forms : ClosedForms
        Of the same case.
    leaks : bool
        Whether a fluid passes, of which the thread has a share.
    """
    from leak import TurnedContact

    lines = [line for load in forms.loads if (line := load.crossover or load.hertz) is not None]
    if not isinstance(surface, TurnedContact) or not lines:
        return []
    crests = [line.fwhm / surface.feed for line in lines]
    shares = surface.thread_share([line.peak_pressure for line in lines]) if leaks else (0.0,)
    return worded_rows(
        display,
        "crests",
        crests=(min(crests), max(crests)),
        shares=(float(min(shares)), float(max(shares))),
    )


def _rows(display: Display, table: FinishTable, whose: str) -> list[tuple[str, str]]:
    finish, face = table.finish, table.surface()
    spreads, height = finish.spreads, finish.spreads.get("rms_height")
    return worded_rows(
        display,
        "finish",
        whose=whose,
        finish=finish,
        face=face,
        table=table,
        spreads=spreads,
        others=[name for name in ("Ra", "Rq", "Rz") if name != finish.parameter],
        lays=own_tables("words.toml")["lays"],
        known=partial(_known, display, spreads),
        height=height if height is not None and height.high > height.low else None,
    )


def _known(display: Display, spreads: Mapping[str, Spread], name: str, how: str = "trimmed") -> str:
    """Whether a number was given, or assumed and in which range."""
    if name not in spreads:
        return " (given)"
    low, _, high = (float(f"{end:.3g}") if "length" in how else end for end in spreads[name])
    return f" (assumed; {display.quantity(low, how)} to {display.quantity(high, how)})"


def temperature_rows(
    case: Case, problem: SealProblem, field: TemperatureField | None = None
) -> Iterator[tuple[str, str]]:
    """Rows of the table of the temperature; none without [temperature].

    Parameters
    ----------
    case : Case
    problem : SealProblem
        The problem of the case.
    field : TemperatureField, optional
        The calculated temperatures, if any.
    """
    display = case.display
    if case.temperature is None:
        return
    at_rest, faces = problem.at_rest, own_tables("words.toml")["heated_faces"]
    calculated = at_rest.heating is not None
    for name, temperature in at_rest.temperatures.items():
        values = {"temperature": in_degrees(display, temperature), "label": case.label_of(name)}
        yield from worded_rows(display, "body_temperature", name=name, calculated=calculated, **values)
    yield "dimensions hold at", in_degrees(display, case.temperature.reference)
    for name, face in case.temperature.faces.items():
        film, heat = face.heat_transfer, None if field is None else field.heat[name]
        at = in_degrees(display, face.temperature)
        yield from worded_rows(
            display, "heated_face", place=faces[name], temperature=at, film=film, heat=heat
        )
    yield from worded_rows(
        display,
        "heat",
        field=field,
        calculated=calculated,
        conductance=None if at_rest.heating is None else at_rest.heating.surroundings.conductance,
        of_rough_faces=case.temperature.of_rough_faces,
        at_rest=at_rest,
        wall=problem.supports.wall,
        **case.labels,
    )


def in_degrees(display: Display, temperature: float) -> str:
    """A temperature [K] in words."""
    unit = display.unit_for("temperature", temperature)
    return f"{trim_zeros(round(unit.of(temperature), 2))} {unit.name}"


def derived_numbers(case: Case, derived: ClosedForms) -> dict[str, Any]:
    """Derived numbers of a case in SI, for `check --json`; of a lower flange of its own, on both faces, beside them."""
    fluid, others = case.fluid, case.parts[1:]
    crossovers = [load.crossover for load in derived.loads if load.crossover]
    width_of = dict(zip(crossovers, widths(crossovers).tolist(), strict=True))
    return {
        "title": case.title,
        "touch_radius_m": derived.initial_contact_radius,
        "contact_angle_rad": case.contact.angle,
        "relative_radius_m": derived.relative_radius,
        "dimensions": {
            case.key_of(name): {key: value for key, (value, _) in listed_dimensions(case, name).items()}
            for name in ("closure", "seat")
        },
        "sections": {
            case.key_of(name): numbers for name in ("closure", "seat") if (numbers := section(case, name))
        },
        "materials": {case.key_of(name): case.table_of(name).material.name for name in ("closure", "seat")},
        **({"lower_flange": derived_numbers(others[0], derive(others[0]))} if others else {}),
        **attributes(derived, "effective_modulus_Pa", "hardness_Pa", "rms_height_m", "rms_slope"),
        "finishes": finish_numbers(case),
        **attributes(derived, "decay_length_m", "law_pressure_Pa"),
        "viscosity_Pa_s": fluid.viscosity if fluid else None,
        "loads": [
            {
                **attributes(load, "fluid_pressure_Pa", "contact_force_N", "line_load_N_per_m"),
                "blow_off_pressure_Pa": load.blow_off_pressure,
                "force_for_target_leak_N": load.force_for_target,
                "hertz_peak_pressure_Pa": load.hertz.peak_pressure if load.hertz else None,
                "hertz_half_width_m": load.hertz.half_width if load.hertz else None,
                "gaussian_peak_pressure_Pa": load.gaussian.peak_pressure if load.gaussian else None,
                "gaussian_std_m": load.gaussian.std if load.gaussian else None,
                "crossover_peak_pressure_Pa": load.crossover.peak_pressure if load.crossover else None,
                "crossover_fwhm_m": width_of[load.crossover] if load.crossover else None,
                "crossover_std_m": load.crossover.std if load.crossover else None,
            }
            for load in derived.loads
        ],
    }


def requirement_numbers(case: Case) -> list[dict[str, Any]] | None:
    """Limits at each judged fluid pressure, for `check --json`; None without a requirement."""
    required = case.requirement
    if required is None:
        return None
    return [
        {
            "fluid_pressure_Pa": pressure,
            "limit": limit.name,
            "allowed_m3_per_s": limit.leak_rate,
            "test_fluid": limit.test_fluid or None,
            "test_fluid_leaks_times": list(limit.ratio),
        }
        for pressure in dict.fromkeys(case.load.fluid_pressure)
        if required.judges(pressure)
        for limit in limits(case, pressure)
    ]
