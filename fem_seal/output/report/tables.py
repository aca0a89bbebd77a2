"""The tables of the report: one unit per column, figures that mean something."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_seal.analysis.caution import Level
from fem_seal.analysis.closed_forms import Sizes, closed_form_limits, derive
from fem_seal.analysis.load_names import load_name
from fem_seal.analysis.results import LoadResult, SealSolution, highest_load
from fem_seal.analysis.variants import ratio_to_case
from fem_seal.contact.load_path import ElastoplasticContact
from fem_seal.contact.yielding import PlasticZone, yielding_of
from fem_seal.materials import HardeningCurve
from fem_seal.output.columns import COLUMNS, Column
from fem_seal.output.tables import rows_of
from fem_seal.units import (
    Unit,
    given,
    leak_rate_text,
    number,
    percent,
    quantity,
    quantity_worth,
    trimmed,
    unit_for,
    worth,
)


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
    "axial_force_N",
    "line_load_N_per_m",
    "peak_pressure_Pa",
    "fwhm_m",
    "std_m",
    "critical_separation_m",
    "critical_separation_elastic_m",
    "leak_rate_m3_per_s",
    "leak_rate_elastic_m3_per_s",
    "max_von_mises_Pa",
)
_GIVEN = ("fluid_pressure_Pa", "applied_force_N", "axial_force_N")
_ASKED = (
    "effective_seal_radius_m",
    "blow_off_pressure_Pa",
    "opening_margin_N",
    "opening_margin_Pa",
    "force_for_target_leak_N",
)


def load_table(result: SealSolution) -> ReadableTable:
    """All loads, with one unit per column and without the columns that no load fills."""
    loads, names = result.loads, list(_OF_LOADS)
    if any(load.applied_force for load in loads):
        names.insert(1, "applied_force_N")
    if result.surface is None or result.surface.hardness is None:
        names = [name for name in names if "_elastic_" not in name]
    table = columns_table([_filled(name, result) for name in names])
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
    return ReadableTable(("load", "validity", "because"), tuple(rows))


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
    """

    column: Column
    values: list[float | None]
    digits: list[int]

    @property
    def some(self) -> bool:
        """Whether any row has a value."""
        return any(value is not None for value in self.values)

    @property
    def unit(self) -> Unit:
        """The one that suits the largest of the values."""
        largest = max(abs(value) for value in self.values if value is not None)
        return unit_for(self.column.kind, largest)


def _filled(name: str, result: SealSolution) -> Filled:
    column = COLUMNS[name]
    return Filled(
        column,
        [column.of(row) for row in rows_of(result)],
        [column.digits(load.digits) for load in result.loads],
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
    return worth(unit.of(value), filled.digits[n])


def comparison_table(result: SealSolution, sizes: Mapping[str, Sizes]) -> ReadableTable:
    """How much every load differs from the closed forms, in per cent; no rows where there are none."""
    names = {key: name for key, name in (("crossover", "crossover"), ("hertz", "Hertz")) if key in sizes}
    if not names:
        return ReadableTable((), ())
    measures = {"peak_pressure": "peak", "fwhm": "FWHM", "std": "std. dev."}
    headings = [f"{text} over {name} − 1 [%]" for name in names.values() for text in measures.values()]
    columns = [
        getattr(sizes["calculated"], measure) / getattr(sizes[key], measure) - 1
        for key in names
        for measure in measures
    ]
    rows = tuple(
        (load_name(load, result.loads), *(_difference(column[n]) for column in columns))
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(("load", *headings), rows)


def comparison_note(result: SealSolution) -> str:
    """What to expect of the comparison with the closed forms; empty if nothing needs saying."""
    law = result.case.interface.law
    if result.unloaded is not None:
        return " The closed forms are for elastic bodies: the differences show what yielding does."
    if limits := closed_form_limits(result.case, derive(result.case)):
        return f" {limits[0].upper()}{limits[1:]}."
    if law == "smooth":
        return " Small differences to Hertz are those of the mesh and of the curved sealing line."
    if law == "exponential":
        return " The crossover is exact for this interface law; the rest is the mesh and the curved sealing line."
    return (
        " The crossover is drawn with u₀ of the roughness at low pressure; differences of a per cent or more show that "
        "the full p(u) is no exponential at these pressures."
    )


def _difference(share: float) -> str:
    digits = 3 if abs(share) < 0.1 else 0
    return f"{100 * share:+.{digits}f}".replace("-", "−")


def variant_table(result: SealSolution) -> ReadableTable:
    """What the interface law does to the load with the largest closing force; no rows if there was no choice."""
    rows = [
        (
            variant.name
            + (" (used)" if ("plastic" in variant.name) == result.case.interface.plastic else ""),
            quantity("contact pressure", variant.peak_pressure),
            quantity("length", variant.fwhm),
            quantity("length", variant.std),
            "–"
            if variant.leak_rate is None
            else leak_rate_text(variant.leak_rate, claimed=not result.strongest.validity.outside),
        )
        for variant in result.interface_variants
    ]
    return ReadableTable(
        ("interface law", "peak pressure", "FWHM", "std. deviation", "leak rate"), tuple(rows)
    )


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
}
_CHANNELS = {"bruggeman": "effective medium", "critical-junction": "critical junction"}


def _named(name: str) -> str:
    """An uncertain input in words; one of several measured spectra is called by its key."""
    key = name.removeprefix("scan_length_")
    return _NAMES.get(name, f"length of the scans ({key})" if key != name else f"{name} between scans")


def interval_table(result: SealSolution) -> ReadableTable:
    """Leak rates with their interval and the shares of the inputs; no rows if nothing was uncertain."""
    interval = result.uncertainty
    if interval is None:
        return ReadableTable((), ())
    unit = unit_for("flow", float(interval.high.max()))
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
                number(unit.of(rate))
                for rate in (load.leak.leak_rate if load.leak else None, interval.low[n], interval.high[n])
                if rate is not None
            ),
            *("–" if np.isnan(share) else f"{100 * share:.0f}" for share in interval.shares[n]),
        )
        for n, load in enumerate(result.loads)
    )
    return ReadableTable(headings, rows)


