"""The columns of all tables: one row each with name, unit, headings, meaning, and how to get it from a load.

leak.csv, the terminal, the report, studies and the manual choose from this list; none of them has one of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.answers.judgement import JudgedLoad
from fem_seal.seal.findings import VALIDITY_COLUMNS
from fem_seal.seal.readings import FURTHER, OWN, WORDS, force_column, leak_rate_column
from fem_seal.units import DIGITS, Unit, fixed_unit, quantity_worth, split_unit
from leak import Reading

if TYPE_CHECKING:
    from fem_seal.seal.load_result import LoadResult
    from leak import CoupledLeakResult, LeakResult


@dataclass(frozen=True, eq=False)
class Row:
    """One load with what a table says of it and no `LoadResult` knows: the row that columns are cells of.

    Parameters
    ----------
    load : LoadResult
    """

    load: LoadResult

    def end(self, which: int) -> float | None:
        """Lower (0) or upper (1) end of the leak rate's interval [m^3/s]; None where nothing makes one."""
        ends = self.load.leak_interval
        return ends[which] if ends is not None and self.load.has_interval else None

    @property
    def margin(self) -> float | None:
        """Of a load that is judged."""
        return self.load.margin if isinstance(self.load, JudgedLoad) else None

    @property
    def force_for_verdict(self) -> float | None:
        """Of a load that is judged [N]."""
        return self.load.force_for_verdict if isinstance(self.load, JudgedLoad) else None


@dataclass(frozen=True)
class Shown:
    """A number on the terminal, always in the same unit.

    Parameters
    ----------
    name : str
        In leak.csv or in what ``check --json`` prints.
    heading : str
    unit : Unit
    """

    name: str
    heading: str
    unit: Unit


@dataclass(frozen=True)
class Column:
    """A column of leak.csv and of all that is made from it.

    Parameters
    ----------
    name : str
        In the files; it ends in the SI unit.
    kind : str
        What `fem_seal.units.unit_for` calls the quantity; empty for a plain number.
    meaning : str
        For the reference of the columns.
    of : callable
        The number of a `Row` in SI, None where nothing was calculated.
    heading : str
        In the report, without a unit.
    title : str
        On the page of a study; the name in words unless given.
    short, shown_in : str
        Heading on the terminal and the unit there, see `fem_seal.units.fixed_unit`.
    unit_like : str
        Name of the column whose unit it has in the report, so that the two can be compared.
    spare_digits : int, optional
        So many digits more than the contact force it is worth where little is missing to opening; None if it does not
        follow from that force.
    needs : tuple of str
        Tables of the case without which the column stays empty.
    most_digits : int
        Significant digits that are shown at most.
    error_of : str
        What `LoadResult.digits_of` calls it or what it is as good as, empty where errors hardly matter.
    """

    name: str
    kind: str
    meaning: str
    of: Callable[[Row], float | None]
    heading: str = ""
    title: str = ""
    short: str = ""
    shown_in: str = ""
    unit_like: str = ""
    spare_digits: int | None = None
    needs: tuple[str, ...] = ()
    most_digits: int = DIGITS
    error_of: str = ""

    @property
    def unit(self) -> str:
        """SI unit, empty for a plain number."""
        return split_unit(self.name)[1]

    @property
    def words(self) -> str:
        """What the page of a study calls it."""
        return self.title or split_unit(self.name)[0].replace("_", " ")

    @property
    def on_terminal(self) -> Shown:
        """How the terminal shows it."""
        return Shown(self.name, self.short, fixed_unit(self.shown_in))

    def number(self, row: Row) -> float:
        """Its cell in a row of numbers, NaN where nothing was calculated."""
        value = self.of(row)
        return math.nan if value is None else float(value)

    def digits(self, load: LoadResult) -> int:
        """Significant digits that it is worth at a load."""
        of_force = DIGITS if self.spare_digits is None else load.digits + self.spare_digits
        of_error = load.digits_of(self.error_of) if self.error_of else DIGITS
        return min(of_force, of_error, self.most_digits)


