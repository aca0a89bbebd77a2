"""Time from a moved slider to what the live page shows of it, on the side of the server.

    python benchmarks/bench_explore.py [CASE.toml ...] [--moves N]

For each slider the median and the largest processor time of some moves in a row, each to a value that was not there
before, as a hand moves it, with the tables that the page makes ahead while a slider rests. Processor time, so that what
else runs on the machine does not count.
"""

import argparse
import json
import statistics
import time
from pathlib import Path

from fem_seal.case.case import load_case
from fem_seal.explore.choices import apply_choice, choices_of
from fem_seal.explore.factors import Factor
from fem_seal.explore.figures import designs_shown, figures
from fem_seal.explore.session import Session

EXAMPLES = Path(__file__).parent.parent / "examples"
DEFAULT = [EXAMPLES / f"{name}.toml" for name in ("ball_cone", "helium", "poppet_on_land")]


def time_designs(session: Session, designs: list[dict[str, str]]) -> list[float]:
    """Processor time of each answer with its pictures [ms]."""
    times = []
    for design in designs:
        start = time.process_time()
        screen = session.answer(design)
        for figure in figures(designs_shown(screen, []), dark=False).values():
            json.dumps(figure.plain())
        times.append(1e3 * (time.process_time() - start))
        if screen.problem:
            print(f"    {design}: {screen.problem}")
    return times


def moves(factor: Factor, count: int) -> list[dict[str, str]]:
    """Designs of a slider that goes to the right from where it stands."""
    return [{factor.key: text} for text in factor.stops[factor.place + 1 : factor.place + 1 + count]]


def measure(path: Path, count: int) -> None:
    """Print the times of one case."""
    case = load_case(path)
    start = time.process_time()
    session = Session(case)
    time_designs(session, [{}])
    print(f"{path.stem}: first answer {time.process_time() - start:.2f} s")
    for factor in session.factors.sliders:
        designs = moves(factor, count)
        if factor.group == "surface":
            for design in designs:
                session.answer(design)
        show(factor.label, time_designs(session, designs))
    force = next(factor for factor in session.factors.sliders if factor.key == "force")
    choices = {choice.key: choice.value for choice in choices_of(case)["surface"]}
    for name in ("water", "nitrogen"):
        if name != choices.get("fluid.name", name):
            start = time.process_time()
            other_session = Session(apply_choice(case, "fluid.name", name))
            time_to_open = 1e3 * (time.process_time() - start)
            first, *more_times = time_designs(other_session, [{}, {"force": force.stops[-1]}])
            print(f"    fluid {name}: first time {time_to_open + first:.0f} ms, then {more_times[0]:.0f} ms")


def show(label: str, times: list[float]) -> None:
    """Print a line."""
    if times:
        print(f"    {label}: median {statistics.median(times):.0f} ms, largest {max(times):.0f} ms")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", type=Path, default=DEFAULT)
    parser.add_argument("--moves", type=int, default=8)
    options = parser.parse_args()
    for case_file in options.cases:
        measure(case_file, options.moves)
