"""Write docs/verification/validation.md: measurements compared with the predictions of the program.

Run: python docs/validation/validation.py [--all] for the page, with FILE.toml ... for files of your own.
"""

from __future__ import annotations

import json
import math
import sys
import tomllib
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

from validation_page import Experiment, Prediction, judged, page, verdict
from validation_pictures import draw_curve, draw_verdicts

import fem_seal
from fem_seal import Case, InputError
from fem_seal.output.columns import COLUMNS
from fem_seal.seal.problem import SealProblem
from fem_seal.studies.expressions import Expression
from fem_seal.studies.responses import evaluate_design

FOLDER = Path(__file__).parent
FILE = FOLDER.parent / "verification" / "validation.md"
# Stored predictions: their calculation takes minutes, writing the page takes seconds.
PREDICTIONS = FOLDER / "predictions.json"
TEMPLATE = "template.toml"
# Readings of yielding asperities that the paper's theory has; others have a single one in the column of the leak rate.
_READINGS = {"paper": ("conserved", "capped")}


def read(path: Path) -> Experiment:
    """The experiment of a file."""
    return Experiment.of(path.name, tomllib.loads(path.read_text(encoding="utf-8")))


def files() -> list[Path]:
    """All experiments of the page."""
    return [path for path in sorted(FOLDER.glob("*.toml")) if path.name != TEMPLATE]


def digest(path: Path) -> str:
    """Digest that changes with the file."""
    return sha256(path.read_bytes()).hexdigest()


def predict(experiment: Experiment, theory: str) -> list[Prediction]:
    """The interval of each observation over all corners and readings.

    Parameters
    ----------
    experiment : Experiment
    theory : {"paper", "corrected", "turned"}
        One of its own.
    """
    values = [Expression(one.value) for one in experiment.observed if one.value]
    found: list[list[float]] = [[] for _ in values]
    refused = ""
    for corner in experiment.corners():
        try:
            of_rough = {"leak.theory": theory} if theory != "turned" else {}
            case = Case(**experiment.case).replace({**corner, **of_rough})
        except InputError as error:
            refused = f"this version cannot read the case: {error}"
            return [Prediction(None, None, refused) for _ in experiment.observed]
        readings, reasons = _numbers(case, values, experiment.surface_only)
        refused = refused or (f"outside the theory with {_told(corner)}: {reasons}" if reasons else "")
        for numbers in readings:
            for one, value in zip(found, values, strict=True):
                one.append(value(numbers))
    each = iter(found)
    return [
        Prediction(*(_ends(next(each)) if one.value else (None, None)), refused)
        for one in experiment.observed
    ]


def curve(experiment: Experiment) -> list[list[tuple[float, float]]]:
    """Least and largest leak rate of each line of the curve at each pressure [m^3/s]; no lines without a curve."""
    found = []
    for line in experiment.curve.lines if experiment.curve else ():
        rates = []
        for corner in experiment.corners_of(line):
            changes = {**corner, "leak.theory": line.theory, "load.applied_force": "0 N"}
            case = Case(**experiment.case).replace(
                {**changes, "load.fluid_pressure": list(experiment.curve.fluid_pressure)}
            )
            rates.append([load.leak.leak_rate for load in fem_seal.run(case).loads])
        found.append([(min(each), max(each)) for each in zip(*rates, strict=True)])
    return found


def _ends(numbers: Sequence[float]) -> tuple[float | None, float | None]:
    known = [one for one in numbers if not math.isnan(one)]
    return (min(known), max(known)) if len(known) == len(numbers) else (None, None)


def _told(corner: dict[str, Any]) -> str:
    return ", ".join(f"{key} = {value}" for key, value in corner.items()) or "the case as it is"


