"""Comparison of experiments and predictions: the verdict, and the page. No seal is calculated here."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType
from typing import Any

INSIDE, OUTSIDE, NOT_DECIDABLE, NOTHING = "inside", "outside", "not decidable", "–"
# A prediction that spans a larger factor means little, even if the measurement is inside.
_WIDE = 10.0

HEAD = """\
# Published seals: predicted, measured, not known

[Verification](verification.md) asks whether the equations are solved right; this page asks whether they are the right
ones. Each experiment is a file in `docs/validation/`: an ordinary case, ranges for the inputs that the report does not
give, and the measured values. Both theories of the rough contact predict an interval: the least and the largest value
over all corners of the inputs not reported, and in the paper's theory over both readings of yielding asperities
(`leak_rate_conserved_m3_per_s`, `leak_rate_capped_m3_per_s`). Turned faces have their own theory, that of
[crests](../theory/turned.md). **Nothing is fitted.** The corners are assumptions, stated in the files; they were chosen
before the comparison, from usual values for the finish and the material, and not changed afterwards; a file to which
one was added says so.

- **inside**: the interval of the prediction and that of the measurement overlap. The width of the prediction
  is given, too: a prediction that spans decades is easily inside.
- **outside**: they do not.

Only numbers from texts are used: several of these reports are known here only by their abstracts, and no number was
read off a figure. What was measured and cannot be decided stands in [a list below](#measured-but-not-decidable), with
the reason and the prediction.
"""

DECIDED = """\
## What can be decided

![predicted over measured, in decades](../images/validation.svg)

Grey is the measured interval, coloured the predicted one, both over the middle (of the logarithm) of the measured one,
or over its upper end where it goes down to zero. A bar that leaves the picture to the left goes down to zero.
"""

NOT_DECIDED = """\
## Measured, but not decidable

The report lacks the number, the program may not claim one, or the number is known only by way of the theory that it
would judge.
"""

TEMPLATE = """\
## Your own measurements

Copy [docs/validation/template.toml](../validation/template.toml) and fill in the known values; for a key that your
report does not give, write its range in `[[scenarios]]`. Then

```
python docs/validation/validation.py docs/validation/my_seal.toml
```

prints the verdict. Files in `docs/validation/` become part of this page with `python docs/validation/validation.py`,
which calculates every file that has changed since, and with `--all` every file.
"""


@dataclass(frozen=True)
class Observed:
    """A measured or observed value.

    Parameters
    ----------
    what : str
    value : str
        Expression over columns of leak.csv, each with the number of its load: ``leak_rate_m3_per_s_at_2``; empty where
        the program has nothing like it, and something is missing.
    low, high : float, optional
        Range of the measured value; not given if the report has no number.
    taken : str
        How the range follows from the report.
    missing : str
        What is missing in the report; empty if nothing.
    known_by : str
        The theory by whose calculation alone the measured value is known; that one it cannot judge.
    """

    what: str
    value: str = ""
    low: float | None = None
    high: float | None = None
    taken: str = ""
    missing: str = ""
    known_by: str = ""

    def __post_init__(self) -> None:
        given = self.low is not None and self.high is not None
        if given == bool(self.missing):
            raise ValueError(f"{self.what}: give either low and high, or what is missing")
        if not (self.value or self.missing):
            raise ValueError(f"{self.what}: give the value that is compared, or what is missing")
        if self.low is not None and self.high is not None and not self.low <= self.high:
            raise ValueError(f"{self.what}: low = {self.low} lies above high = {self.high}")


@dataclass(frozen=True)
class Prediction:
    """The prediction of the program.

    Parameters
    ----------
    low, high : float or None
        Over all corners and readings; None where there is none.
    refused : str
        Why the program claims nothing; empty if it does.
    """

    low: float | None
    high: float | None
    refused: str = ""

    @property
    def span(self) -> float:
        """Factor between both ends; infinite if the lower one is not positive."""
        if self.low is None or self.high is None:
            return math.nan
        return self.high / self.low if self.low > 0 else (1.0 if self.high == self.low else math.inf)


@dataclass(frozen=True)
class Line:
    """A line of a curve over the fluid pressure: the envelope of some corners.

    Parameters
    ----------
    name : str
    theory : str
    where : dict
        The corners, by values that they have.
    """

    name: str
    theory: str
    where: dict[str, Any]


@dataclass(frozen=True)
class Curve:
    """The leak rate over the fluid pressure in several states of knowledge.

    Parameters
    ----------
    title, text : str
        What is said above it.
    fluid_pressure : tuple of str
    lines : tuple of Line
    """

    title: str
    text: str
    fluid_pressure: tuple[str, ...]
    lines: tuple[Line, ...]


@dataclass(frozen=True)
class Experiment:
    """A file of docs/validation/.

    Parameters
    ----------
    name : str
        Of the file.
    title, source, reported, not_reported : str
    case : dict
        Tables of the case.
    scenarios : tuple of dict
        Dotted keys of the case with a value, or a list of values that are combined.
    observed : tuple of Observed
    surface_only : bool
        Whether the values follow from the surfaces alone, without a contact.
    curve : Curve or None
    """

    name: str
    title: str
    source: str
    reported: str
    not_reported: str
    case: dict[str, Any]
    scenarios: tuple[dict[str, Any], ...]
    observed: tuple[Observed, ...]
    surface_only: bool = False
    curve: Curve | None = None

    @classmethod
    def of(cls, name: str, tables: Mapping[str, Any]) -> Experiment:
        """From a file's tables; KeyError, TypeError or ValueError if they are not those of an experiment."""
        about, curve = dict(tables["experiment"]), tables.get("curve")
        return cls(
            name=name,
            curve=None
            if curve is None
            else Curve(**{**curve, "lines": [Line(**one) for one in curve["lines"]]}),
            case=dict(tables["case"]),
            scenarios=tuple(tables.get("scenarios", ())),
            observed=tuple(Observed(**one) for one in tables["observed"]),
            **about,
        )

    @property
    def theories(self) -> tuple[str, ...]:
        """Those that predict it: of turned faces that of their crests, else both of the rough contact."""
        faces = self.case.get("roughness", {}).values()
        turned = any("feed" in face for face in faces if isinstance(face, Mapping))
        from_drawing = any(face.startswith("turned") for face in faces if isinstance(face, str))
        return ("turned",) if turned or from_drawing else ("corrected", "paper")

    def corners(self) -> list[dict[str, Any]]:
        """Changes of the case: every combination within each table of scenarios; a single empty one without tables.

        "none" is a key that is not given.
        """
        found: list[dict[str, Any]] = []
        for table in self.scenarios or ({},):
            values = [one if isinstance(one, list) else [one] for one in table.values()]
            chosen = ([None if one == "none" else one for one in each] for each in product(*values))
            found += [dict(zip(table, each, strict=True)) for each in chosen]
        return found

    def corners_of(self, line: Line) -> list[dict[str, Any]]:
        """Those of a line of the curve."""
        where = {key: None if value == "none" else value for key, value in line.where.items()}
        return [corner for corner in self.corners() if where.items() <= corner.items()]


def verdict(observed: Observed, prediction: Prediction, theory: str = "") -> tuple[str, str]:
    """Inside, outside or not decidable, and why.

    Parameters
    ----------
    observed : Observed
    prediction : Prediction
    theory : str
        That predicts.
    """
    if observed.missing:
        return NOT_DECIDABLE, observed.missing
    if theory and theory == observed.known_by:
        return NOT_DECIDABLE, "the measured value is known only as what this theory calculates"
    if prediction.refused:
        return NOT_DECIDABLE, prediction.refused
    low, high = prediction.low, prediction.high
    assert observed.low is not None and observed.high is not None  # otherwise `missing` is given
    if low is None or high is None or math.isnan(low) or math.isnan(high):
        return NOT_DECIDABLE, "the program has no number for it"
    if low > observed.high:
        return OUTSIDE, f"the least that is predicted is {_factor(low, observed.high)} too large"
    if high < observed.low:
        return OUTSIDE, f"the most that is predicted is {_factor(observed.low, high)} too small"
    if prediction.span > _WIDE:
        return INSIDE, f"but the prediction spans {_times(prediction.span)} and says little"
    return INSIDE, f"the prediction spans {_times(prediction.span)}"


def _factor(larger: float, smaller: float) -> str:
    return f"a factor {larger / smaller:.3g}" if smaller > 0 else "by any factor"


def _times(span: float) -> str:
    if math.isinf(span):
        return "all down to zero"
    return f"a factor {span:.0f}" if 10 <= span < 1e4 else f"a factor {span:.2g}"


# Predictions of each theory for each observation of an experiment; least and largest of some corners.
ByTheory, Ends = Mapping[str, Sequence[Prediction]], Sequence[float]
ML_PER_MIN = 6e7  # in a m^3/s
NAMES = {"corrected": "corrected theory", "paper": "paper's theory", "turned": "crests of turned faces"}


def page(
    experiments: Sequence[Experiment],
    predictions: Mapping[str, ByTheory],
    curves: Mapping[str, Sequence[Sequence[Ends]]] = MappingProxyType({}),
) -> str:
    """The whole page, Markdown.

    Parameters
    ----------
    experiments : sequence of Experiment
    predictions : mapping
        One for each observation in each theory, by the name of the experiment.
    curves : mapping
        Least and largest leak rate of each line of a curve at each pressure [m^3/s], by the name of the experiment.
    """
    rows = judged(experiments, predictions)
    return "\n".join(
        [
            HEAD,
            DECIDED,
            *_decided(rows),
            *(line for one in experiments if one.curve for line in _curve(one.curve, curves[one.name])),
            NOT_DECIDED,
            *_not_decided(rows),
            "## The experiments\n",
            *_sections(experiments),
            TEMPLATE,
        ]
    )


@dataclass(frozen=True)
class Row:
    """An observation with the verdict on what a theory predicts."""

    experiment: Experiment
    observed: Observed
    theory: str
    prediction: Prediction
    word: str
    why: str


def judged(experiments: Sequence[Experiment], predictions: Mapping[str, ByTheory]) -> list[Row]:
    """All observations in all theories.

    Parameters
    ----------
    experiments : sequence of Experiment
    predictions : mapping
        See `page`.
    """
    return [
        Row(one, observed, theory, prediction, *verdict(observed, prediction, theory))
        for one in experiments
        for number, observed in enumerate(one.observed)
        for theory in one.theories
        for prediction in [predictions[one.name][theory][number]]
    ]


def _link(experiment: Experiment) -> str:
    anchor = "".join(c for c in experiment.title.lower().replace(" ", "-") if c.isalnum() or c == "-")
    return f"[{experiment.title}](#{anchor})"


def _decided(rows: Sequence[Row]) -> Iterator[str]:
    decided = [row for row in rows if row.word != NOT_DECIDABLE]
    inside = [row for row in decided if row.word == INSIDE]
    wide = sum(row.prediction.span > _WIDE for row in inside)
    yield f"Of {len(decided)} rows {len(inside)} are inside, of which {wide} say little.\n"
    yield "| what | measured | theory | predicted | verdict | why |\n|---|---|---|---|---|---|"
    shown = None
    for row in decided:
        if row.experiment is not shown:
            yield f"| **{_link(row.experiment)}** | | | | | |"
            shown = row.experiment
        yield (
            f"| {row.observed.what} | {_interval(row.observed.low, row.observed.high)} | {NAMES[row.theory]} "
            f"| {_interval(row.prediction.low, row.prediction.high)} | **{row.word}** | {row.why} |"
        )
    yield ""


def _not_decided(rows: Sequence[Row]) -> Iterator[str]:
    reasons: dict[tuple[str, str, str], list[str]] = {}
    for row in rows:
        if row.word == NOT_DECIDABLE:
            predicted = _interval(row.prediction.low, row.prediction.high)
            told = reasons.setdefault((_link(row.experiment), row.observed.what, row.why), [])
            told += [f"{NAMES[row.theory]} {predicted}"] if predicted != NOTHING else []
    for (link, what, why), told in reasons.items():
        yield f"- {link}, {what}: {why}." + (f" Predicted: {', '.join(told)}." if told else "")
    yield ""


def _curve(curve: Curve, lines: Sequence[Sequence[Ends]]) -> Iterator[str]:
    yield f"## {curve.title}\n"
    yield f"{curve.text.strip()}\n"
    yield "| leak rate [ml/min] | " + " | ".join(curve.fluid_pressure) + " |"
    yield "|---" * (1 + len(curve.fluid_pressure)) + "|"
    for line, ends in zip(curve.lines, lines, strict=True):
        texts = [_interval(*(ML_PER_MIN * end for end in both)) for both in ends]
        yield f"| {line.name} | {' | '.join(texts)} |"
    yield "\n![leak rate over the fluid pressure](../images/validation_curve.svg)\n"


def _sections(experiments: Sequence[Experiment]) -> Iterator[str]:
    for experiment in experiments:
        yield f"### {experiment.title}\n"
        yield f"{experiment.source}. File: [{experiment.name}](../validation/{experiment.name}).\n"
        yield f"Reported: {experiment.reported}\n"
        yield f"Not reported: {experiment.not_reported} ({len(experiment.corners())} corners.)\n"
        if any(one.taken for one in experiment.observed):
            yield "How the numbers were taken from the report:\n"
            yield from (f"- {one.what}: {one.taken}." for one in experiment.observed if one.taken)
            yield ""


def _interval(low: float | None, high: float | None) -> str:
    if low is None or high is None or math.isnan(low) or math.isnan(high):
        return NOTHING
    texts = [f"{end:.3g}" for end in (low, high)]
    return texts[0] if texts[0] == texts[1] else " to ".join(texts)
