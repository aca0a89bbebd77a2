"""Fixtures that several test files share."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterator
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


@pytest.fixture(scope="session", autouse=True)
def no_user_cache() -> Iterator[None]:
    """Nothing is read from the cache folder of whoever runs the tests, and nothing written to it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FEM_SEAL_CACHE", "")
        yield


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
    monkeypatch.setattr("fem_seal.output.pictures.style._render", lambda figure: b"<svg></svg>")


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
