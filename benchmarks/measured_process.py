"""Run a program and measure it: wall time, processor time and peak memory of the program alone."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

# Linux hands the peak memory of whoever starts a program on to it; this starter needs some 10 MB only.
_STARTER = """
import json, os, sys, time
log, *command = sys.argv[1:]
output = [(os.POSIX_SPAWN_OPEN, 1, log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644), (os.POSIX_SPAWN_DUP2, 1, 2)]
start = time.perf_counter()
_, status, used = os.wait4(os.posix_spawnp(command[0], command, os.environ, file_actions=output), 0)
wall = time.perf_counter() - start
print(json.dumps([os.waitstatus_to_exitcode(status), wall, used.ru_utime + used.ru_stime, used.ru_maxrss]))
"""


@dataclass(frozen=True)
class Cost:
    """What a program took.

    Parameters
    ----------
    wall : float
        From start to end [s].
    processor : float
        Processor time of all threads [s]; other programs on the machine disturb it less than the wall time.
    memory : float
        Peak resident memory [MB].
    """

    wall: float
    processor: float
    memory: float


def measure_process(
    command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
) -> Cost:
    """Run a command in a folder; what it prints goes to `printed.log` there.

    Raises
    ------
    RuntimeError
        If the command fails, with the end of what it printed.
    """
    log = folder / "printed.log"
    answer = subprocess.run(
        [sys.executable, "-I", "-S", "-c", _STARTER, str(log), *command],
        cwd=folder,
        env={**os.environ, **(environment or {})},
        capture_output=True,
        text=True,
        check=True,
    )
    code, wall, processor, kilobytes = json.loads(answer.stdout)
    if code != 0:
        raise RuntimeError(
            f"{' '.join(command)} ended with {code}:\n{log.read_text(errors='replace')[-2000:]}"
        )
    return Cost(wall, processor, kilobytes / 1024)
