"""The result files of one calculation, in one folder, and the content of summary.json."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from fem_seal.answers.answer import OptionalSteps
from fem_seal.answers.case_load import CaseLoad
from fem_seal.answers.closed_forms import derive_beside
from fem_seal.answers.solution import SealSolution
from fem_seal.case.case import input_tables
from fem_seal.contact.load_path import ElastoplasticContact, Imprint
from fem_seal.contact.solution import PlasticZone, YieldedZone
from fem_seal.files import as_json, write_text
from fem_seal.output import answer_outputs, stored
from fem_seal.output.answer_output import by_scenario
from fem_seal.output.case_words import chosen_dimensions, derived_numbers
from fem_seal.output.folders import replaced_together
from fem_seal.output.pressure_map import map_of, write_map
from fem_seal.output.report.page import far_field_sentence, write_report
from fem_seal.output.sources import sources
from fem_seal.output.tables import (
    contact_rows,
    imprint_rows,
    leak_rows,
    leakage_table,
    write_leak_csv,
    write_profile_csv,
    write_rows_csv,
)
from fem_seal.output.vtk import write_around, write_contact, write_contact_line, write_unloaded
from fem_seal.seal.problem import exponential_law
from fem_seal.units import attributes
from fem_seal.version import __version__


def write(
    result: SealSolution,
    folder: Path,
    *,
    full: bool = False,
    all_columns: bool = False,
    with_report: bool = True,
) -> tuple[str, ...]:
    """Write tables, summary, VTK files, mesh and report into a folder.

    They replace the files of an earlier run together, or none is written; everything else in the folder is left alone.
    The caller holds the lock of the folder, see `fem_seal.output.folders`.

    Parameters
    ----------
    result : SealSolution
    folder : pathlib.Path
        Made if it does not exist.
    full : bool
        Whether the report has all numbers, pictures and tables.
    all_columns : bool
        Whether leak.csv and summary.json have all columns, also those that do not belong to the case.
    with_report : bool
        Whether report.html is among the files.

    Returns
    -------
    tuple of str
        A sentence for each optional file that could not be written; summary.json has them, too.

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    folder, steps = Path(folder), OptionalSteps()
    tables = [name for output in answer_outputs.OUTPUTS for name in output.tables]
    with replaced_together(folder, tables=tables) as draft:
        write_leak_csv(result, draft / "leak.csv", all_columns=all_columns)
        write_profile_csv(result, draft / "profile.csv")
        # a full disc affects the other files as well
        reports = {
            "report.html": lambda result, folder: write_report(result, folder / "report.html", full=full)
        }
        # given contacts have neither mesh nor fields, but for maps
        files = _FILES if not result.of_profile else {"map": write_map} if map_of(result.loads[0]) else {}
        for name, write_one in (files | reports if with_report else files).items():
            with steps.attempt(name, but=OSError):
                write_one(result, draft)
        answer_tables = {
            name: table
            for output in answer_outputs.OUTPUTS
            if output.answers(result)
            for name, table in output.tables.items()
        }
        for name, table in {
            "contacts.csv": contact_rows,
            "imprint.csv": imprint_rows,
            **answer_tables,
        }.items():
            with steps.attempt(name, but=OSError):
                columns, rows = table(result)
                if rows:
                    write_rows_csv(draft / name, columns, rows)
        with steps.attempt(stored.FILE, but=OSError):
            stored.store_result(result, draft / stored.FILE)
        with steps.attempt("summary.json", but=OSError):
            warnings = (*result.warnings, *steps.failures)
            write_summary(
                replace(result, warnings=warnings), draft / "summary.json", folder, all_columns=all_columns
            )
    return tuple(steps.failures)


def _vtk(result: SealSolution, folder: Path) -> None:
    write_contact(result, folder)
    write_contact_line(result, folder)
    write_around(result, folder)
    write_unloaded(result, folder)


# Optional files: a failure becomes a warning.
_FILES: dict[str, Callable[[SealSolution, Path], object]] = {
    "mesh.msh": lambda result, folder: result.seal_mesh.write(folder / "mesh.msh"),
    "VTK files": _vtk,
}


# Raised when a key of summary.json changes its meaning or goes away; new keys do not count.
FORMAT_VERSION = 2


