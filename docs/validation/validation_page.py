"""Comparison of experiments and predictions: the verdict, and the page. No seal is calculated here."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

INSIDE, OUTSIDE, NOT_DECIDABLE = "inside", "outside", "not decidable"
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
before the comparison, from usual values for the finish and the material, and not changed afterwards.

- **inside**: the interval of the prediction and that of the measurement overlap. The width of the prediction
  is given, too: a prediction that spans decades is easily inside.
- **outside**: they do not.
- **not decidable**: the report lacks the number, or the program may not claim one. The reason is
  given, and also the prediction, for readers with more information.

Only numbers from texts are used: several of these reports are known here only by their abstracts, and no number was
read off a figure.
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
        Expression over columns of leak.csv, each with the number of its load: ``leak_rate_m3_per_s_at_2``.
    low, high : float, optional
        Range of the measured value; not given if the report has no number.
    taken : str
        How the range follows from the report.
    missing : str
        What is missing in the report; empty if nothing.
    """

    what: str
    value: str
    low: float | None = None
    high: float | None = None
    taken: str = ""
    missing: str = ""

    def __post_init__(self) -> None:
        given = self.low is not None and self.high is not None
        if given == bool(self.missing):
            raise ValueError(f"{self.what}: give either low and high, or what is missing")
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

    @classmethod
    def of(cls, name: str, tables: Mapping[str, Any]) -> Experiment:
        """From a file's tables; KeyError, TypeError or ValueError if they are not those of an experiment."""
        about = dict(tables["experiment"])
        return cls(
            name=name,
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
        """Changes of the case: every combination within each table of scenarios; a single empty one without tables."""
        found: list[dict[str, Any]] = []
        for table in self.scenarios or ({},):
            values = [one if isinstance(one, list) else [one] for one in table.values()]
            found += [dict(zip(table, chosen, strict=True)) for chosen in product(*values)]
        return found


def verdict(observed: Observed, prediction: Prediction) -> tuple[str, str]:
    """Inside, outside or not decidable, and why.

    Parameters
    ----------
    observed : Observed
    prediction : Prediction
    """
    if observed.missing:
        return NOT_DECIDABLE, observed.missing
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


# Predictions of each theory for each observation of an experiment.
ByTheory = Mapping[str, Sequence[Prediction]]
_NAMES = {"corrected": "corrected theory", "paper": "paper's theory", "turned": "crests of turned faces"}


def page(experiments: Sequence[Experiment], predictions: Mapping[str, ByTheory]) -> str:
    """The whole page, Markdown.

    Parameters
    ----------
    experiments : sequence of Experiment
    predictions : mapping
        One for each observation in each theory, by the name of the experiment.
    """
    return "\n".join(
        [HEAD, *_summary(experiments, predictions), *_sections(experiments, predictions), TEMPLATE]
    )


def _judged(
    experiment: Experiment, predictions: Mapping[str, ByTheory], theory: str
) -> Iterator[tuple[Observed, Prediction, str, str]]:
    for observed, prediction in zip(experiment.observed, predictions[experiment.name][theory], strict=True):
        yield observed, prediction, *verdict(observed, prediction)


def _summary(experiments: Sequence[Experiment], predictions: Mapping[str, ByTheory]) -> Iterator[str]:
    yield f"| experiment | theory | {INSIDE} | {OUTSIDE} | {NOT_DECIDABLE} | not known |\n|---|---|---|---|---|---|"
    for experiment in experiments:
        anchor = "".join(c for c in experiment.title.lower().replace(" ", "-") if c.isalnum() or c == "-")
        unknown = experiment.not_reported.partition(". ")[0].partition(";")[0].rstrip(".")
        for theory in experiment.theories:
            found = [word for _, _, word, _ in _judged(experiment, predictions, theory)]
            counts = " | ".join(str(found.count(word)) for word in (INSIDE, OUTSIDE, NOT_DECIDABLE))
            yield f"| [{experiment.title}](#{anchor}) | {_NAMES[theory]} | {counts} | {unknown} |"
            unknown = ""
    yield ""


def _sections(experiments: Sequence[Experiment], predictions: Mapping[str, ByTheory]) -> Iterator[str]:
    for experiment in experiments:
        yield f"## {experiment.title}\n"
        yield f"{experiment.source}. File: [{experiment.name}](../validation/{experiment.name}).\n"
        yield f"Reported: {experiment.reported}\n"
        yield f"Not reported: {experiment.not_reported} ({len(experiment.corners())} corners.)\n"
        yield "| what | measured | theory | predicted | verdict | why |\n|---|---|---|---|---|---|"
        by_theory = [_judged(experiment, predictions, theory) for theory in experiment.theories]
        for each in zip(*by_theory, strict=True):
            for theory, (observed, prediction, word, why) in zip(experiment.theories, each, strict=True):
                measured = "–" if observed.missing else _interval(observed.low, observed.high)
                predicted = _interval(prediction.low, prediction.high)
                yield f"| {observed.what} | {measured} | {_NAMES[theory]} | {predicted} | **{word}** | {why} |"
        yield ""
        if any(one.taken for one in experiment.observed):
            yield "How the numbers were taken from the report:\n"
            yield from (f"- {one.what}: {one.taken}." for one in experiment.observed if one.taken)
            yield ""


def _interval(low: float | None, high: float | None) -> str:
    if low is None or high is None or math.isnan(low) or math.isnan(high):
        return "–"
    texts = [f"{end:.3g}" for end in (low, high)]
    return texts[0] if texts[0] == texts[1] else " to ".join(texts)