def interval_note(result: SealSolution) -> str:
    """How the interval was made; empty if there is none."""
    interval, settings = result.uncertainty, result.case.uncertainty
    if interval is None:
        return ""
    given_as = {} if settings is None else settings.spreads
    inputs = [
        _named(name)
        + (
            f" ±{percent(given_as[name].relative)} ({given_as[name].distribution})"
            if name in given_as
            else ""
        )
        for name in interval.inputs
    ]
    text = f"{interval.samples} samples (seed {interval.seed}) of {', '.join(inputs)}."
    if interval.error is not None:
        text += (
            f" {interval.runs} of them were calculated in full; a polynomial through these gave the others, off by at "
            f"most {percent(interval.error)} where it was checked."
        )
    sealed = float(interval.sealed.max())
    if sealed > 0:
        text += f" Up to {percent(sealed)} of the samples are sealed."
    return text + (
        " The columns of the inputs show their first-order share in the variance of the logarithm of the leak rate; "
        "what is missing to 100 % comes from inputs acting together. The interval knows nothing of errors of the "
        "theory."
    )


def theory_table(result: SealSolution) -> ReadableTable:
    """Leak rate at the lowest and highest fluid pressure with every reading of the theory; maybe no rows."""
    if not result.theory_variants:
        return ReadableTable((), ())
    lowest = min(range(len(result.loads)), key=lambda n: result.loads[n].point)
    shown = list(dict.fromkeys((lowest, highest_load(result.loads))))
    of_case = [load.leak.leak_rate if load.leak else 0.0 for load in result.loads]
    largest = max(variant.leak_rate[n] for variant in result.theory_variants for n in shown)
    unit = unit_for("flow", largest)
    headings = ["p(u)", "channels", "P(u)", "percolation threshold"]
    for n in shown:
        pressure = load_name(result.loads[n], result.loads)
        headings += [f"leak rate at {pressure} [{unit.name}]", "over that of the case"]
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
            cells += [number(unit.of(rate)), number(ratio_to_case(rate, of_case[n]), 2)]
        rows.append(tuple(cells))
    return ReadableTable(tuple(headings), tuple(rows))


def theory_note(result: SealSolution) -> str:
    """How far the readings lie apart; empty without them."""
    if not result.theory_variants:
        return ""
    load = highest_load(result.loads)
    rates = [variant.leak_rate[load] for variant in result.theory_variants]
    pressure = load_name(result.loads[load], result.loads)
    if min(rates) <= 0:
        return f"At {pressure} some readings of the theory say that the seal is tight, others that it leaks."
    return (
        f"At {pressure} the readings of the theory differ by up to a factor {number(max(rates) / min(rates), 2)}: a "
        "choice of model, not a precision. Direct numerical results favour the effective P(u) with the threshold "
        "0.42 (docs/verification.md); which p(u) carries the contact is open."
    )


_DIGITS = 4
TARGET_FORCE = "Force for the target leak rate"


def opens_at(load: LoadResult) -> str | None:
    """The fluid pressure that lifts the closure off; None if none does, or if nobody asked."""
    pressure = load.blow_off_pressure
    return None if pressure is None or math.isinf(pressure) else quantity("fluid pressure", pressure, _DIGITS)