def _leak_rate_read(reading: Reading) -> Column:
    """Leak rate in one reading of yielding asperities."""
    further = reading != OWN

    def of(row: Row) -> float | None:
        return _rate(row.load.readings[reading].leak) if row.load.yields else None

    return Column(
        leak_rate_column(reading),
        "flow",
        f'where asperities yield and leak.theory = "paper": leak rate {WORDS[reading].column}',
        of,
        heading=f"leak rate, {reading}" if further else "",
        title=f"leak rate, {WORDS[reading].title}",
        unit_like="leak_rate_m3_per_s" if further else "",
        spare_digits=0,
        error_of="leak_rate",
        needs=_FLOW,
    )


def _force_read(reading: Reading) -> Column:
    """Force for the target in another reading of yielding asperities."""

    def of(row: Row) -> float | None:
        return row.load.others[reading].force_for_target if reading in row.load.others else None

    return Column(
        force_column(reading),
        "force",
        'where asperities yield and leak.theory = "paper": `force_for_target_leak_N` '
        + WORDS[reading].condition,
        of,
        error_of="force_for_target",
        heading=f"for the target, {reading}",
        short=str(reading),
        shown_in="N",
        unit_like="force_for_target_leak_N",
    )


def _rate(leak: LeakResult | None) -> float | None:
    return None if leak is None else leak.leak_rate


def _contact_radius(row: Row) -> float:
    profile = row.load.contact.profile
    return float(np.interp(profile.centroid, profile.x, profile.radius))


def _knudsen_number(row: Row) -> float | None:
    number = None if row.load.leak is None else row.load.leak.knudsen_number
    return number if number is not None and math.isfinite(number) else None


def _coupled(row: Row) -> CoupledLeakResult | None:
    from leak import CoupledLeakResult

    return row.load.leak if isinstance(row.load.leak, CoupledLeakResult) else None


def _lift_off_x(row: Row) -> float | None:
    coupled = _coupled(row)
    return None if coupled is None else coupled.lift_off_x


def _blow_off_pressure(row: Row) -> float | None:
    coupled = _coupled(row)
    return row.load.blow_off_pressure if coupled is None else coupled.blow_off_pressure


def _plastic_strain(row: Row) -> float | None:
    from fem_seal.bodies.fields import ElastoplasticField
    from fem_seal.contact.load_path import ElastoplasticContact

    contact = row.load.contact
    if not isinstance(contact, ElastoplasticContact):
        return None
    return max(
        float(field.accumulated_plastic_strain.max())
        for field in contact.fields.values()
        if isinstance(field, ElastoplasticField)
    )


def _load_steps(row: Row) -> float | None:
    from fem_seal.contact.load_path import ElastoplasticContact

    contact = row.load.contact
    return float(contact.load_steps) if isinstance(contact, ElastoplasticContact) else None


def _of_scratches(row: Row, which: int) -> float | None:
    around = row.load.around
    return None if around is None or around.scratches is None else around.scratches[which]


_FLOW = ("roughness", "fluid")