def summary(result: SealSolution, *, all_columns: bool = False) -> dict[str, Any]:
    """Everything about a result except its fields, in SI, ready for JSON.

    Parameters
    ----------
    result : SealSolution
    all_columns : bool
        See `write`.

    Returns
    -------
    dict
        ``format_version``, ``program``, ``created``, ``title``, ``case_file``, ``input``, ``derived``, ``mesh``,
        ``loads`` (rows of leak.csv with their validity and a list of reasons), ``leakage`` (other units and classes,
        one entry per load; no class outside the theory), ``yielding`` (one entry
        per load; null for a body that does not exceed its yield stress; of another lower flange and its half of the
        gasket those that do, as ``lower closure`` and ``lower seat``), ``imprint`` (of each body that has yielded, by
        the same names; null if all bodies are elastic), ``compression`` (steps of a gasket, what
        is left after them, and the springback; null for a valve seat),
        ``convergence`` (one entry per load), ``discretisation_error``, ``far_field``
        (relative changes, and a sentence), ``form`` (answers about the form error at the highest load; null for a
        round seal), ``requirement`` (verdict, margin and their basis; null without one), ``verdict_force``
        (force with which the verdict passes or why none does, one entry per load; null unless asked),
        ``standard_tests`` (rows of standard_tests.csv) with ``standard_verdict``, ``set_pressure`` (of a relief valve,
        with rows of set_pressure.csv), null without them, ``levers`` (the
        sensitivities, the strongest first), ``particles`` (answers about particles in the fluid, one entry per
        load that leaks), ``theories`` (result of the other theory, and why it differs) and ``interface_variants``,
        which are null where they are not calculated,
        ``uncertainty`` (null unless asked for), ``error_shares`` (shares of the width of the interval of each load by
        source and, as ``parts``, of inputs, theory and doubts; what is ``not_measured`` and in no interval; what an
        ``earlier_load`` twice as high leaves; the factor that a measurement is expected to leave),
        ``warnings``, ``wall_times_s``, ``sources``.
    """
    case = result.case
    return {
        "format_version": FORMAT_VERSION,
        "program": {"name": "fem-seal", "version": __version__},
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "title": case.title,
        "case_file": None if case.file is None else str(case.file),
        "input": resolved_input(result),
        "derived": derived_numbers(case, derive_beside(result)),
        "mesh": None if result.of_profile else mesh_numbers(result),
        "loads": leak_rows(result, all_columns=all_columns),
        "leakage": leakage_table(result),
        "yielding": [] if result.of_profile else [_yielding(load) for load in result.loads],
        "imprint": None if result.unloaded_bodies is None else _imprints(result.imprints),
        "convergence": [] if result.of_profile else [_convergence(load) for load in result.loads],
        "discretisation_error": None if result.of_profile else asdict(result.discretisation_error),
        "far_field": {
            "changes": [by_scenario(asdict(change)) for change in result.far_field],
            "says": far_field_sentence(result),
        },
        **{
            key: value
            for output in answer_outputs.OUTPUTS
            for key, value in output.summary_of(result).items()
        },
        "warnings": list(result.warnings),
        "wall_times_s": dict(result.timings),
        "sources": [asdict(source) for source in sources(result)],
    }


def write_summary(
    result: SealSolution, path: Path, folder: Path | None = None, *, all_columns: bool = False
) -> Path:
    """Write summary.json, atomically; numbers that JSON does not know (NaN, infinity) are null.

    Parameters
    ----------
    result : SealSolution
    path : pathlib.Path
    folder : pathlib.Path, optional
        Final folder of the results; that of `path` unless given.
    all_columns : bool
        See `write`.
    """
    content = summary(result, all_columns=all_columns)
    content["input"]["output"]["folder"] = str((folder or path.parent).absolute())
    return write_text(path, as_json(content) + "\n")


def resolved_input(result: SealSolution) -> dict[str, Any]:
    """The case as nested tables in SI, with chosen dimensions and sizes in place of open entries."""
    case = result.case
    tables = input_tables(case)
    for name in ("closure", "seat"):
        tables[case.key_of(name)] |= chosen_dimensions(case, name)
    if not result.of_profile:
        tables["mesh"]["contact_size"] = result.seal_mesh.sizing.contact_size
    if case.interface.law == "exponential":
        tables["interface"]["u0"], tables["interface"]["p_c"] = exponential_law(
            case.interface, result.surface
        )
    return tables


def mesh_numbers(result: SealSolution) -> dict[str, Any]:
    """Size and quality of the mesh."""
    quality, sizing, model = result.seal_mesh.quality, result.seal_mesh.sizing, result.model
    return {
        "triangles": quality.elements,
        "vertices": quality.vertices,
        "unknowns": {name: body.fem.size for name, body in model.bodies.items()},
        "contact_elements": len(model.line.vertices) - 1,
        "contact_points": len(model.line.x),
        "contact_size_m": sizing.contact_size,
        "contact_zone_m": list(sizing.zone),
        "far_size_m": sizing.far_size,
        "smallest_shape": quality.smallest,
        "mean_shape": quality.mean,
        "area_error": quality.area_error,
    }


def _yielding(load: CaseLoad) -> dict[str, Any]:
    """Where the bodies yield or, solved as elastic, exceed their yield stress."""
    # of a lower flange of its own only what exceeds its yield stress
    zones = {
        name: zone for name, zone in load.zones.items() if zone is not None or name in ("closure", "seat")
    }
    return {
        "fluid_pressure_Pa": load.fluid_pressure,
        **{name: None if zone is None else _zone(zone) for name, zone in zones.items()},
    }


def _zone(zone: YieldedZone | PlasticZone) -> dict[str, Any]:
    worst: dict[str, Any] = (
        {"solved_as": "elastoplastic", "max_accumulated_plastic_strain": zone.strain}
        if isinstance(zone, PlasticZone)
        else {"solved_as": "elastic", "von_mises_Pa": zone.von_mises, "over_yield_stress": zone.excess}
    )
    return {
        "yield_stress_Pa": zone.yield_stress,
        **worst,
        "at_r_m": zone.place[0],
        "at_z_m": zone.place[1],
        "depth_m": zone.depth,
        "yielded_down_to_m": zone.deepest,
    }


def _imprints(imprints: Mapping[str, Imprint]) -> dict[str, Any]:
    return {
        name: {
            "depth_m": imprint.deepest,
            "at_x_m": imprint.deepest_at,
            **attributes(imprint, "width_m", "rim_m"),
        }
        for name, imprint in imprints.items()
    }


def _convergence(load: CaseLoad) -> dict[str, Any]:
    contact = load.contact
    plastic = contact if isinstance(contact, ElastoplasticContact) else None
    return {
        "fluid_pressure_Pa": load.fluid_pressure,
        "iterations": contact.iterations,
        "residual": contact.residuals[-1] if contact.residuals else None,
        "force_error": contact.force_error,
        "approach_m": contact.face_approach,
        "load_steps": None if plastic is None else plastic.load_steps,
        "equilibrium_residual": None if plastic is None else plastic.equilibrium_residuals[-1],
    }
