"""Flow conductivities that a slider needs again and again, made once and kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from fem_seal.seal.conductivity_tables import FamilyTable, family_table, family_tables
from fem_seal.seal.leak_model import MARGIN, Conductivity, Flow, theory_table
from leak import RoughContact

# Decades below the peak pressure over which a table of one surface alone reaches.
_DECADES = 9


class Missing(Exception):
    """Something that is not there yet and takes longer than a slider may.

    Parameters
    ----------
    keys : sequence
        Names of what is missing.
    """

    def __init__(self, keys: Sequence[Hashable]) -> None:
        super().__init__(f"{len(keys)} tables are not there yet")
        self.keys = tuple(keys)


@dataclass(frozen=True)
class OwnTable:
    """Name of a table of one surface alone, over whole decades of pressure.

    Parameters
    ----------
    surface : RoughContact
    low, high : int
        Decimal logarithms of the pressures [Pa].
    method : str
    gas : bool
    """

    surface: RoughContact
    low: int
    high: int
    method: str
    gas: bool

    def made(self) -> Conductivity:
        """The table."""
        low, high = 10.0**self.low, 10.0**self.high
        return theory_table(self.surface, low, high, None, self.method, of_gas=self.gas)


TableName: TypeAlias = FamilyTable | OwnTable


def conductivity(
    flow: Flow,
    surface: RoughContact,
    log_peak: float,
    known: Callable[[TableName], Conductivity | None],
    *,
    family: bool = True,
) -> Conductivity:
    """Flow conductivity of a surface, for liquids and gases, from tables that are kept.

    Parameters
    ----------
    flow : Flow
    surface : RoughContact
    log_peak : float
        Decimal logarithm of the highest pressure [Pa].
    known : callable
        Gives a table, or None if it is not there.
    family : bool
        Whether surfaces that follow have the same shape of spectrum, and tables of that shape are worth while.

    Raises
    ------
    Missing
        If one of them is not there.
    """
    names: Sequence[TableName]
    if family:
        names = family_tables(flow, surface)
    else:
        low, high = math.floor(log_peak - _DECADES), math.ceil(log_peak + MARGIN)
        names = (OwnTable(surface, low, high, flow.conductivity, flow.gas is not None),)
    found = {name: known(name) for name in names}
    tables = [table for table in found.values() if table is not None]
    if missing := [name for name in found if found[name] is None]:
        raise Missing(missing)
    made = family_table(flow, surface, tables) if family else tables[0]
    assert made is not None  # a simulation is not followed live
    return made
