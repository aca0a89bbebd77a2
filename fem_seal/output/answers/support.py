"""What supports the leak rate of a result: simulation and measurements, and what the other theory gives."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.answers.case_load import rate_of
from fem_seal.answers.leakage_class import volume_of
from fem_seal.wording import say

if TYPE_CHECKING:
    from fem_seal.answers.case_load import CaseLoad
    from fem_seal.answers.solution import SealSolution

# Share of the leak rate of elastic asperities that the paper measured, and how near a result is told to be like it.
_MEASURED, _NEAR = 1 / 8, 0.1


def is_by_paper(load: CaseLoad) -> bool:
    """Whether the leak rate is told as the paper's number and not as its interval.

    Parameters
    ----------
    load : CaseLoad
    """
    # one that is sealed alone is told with its upper bound
    told = load.leak is not None and load.leak.leak_rate > 0.0 and not load.validity.outside
    return told and "paper" in load.names and load.sampled is None


def theory_in_brief(result: SealSolution) -> Iterator[str]:
    """What the leak rate by the paper's theory means, and that of the default theory; nothing by that one.

    Parameters
    ----------
    result : SealSolution
    """
    case, load = result.case, result.highest
    if not is_by_paper(load) or load.leak is None:
        return
    volume = volume_of(case)
    elastic, upper = load.scenario("elastic"), load.leak_range
    if elastic is not None and elastic.leak is not None and elastic.leak.leak_rate > 0.0:
        share = load.leak.leak_rate / elastic.leak.leak_rate
        if abs(share / _MEASURED - 1.0) < _NEAR and upper is not None:
            bound = case.display.leak_range(upper.high, 2, beside=(upper.low,), volume=volume)
            yield say(case.display, "support", "measured", bound=bound)
    default = load.scenario("corrected")
    if default is not None and default.leak is not None:
        rate = case.display.leak_range(rate_of(default), 2, volume=volume)
        yield say(case.display, "support", "default", rate=rate)


def supported_by(result: SealSolution) -> list[str]:
    """The line that names simulation and measurements; none where no leak rate is claimed.

    Parameters
    ----------
    result : SealSolution
    """
    load = result.highest
    if load.leak is None or load.validity.outside:
        return []
    theories = [name for name in ("paper", "corrected") if name in load.names]
    support = "test" if load.tested else theories[0] if theories else "direct"
    return [say(result.case.display, "support", support)]
