"""Evaluation of a study: best designs, and the parameters that matter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fem_seal.answers.judgement import Verdict
from fem_seal.arrays import BoolArray, FloatArray
from fem_seal.seal.findings import Level
from fem_seal.seal.scenarios import BESIDE, IN_INTERVAL, leak_rate_column
from fem_seal.studies.designs import MORRIS_LEVELS, SENSITIVITY, unit_points
from fem_seal.studies.expressions import Constraint, Expression
from fem_seal.studies.store import Store
from fem_seal.studies.tables import Design

if TYPE_CHECKING:
    import pandas as pd


LEAK_RATE = "leak_rate_m3_per_s"
PASSES = "pass_probability"
# Shares of seals, and the probability to pass that is asked for where no constraint says another one.
SHARES = (PASSES, "pass_probability_error", "batch_share_p05")
CONFIDENT = 0.95
# Part of a range that counts as its edge.
_EDGE = 0.01
# What a design leaks at most.
_UPPER_ENDS = (LEAK_RATE, *map(leak_rate_column, IN_INTERVAL), "leak_rate_high_m3_per_s")
_QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
# Columns that differ by less, relative to their size, are equal.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Designs:
    """The table of a study with what its columns mean.

    Parameters
    ----------
    table : pandas.DataFrame
        One row per design that has been calculated; constraints as columns of true and false.
    about : dict
        As `fem_seal.studies.session.description` wrote it.
    """

    table: pd.DataFrame
    about: Mapping[str, Any]

    @classmethod
    def read(cls, store: Store) -> Designs:
        """The designs in a study file."""
        table, about = store.table(), store.about
        constraints = {name: Constraint(text) for name, text in about["constraints"].items()}
        if constraints:
            rows = records(table)
            for name, constraint in constraints.items():
                table[name] = [constraint.is_met(row) for row in rows]
        return cls(table, about)

    @cached_property
    def successes(self) -> pd.DataFrame:
        """Designs that did not fail."""
        return self.table[self.table["status"] == "done"]

    @property
    def limit(self) -> float | None:
        """What the requirement of the base case allows to leak [m^3/s]; None if that is not one number."""
        varies = any(name.startswith("requirement.") for name in self.parameters)
        return None if varies else self.about["seal"].get("limit_m3_per_s")

    @property
    def confidence(self) -> float:
        """Probability to pass that a constraint asks for, or that is usual."""
        return self.allowed_range(PASSES)[0]

    def allowed_range(self, name: str) -> tuple[float, float]:
        """Between which values of a column a design keeps the requirement and the constraints [SI]."""
        is_rate = name.startswith("leak_rate") and name.endswith("_m3_per_s")
        low = 1.0 if name == "margin" else -math.inf
        high = self.limit if is_rate and self.limit is not None else math.inf
        for text in self.about["constraints"].values():
            constraint = Constraint(text)
            first, second = constraint.sides
            for side, opposite in ((first, second), (second, first)):
                if side.what != name or opposite.names:
                    continue
                end = opposite.number({})
                if constraint.is_met({name: end - abs(end) - 1.0}):
                    high = min(high, end)
                else:
                    low = max(low, end)
        return CONFIDENT if name == PASSES and low == -math.inf else low, high

    @property
    def parameters_at_edge(self) -> list[str]:
        """Numeric parameters at an end of whose range the best design by the only goal is."""
        best = self.best(1) if len(self.about["goals"]) == 1 else []
        ranges = {
            parameter["name"]: parameter["bounds"]
            for parameter in self.about["parameters"]
            if parameter["numeric"]
        }
        return [
            name
            for name, (low, high) in ranges.items()
            if best
            and high > low
            and not _EDGE < (self.successes[name][best[0]] - low) / (high - low) < 1.0 - _EDGE
        ]

    @property
    def feasible(self) -> pd.DataFrame:
        """Designs that did not fail and meet all constraints."""
        names = list(self.about["constraints"])
        return self.successes[self.successes[names].all(axis=1)] if names else self.successes

    @cached_property
    def validity(self) -> pd.Series:
        """How far each design that did not fail can be trusted, in words; empty in files that do not say it yet."""
        return self._texts("validity")

    @cached_property
    def verdict(self) -> pd.Series:
        """What is said of the requirement at each design that did not fail; empty where nothing was asked."""
        return self._texts("verdict")

    @property
    def verdicts(self) -> dict[str, int]:
        """How many designs pass, fail and are inconclusive; empty where nothing was asked."""
        counts = self.verdict.value_counts()
        return {str(verdict): int(counts[verdict]) for verdict in Verdict if verdict in counts}

    @property
    def worst_reason(self) -> pd.Series:
        """The first reason why a design that did not fail is not simply valid; empty if it is."""
        return self._texts("validity_reasons").str.split("; ").str[0]

    def _texts(self, name: str) -> pd.Series:
        import pandas as pd

        texts = self.successes.get(name, pd.Series("", index=self.successes.index, dtype=object))
        return texts.fillna("").astype(object)

    @property
    def is_outside(self) -> pd.Series:
        """Which designs that did not fail are outside the theory, so that nothing can be claimed of them."""
        return self.validity == Level.OUTSIDE

    @property
    def keeps_outside(self) -> bool:
        """Whether designs outside the theory count like any other."""
        return bool(self.about.get("outside_theory") == "keep")

    @cached_property
    def eligible(self) -> pd.Series:
        """Which designs that did not fail can be the best: they meet all constraints and are inside the theory."""
        counts = ~self.is_outside | self.keeps_outside
        return counts & self.successes.index.isin(self.feasible.index)

    @property
    def left_out(self) -> int:
        """How many designs meet all constraints and are left out for being outside the theory."""
        return len(self.feasible) - int(self.eligible.sum())

    @property
    def violations(self) -> pd.Series:
        """What each design that did not fail violates, in words; empty where it meets all constraints."""
        import pandas as pd

        texts = [f"{name}: {text}" for name, text in self.about["constraints"].items()]
        rows = self.successes[list(self.about["constraints"])].to_numpy(dtype=bool)
        words = [
            ", ".join(text for text, ok in zip(texts, row, strict=True) if not ok) for row in rows.tolist()
        ]
        return pd.Series(words, index=self.successes.index, dtype=object)

    @property
    def has_ineligible(self) -> bool:
        """Whether designs that did not fail violate constraints or are left out."""
        return not bool(self.eligible.all())

    @property
    def ineligibility(self) -> str:
        """What is wrong with the designs that do not count, after "designs that"."""
        reasons = ["violate a constraint"] if len(self.feasible) < len(self.successes) else []
        reasons += ["are outside the theory"] if self.left_out else []
        return " or ".join(reasons)

    @property
    def kind(self) -> str:
        """How the designs were chosen: the kind of the design, or "search" for an optimisation."""
        design = self.about["design"]
        return "search" if design["optimise"] else str(design["kind"])

    @property
    def has_distribution(self) -> bool:
        """Whether a parameter was drawn from a distribution."""
        return any(parameter["distribution"] for parameter in self.about["parameters"])

    @property
    def parameters(self) -> list[str]:
        """What varies."""
        return [str(parameter["name"]) for parameter in self.about["parameters"]]

    @property
    def numeric_parameters(self) -> list[str]:
        """Parameters that are numbers."""
        return [parameter["name"] for parameter in self.about["parameters"] if parameter["numeric"]]

    @property
    def outputs(self) -> list[str]:
        """Responses and derived columns, without those that only stand beside others."""
        companions = self.about.get("beside", ())
        return [*(name for name in self.about["responses"] if name not in companions), *self.about["derived"]]

    @cached_property
    def informative_outputs(self) -> list[str]:
        """Outputs that vary by more than round-off and are no parameter under another name."""
        inputs = [self.successes[name].to_numpy(dtype=float) for name in self.numeric_parameters]
        names = []
        for name in self.outputs:
            values = self.successes[name].to_numpy(dtype=float)
            finite = values[np.isfinite(values)]
            varies = finite.size and np.ptp(finite) > _ROUND_OFF * np.abs(finite).max()
            if varies and not any(np.allclose(values, x, rtol=_ROUND_OFF, atol=0.0) for x in inputs):
                names.append(name)
        return names

    @cached_property
    def goal_values(self) -> pd.DataFrame:
        """Goals of the designs that did not fail, one column each, as the user wrote them; may hold NaN."""
        import pandas as pd

        formulas = {name: Expression(text) for name, text in self.about["goals"].items()}
        rows = records(self.successes)
        values = {
            name: [self.sign(name) * formula(row) for row in rows] for name, formula in formulas.items()
        }
        return pd.DataFrame(values, index=self.successes.index, dtype=float)

    def sign(self, goal: str) -> float:
        """1 for a goal that is to be small, -1 for one that is to be large, which is kept with a minus sign."""
        return 1.0 if self.about["goals"][goal] == goal else -1.0

    @cached_property
    def goals(self) -> pd.DataFrame:
        """Goals of the designs that count, one column each, to be small; NaN left out."""
        signs = [self.sign(name) for name in self.about["goals"]]
        return (self.goal_values[self.eligible] * signs).dropna()

    @property
    def passes(self) -> BoolArray:
        """Which designs that did not fail keep the requirement, often enough where that is known; all without one."""
        if PASSES in self.successes:
            return (self.successes[PASSES] >= self.confidence).to_numpy()
        passing = self.verdict.isin([Verdict.PASS, Verdict.PASS_UNLESS])
        return (passing | (not self.verdicts)).to_numpy()

    @property
    def order(self) -> list[int]:
        """Numbers of the designs that did not fail: those that count and pass first, the best of them above."""
        keys = (~self.eligible).to_frame("left out").assign(fails=~self.passes)
        if self.goals.shape[1] == 2:
            keys["beaten"] = True
            keys.loc[self.goals.index, "beaten"] = ~pareto_front(self.goals.to_numpy())
        for name in self.about["goals"]:
            keys[f"goal {name}"] = self.sign(name) * self.goal_values[name]
        for name in (PASSES, "margin"):
            if name in self.successes:
                keys[name] = -self.successes[name]
        return [int(number) for number in keys.sort_values(list(keys.columns), kind="stable").index]

    def best(self, count: int) -> list[int]:
        """Numbers of the best designs: by the only goal, or the Pareto front of two by the first one.

        Of equal designs, which some plans repeat, the first one counts.
        """
        if self.goals.shape[1] == 0 or self.goals.empty:
            return []
        goals = self.goals[~self.successes.loc[self.goals.index, self.parameters].duplicated()]
        if goals.shape[1] == 2:
            goals = goals[pareto_front(goals.to_numpy())]
        return [int(number) for number in goals.sort_values(list(goals.columns)).index[:count]]


def records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Rows of a table by their columns."""
    return cast("list[dict[str, Any]]", table.to_dict("records"))