COLUMNS = {
    column.name: column
    for column in (
        Column(
            "fluid_pressure_Pa",
            "fluid pressure",
            "pressure difference across the seal",
            lambda row: row.load.fluid_pressure,
            heading="fluid pressure",
            short="p fluid",
            shown_in="bar",
        ),
        Column(
            "contact_force_N",
            "force",
            "contact force F_N, the axial force that the solid contact carries: `applied_force_N` together with the "
            "axial force of the fluid",
            lambda row: row.load.contact_force,
            heading="contact force",
            title="contact force",
            short="F contact",
            shown_in="N",
            spare_digits=0,
        ),
        Column(
            "line_load_N_per_m",
            "line load",
            "f_N, contact force per unit length of the circle of first touch, normal to the contact",
            lambda row: row.load.line_load,
            heading="line load",
            short="line load",
            shown_in="kN/m",
            spare_digits=0,
        ),
        Column(
            "peak_pressure_Pa",
            "contact pressure",
            "largest contact pressure over x",
            lambda row: row.load.contact.profile.peak_pressure,
            heading="peak pressure",
            short="p peak",
            shown_in="MPa",
            spare_digits=0,
            error_of="peak_pressure",
        ),
        Column(
            "contact_radius_m",
            "length",
            "distance of the centre of the contact pressure from the axis",
            _contact_radius,
        ),
        Column(
            "fwhm_m",
            "length",
            "full width of the pressure profile at half of its peak",
            lambda row: row.load.contact.profile.fwhm,
            heading="width (FWHM)",
            title="width at half maximum",
            short="FWHM",
            shown_in="mm",
            error_of="fwhm",
        ),
        Column(
            "std_m",
            "length",
            "square root of the second central moment of the pressure over x",
            lambda row: row.load.contact.profile.std,
            heading="std. deviation",
            title="standard deviation of the pressure profile",
            short="std dev",
            shown_in="mm",
            unit_like="fwhm_m",
            error_of="std",
        ),
        Column(
            "leak_rate_m3_per_s",
            "flow",
            "volume per time through the whole circumference; of a liquid at atmospheric pressure, of a gas at "
            "101325 Pa and its temperature",
            lambda row: _rate(row.load.leak),
            heading="leak rate",
            short="leak rate",
            shown_in="mm³/s",
            spare_digits=0,
            needs=_FLOW,
            error_of="leak_rate",
        ),
        Column(
            "leak_rate_elastic_m3_per_s",
            "flow",
            "leak rate of the same contact with asperities that never yield",
            lambda row: _rate(row.load.reading(Reading.ELASTIC).leak),
            heading="leak rate, elastic",
            short="elastic",
            shown_in="mm³/s",
            unit_like="leak_rate_m3_per_s",
            spare_digits=0,
            needs=_FLOW,
            error_of="leak_rate",
        ),
        Column(
            "critical_separation_m",
            "length",
            "u_c, height of the narrowest point on the first open leak path, at the peak pressure; zero where sealed",
            lambda row: row.load.critical_separation,
            heading="u_c",
            short="u_c",
            shown_in="um",
            # the narrowest gap follows the force only like its logarithm
            spare_digits=1,
            error_of="peak_pressure",
            needs=("roughness",),
        ),
        Column(
            "critical_separation_elastic_m",
            "length",
            "u_c with asperities that never yield",
            lambda row: row.load.reading(Reading.ELASTIC).critical_separation,
            heading="u_c, elastic",
            unit_like="critical_separation_m",
            spare_digits=1,
            error_of="peak_pressure",
            needs=("roughness",),
        ),
        Column(
            "max_von_mises_Pa",
            "contact pressure",
            "largest von Mises stress in both bodies, good to 0.3 % where they are elastic and their surfaces rough; "
            "it has no value where it stands in a re-entrant corner, and grows there with smaller elements",
            lambda row: row.load.max_von_mises,
            heading="von Mises",
            title="max. von Mises stress",
            short="von Mises",
            shown_in="MPa",
            # its error would be in the fourth
            most_digits=3,
            spare_digits=0,
            error_of="peak_pressure",
        ),
        Column(
            "leak_rate_low_m3_per_s",
            "flow",
            "lower end of the leak rate's interval, the one that sentences and verdict use: it holds both readings of "
            "yielding asperities, the samples of uncertain inputs in both, and what the calculation may be off by "
            "(guide/verdict in the manual); nan where none of them makes one",
            lambda row: row.end(0),
            short="low",
            shown_in="mm³/s",
            spare_digits=0,
            needs=_FLOW,
            error_of="leak_rate",
        ),
        Column(
            "leak_rate_high_m3_per_s",
            "flow",
            "upper end of the same interval",
            lambda row: row.end(1),
            short="high",
            shown_in="mm³/s",
            spare_digits=0,
            needs=_FLOW,
            error_of="leak_rate",
        ),
        Column(
            "leak_rate_kg_per_s",
            "mass flow",
            "leak rate by mass; nan if the density is unknown",
            lambda row: None if row.load.leak is None else row.load.leak.mass_flow,
            title="leak rate by mass",
            error_of="leak_rate",
            needs=_FLOW,
        ),
        Column(
            "leak_rate_Pa_m3_per_s",
            "throughput",
            "pV throughput of a gas",
            lambda row: None if row.load.leak is None else row.load.leak.throughput,
            title="leak rate pV",
            short="leak rate",
            shown_in="mbar l/s",
            spare_digits=0,
            needs=_FLOW,
            error_of="leak_rate",
        ),
        Column(
            "leak_rate_standard_m3_per_s",
            "flow",
            "volume of a gas per time at 0 degC and 101325 Pa",
            lambda row: None if row.load.leak is None else row.load.leak.standard_leak_rate,
            title="leak rate at 0 °C, 1 atm",
            error_of="leak_rate",
            needs=_FLOW,
        ),
        Column(
            "knudsen_number",
            "",
            "of a gas: mean free path over u_eff at the peak contact pressure",
            _knudsen_number,
        ),
        Column(
            "lift_off_x_m",
            "length",
            'with leak.fluid_in_gap = "local": x beyond which, towards the high pressure, the fluid has lifted the '
            "surfaces apart",
            _lift_off_x,
        ),
        Column(
            "blow_off_pressure_Pa",
            "fluid pressure",
            "fluid pressure that opens the seal at the applied force of the row, infinite if none does; with "
            'leak.fluid_in_gap = "local" the pressure that lifts the surfaces apart everywhere',
            _blow_off_pressure,
            heading="opens at",
            short="opens at",
            shown_in="bar",
        ),
        Column(
            "applied_force_N",
            "force",
            "axial force of spring or actuator on the closure (load.applied_force), positive where it closes",
            lambda row: row.load.applied_force,
            heading="applied force",
        ),
        Column(
            "effective_seal_radius_m",
            "length",
            'with load.closing = "penetration": radius of the circle whose area times the fluid pressure is the axial '
            "force of the fluid",
            lambda row: row.load.effective_radius,
            heading="effective seal radius",
            short="r fluid",
            shown_in="mm",
        ),
        Column(
            "force_for_target_leak_N",
            "force",
            "smallest applied force for which the leak rate stays below load.target_leak_rate",
            lambda row: row.load.force_for_target,
            error_of="force_for_target",
            heading="applied force for the target",
            short="target force",
            shown_in="N",
        ),
        Column(
            "max_accumulated_plastic_strain",
            "",
            "where a body yields: the largest accumulated plastic strain of both bodies",
            _plastic_strain,
        ),
        Column(
            "load_steps",
            "",
            "where a body yields: number of steps from the previous load",
            _load_steps,
        ),
        Column(
            "opening_margin_N",
            "force",
            "how far the applied force may fall before the seal opens; nan where nothing opens it",
            lambda row: None if row.load.opening is None else row.load.opening.force,
            heading="force to opening",
            short="to opening",
            shown_in="N",
            spare_digits=0,
        ),
        Column(
            "opening_margin_Pa",
            "fluid pressure",
            "how far the fluid pressure may change before the seal opens",
            lambda row: None if row.load.opening is None else row.load.opening.pressure,
            heading="pressure to opening",
            short="to opening",
            shown_in="bar",
            spare_digits=0,
        ),
        Column(
            "opening_margin",
            "",
            "margin to opening as a share of the force or pressure that acts",
            lambda row: None if row.load.opening is None else row.load.opening.share,
        ),
        Column(
            "peak_pressure_max_Pa",
            "contact pressure",
            "of a seal with [form]: largest contact pressure around the axis",
            lambda row: None if row.load.formed is None else float(row.load.formed.peak_pressure.max()),
            heading="peak around the axis",
            title="largest pressure around the axis",
            short="p max",
            shown_in="MPa",
            unit_like="peak_pressure_Pa",
            spare_digits=0,
            error_of="peak_pressure",
        ),
        Column(
            "line_load_min_over_mean",
            "",
            "of a seal with [form]: least line load around the axis over its mean",
            lambda row: None if row.load.formed is None else row.load.formed.least_over_mean,
            heading="least line load over mean",
            short="f min/mean",
        ),
        Column(
            "leak_rate_round_m3_per_s",
            "flow",
            "of a seal with [form]: leak rate of the round seal without scratches",
            lambda row: None if row.load.formed is None else _rate(row.load.leak_round),
            heading="leak rate if round",
            short="if round",
            shown_in="mm³/s",
            unit_like="leak_rate_m3_per_s",
            spare_digits=0,
            error_of="leak_rate",
            needs=_FLOW,
        ),
        Column(
            "leak_rate_scratches_low_m3_per_s",
            "flow",
            "what scratches and lay add to the leak rate at least, if no fluid passes between them and the roughness",
            lambda row: _of_scratches(row, 0),
            needs=_FLOW,
        ),
        Column(
            "leak_rate_scratches_high_m3_per_s",
            "flow",
            "what they add at most, if it passes freely; the leak rate includes this",
            lambda row: _of_scratches(row, 1),
            heading="of it through scratches",
            short="scratches",
            shown_in="mm³/s",
            unit_like="leak_rate_m3_per_s",
            spare_digits=0,
            error_of="leak_rate",
            needs=_FLOW,
        ),
        *(_leak_rate_read(one) for one in (OWN, *FURTHER)),
        *(_force_read(one) for one in FURTHER),
        Column(
            "force_for_verdict_N",
            "force",
            "with load.target_leak_rate: smallest applied force with which the verdict passes at this fluid pressure, "
            "that on the requirement or, without one, on the target, with the interval of the leak rate and what the "
            "calculation may be off by; nan where none does (summary.json says why)",
            lambda row: row.force_for_verdict,
            heading="applied force for a pass",
            short="to pass",
            shown_in="N",
            unit_like="force_for_target_leak_N",
        ),
        Column(
            "contact_temperature_K",
            "temperature",
            "with `[temperature]`: mean of both faces where they press on each other",
            lambda row: row.load.contact_temperature,
            heading="temperature of the contact",
            needs=("temperature",),
        ),
        Column(
            "effective_viscosity_Pa_s",
            "viscosity",
            "of a liquid: constant viscosity with which as much would leak, above that at atmospheric pressure where "
            "the liquid thickens",
            lambda row: row.load.effective_viscosity,
            title="effective viscosity",
            needs=_FLOW,
        ),
        Column(
            "margin",
            "",
            "with `[requirement]`: allowed leak rate over the upper end of the calculated one; infinite where sealed, "
            "zero where the seal is open, nan where the load is not judged, nothing visible may leak, or a zero is "
            "outside the theory",
            lambda row: row.margin,
            heading="margin",
            short="margin",
            spare_digits=0,
            error_of="leak_rate",
            needs=("requirement",),
            # of an interval, as its ends are
            most_digits=2,
        ),
    )
}


