"""Fixtures that several test files share."""

from __future__ import annotations

import gc
import os
import sys
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from functools import cache
from pathlib import Path

import hypothesis
import numpy as np
import pytest
import typer.main
import warm_process
from made_once import MadeOnce
from places import REFERENCE, SHARED

from leak import TabulatedLaw

# pytest.approx(..., rel=...) lets 1e-12 pass besides: as much as all of a leak rate in m^3/s or of a compliance in m/N.
type(pytest.approx(1.0)).DEFAULT_ABSOLUTE_TOLERANCE = 0.0
assert pytest.approx(1e-13) != 2e-13

# The same code gets the same verdict every time; HYPOTHESIS_PROFILE=default looks for new examples.
hypothesis.settings.register_profile("repeatable", derandomize=True)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))

# All that is loaded while tests are collected stays: looking for what could go is a fifth of the time.
gc.disable()

# Files whose tests are long and share nothing but what is quickly made again: each of their tests goes to whichever
# process is free. All other files stay whole, with what their fixtures have made.
APART = (
    "tests/system/test_examples.py",
    "tests/fem_seal/answers/test_uncertainty.py",
    "tests/verification/test_contact.py",
)

# Files that share what is too dear to be had in several processes: results, and CoolProp, which takes seconds to load.
TOGETHER = {
    "tests/fem_seal/output/test_around_report.py": "tests/fem_seal/output/test_around_files.py",
    **{
        f"tests/{name}.py": "CoolProp"
        for name in (
            "fem_seal/seal/test_fluid",
            "fem_seal/answers/test_leak_map",
            "leak/test_fluids",
            "leak/test_gases",
            "leak/test_pressure_law",
            "leak/test_real_gas",
        )
    },
}

# Files whose tests mostly wait, for clusters that start and designs that never end. They come first and one after the
# other, so that one process waits while the others compute.
WAITING = (
    "tests/fem_seal/studies/test_faults.py",
    "tests/fem_seal/studies/test_processes.py",
    "tests/system/test_cluster_recipes.py",
    "tests/fem_seal/explore/test_browser.py",
)


@pytest.hookimpl(wrapper=True)
def pytest_collect_file() -> Generator[None, list[pytest.Collector], list[pytest.Collector]]:
    """Files of tests hold no examples of their own: nobody looks for any in them."""
    found = yield
    return [one for one in found if type(one) is pytest.Module]


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Each of several processes begins with another file, so that most files are compiled by one of them only."""
    report = yield
    if isinstance(collector, pytest.Directory) and report.passed:
        process = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
        first = process * len(report.result) // int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
        report.result = [*report.result[first:], *report.result[:first]]
    return report


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files that wait come first, then those of many tests; what fills the gaps at the end comes last."""
    tests = Counter(_file(one.nodeid) for one in items)

    def place(item: pytest.Item) -> tuple[int, int, str]:
        file = _file(item.nodeid)
        return (-1 if file in WAITING else int(file in APART)), -tests[file], file

    items.sort(key=place)


def _file(test: str) -> str:
    return test.split("::", 1)[0]


def pytest_collection_finish() -> None:
    """Keep the collector of cycles off what stays to the end: modules, tests and the results that tests share.

    With its usual thresholds it goes through all of them thousands of times, most often while pictures are drawn.
    """
    gc.freeze()
    gc.set_threshold(50_000, 20, 50)
    gc.enable()


@pytest.fixture(scope="session", autouse=True)
def made_once() -> Iterator[MadeOnce]:
    """Meshes and condensed bodies are made once for each file of tests, not once for each run of the same seal."""
    with pytest.MonkeyPatch.context() as patch:
        made = MadeOnce()
        made.patch(patch)
        yield made


@pytest.fixture
def made_anew(made_once: MadeOnce, monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything is made each time, for tests of how it is made."""
    monkeypatch.setattr(made_once, "keeps", False)


@pytest.fixture(scope="module", autouse=True)
def forgotten_afterwards(request: pytest.FixtureRequest, made_once: MadeOnce) -> Iterator[None]:
    """Results that the tests of one file share go with it: kept to the end they are gigabytes."""
    yield
    made_once.forget()
    for thing in vars(request.module).values():
        if hasattr(thing, "cache_clear") and thing.__module__ == request.module.__name__:
            thing.cache_clear()
    gc.collect()
    # what is left stays: the next file need not look through it again
    gc.freeze()


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int | None:
    """With ``-n auto`` a process for each core, and one that waits."""
    if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ:
        return None
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return (cores or 1) + 1


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """Tests by file, those that wait as one, those of some files one by one."""
    if config.getoption("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    # the order is that of `pytest_collection_modifyitems`
    config.option.loadscopereorder = False

    class Scheduling(LoadFileScheduling):  # type: ignore[misc]
        def _split_scope(self, nodeid: str) -> str:
            file = _file(nodeid)
            if file in WAITING:
                return "waiting"
            return nodeid if file in APART else TOGETHER.get(file, file)

    return Scheduling(config, log)


@pytest.fixture(scope="session")
def reference_folder() -> Path:
    """Folder with the independent reference numbers; tests/reference unless FEM_SEAL_REFERENCE says where."""
    return Path(os.environ.get("FEM_SEAL_REFERENCE", REFERENCE))


@pytest.fixture(scope="session")
def reference(reference_folder: Path) -> Callable[[str], np.ndarray]:
    """Reads a table of reference numbers by the name of its file; its columns go by their headings."""
    return lambda name: np.genfromtxt(
        reference_folder / name, delimiter=",", names=True, dtype=None, encoding="utf8"
    )


@pytest.fixture(autouse=True, scope="session")
def warm_processes() -> Iterator[None]:
    """What is called apart runs in copies of a process that has loaded VTK and the readers of drawings.

    `tests/meshes/test_own_process.py` tests the processes themselves, which load everything anew.
    """
    with pytest.MonkeyPatch.context() as patch:
        if sys.platform == "linux":
            patch.setattr("meshes.own_process.subprocess", warm_process)
        yield


@pytest.fixture(autouse=True, scope="session")
def commands_made_once() -> Iterator[None]:
    """Commands and their options are put together once for all tests, as a process does that calls one."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("typer.main.get_command", cache(typer.main.get_command))
        yield


@pytest.fixture
def read_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawings and meshes are read in this process, for tests of what a sound file holds.

    A process of its own, as everywhere else, is for files that hang, crash or print: see
    `tests/meshes/test_own_process.py`, the damaged files, and every case that names a drawing.
    """
    for module in ("section", "meshed_body"):
        monkeypatch.setattr(
            f"meshes.drawings.{module}.run_in_subprocess", lambda limit, read, *given: read(*given)
        )


@pytest.fixture
def unrendered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are made as always but not turned into SVG, for tests of files and sentences, not of pictures."""
    monkeypatch.setattr("fem_seal.output.pictures.style._drawn", lambda figure: b"<svg></svg>")


@pytest.fixture
def greenwood_williamson(reference: Callable[[str], np.ndarray]) -> TabulatedLaw:
    """The tabulated law of the reference."""
    table = reference("law_greenwood_williamson.csv")
    return TabulatedLaw(table["gap_m"], table["pressure_Pa"])


@pytest.fixture(scope="session")
def topography_folder() -> Path:
    """Folder with files of real instruments, next to the repository unless FEM_SEAL_TOPOGRAPHY says where."""
    folder = Path(os.environ.get("FEM_SEAL_TOPOGRAPHY", SHARED / "topography"))
    if not folder.is_dir():
        pytest.skip(f"instrument files are not at {folder}; set FEM_SEAL_TOPOGRAPHY to their folder")
    return folder