def pareto_front(goals: FloatArray) -> BoolArray:
    """Which rows are not surpassed: no other row is as small in every column and smaller in one.

    Parameters
    ----------
    goals : ndarray, shape (n, 2)

    Examples
    --------
    >>> pareto_front(np.array([[1.0, 3.0], [2.0, 2.0], [3.0, 3.0], [3.0, 1.0]])).tolist()
    [True, True, False, True]
    """
    order = np.lexsort((goals[:, 1], goals[:, 0]))
    first, second = goals[order].T
    # along rising first goal, a row stays if its second goal is below all before; equal rows stay together
    lowest_before = np.concatenate([[np.inf], np.minimum.accumulate(second)[:-1]])
    stays = second < lowest_before
    same = np.concatenate([[False], (np.diff(first) == 0) & (np.diff(second) == 0)])
    for place in np.flatnonzero(same):
        stays[place] = stays[place - 1]
    front = np.empty(len(goals), dtype=bool)
    front[order] = stays
    return front


def quantiles(values: FloatArray) -> dict[float, float]:
    """Values below which some shares of all designs lie, by the share."""
    return dict(zip(_QUANTILES, np.quantile(values, _QUANTILES).tolist(), strict=True))


def other_leak_rates(designs: Designs) -> dict[str, FloatArray]:
    """Leak rates in the scenarios beside, as far as some design has them [m^3/s]."""
    columns = {
        scenario: column for scenario in BESIDE if (column := leak_rate_column(scenario)) in designs.successes
    }
    rates_of = {
        scenario: designs.successes[column].dropna().to_numpy(dtype=float)
        for scenario, column in columns.items()
    }
    return {scenario: rates for scenario, rates in rates_of.items() if len(rates)}