def valve_facts(result: SealSolution, load: LoadResult) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the pressure that opens the seal and of the force for the target leak rate."""
    if opens := opens_at(load):
        yield "Opens at", opens, f"fluid pressure, under {given('force', load.applied_force)} of the spring"
    target = result.case.load.target_leak_rate
    if target is not None and load.force_for_target is not None:
        force = quantity("force", load.force_for_target, _DIGITS)
        yield (
            TARGET_FORCE,
            force,
            f"of spring or actuator, to leak {given('flow', target)}",
        )


def what_opens(result: SealSolution, load: LoadResult) -> Iterator[str]:
    """How far a load is from opening the seal, and from the target leak rate."""
    if opens := opens_at(load):
        assert load.blow_off_pressure is not None
        share = load.fluid_pressure / load.blow_off_pressure
        carried = quantity_worth("force", load.axial_force, load.digits)
        yield (
            f"The fluid acts against the spring and opens the seal at {opens}. At "
            f"{percent(share, 2 if load.digits == 4 else 4)} of this pressure the contact still carries "
            f"{carried} of the spring's {given('force', load.applied_force)}."
        )
    target, force = result.case.load.target_leak_rate, load.force_for_target
    if target is None or force is None:
        return
    pressure, acting = given("fluid pressure", load.fluid_pressure), load.applied_force
    compared = (
        "none acts now"
        if acting == 0
        else f"{quantity('force', abs(force - acting))} {'more' if force > acting else 'less'} than the "
        f"{given('force', acting)} that act now"
    )
    alone = "; the fluid alone closes more than is needed" if force < 0 else ""
    yield (
        f"The leak rate falls to the target of {given('flow', target)} at {pressure} with a force of spring or "
        f"actuator of {quantity('force', force, _DIGITS)}: {compared}{alone}."
    )


def valve_table(result: SealSolution) -> ReadableTable:
    """What fluid and spring do at each load; no rows if nobody asked."""
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
    return (
        quantity("length", imprint.deepest),
        f"in the {name}, {quantity('length', imprint.width)} wide at half depth",
    )


def what_yielded(result: SealSolution, load: LoadResult) -> Iterator[str]:
    """How far the bodies have yielded at a load that was solved as elastoplastic."""
    if result.unloaded is None:
        return
    zones = [zone for zone in yielding_of(load.contact).values() if isinstance(zone, PlasticZone)]
    if not zones:
        yield (
            "A material has a stress-strain curve, but nothing has yielded up to this load: the bodies are still "
            "elastic."
        )
    for zone in zones:
        yield (
            f"The {zone.body} has yielded down to {quantity('length', zone.deepest)} from the contact line, with up to "
            f"{percent(zone.strain)} plastic strain; the contact is the wider and its peak the lower for it."
        )


def yielding_table(result: SealSolution) -> ReadableTable:
    """Where and how far each body has yielded at each load; no rows if all bodies are elastic."""
    headings = ("load", "body", "plastic strain", "largest at", "yielded down to", "load steps")
    if result.unloaded is None:
        return ReadableTable(headings, ())
    rows = []
    for load in result.loads:
        assert isinstance(load.contact, ElastoplasticContact)
        zones = yielding_of(load.contact)
        for name in load.contact.bodies:
            zone = zones.get(name)
            told = (
                (percent(zone.strain), _depth(zone.depth), quantity("length", zone.deepest))
                if isinstance(zone, PlasticZone)
                else ("none", "–", "–")
            )
            rows.append((load_name(load, result.loads), name, *told, str(load.contact.load_steps)))
    return ReadableTable(headings, tuple(rows))


def _depth(depth: float) -> str:
    return "the surface" if depth == 0 else f"{quantity('length', depth)} depth"


def curve_in_words(curve: HardeningCurve) -> str:
    """A hardening curve in a few words."""
    first = given("contact pressure", curve.stress[0])
    if len(curve.stress) == 1:
        return f"{first}, perfectly plastic"
    last = given("contact pressure", curve.stress[-1])
    return f"{first} to {last} at {percent(curve.last_strain)} plastic strain"


def path_accuracy(result: SealSolution) -> Iterator[tuple[str, str]]:
    """Load steps and balance of the bodies that yield."""
    contacts = [load.contact for load in result.loads if isinstance(load.contact, ElastoplasticContact)]
    if contacts:
        yield "load steps", str(sum(contact.load_steps for contact in contacts))
        worst = max(contact.equilibrium_residuals[-1] for contact in contacts)
        yield "forces out of balance in the bodies", f"{number(worst, 1)} of the largest"
