"""Report, terminal and findings of one case have the units of one system, but for what sources and standards say."""

from __future__ import annotations

import html
import re
from pathlib import Path

import pytest

from fem_seal.case.case import load_case, write_case
from fem_seal.cli.app import main
from fem_seal.output.answer_output import prose
from fem_seal.output.direct import shown_rows
from fem_seal.output.library import fluid_cells, fluid_rows, material_cells, material_rows
from fem_seal.seal.findings import caution
from fem_seal.units import Display

EXAMPLES = Path(__file__).parents[3] / "examples"
# a throughput in SI stands beside that of every system
_END = r"(?![\w³/·*^-]| m³)"
FOREIGN = {
    "US": r"\d ?(?:m?bar|[MGk]?Pa|[kM]?N|N/mm|[kM]?N/m|[mun]m|µm|[mµn]?l|[mµn]?l/min|mm³/s|mbar l/s|degC|°C|mPa s)",
    "SI": r"\d ?(?:m?bar|mbar l/s|[mµn]?l/min|psi|ksi|lbf|in|[uµ]in|lbf/in|°F|degF|in³/h|atm cm³/s)",
    "field": r"\d ?(?:psi|ksi|lbf|in|[uµ]in|lbf/in|°F|degF|cP|in³/h|in³/min|atm cm³/s|ft lbf)",
}
# Sources and conditions of the library in their own words, tests of standards, the state of a standard volume.
_OF_OTHERS = re.compile(
    "IAPWS|ISO 3448|Thermophys|Lubrication|from memory|secondary:|asme.org| H(?:V|B|RC)\\b|piping-world|101325 Pa"
)


def lines_of(page: str) -> list[str]:
    """Texts of a report without its pictures."""
    page = re.sub(r"(?s)<(style|script|svg)[^>]*>.*?</\1>", "", page)
    return [
        line.strip()
        for line in html.unescape(re.sub(r"<[^>]+>", "\n", page.replace("\xa0", " "))).splitlines()
    ]


def foreign(lines: list[str], system: str) -> list[str]:
    """Lines with a number in a unit of another system."""
    unit = re.compile(FOREIGN[system] + _END)
    return [line for line in dict.fromkeys(lines) if unit.search(line) and not _OF_OTHERS.search(line)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("example", "system"),
    [
        ("ball_cone", "US"),
        ("helium", "US"),
        ("copper_ring", "US"),
        ("double_land", "US"),
        ("diesel_1800_bar", "US"),
        ("helium", "SI"),
        ("double_land", "SI"),
        ("helium", "field"),
    ],
)
def test_a_run_speaks_in_the_units_of_its_case(example, system, tmp_path, capsys):
    case = load_case(EXAMPLES / f"{example}.toml").replace({"report.units": system})
    file = write_case(case.written, tmp_path, example)
    capsys.readouterr()
    assert main(["run", str(file), "-o", str(tmp_path / "out"), "--details"]) == 0
    said = capsys.readouterr()
    # lines that are broken are one again
    terminal = re.sub(r"\n +", " ", (said.out + said.err).replace(str(tmp_path), "")).splitlines()
    title = str(case.title)
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    lines = [line.replace(title, "") for line in (*terminal, *lines_of(page))]
    assert foreign(lines, system) == []


@pytest.mark.slow
def test_a_study_speaks_in_the_units_of_its_case(tmp_path, capsys):
    changes = {
        "report.units": "US",
        "load.fluid_pressure": "10 bar",
        "requirement.leak_rate": "1 ml/min",
        "mesh.contact_size": "0.1 mm",
    }
    write_case(load_case(EXAMPLES / "ball_cone.toml").replace(changes).written, tmp_path, "case")
    (tmp_path / "study.toml").write_text(
        'base = "case.toml"\nresponses = ["leak_rate_m3_per_s", "peak_pressure_Pa", "line_load_N_per_m"]\n'
        '[parameters]\n"closure.radius" = ["19 mm", "20 mm"]\n[report]\n'
        'goals = { leak_rate_m3_per_s = "min" }\n'
    )
    assert main(["study", str(tmp_path / "study.toml"), "--workers", "1"]) == 0
    said = capsys.readouterr().out
    page = (tmp_path / "study.study" / "report.html").read_text(encoding="utf-8")
    # headings have the unit in brackets, axes of the plots too
    headings = re.findall(
        r"\[([^\[\]<>\"]{1,12})\]", said + re.sub(r"(?s)<script[^>]*>.{200000,}?</script>", "", page)
    )
    assert {"ksi", "in", "lbf/in"} <= set(headings)
    assert {"MPa", "bar", "mm", "N/m", "N/mm", "kN/m", "mm³/s", "ml/min"} & set(headings) == set()
    assert foreign([*said.replace(str(tmp_path), "").splitlines(), *lines_of(page)], "US") == []