def class_shares(designs: Designs) -> list[tuple[str, float, float]]:
    """Classes of the study's standard, the tightest first: name, allowed leak rate [m^3/s], share of the designs.

    A design that meets a class meets all wider ones as well; one outside the theory can claim none. A class is met if
    every scenario of the interval that the study has meets it. Empty without leak rates, or if no class of the
    standard can be judged.
    """
    from leak import leakage_limits
    from leak.standards import invisible_leak_rate

    seal = designs.about["seal"]
    if LEAK_RATE not in designs.successes or designs.successes.empty:
        return []
    leak_rate = designs.successes[LEAK_RATE].dropna()
    ends = [name for name in _UPPER_ENDS if name in designs.successes]
    # without a number of its own an end is that of the leak rate
    leak_rate = designs.successes.loc[leak_rate.index, ends].max(axis=1)
    counts = ~designs.is_outside[leak_rate.index]
    limits = {
        # of what may not be seen: what nobody sees
        limit.name: limit.leak_rate or invisible_leak_rate(gas=seal["gas"])
        for limit in leakage_limits(seal["nominal_size"], gas=seal["gas"])
        if limit.standard == designs.about["standard"]
    }
    by_size = sorted(limits.items(), key=lambda item: item[1])
    return [(name, limit, float(((leak_rate <= limit) & counts).mean())) for name, limit in by_size]