def _numbers(
    case: Case, values: Sequence[Expression], surface_only: bool
) -> tuple[list[dict[str, float]], str]:
    """Variables for the expressions in each reading, and the reason if nothing may be claimed."""
    if surface_only:
        return _of_surfaces(case), ""
    asked = {name for value in values for name in value.names}
    columns = {name.rpartition("_at_")[0] for name in asked}
    readings = {f"leak_rate_{one}_m3_per_s": {} for one in _READINGS.get(case.leak.theory, ("",))}
    wanted = (*columns, *readings)
    reasons: list[str] = []
    for number, (pressure, force) in enumerate(case.load.points, start=1):
        one = case.replace({"load.fluid_pressure": pressure, "load.applied_force": force})
        row = evaluate_design(one, [name for name in wanted if name in COLUMNS], interpolate=False)
        reasons += [
            f"load {number}, {reason}" for reason in row.validity.reasons if row.validity.outside_theory
        ]
        for column, numbers in readings.items():
            read_so = row.values.get(column, math.nan)
            chosen = dict(row.values)
            if not math.isnan(read_so):
                chosen["leak_rate_m3_per_s"] = read_so
            numbers.update({f"{name}_at_{number}": value for name, value in chosen.items()})
    return list(readings.values()), "; ".join(reasons)


def _of_surfaces(case: Case) -> list[dict[str, float]]:
    """Variables that follow from the surfaces alone, in each reading."""
    surface = SealProblem.of(case).surface
    if surface is None:
        raise ValueError("the case has no roughness")
    yields = [
        body.material.yield_stress
        for body in (case.closure, case.lower)
        if body.material.yield_stress is not None
    ]
    common = {"hardness_Pa": surface.hardness or math.nan, "yield_stress_Pa": min(yields, default=math.nan)}
    return [
        {**common, "sealing_pressure_Pa": surface.reading(one).sealing_pressure} for one in surface.readings
    ]


def stored() -> dict[str, dict[str, Any]]:
    """Stored predictions of the files."""
    found: dict[str, dict[str, Any]] = json.loads(PREDICTIONS.read_text(encoding="utf-8"))
    return found


def rendered(known: dict[str, dict[str, Any]]) -> str:
    """The page from stored predictions."""
    curves = {name: entry["curve"] for name, entry in known.items() if "curve" in entry}
    return page([read(path) for path in files()], _predictions(known), curves)


def draw(known: dict[str, dict[str, Any]]) -> None:
    """The pictures of the page from stored predictions."""
    experiments, images = [read(path) for path in files()], FILE.parents[1] / "images"
    draw_verdicts(judged(experiments, _predictions(known)), images / "validation.svg")
    for one in experiments:
        if one.curve is not None:
            draw_curve(one.curve, known[one.name]["curve"], images / "validation_curve.svg")


def _predictions(known: dict[str, dict[str, Any]]) -> dict[str, dict[str, list[Prediction]]]:
    return {
        name: {theory: [Prediction(**one) for one in each] for theory, each in entry["predictions"].items()}
        for name, entry in known.items()
    }


def update(everything: bool) -> None:
    """Calculate files that have changed, or all, and write the page."""
    known = stored() if PREDICTIONS.exists() and not everything else {}
    fresh = {}
    for path in files():
        entry = known.get(path.name)
        # this version may calculate a case that an earlier one could not
        refused = entry is not None and any(
            one["refused"] for each in entry["predictions"].values() for one in each
        )
        if entry is None or entry["sha256"] != digest(path) or refused:
            print(path.name, flush=True)
            experiment = read(path)
            found = {
                theory: [one.__dict__ for one in predict(experiment, theory)]
                for theory in experiment.theories
            }
            entry = {"sha256": digest(path), "predictions": found}
            if experiment.curve is not None:
                entry["curve"] = curve(experiment)
        fresh[path.name] = entry
        PREDICTIONS.write_text(json.dumps({**known, **fresh}, indent=1) + "\n", encoding="utf-8")
    PREDICTIONS.write_text(json.dumps(fresh, indent=1) + "\n", encoding="utf-8")
    FILE.write_text(rendered(fresh), encoding="utf-8")
    draw(fresh)


def show(path: Path) -> None:
    """Print the verdict on a file of the user's own."""
    experiment = read(path)
    print(experiment.title)
    for theory in experiment.theories:
        for observed, prediction in zip(experiment.observed, predict(experiment, theory), strict=True):
            word, why = verdict(observed, prediction, theory)
            ends = f"{prediction.low} to {prediction.high}"
            print(f"  {observed.what}, {theory} theory: predicted {ends}; {word}: {why}")


if __name__ == "__main__":
    asked = [Path(one) for one in sys.argv[1:] if one != "--all"]
    for one in asked:
        show(one)
    if not asked:
        update("--all" in sys.argv)
