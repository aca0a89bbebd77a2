"""Words for the theories of the rough contact and their readings of yielding asperities."""

from __future__ import annotations

from dataclasses import dataclass

from fem_seal.files import own_tables
from leak.theory.plasticity import READINGS, Reading

OWN, *FURTHER = READINGS["paper"]
"""The reading that a case takes, and those that stand beside it."""


THEORIES = {"paper": "the paper's theory", "corrected": "the corrected theory"}
"""What the theories of the rough contact are called."""


def leak_rate_column(reading: str) -> str:
    """Column of the leak rate in a reading, or by a theory.

    Parameters
    ----------
    reading : Reading or str
    """
    return f"leak_rate_{reading}_m3_per_s"


def force_column(reading: Reading) -> str:
    """Column of the force for a target leak rate in a reading.

    Parameters
    ----------
    reading : Reading
    """
    return f"force_for_target_leak_{reading}_N"


@dataclass(frozen=True)
class ReadingWords:
    """What a reading is called where.

    Parameters
    ----------
    asperities : str
        A noun, such as "elastic asperities".
    curve : str
        In the legend of a picture.
    short : str
        The same beside a name.
    condition : str
        A clause that begins with "if".
    taken : str
        What a number is calculated with.
    column : str
        Behind "leak rate" in the description of its column.
    title : str
        Behind "leak rate, " on an axis.
    """

    asperities: str
    curve: str
    short: str = ""
    condition: str = ""
    taken: str = ""
    column: str = ""
    title: str = ""


WORDS = {Reading(name): ReadingWords(**words) for name, words in own_tables("readings.toml").items()}