@dataclass(frozen=True)
class Sensitivity:
    """Influence of each parameter on one output.

    Parameters
    ----------
    output : str
    logarithmic : bool
        Whether the logarithm of the output was analysed, as of every output that is positive and spans a factor of ten.
    method : {"sobol-sensitivity", "morris"}
    parameters : tuple of str
    first, total : ndarray
        Sobol': first-order and total index. Morris: mean of the absolute effects and their standard deviation, in
        units of the (logarithm of the) output.
    first_error, total_error : ndarray
        Half widths of the 95 % confidence intervals; zero for the standard deviation of the effects.
    """

    output: str
    logarithmic: bool
    method: str
    parameters: tuple[str, ...]
    first: FloatArray
    total: FloatArray
    first_error: FloatArray
    total_error: FloatArray

    @property
    def influence(self) -> FloatArray:
        """How much each parameter matters."""
        return self.first if self.method == "morris" else self.total

    @property
    def order(self) -> list[int]:
        """Places of the parameters, the one that matters most first."""
        return [int(place) for place in np.argsort(-self.influence, kind="stable")]

    @property
    def noise(self) -> BoolArray:
        """Which first-order Sobol' indices are noise of the sample: above the total one, or below zero."""
        if self.method == "morris":
            return np.zeros(len(self.first), dtype=bool)
        round_off = _ROUND_OFF * self.total.max()
        return (self.first > self.total + round_off) | (self.first < -round_off)


def sensitivities(designs: Designs) -> list[Sensitivity]:
    """Sensitivity of every output; empty unless the design was made for it and all of its designs are done.

    Parameters
    ----------
    designs : Designs

    References
    ----------
    A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010); M. D. Morris, Technometrics 33, 161 (1991); J. Herman,
    W. Usher, J. Open Source Softw. 2, 97 (2017).
    """
    if designs.kind not in SENSITIVITY:
        return []
    names = tuple(designs.parameters)
    design = Design(**{key: value for key, value in designs.about["design"].items() if key != "optimise"})
    unit = unit_points(design, len(names))
    table = designs.table
    if len(table) != len(unit) or not (table["status"] == "done").all():
        return []
    results = []
    for output in designs.outputs:
        values = table[output].to_numpy(dtype=float)
        if np.all(np.isfinite(values)) and np.ptp(values) > 0:
            results.append(_sensitivity(design, names, unit, output, values))
    return results


def _sensitivity(
    design: Design, names: tuple[str, ...], unit: FloatArray, output: str, values: FloatArray
) -> Sensitivity:
    logarithmic = bool(np.all(values > 0) and values.max() > 10 * values.min())
    y = np.log(values) if logarithmic else values
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}
    if design.kind == "morris":
        from SALib.analyze import morris

        analysis = morris.analyze(problem, unit, y, num_levels=MORRIS_LEVELS, seed=design.seed)
        keys: tuple[str | None, ...] = ("mu_star", "sigma", "mu_star_conf", None)
    else:
        from SALib.analyze import sobol

        scores = (y - y.mean()) / y.std()
        analysis = sobol.analyze(problem, scores, calc_second_order=False, seed=design.seed)
        keys = ("S1", "ST", "S1_conf", "ST_conf")
    numbers = (np.zeros(len(names)) if key is None else np.asarray(analysis[key]) for key in keys)
    return Sensitivity(output, logarithmic, design.kind, names, *numbers)
