"""The tables of the report: one unit per column, figures that mean something."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.accuracy import Comparison
from fem_seal.answers.closed_forms import Sizes, closed_form_limits, derive
from fem_seal.answers.leakage_class import volume_of
from fem_seal.answers.solution import SealSolution
from fem_seal.answers.variants import ratio_to_case
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.contact.yielding import PlasticZone, yielding_of
from fem_seal.output.case_words import law_word
from fem_seal.output.columns import COLUMNS, Column
from fem_seal.output.prose import other_reading, said
from fem_seal.output.report.verdict import force_to_pass, verdict_force_sentences
from fem_seal.output.tables import rows_of
from fem_seal.seal.bounds import Bounds
from fem_seal.seal.findings import Level
from fem_seal.seal.load_names import load_name
from fem_seal.seal.load_result import LoadResult, highest_load
from fem_seal.seal.readings import FURTHER, force_column, leak_rate_column
from fem_seal.units import (
    LIQUID,
    LeakVolume,
    Unit,
    given,
    leak_rate_text,
    number,
    percent,
    quantity,
    quantity_worth,
    range_text,
    trimmed,
    unit_for,
    worth,
)

if TYPE_CHECKING:
    from fem_seal.answers.judgement import JudgedLoad
    from fem_seal.materials import HardeningCurve
    from leak import Reading


@dataclass(frozen=True)
class ReadableTable:
    """A table for the page.

    Parameters
    ----------
    headings : tuple of str
    rows : tuple of tuple of str
    """

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


# Columns of the table of all loads, and what the next one asks about opening and target.
_OF_LOADS = (
    "fluid_pressure_Pa",
    "contact_force_N",
    "line_load_N_per_m",
    "peak_pressure_Pa",
    "peak_pressure_max_Pa",
    "fwhm_m",
    "std_m",
    "critical_separation_m",
    "critical_separation_elastic_m",
    "leak_rate_m3_per_s",
    *(leak_rate_column(one) for one in FURTHER),
    "leak_rate_elastic_m3_per_s",
    "leak_rate_round_m3_per_s",
    "max_von_mises_Pa",
)
# The page holds so many columns; where there are more, these go first. leak.csv has them all.
_WIDEST, _SPARED = 12, ("std_m", "critical_separation_elastic_m")
_GIVEN = ("fluid_pressure_Pa", "applied_force_N", "contact_force_N")
_ASKED = (
    "effective_seal_radius_m",
    "blow_off_pressure_Pa",
    "opening_margin_N",
    "opening_margin_Pa",
    "force_for_target_leak_N",
    *(force_column(one) for one in FURTHER),
    "force_for_verdict_N",
)


def load_table(result: SealSolution) -> ReadableTable:
    """All loads, with one unit per column and without the columns that no load fills."""
    loads, names = result.loads, list(_OF_LOADS)
    if any(load.applied_force for load in loads):
        names.insert(1, "applied_force_N")
    if result.surface is None or result.surface.hardness is None:
        names = [name for name in names if "_elastic_" not in name]
    columns = [one for one in (_filled(name, result) for name in names) if one.some]
    for name in _SPARED:
        if len(columns) > _WIDEST:
            columns = [one for one in columns if one.column.name != name]
    table = columns_table(columns)
    # with a mark and not a column more: the page is full
    rows = (
        (f"{first} {load.validity.level.mark}".rstrip(), *others)
        for (first, *others), load in zip(table.rows, loads, strict=True)
    )
    return ReadableTable(table.headings, tuple(rows))


def marks_in_words(result: SealSolution) -> str:
    """What the marks in the table of the loads mean; empty without any."""
    found = [level for level in Level if any(load.validity.level is level for load in result.loads)]
    told = [f"{level.mark} {level}" for level in found if level.mark]
    return f" {', '.join(told)}." if told else ""


def validity_table(result: SealSolution) -> ReadableTable:
    """Every reason why the numbers of a load are not simply valid; no rows if all are."""
    rows = [
        (load_name(load, result.loads), str(caution.level), caution.reason)
        for load in result.loads
        for caution in load.validity.cautions
    ]
    return ReadableTable(("load", "validity", "reason"), tuple(rows))


@dataclass(frozen=True)
class Filled:
    """A column with its values.

    Parameters
    ----------
    column : Column
    values : list of float or None
        One per row, SI.
    digits : list of int
        Significant digits that the values are worth.
    volume : LeakVolume
        What a volume is that leaks.
    """

    column: Column
    values: list[float | None]
    digits: list[int]
    volume: LeakVolume = LIQUID

    @property
    def some(self) -> bool:
        """Whether any row has a value."""
        return any(value is not None for value in self.values)

    @property
    def unit(self) -> Unit:
        """The one that suits the largest of the values."""
        largest = max(abs(value) for value in self.values if value is not None)
        found = unit_for(self.column.kind, largest)
        return self.volume.named(found) if self.column.kind == "flow" else found


def _filled(name: str, result: SealSolution) -> Filled:
    column = COLUMNS[name]
    return Filled(
        column,
        [column.of(row) for row in rows_of(result)],
        [column.digits(load) for load in result.loads],
        volume_of(result.case),
    )


def columns_table(columns: Sequence[Filled]) -> ReadableTable:
    """Columns side by side, one unit in each, without those that no row fills.

    Parameters
    ----------
    columns : sequence of Filled
    """
    shown = [one for one in columns if one.some]
    own = {one.column.name: one.unit for one in shown}
    units = [own.get(one.column.unit_like, own[one.column.name]) for one in shown]
    return ReadableTable(
        tuple(f"{one.column.heading} [{unit.name}]" for one, unit in zip(shown, units, strict=True)),
        tuple(
            tuple(_cell(one, unit, n) for one, unit in zip(shown, units, strict=True))
            for n in range(len(columns[0].values))
        ),
    )


def _cell(filled: Filled, unit: Unit, n: int) -> str:
    value = filled.values[n]
    if value is None:
        return "–"
    if filled.column.name == "fluid_pressure_Pa":
        return trimmed(unit.of(value))
    if filled.column.kind == "flow" and value and not filled.volume.measurable(value):
        return "none measurable"
    return worth(unit.of(value), filled.digits[n])


def comparison_table(result: SealSolution, sizes: Mapping[str, Sizes]) -> ReadableTable:
    """How much every load differs from the closed forms, in per cent; no rows where there are none."""
    names = {key: name for key, name in (("crossover", "crossover"), ("hertz", "Hertz")) if key in sizes}
    if not names:
        return ReadableTable((), ())
    measures = {"peak_pressure": "peak", "fwhm": "FWHM", "std": "std. dev."}
    headings = [f"{text} over {name} − 1 [%]" for name in names.values() for text in measures.values()]
    columns = [
        (measure, getattr(sizes["calculated"], measure) / getattr(sizes[key], measure) - 1)
        for key in names
        for measure in measures
    ]
    rows = tuple(
        (load_name(load, result.loads), *(_difference(of[n], load, measure) for measure, of in columns))
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(("load", *headings), rows)


def comparison_note(result: SealSolution) -> str:
    """What to expect of the comparison with the closed forms; empty if nothing needs saying."""
    if result.unloaded is not None:
        return said("notes.comparison", "yielding")
    if limits := closed_form_limits(result.case, derive(result.case)):
        return f"{limits[0].upper()}{limits[1:]}."
    return said("notes.comparison", law_word(result.case))


def _difference(share: float, load: LoadResult, measure: str) -> str:
    """In per cent, with as many decimals as the mesh leaves."""
    error = 0.0 if load.mesh_error is None else getattr(load.mesh_error, measure)
    decimals = 3 if abs(share) < 0.1 else 0
    if error > 0:
        decimals = min(decimals, max(0, math.ceil(-math.log10(200 * error))))
    return f"{100 * share:+.{decimals}f}".replace("-", "−")


def variant_table(result: SealSolution) -> ReadableTable:
    """What the interface law does to the load with the largest contact force; no rows if there was no choice."""
    ends = [rate for one in result.interface_variants for rate in (one.leak_rate, *one.others.values())]
    rates = [rate for rate in ends if rate is not None]
    volume = volume_of(result.case)
    unit = volume.named(unit_for("flow", max(rates, default=0.0)))
    load = result.strongest
    rows = [
        (
            variant.name
            + (" (used)" if ("plastic" in variant.name) == result.case.interface.plastic else ""),
            quantity_worth("contact pressure", variant.peak_pressure, load.pressure_digits),
            quantity_worth("length", variant.fwhm, load.digits_of("fwhm")),
            quantity_worth("length", variant.std, load.digits_of("std")),
            _both_readings(variant, unit, load, volume),
        )
        for variant in result.interface_variants
    ]
    leak_rate = f"leak rate [{unit.name}]" if rates else "leak rate"
    return ReadableTable(("interface law", "peak pressure", "FWHM", "std. deviation", leak_rate), tuple(rows))


def _both_readings(variant: Comparison, unit: Unit, load: LoadResult, volume: LeakVolume) -> str:
    """The leak rate in both readings of yielding asperities, or the only one."""
    claimed = not load.validity.outside
    if variant.leak_rate is None:
        return "–"
    ends = Bounds.of([variant.leak_rate, *variant.others.values()])
    digits = min(load.leak_digits, 2 if ends.apart else 3)
    told = [
        worth(unit.of(one), digits) if one else leak_rate_text(0.0, claimed=claimed)
        for one in map(volume.measurable, ends)
    ]
    return range_text(*told)


_NAMES = {
    "viscosity": "viscosity",
    "hardness": "hardness",
    "youngs_modulus": "Young's modulus",
    "rms_height": "rms height",
    "hurst": "Hurst exponent",
    "q_rolloff": "roll-off",
    "q_high": "shortest wavelength",
    "spectrum": "spectrum between scans",
    "scan_length": "length of the scans",
    "form": "form error",
    "lay": "lay",
}
_CHANNELS = {
    "bruggeman": "effective medium",
    "critical-junction": "critical junction",
    "threshold-law": "closed law near the threshold",
}


def _named(name: str) -> str:
    """An uncertain input in words; one of several measured spectra is called by its key."""
    key = name.removeprefix("scan_length_")
    return _NAMES.get(name, f"length of the scans ({key})" if key != name else f"{name} between scans")


def interval_table(result: SealSolution) -> ReadableTable:
    """Leak rates with their interval and the shares of the inputs; no rows if nothing was uncertain."""
    interval = result.uncertainty
    if interval is None:
        return ReadableTable((), ())
    ends = [one or (math.nan, math.nan) for one in result.leak_ranges]
    volume = volume_of(result.case)
    unit = volume.named(unit_for("flow", max(high for _, high in ends)))
    span = percent(interval.confidence)
    headings = (
        "load",
        f"leak rate [{unit.name}]",
        f"{span}: from [{unit.name}]",
        f"to [{unit.name}]",
        *(f"{_named(name)} [%]" for name in interval.inputs),
    )
    rows = tuple(
        (
            load_name(load, result.loads),
            *(
                worth(unit.of(volume.measurable(rate)), min(load.leak_digits, digits))
                for rate, digits in (
                    (load.leak.leak_rate if load.leak else None, 3),
                    *((end, 2) for end in ends[n]),
                )
                if rate is not None
            ),
            *("–" if np.isnan(share) else f"{100 * share:.0f}" for share in interval.shares[n]),
        )
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(headings, rows)


def interval_note(result: SealSolution) -> str:
    """How the interval was made; empty if there is none."""
    interval, settings, roughness = result.uncertainty, result.case.uncertainty, result.case.roughness
    if interval is None:
        return ""
    given_as = {} if settings is None else settings.spreads
    spreads = {name: f" ±{percent(one.relative)} ({one.distribution})" for name, one in given_as.items()}
    sealed = float(interval.sealed.max())
    return said(
        "notes.interval",
        "samples",
        "polynomial" if interval.runs < interval.samples else "",
        "checked" if interval.error is not None else "",
        "finish" if roughness is not None and roughness.finishes else "",
        "sealed" if sealed > 0 else "",
        "shares",
        "shares_both" if result.highest.yields else "",
        "held",
        samples=interval.samples,
        seed=interval.seed,
        inputs=", ".join(_named(name) + spreads.get(name, "") for name in interval.inputs),
        runs=interval.runs,
        error=percent(interval.error or 0.0),
        sealed=percent(sealed),
    )


def theory_table(result: SealSolution) -> ReadableTable:
    """Leak rate at the lowest and highest fluid pressure with every reading of the theory; maybe no rows."""
    if not result.theory_variants:
        return ReadableTable((), ())
    lowest = min(range(len(result.loads)), key=lambda n: result.loads[n].point)
    shown = list(dict.fromkeys((lowest, highest_load(result.loads))))
    of_case = [load.leak.leak_rate if load.leak else 0.0 for load in result.loads]
    largest = max(variant.leak_rate[n] for variant in result.theory_variants for n in shown)
    volume = volume_of(result.case)
    unit = volume.named(unit_for("flow", largest))
    headings = ["p(u)", "channels", "P(u)", "percolation threshold"]
    for n in shown:
        pressure = load_name(result.loads[n], result.loads)
        headings += [f"leak rate at {pressure} [{unit.name}]", "ratio to the case"]
    rows = []
    for variant in result.theory_variants:
        cells = [
            variant.interface_law + (" (used)" if variant.used else ""),
            _CHANNELS[variant.conductivity],
            variant.separation_width or "–",
            trimmed(variant.percolation_threshold),
        ]
        for n in shown:
            rate = variant.leak_rate[n]
            digits = min(result.loads[n].leak_digits, 3)
            cells += [
                worth(unit.of(volume.measurable(rate)), digits),
                number(ratio_to_case(rate, of_case[n]), 2),
            ]
        rows.append(tuple(cells))
    return ReadableTable(tuple(headings), tuple(rows))


def theory_note(result: SealSolution) -> str:
    """How far the readings lie apart; empty without them."""
    if not result.theory_variants:
        return ""
    load = highest_load(result.loads)
    rates = [variant.leak_rate[load] for variant in result.theory_variants]
    tight = min(rates) <= 0
    return said(
        "notes.theory",
        "tight" if tight else "factor",
        "yields" if result.highest.yields else "",
        load=load_name(result.loads[load], result.loads),
        factor="" if tight else number(max(rates) / min(rates), 2),
    )


_DIGITS = 4
TARGET_FORCE = "Force for the target leak rate"


def opens_at(load: LoadResult) -> str | None:
    """The fluid pressure that lifts the closure off; None if none does, or if nobody asked."""
    pressure = load.blow_off_pressure
    return None if pressure is None or math.isinf(pressure) else quantity("fluid pressure", pressure, _DIGITS)


def valve_facts(result: SealSolution, load: JudgedLoad) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the pressure that opens the seal and of the force for the target leak rate."""
    if opens := opens_at(load):
        yield (
            "Opens at",
            opens,
            f"fluid pressure, with an applied force of {given('force', load.applied_force)}",
        )
    target = result.case.load.target_leak_rate
    if target is not None and load.force_for_target is not None:
        both = [
            _target_force(load, force) for force in (load.force_for_target, *_other_forces(load).values())
        ]
        named = "; the two ends are readings of asperities that yield" if both[0] != both[-1] else ""
        yield (
            TARGET_FORCE,
            range_text(both[0], both[-1]),
            f"applied force for {_target(result, target)}{named}",
        )
    if load.verdict_force is not None:
        found = load.verdict_force
        none = "none" if found.looked_for else "not looked for"
        begins = f" {found.begins}" if found.begins else ""
        yield (
            "Force for a pass",
            none if found.force is None else force_to_pass(found.force),
            found.why_none
            or f"applied force from which the verdict passes{begins}, with interval and accuracy of the leak rate",
        )


