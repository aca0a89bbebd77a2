"""The leak rate with every reading of the theory, so that nobody mistakes a choice of model for precision."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.atomic_files import write_text

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.contact_solution import ContactSolution
    from fem_seal.laws import Law
    from fem_seal.results import SealResult
    from leak import RoughContact

# Share of the contact area at which channels close: two-dimensional percolation, and the textbook value.
_THRESHOLDS = (0.42, 0.5)
_WIDTHS = ("effective", "plain")

COLUMNS = (
    "interface_law",
    "conductivity",
    "separation_width",
    "percolation_threshold",
    "fluid_pressure_Pa",
    "leak_rate_m3_per_s",
    "ratio_to_case",
)


@dataclass(frozen=True)
class TheoryVariant:
    """One reading of the theory and the leak rates that it gives.

    Parameters
    ----------
    plastic : bool or None
        p(u) of the plastically smoothed (True) or of the elastic surface; None if the case gives the law itself.
    conductivity : {"bruggeman", "critical-junction"}
    separation_width : {"effective", "plain"} or None
        Width of the Gaussians in P(u); None for the critical junction, which needs no P(u).
    percolation_threshold : float
    leak_rate : tuple of float
        At each load [m^3/s].
    used : bool
        Whether it is the one that the case asks for.
    """

    plastic: bool | None
    conductivity: str
    separation_width: str | None
    percolation_threshold: float
    leak_rate: tuple[float, ...]
    used: bool

    @property
    def interface_law(self) -> str:
        """The law in a word."""
        return "given" if self.plastic is None else "plastic" if self.plastic else "elastic"


def theory_variants(result: SealResult) -> tuple[TheoryVariant, ...]:
    """Leak rates of all loads with every reading of the theory: p(u), P(u), percolation threshold, channels.

    Parameters
    ----------
    result : SealResult

    Returns
    -------
    tuple of TheoryVariant
        Empty if nothing leaks in the case for want of roughness or fluid.
    """
    from fem_seal.pipeline import interface_law

    case, surface = result.case, result.surface
    if surface is None or case.fluid is None:
        return ()
    variants: list[TheoryVariant] = []
    for plastic in _laws(result):
        contacts: Sequence[ContactSolution] = result.contact
        if plastic is not None and plastic != case.interface.plastic:
            changed = case.model_copy(
                update={"interface": case.interface.model_copy(update={"plastic": plastic})}
            )
            contacts = _contacts(result, interface_law(changed, surface))
        variants += [
            _variant(case, surface, contacts, plastic, *flow) for flow in _flows(case, surface.peklenik)
        ]
    return tuple(variants)


def _contacts(result: SealResult, law: Law) -> Sequence[ContactSolution]:
    """The loads of a result with another interface law."""
    from fem_seal.contact import solve
    from fem_seal.load_solver import LoadSolver
    from fem_seal.solved_loads import solve_loads

    if result.unloaded is not None:
        return solve_loads(LoadSolver(result.case, law, result.model)).contacts
    return tuple(
        solve(result.model, law, axial_force=load.axial_force, loads=load.contact.loads, start=load.contact)
        for load in result.loads
    )


def _laws(result: SealResult) -> tuple[bool | None, ...]:
    if result.case.interface.law != "persson":
        return (None,)
    assert result.surface is not None
    return (False,) if result.surface.hardness is None else (False, True)


def _flows(case: Case, peklenik: float) -> list[tuple[str, str | None, float]]:
    """Conductivity, width in P(u) and threshold."""
    thresholds = sorted({*_THRESHOLDS, case.leak.percolation_threshold})
    channels: list[tuple[str, str | None, float]] = [
        ("bruggeman", width, threshold) for width, threshold in product(_WIDTHS, thresholds)
    ]
    if peklenik != 1.0:
        return channels  # one junction knows no direction
    return [*channels, *(("critical-junction", None, threshold) for threshold in thresholds)]


def _variant(
    case: Case,
    surface: RoughContact,
    contacts: Sequence[ContactSolution],
    plastic: bool | None,
    conductivity: str,
    width: str | None,
    threshold: float,
) -> TheoryVariant:
    from fem_seal.pipeline import conductivity_table, leak_of_contact

    read = case.model_copy(update={"leak": case.leak.model_copy(update={"conductivity": conductivity})})
    surface = replace(
        surface,
        percolation_threshold=threshold,
        separation_width=surface.separation_width if width is None else width,
    )
    table = conductivity_table(read, surface, contacts)
    rates = tuple(
        leak_of_contact(read, table, contact, pressure).leak_rate
        for contact, pressure in zip(contacts, case.load.fluid_pressure, strict=True)
    )
    used = (
        plastic in (None, case.interface.plastic)
        and conductivity == case.leak.conductivity
        and width in (None, "effective")
        and threshold == case.leak.percolation_threshold
    )
    return TheoryVariant(plastic, conductivity, width, threshold, rates, used)


def variant_rows(result: SealResult) -> list[dict[str, object]]:
    """Rows with `COLUMNS`, one per reading and load.

    Parameters
    ----------
    result : SealResult
        With its `theory_variants`.
    """
    return [
        dict(
            zip(
                COLUMNS,
                (
                    variant.interface_law,
                    variant.conductivity,
                    variant.separation_width or "",
                    variant.percolation_threshold,
                    load.fluid_pressure,
                    rate,
                    ratio_to_case(rate, load.leak.leak_rate if load.leak else 0.0),
                ),
                strict=True,
            )
        )
        for variant in result.theory_variants
        for load, rate in zip(result.loads, variant.leak_rate, strict=True)
    ]


def ratio_to_case(leak_rate: float, of_case: float) -> float:
    """Leak rate over that of the case; NaN where the case is sealed."""
    return leak_rate / of_case if of_case > 0 else float("nan")


def write_variants_csv(result: SealResult, path: Path) -> Path:
    """Write variants.csv, atomically."""
    lines = [",".join(COLUMNS)]
    lines += [
        ",".join(f"{value:.10g}" if isinstance(value, float) else str(value) for value in row.values())
        for row in variant_rows(result)
    ]
    return write_text(path, "\n".join(lines) + "\n")
