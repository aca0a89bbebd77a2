"""What the report says of bodies that yield: where and how far they yielded, and what that did to the contact."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fem_seal.elastoplastic_contact import ElastoplasticContact
from fem_seal.hardening import HardeningCurve
from fem_seal.load_names import load_name
from fem_seal.readable import given, number, percent, quantity
from fem_seal.report_tables import ReadableTable
from fem_seal.yielding import PlasticZone, yielding_of

if TYPE_CHECKING:
    from fem_seal.results import LoadResult, SealResult


def imprint_in_words(result: SealResult) -> tuple[str, str] | None:
    """Depth of the deepest imprint, and in which body and how wide; None if nothing has yielded."""
    imprints = {} if result.unloaded is None else result.unloaded.imprints
    if not imprints:
        return None
    name, imprint = max(imprints.items(), key=lambda item: item[1].deepest)
    return (
        quantity("length", imprint.deepest),
        f"in the {name}, {quantity('length', imprint.width)} wide at half depth",
    )


def what_yielded(result: SealResult, load: LoadResult) -> Iterator[str]:
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


def yielding_table(result: SealResult) -> ReadableTable:
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


def path_accuracy(result: SealResult) -> Iterator[tuple[str, str]]:
    """Load steps and balance of the bodies that yield."""
    contacts = [load.contact for load in result.loads if isinstance(load.contact, ElastoplasticContact)]
    if contacts:
        yield "load steps", str(sum(contact.load_steps for contact in contacts))
        worst = max(contact.equilibrium_residuals[-1] for contact in contacts)
        yield "forces out of balance in the bodies", f"{number(worst, 1)} of the largest"