def what_opens(result: SealSolution, load: JudgedLoad) -> Iterator[str]:
    """How far a load is from opening the seal, and from the target leak rate."""
    if opens := opens_at(load):
        assert load.blow_off_pressure is not None
        share = load.fluid_pressure / load.blow_off_pressure
        yield said(
            "reasons.opening",
            "all",
            opens=opens,
            share=percent(share, 2 if load.digits == 4 else 4),
            contact_force=quantity_worth("force", load.contact_force, load.digits),
            applied_force=given("force", load.applied_force),
        )
    yield from _what_the_target_takes(result, load)
    yield from verdict_force_sentences([load])


def _what_the_target_takes(result: SealSolution, load: LoadResult) -> Iterator[str]:
    target, force = result.case.load.target_leak_rate, load.force_for_target
    if target is None or force is None:
        return
    acting = load.applied_force
    compared = ("more" if force > acting else "less") if acting else "none"
    told = said(
        "reasons.target",
        "force",
        compared,
        "fluid" if force < 0 else "",
        target=_target(result, target),
        pressure=given("fluid pressure", load.fluid_pressure),
        force=_target_force(load, force),
        difference=quantity_worth("force", abs(force - acting), load.digits_of("force_for_target")),
        acting=given("force", acting),
    )
    others = [
        other_reading(reading, f"{_target_force(load, one)} are needed")
        for reading, one in _other_forces(load).items()
    ]
    yield " ".join([told, *others])


