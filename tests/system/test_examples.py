"""Every file in examples/ does what it says."""

import importlib.util
import re
import tomllib

import gallery
import pytest
from places import EXAMPLES

from fem_seal import load_case, run
from fem_seal.answers.closed_forms import derive
from fem_seal.cli.terminal import show_result, warn
from fem_seal.output.report.brief import loads_in_brief, remarks_in_brief
from fem_seal.output.report.page import report

CASES = sorted(EXAMPLES.glob("*.toml"))

# What each script checks, with its tolerance and why.
SCRIPTS = {
    # both equations of the stretched medium solved by nested bisection over P(u) on another grid, and the trapezoidal
    # sum of their resistance over x
    "lay.py": (3.8469, 0.003),
    # a closed form; second-order steps
    "fluid_opens_the_gap.py": (1.0, 1e-5),
    # the Hurst exponent that was put into the scan; its standard error from one scan of 4 mm is 0.02
    "make_seat_scan.py": (0.6, 0.06),
    # the paper says "about 8"; theory with the spectrum of the example, from an independent calculation, 8.1
    "leak_of_a_given_profile.py": (8.1, 0.1),
    # 61.6678 MPa of the exact crossover (independent boundary elements) over Hertz, sqrt(E* f_N / (pi R)) by
    # hand
    "how_wide_is_the_contact.py": (61.6678 / 191.646, 1e-5),
}


def test_every_script_is_checked():
    assert {path.name for path in EXAMPLES.glob("*.py")} == set(SCRIPTS)


@pytest.mark.parametrize("name", SCRIPTS)
def test_script(name):
    spec = importlib.util.spec_from_file_location(name.removesuffix(".py"), EXAMPLES / name)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    number, tolerance = SCRIPTS[name]
    assert script.main() == pytest.approx(number, abs=tolerance)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.name)
def test_case_is_valid_and_says_what_it_is(path):
    case = load_case(path)
    assert case.title
    assert tomllib.loads(path.read_text())["title"] == case.title
    assert all(load.contact_force > 0 for load in derive(case).loads)


@pytest.mark.slow
@pytest.mark.parametrize("path", CASES, ids=lambda path: path.name)
def test_case_runs_and_is_resolved(path, capsys):
    result = run(load_case(path))
    _is_told_in_brief(result, capsys)
    _has_the_columns_that_belong_to_it(result)
    assert len(result.loads) == len(result.case.load.points)
    for load in result.loads:
        assert abs(load.contact.force_error) < 1e-9
        assert load.leak is None or 0 <= load.leak.leak_rate < float("inf")
        # both readings of asperities that yield lie around the one that is told as a single number
        assert (load.leak_range is not None) == (load.leak is not None and len(result.surface.readings) > 1)
    for load, ends in zip(result.loads, result.leak_ranges, strict=True):
        assert ends is None or ends[0] <= load.leak.leak_rate <= ends[1]
    # the load steps of a body that yields leave a per cent, elements a few parts in ten thousand
    assert result.discretisation_error.peak_pressure < (1e-2 if result.unloaded_bodies else 5e-4)
    _is_read_in_minutes(report(result))
    # the manual shows what is solved here
    assert (gallery.keep(result, path) / "report.html").exists()


def _is_read_in_minutes(page):
    """Words of the short report with and without what is folded, pictures, and the size of the file."""
    body = re.sub(r"<(style|title)>.*?</\1>", "", page, flags=re.DOTALL)
    unfolded = re.sub(r"<details>.*?</details>", "", body, flags=re.DOTALL)
    texts = (re.sub(r"<[^>]+>", " ", text).split() for text in (unfolded, body))
    seen, every = (sum(bool(re.search(r"\w", word)) for word in text) for text in texts)
    assert seen <= 750 and every <= 1200
    assert body.count("<img") <= 5 and len(page) <= 600_000


# Columns that are filled whatever the case: the other theory, and what repeats the leak rate and its gap.
REPEATED = {
    "leak_rate_paper_m3_per_s",
    "leak_rate_corrected_m3_per_s",
    "leak_rate_elastic_m3_per_s",
    "leak_rate_crests_m3_per_s",
    "critical_separation_elastic_m",
}
# A sealed load has no interval.
NO_INTERVAL = {"leak_rate_low_m3_per_s", "leak_rate_high_m3_per_s"}


def _has_the_columns_that_belong_to_it(result):
    """What was calculated, which is not asked when the columns are chosen, fills them and no others."""
    every = result.all_columns
    filled = {name for name in every if (every[name].notna() & (every[name] != "")).any()}
    assert filled - {*result.table} <= REPEATED
    empty = {*result.table} - filled
    # a valid load has no reasons
    assert ("validity_reasons" in empty) == (set(result.table["validity"]) == {"valid"})
    empty -= {"validity_reasons"}
    assert not empty or (empty <= NO_INTERVAL and all(load.leak.leak_rate == 0 for load in result.loads))


def _is_told_in_brief(result, capsys):
    """The verdict first, what decides it, at most six columns; all of it in lines of 80 characters."""
    show_result(result, details=False)
    warn(remarks_in_brief(result), "report.html")
    said = capsys.readouterr()
    verdict, second, *rest = said.out.splitlines()
    assert re.match(r"(Pass|Fail|Inconclusive|Leaks|Sealed|After the leak test|At) ", verdict)
    assert second
    table, left_out = loads_in_brief(result.case, result.loads)
    assert 2 <= len(table.headings) <= 6
    assert len(table.rows) + left_out == len(result.loads) and len(table.rows) <= 8
    # every cell is whole
    printed = " ".join(rest).split()
    assert all(set(cell.split()) <= set(printed) for row in table.rows for cell in row)
    assert said.err.count("warning: ") <= 4
    show_result(result, details=True)
    everything = capsys.readouterr().out
    assert everything.startswith(verdict)
    assert max(map(len, (said.out + said.err + everything).splitlines())) <= 80


def test_the_main_example_is_the_case_of_the_paper():
    case = load_case(EXAMPLES / "ball_cone.toml")
    derived = derive(case)
    last = derived.loads[-1]
    # Fischer et al.: F_N = 1260 N (rounded), f_N = 20 kN/m, E* = 115 GPa, half-width 0.07 mm at 20 bar
    assert last.fluid_pressure == 20e5
    assert last.contact_force == pytest.approx(1256.6, abs=0.1)
    assert last.line_load == pytest.approx(20e3, rel=1e-12)
    assert derived.effective_modulus == pytest.approx(115.38e9, rel=1e-4)
    assert derived.hardness == 3.5e9
    # rms slope 0.4 for wavelengths above 2 um, as the paper measured it
    assert derived.rms_slope == pytest.approx(0.4, abs=2e-3)
    # sqrt(E* f_N / (pi R)) by hand; the paper's 181 MPa is a misprint
    assert last.hertz.peak_pressure == pytest.approx(191.646e6, rel=1e-5)
    assert last.hertz.half_width == pytest.approx(0.0664e-3, rel=1e-3)
