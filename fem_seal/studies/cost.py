"""Cost of a design by its requested columns."""

from __future__ import annotations

from collections.abc import Collection

from fem_seal.case.case import Case
from fem_seal.seal.cost import OWN, load_seconds, seconds

# What takes the interval of the leak rate, and with it what the calculation may be off by.
INTERVAL = frozenset(
    {"leak_rate_low_m3_per_s", "leak_rate_p50_m3_per_s", "leak_rate_high_m3_per_s", "margin"}
)
FORCE_FOR_VERDICT = "force_for_verdict_N"
# What takes the share of the samples that keep the requirement.
PASS_COLUMNS = frozenset({"pass_probability", "pass_probability_error", "batch_share_p05"})
# A sample of uncertain inputs [s]; forces that are tried for a target, and runs for a verdict.
_SAMPLE, _FORCES, _RUNS = 0.02, 12, 6
# Samples that are calculated for that share, of five inputs.
_FOR_SHARE = 15


def is_target(column: str) -> bool:
    """Whether a column takes the search for the force with which a target leak rate is kept."""
    return "_for_target" in column


def is_of_bolts(column: str) -> bool:
    """Whether a column takes the state of the bolts."""
    return column.startswith("bolt_") or "_preload_" in column or column in INTERVAL


def design_seconds(case: Case, columns: Collection[str]) -> float:
    """Estimated processor time of a design and of the answers that its columns need [s], good to a factor of three.

    Parameters
    ----------
    case : Case
        With one load.
    columns : collection of str
        Of leak.csv.
    """
    verdict = FORCE_FOR_VERDICT in columns
    has_samples = case.sampling is not None and (verdict or not INTERVAL.isdisjoint(columns))
    samples = 0 if case.sampling is None or not has_samples else case.sampling.samples
    if case.sampling is not None and not PASS_COLUMNS.isdisjoint(columns):
        samples += _FOR_SHARE
    load_time = seconds(case) + _SAMPLE * samples + (OWN if has_samples else 0.0)
    target = case.load.target_leak_rate is not None
    forces = (
        OWN + _FORCES * load_seconds(case) if target and (verdict or any(map(is_target, columns))) else 0.0
    )
    return forces + load_time * (_RUNS if target and verdict else 1)