def test_lists_of_the_libraries_take_the_units_that_are_asked_for(capsys):
    for command in (["materials", "316L"], ["fluids", "water"], ["fluids", "helium"]):
        assert main([*command, "--units", "US", "--temperature", "100 degF"]) == 0
        # condition and source speak in their own words; lines that are broken are one again
        lines = re.sub(r"\n +", " ", capsys.readouterr().out).splitlines()
        assert foreign([line for line in lines if not re.match("condition|source", line)], "US") == []
    us = Display("US")
    headings = " ".join([*material_cells(us, material_rows())[0], *fluid_cells(us, fluid_rows())[0]]).split()
    assert {"ksi", "1e-6/degF", "cP", "lb/ft3", "psi", "degF"} <= set(headings)
    assert not {"GPa", "MPa", "1e-6/K", "mPa", "kg/m3", "bar", "degC"} & set(headings)
    main(["materials", "316L", "--units", "US"])
    assert "29010 ksi" in (said := " ".join(_out(capsys))) and "8.889e-6/degF" in said
    main(["fluids", "water", "--units", "SI"])
    assert "at 100 MPa" in " ".join(_out(capsys))


def _out(capsys) -> list[str]:
    return capsys.readouterr().out.splitlines()


def test_table_of_the_direct_simulation_takes_the_units_of_the_case():
    columns = prose()["terminal"]["samples"]
    row = {one["key"]: 6.894757e6 if "unit" in one else 1 for one in columns}
    rows = [row | {"blocked_samples": 0, "samples": 1}]
    headings, ((_, pressure, *_),) = shown_rows(Display(), rows)
    assert headings[1] == "p\nMPa" and pressure == "6.895"
    headings, ((_, pressure, *_),) = shown_rows(Display("US"), rows)
    assert headings[1] == "p\nksi" and pressure == "1.0000"
    assert {"conserved\nu_eff, uin", "mean gap\nuin"} <= set(headings)
    assert not any(unit in heading for heading in headings for unit in ("MPa", "um"))


def test_a_finding_takes_the_units_of_the_system():
    values = {"share": 0.03, "size": 2.54e-5}
    assert "present 25.4 um" in caution("mesh", **values).text()
    assert "present 1000 uin" in caution("mesh", **values).text(Display("US"))
    at = {
        "stress": "2 ksi",
        "excess": "2",
        "limit": "29 ksi",
        "r": 0.0127,
        "z": 0.0,
        "depth": "",
        "deepest": "",
    }
    told = caution("yield_stress", name="seat", where="290 psi", first="", **at).text(Display("US"))
    assert "2 ksi at r = 0.5 in" in told and "exceeds 29 ksi" in told


def test_si_units_of_small_leak_rates_need_no_powers_of_ten():
    unit = Display("SI").shared_flow_unit((2.04e-12, 5.87e-10))
    assert (unit.name, unit.of(2.04e-12)) == ("mm³/s", pytest.approx(0.00204))


@pytest.mark.parametrize(
    ("limits", "throughputs"),
    [
        ({}, True),
        ({"load.target_leak_rate": "1 ml/min"}, False),
        ({"load.target_leak_rate": "1 mbar l/s"}, True),
        ({"load.target_leak_rate": "1 mbar l/s", "requirement": {"leak_rate": "1 ml/min"}}, False),
    ],
)
def test_leak_rates_of_a_gas_have_the_kind_of_unit_of_their_limit(limits, throughputs):
    assert (
        load_case(EXAMPLES / "helium.toml").replace({"requirement": None, **limits}).display.throughputs
        == throughputs
    )
