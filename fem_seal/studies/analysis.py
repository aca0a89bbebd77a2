"""What the designs of a study say: which are good, which are best, how the leak rate is distributed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from fem_seal.studies.expressions import Constraint, Expression

if TYPE_CHECKING:
    import pandas as pd

    from fem_seal.studies.store import Store

FloatArray = NDArray[np.float64]

LEAK_RATE = "leak_rate_m3_per_s"
QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)


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
            for name, one in constraints.items():
                table[name] = [one.met(row) for row in rows]
        return cls(table, about)

    @cached_property
    def done(self) -> pd.DataFrame:
        """Designs that did not fail."""
        return self.table[self.table["status"] == "done"]

    @cached_property
    def feasible(self) -> pd.DataFrame:
        """Designs that did not fail and meet all constraints."""
        names = list(self.about["constraints"])
        return self.done[self.done[names].all(axis=1)] if names else self.done

    @property
    def numeric_parameters(self) -> list[str]:
        """Parameters that are numbers."""
        return [one["name"] for one in self.about["parameters"] if one["numeric"]]

    @property
    def outputs(self) -> list[str]:
        """Responses and derived columns."""
        return [*self.about["responses"], *self.about["derived"]]

    @cached_property
    def goals(self) -> pd.DataFrame:
        """Goals of the feasible designs, one column each, to be small; NaN left out."""
        import pandas as pd

        formulas = {name: Expression(text) for name, text in self.about["goals"].items()}
        rows = records(self.feasible)
        values = {name: [one(row) for row in rows] for name, one in formulas.items()}
        return pd.DataFrame(values, index=self.feasible.index, dtype=float).dropna()

    def best(self, count: int) -> list[int]:
        """Numbers of the best designs: by the only goal, or the Pareto front of two by the first one."""
        if self.goals.shape[1] == 0 or self.goals.empty:
            return []
        goals = self.goals if self.goals.shape[1] == 1 else self.goals[pareto_front(self.goals.to_numpy())]
        return [int(number) for number in goals.sort_values(list(goals.columns)).index[:count]]


def records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Rows of a table by their columns."""
    return cast("list[dict[str, Any]]", table.to_dict("records"))


def pareto_front(goals: FloatArray) -> NDArray[np.bool_]:
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


def quantiles(values: FloatArray, shares: Sequence[float] = QUANTILES) -> dict[float, float]:
    """Values below which the given shares of all designs lie.

    Parameters
    ----------
    values : ndarray
    shares : sequence of float
    """
    return dict(zip(shares, np.quantile(values, shares).tolist(), strict=True))


def class_shares(designs: Designs) -> list[tuple[str, float, float]]:
    """Classes of the study's standard, the tightest first: name, allowed leak rate [m^3/s], share of the designs.

    A design that meets a class meets all wider ones as well. Empty without leak rates, or if no class of the standard
    can be judged.
    """
    from leak import leakage_limits

    seal = designs.about["seal"]
    if LEAK_RATE not in designs.done or designs.done.empty:
        return []
    leak_rate = designs.done[LEAK_RATE].dropna().to_numpy()
    limits = {}
    for limit in leakage_limits(seal["nominal_size"], gas=seal["gas"]):
        if limit.standard == designs.about["standard"]:
            limits[limit.name] = limit.leak_rate
    ordered = sorted(limits.items(), key=lambda item: item[1])
    return [(name, most, float((leak_rate <= most).mean())) for name, most in ordered]
