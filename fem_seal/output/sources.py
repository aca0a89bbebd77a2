"""The publications behind the numbers of a result, as far as it used their formulas, and how to cite the program."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fem_seal.output.answer_output import prose
from fem_seal.output.tables import standards_used
from fem_seal.units import Display
from fem_seal.version import __version__
from fem_seal.wording import environment

if TYPE_CHECKING:
    from fem_seal.answers.solution import SealSolution


@dataclass(frozen=True)
class Source:
    """A publication and what was taken from it.

    Parameters
    ----------
    name : str
        Short name, as used in texts.
    reference : str
        Full reference.
    used_for : str
        Its use, in words.
    equations : tuple of str
        The equations, as one line of text each.
    """

    name: str
    reference: str
    used_for: str
    equations: tuple[str, ...] = ()


def sources(result: SealSolution) -> Iterator[Source]:
    """Publications whose formulas a result used, in the order of the calculation.

    Parameters
    ----------
    result : SealSolution
    """
    parts = {name for name, is_used in features_used(result).items() if is_used}
    for entry in prose()["sources"]:
        if "placeholder" in entry:
            yield from _own_sources(result, entry["placeholder"]) if "flow" in parts else ()
        elif set(entry.get("when", ())) <= parts:
            yield Source(
                entry["name"],
                entry["reference"],
                ", ".join(_choose_parts(entry["used_for"], parts)),
                tuple(_choose_parts(entry.get("equations", {}), parts)),
            )


def features_used(result: SealSolution) -> dict[str, bool]:
    """Features that a result used, by their names in words.toml.

    Parameters
    ----------
    result : SealSolution
    """
    from leak import Barus, Roelands, RoughContact, TurnedContact

    case, surface = result.case, result.surface
    roughness = None if surface is None else case.roughness
    law = None if case.fluid is None or case.fluid.gas is not None else case.fluid.pressure_law
    theory = surface.theory if isinstance(surface, RoughContact) else ""
    return {
        "flow": any(load.leak is not None for load in result.loads),
        "exponential law": case.interface.law == "exponential",
        "yielding bodies": result.unloaded_bodies is not None,
        "penetration": case.load.closing == "penetration",
        "roughness": isinstance(surface, RoughContact),
        "measured roughness": roughness is not None and roughness.is_measured,
        "finish": roughness is not None and bool(roughness.finishes),
        "yielding asperities": surface is not None and surface.hardness is not None,
        "paper's theory": theory == "paper",
        "corrected theory": theory == "corrected",
        "earlier load": any(load.remembers for load in result.loads),
        "turned faces": isinstance(surface, TurnedContact),
        "stretched roughness": surface is not None and surface.peklenik != 1.0,
        "gas": case.fluid is not None and case.fluid.gas is not None,
        "Barus": isinstance(law, Barus),
        "Roelands": isinstance(law, Roelands),
        "direct": case.leak.conductivity == "direct",
        "von Mises": case.simulated_asperities == "von-mises",
        "bruggeman": case.leak.conductivity == "bruggeman",
        "fluid in gap": case.leak.fluid_in_gap == "local" and case.fluid is not None,
        "interval": result.uncertainty is not None,
        "particles": bool(result.particles),
    }


def _own_sources(result: SealSolution, what: str) -> Iterator[Source]:
    """Publications of the fluid and of the leakage standards."""
    fluid = result.case.fluid
    if what == "standards":
        for standard in standards_used(result):
            memory = f"; from memory: {standard.from_memory}" if standard.from_memory else ""
            what = f"{standard.revision}; {standard.source}{memory}"
            yield Source(standard.name, what, f"leakage class of {standard.name}")
    elif fluid is not None and fluid.library_entry is not None:
        yield Source(fluid.name, fluid.library_entry.source, "properties of the fluid")


def _choose_parts(parts: Mapping[str, str], used: set[str]) -> Iterator[str]:
    return (text for name, text in parts.items() if name == "always" or name in used)


# Year of this version.
_YEAR = 2026


def citation() -> str:
    """Both references as text, followed by BibTeX."""
    text = environment(Display()).get_template("answers/citation.j2")
    return text.render(version=__version__, year=_YEAR)