def _other_forces(load: LoadResult) -> dict[Reading, float]:
    """Force for the target in the other readings of yielding asperities, where one is found [N]."""
    found = {reading: one.force_for_target for reading, one in load.others.items()}
    return {reading: force for reading, force in found.items() if force is not None}


def _target(result: SealSolution, leak_rate: float) -> str:
    state = volume_of(result.case).state
    return f"{given('flow', leak_rate)} at {state}" if state else given("flow", leak_rate)


def _target_force(load: LoadResult, force: float | None) -> str:
    if force is None:
        return "–"
    unit = unit_for("force", force)
    return f"{worth(unit.of(force), load.digits_of('force_for_target'))} {unit.name}"


def valve_table(result: SealSolution) -> ReadableTable:
    """What fluid and applied force do at each load; no rows if nobody asked."""
    asked = {name: _filled(name, result) for name in _ASKED}
    # what lifts the closure off, also where leak.csv has what the surfaces hold by themselves; infinite: nothing does
    opens = [_finite(load.blow_off_pressure) for load in result.loads]
    asked["blow_off_pressure_Pa"] = replace(asked["blow_off_pressure_Pa"], values=opens)
    if not any(one.some for one in asked.values()):
        return ReadableTable((), ())
    return columns_table([*(_filled(name, result) for name in _GIVEN), *asked.values()])


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def imprint_in_words(result: SealSolution) -> tuple[str, str] | None:
    """Depth of the deepest imprint, and in which body and how wide; None if nothing has yielded."""
    imprints = {} if result.unloaded is None else result.unloaded.imprints
    if not imprints:
        return None
    name, imprint = max(imprints.items(), key=lambda item: item[1].deepest)
    digits = result.strongest.digits_of("fwhm")  # as good as the width of the contact that made it
    return (
        quantity_worth("length", imprint.deepest, digits),
        f"in the {name}, {quantity_worth('length', imprint.width, digits)} wide at half depth",
    )


