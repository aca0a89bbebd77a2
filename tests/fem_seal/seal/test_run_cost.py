"""What makes a run short and small, counted and never timed."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
import weakref
from functools import wraps

import pytest
from sample_results import case

import fem_seal
from fem_seal.__main__ import LATE_IMPORTS
from fem_seal.answers import accuracy, opening, variants
from fem_seal.answers.variants import interface_variants
from leak.flow.rough_contact import _conductivity_table


def test_a_command_spares_itself_at_its_start_and_at_its_end():
    """Before anything is loaded; and looking for circles through all objects was a quarter of a check at the end."""
    code = (
        "import gc, sys; sys.argv = ['fem-seal', 'schema']; from fem_seal.__main__ import main; "
        "code = main(); print(); print(sys.meta_path[0].__module__, "
        "gc.get_freeze_count() > 10_000, len(gc.get_objects()) < 1000); sys.exit(code)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "fem_seal.__main__ True True"


def test_other_bodies_stand_one_at_a_time_and_are_gone_when_the_run_goes_on(monkeypatch):
    """Beside those of the result: on coarser elements, in a larger housing, with another support."""
    made: list[weakref.ref[object]] = []
    alive: list[int] = []

    def count() -> int:
        return sum(model() is not None for model in made)

    condensed, margins = accuracy.condense_bodies, opening.with_margins

    @wraps(condensed)
    def counted(*asked):
        alive.append(count())
        model = condensed(*asked)
        made.append(weakref.ref(model))
        return model

    def go_on(*asked):
        assert count() == 0
        return margins(*asked)

    monkeypatch.setattr(accuracy, "condense_bodies", counted)
    monkeypatch.setattr(opening, "with_margins", go_on)
    result = fem_seal.run(case(load={"fluid_pressure": "5 bar"}))
    assert len(result.far_field) == 2
    # on coarser elements stands while the other two are compared with it
    assert alive == [0, 1, 1]
    assert not result.warnings or "could not be calculated" not in " ".join(result.warnings)


@pytest.mark.slow
def test_the_comparison_of_laws_needs_no_table_of_its_own(monkeypatch):
    """The contact with the other law lies within the pressures for which the loads have their tables."""
    made: list[int] = []

    def compared(*asked):
        before = _conductivity_table.cache_info().misses
        found = interface_variants(*asked)
        made.extend([before, _conductivity_table.cache_info().misses - before])
        return found

    monkeypatch.setattr(variants, "interface_variants", compared)
    _conductivity_table.cache_clear()
    first, second = fem_seal.run(
        case(load={"fluid_pressure": ["2 bar", "20 bar"]}), full=True
    ).interface_variants
    of_the_loads, of_the_comparison = made
    assert of_the_loads >= 3
    assert of_the_comparison == 0
    assert first.leak_rate != second.leak_rate


def test_the_shapes_of_a_case_are_made_once():
    one = case()
    assert one.bodies is one.bodies
    # of a case that changes something else, too, but not of one with another seat
    assert one.replace({"load.fluid_pressure": "7 bar"}).bodies is one.bodies
    harder = one.replace({"seat.material.hardness": "4 GPa"})
    assert harder.bodies is one.bodies and harder.hardness == pytest.approx(4e9)
    assert one.replace({"seat.angle": "40 deg"}).bodies[1] != one.bodies[1]


_DRAWN = """
import json, sys, types
from fem_seal.__main__ import LATE_IMPORTS, postpone_unused_imports
if sys.argv[1] == "command":
    postpone_unused_imports()
import scipy.special
from matplotlib.artist import ArtistInspector
from fem_seal.output.pictures.style import label, panels, style, svg
with style():
    figure, (axes,) = panels(1)
    axes.plot([1.0, 2.0], [3.0, 4.0], label="line")
    axes.legend()
    label(axes, "title", "x", "y")
    drawing = svg(figure).decode()
line = axes.lines[0]
try:
    refused = line.set(no_such_property=1)
except AttributeError as error:
    refused = str(error)
print(json.dumps({
    "drawing": drawing,
    "refused": refused,
    "properties": ArtistInspector(line).get_setters(),
    "erf": scipy.special.erf([0.5]).tolist(),
    "waiting": [name for name in sorted(LATE_IMPORTS) if type(sys.modules.get(name)) is not types.ModuleType],
    "explained": "markersize" in (type(line).set.__doc__ or ""),
    "used later": sys.modules["numpy.testing"].assert_equal.__name__,
}))
"""


@pytest.mark.slow
def test_a_command_is_spared_what_no_command_uses_and_draws_the_same():
    """Modules that cost a twelfth of a run; whoever uses fem_seal as a library has them all."""
    command, library = (
        json.loads(
            subprocess.run(
                [sys.executable, "-c", _DRAWN, whose],
                capture_output=True,
                text=True,
                timeout=120,
                check=True,
            ).stdout
        )
        for whose in ("command", "library")
    )
    assert (command.pop("waiting"), library.pop("waiting")) == (sorted(LATE_IMPORTS), [])
    assert (command.pop("explained"), library.pop("explained")) == (False, True)
    assert command == library
    assert "no_such_property" in command["refused"]
    assert len(command["properties"]) > 30


def test_a_spectrum_loads_no_readers_of_scans():
    code = (
        "import sys, leak; leak.PowerSpectrum, leak.RoughContact; "
        "print([name for name in sys.modules if 'scan' in name and name.startswith('leak')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True
    )
    assert done.stdout == "[]\n"


HELD = {
    "gas in two readings": {"fluid": {"name": "nitrogen"}, "requirement": {"leak_rate": "1 ml/min"}},
    "form": {"form": {"seat": {"harmonics": [{"waves": 2, "amplitude": "2 um"}]}}},
    "target": {"load": {"fluid_pressure": "20 bar", "target_leak_rate": "1 ml/min"}},
}


@pytest.mark.slow
@pytest.mark.parametrize("what", HELD)
def test_a_result_is_gone_once_nobody_asks_for_it(what):
    """Nothing of it holds itself, so that its memory does not wait for the garbage collector."""
    asked = case(**{"load": {"fluid_pressure": ["5 bar", "20 bar"]}, **HELD[what]})
    # what is loaded and worked out once for all cases
    assert len(fem_seal.run(asked).table)
    gc.collect()
    gc.disable()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        result = fem_seal.run(asked)
        assert len(result.table)
        gone = weakref.ref(result)
        del result
        assert gone() is None
        gc.collect()
        left = {type(one).__qualname__ for one in gc.garbage if _is_ours(one)}
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
        gc.enable()
    assert left == set()


def _is_ours(one: object) -> bool:
    return type(one).__module__.partition(".")[0] in ("fem_seal", "leak")


@pytest.mark.skipif(sys.platform != "linux", reason="the reserve is one of Linux's C library")
def test_free_memory_goes_back_to_the_system():
    code = (
        "from fem_seal.processes import returned_memory\n"
        "def resident():\n"
        "    with open('/proc/self/statm') as file: return int(file.read().split()[1]) * 4096 / 2**20\n"
        "before = resident()\n"
        "with returned_memory():\n"
        "    many = [bytearray(100_000) for _ in range(2000)]; above = bytearray(100_000); del many\n"
        "    kept = resident() - before\n"
        "print(kept, resident() - before)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    kept, left = map(float, done.stdout.split())
    assert kept > 150
    assert left < 20
