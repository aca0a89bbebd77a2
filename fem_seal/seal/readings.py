"""Words for the theories of the rough contact and their readings of yielding asperities."""

from __future__ import annotations

from fem_seal.seal.scenarios import SCENARIOS
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


WORDS = SCENARIOS