def in_words(load: LoadResult, name: str) -> str:
    """A number of a load for a sentence: with its unit, and no more digits than in the tables.

    Parameters
    ----------
    load : LoadResult
    name : str
        Of a column that is a quantity.
    """
    column = COLUMNS[name]
    return quantity_worth(column.kind, column.number(Row(load)), column.digits(load))


LEAK_COLUMNS = tuple(COLUMNS)
# What is known of the pressure profile of another program.
PROFILE_LEAK_COLUMNS = (
    "fluid_pressure_Pa",
    "peak_pressure_Pa",
    "leak_rate_m3_per_s",
    "leak_rate_elastic_m3_per_s",
    "critical_separation_m",
    "critical_separation_elastic_m",
    "leak_rate_kg_per_s",
    "leak_rate_Pa_m3_per_s",
    "leak_rate_low_m3_per_s",
    "leak_rate_high_m3_per_s",
    *map(leak_rate_column, (OWN, *FURTHER)),
)

# What the terminal shows of the loads, where a row fills it.
LEAK_ON_TERMINAL = tuple(
    COLUMNS[name].on_terminal
    for name in (
        "fluid_pressure_Pa",
        "contact_force_N",
        "peak_pressure_Pa",
        "fwhm_m",
        "std_m",
        "critical_separation_m",
        "leak_rate_m3_per_s",
        "leak_rate_Pa_m3_per_s",
        "leak_rate_low_m3_per_s",
        "leak_rate_high_m3_per_s",
        "leak_rate_elastic_m3_per_s",
        "leak_rate_round_m3_per_s",
        "leak_rate_scratches_high_m3_per_s",
        "line_load_min_over_mean",
        "max_von_mises_Pa",
        "effective_seal_radius_m",
        "blow_off_pressure_Pa",
        "force_for_target_leak_N",
        *map(force_column, FURTHER),
        "force_for_verdict_N",
        "opening_margin_N",
        "opening_margin_Pa",
        "margin",
    )
)
# What `fem-seal check` shows of the loads: what is known of the columns before a solve, and the closed forms.
CHECK_ON_TERMINAL = (
    *(COLUMNS[name].on_terminal for name in ("fluid_pressure_Pa", "contact_force_N", "line_load_N_per_m")),
    Shown("hertz_peak_pressure_Pa", "Hertz p0", fixed_unit("MPa")),
    Shown("hertz_half_width_m", "half width", fixed_unit("mm")),
    Shown("gaussian_peak_pressure_Pa", "Gauss p0", fixed_unit("MPa")),
    Shown("crossover_peak_pressure_Pa", "crossover p0", fixed_unit("MPa")),
    Shown("crossover_fwhm_m", "FWHM", fixed_unit("mm")),
    Shown("crossover_std_m", "std dev", fixed_unit("mm")),
    *(COLUMNS[name].on_terminal for name in ("blow_off_pressure_Pa", "force_for_target_leak_N")),
)