def what_yielded(result: SealSolution, load: LoadResult) -> Iterator[str]:
    """How far the bodies have yielded at a load that was solved as elastoplastic."""
    if result.unloaded is None:
        return
    zones = [zone for zone in yielding_of(load.contact).values() if isinstance(zone, PlasticZone)]
    if not zones:
        yield said("reasons.yielding", "none")
    for zone in zones:
        deepest, strain = (
            quantity_worth("length", zone.deepest, load.digits_of("fwhm")),
            percent(zone.strain),
        )
        yield said("reasons.yielding", "zone", body=zone.body, deepest=deepest, strain=strain)


def yielding_table(result: SealSolution) -> ReadableTable:
    """Where and how far each body has yielded at each load; no rows if all bodies are elastic."""
    headings = ("load", "body", "plastic strain", "largest at", "yielded to a depth of", "load steps")
    if result.unloaded is None:
        return ReadableTable(headings, ())
    rows = []
    for load in result.loads:
        assert isinstance(load.contact, ElastoplasticContact)
        zones = yielding_of(load.contact)
        for name in load.contact.bodies:
            zone = zones.get(name)
            told = (
                (percent(zone.strain), *_depths(zone, load.digits_of("fwhm")))
                if isinstance(zone, PlasticZone)
                else ("none", "–", "–")
            )
            rows.append((load_name(load, result.loads), name, *told, str(load.contact.load_steps)))
    return ReadableTable(headings, tuple(rows))


def _depths(zone: PlasticZone, digits: int) -> tuple[str, str]:
    """Where the plastic strain is largest, and how deep it reaches."""
    largest, deepest = (quantity_worth("length", one, digits) for one in (zone.depth, zone.deepest))
    return "the surface" if zone.depth == 0 else f"{largest} depth", deepest


def curve_in_words(curve: HardeningCurve) -> str:
    """A hardening curve in a few words."""
    # four digits: between two temperatures it is no number that anybody wrote
    first, last = (
        given("contact pressure", float(f"{one:.4g}")) for one in (curve.stress[0], curve.stress[-1])
    )
    if len(curve.stress) == 1:
        return f"{first}, perfectly plastic"
    return f"{first} to {last} at {percent(curve.last_strain)} plastic strain"


def path_accuracy(result: SealSolution) -> Iterator[tuple[str, str]]:
    """Load steps and balance of the bodies that yield."""
    contacts = [load.contact for load in result.loads if isinstance(load.contact, ElastoplasticContact)]
    if contacts:
        yield "load steps", str(sum(contact.load_steps for contact in contacts))
        worst = max(contact.equilibrium_residuals[-1] for contact in contacts)
        yield "imbalance of forces in the bodies", f"{number(worst, 1)} of the largest force"