# Columns of leak.csv that hold words, after its numbers.
TEXT_COLUMNS = ("verdict", *VALIDITY_COLUMNS)
VERDICT_MEANING = (
    'with `[requirement]`: "pass", "fail" or "inconclusive", see guide/verdict in the manual; empty where the '
    "load is not judged"
)
# The other tables: names of the columns and what they mean.
VALIDITY_MEANINGS = dict(
    zip(
        VALIDITY_COLUMNS,
        (
            '"valid", "doubtful" or "outside the theory", see guide/validity in the manual',
            'why, the worst reason first, with "; " between them',
        ),
        strict=True,
    )
)
PROFILE_MEANINGS = {
    "fluid_pressure_Pa": "of the load",
    "x_m": "arc length along the contact line, zero at first touch, positive towards larger r",
    "r_m": "distance from the axis",
    "contact_pressure_Pa": "pressure between the bodies, averaged over many asperities, positive in compression",
    "gap_m": "distance between the mean planes of the surfaces",
    "fluid_pressure_in_gap_Pa": "fluid pressure there, above that of the outlet; nan where it is not known",
    "contact_force_per_length_N_per_m": "axial force that the contact carries per arc length, "
    "`2 pi r p n_z cos(alpha)` with the contact normal `n` and the angle `alpha` between it and the normal of the "
    "seat's own face; its integral over `x_m` is `contact_force_N` of the load",
}
IMPRINT_MEANINGS = {
    "body": '"closure" or "seat"',
    "x_m": "arc length along the contact line",
    "depth_m": "depth of the face below its original position, after unloading; negative where it is raised",
}
AROUND_MEANINGS = {
    "fluid_pressure_Pa": "of the load",
    "applied_force_N": "of the load",
    "angle_rad": "around the axis",
    "line_load_N_per_m": "at this angle",
    "peak_pressure_Pa": "largest contact pressure over x at this angle; zero where smooth surfaces are apart",
    "fwhm_m": "full width at half maximum at this angle",
    "leak_rate_m3_per_s_per_rad": "leak rate per angle; its integral over the turn is that of the seal; empty where "
    "none is calculated",
    **{
        f"leak_rate_{one}_m3_per_s_per_rad": f"the same with {WORDS[one].taken}; empty where none yields"
        for one in FURTHER
    },
}
VARIANT_MEANINGS = {
    "interface_law": 'p(u): "plastic", "elastic" or "given"',
    "conductivity": "leak.conductivity",
    "separation_width": "width of the Gaussians in P(u); empty for the critical junction, which needs no P(u)",
    "percolation_threshold": "share of contact above which no leak path is open",
    "fluid_pressure_Pa": "of the load",
    "leak_rate_m3_per_s": "with this reading of the theory",
    "ratio_to_case": "ratio to the leak rate of the case; nan where the case is sealed",
}
PARTICLE_MEANINGS = {
    "fluid_pressure_Pa": "of the load",
    "applied_force_N": "of the load",
    "size_m": "size of the particles",
    "gaps_below_low": "share of the open area at the peak pressure whose gap is narrower, the smaller of both readings "
    "of yielding asperities",
    "gaps_below_high": "the larger one",
    "leak_rate_low_m3_per_s": "leak rate with all gaps narrower than the particles shut, the smaller of both readings",
    "leak_rate_high_m3_per_s": "the larger one",
    "remaining_share_low": "the same over the leak rate of the clean fluid in the same reading",
    "remaining_share_high": "the larger one",
    "particles_low_per_m3": "particles of at least this size in the fluid, as few as the counts allow",
    "particles_high_per_m3": "as many as they allow",
}
PROFILE_COLUMNS, IMPRINT_COLUMNS, AROUND_COLUMNS, VARIANT_COLUMNS, PARTICLE_COLUMNS = map(
    tuple, (PROFILE_MEANINGS, IMPRINT_MEANINGS, AROUND_MEANINGS, VARIANT_MEANINGS, PARTICLE_MEANINGS)
)
