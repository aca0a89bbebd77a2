"""How much the result depends on what is far from the contact: the size of the housing and how its wall is held."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

from fem_seal.condensation import ContactModel, condense
from fem_seal.errors import ConvergenceError, InputError
from fem_seal.held_body import Supports
from fem_seal.load_names import load_name
from fem_seal.load_solver import interference, supports
from meshes import ContactGeometry, GeometryError, MeshingError, SealMesh, build_contact

if TYPE_CHECKING:
    from fem_seal.case import Case
    from fem_seal.contact_solution import ContactSolution
    from fem_seal.discretisation import CoarserLoad
    from fem_seal.results import SealResult

_LARGER = 2.0
# Relative changes below this are not worth a number.
_LEAST = 1e-5
_LENGTHS = ("outer_radius", "height")


@dataclass(frozen=True)
class FarFieldChange:
    """What a change far from the contact does to the load with the largest closing force, relative.

    Parameters
    ----------
    name : str
        What was changed.
    peak_pressure, fwhm : float
    leak_rate : float or None
        None without a leak rate, or where it is zero.
    """

    name: str
    peak_pressure: float
    fwhm: float
    leak_rate: float | None

    @property
    def largest(self) -> float:
        """Largest of the changes."""
        return max(abs(self.peak_pressure), abs(self.fwhm), abs(self.leak_rate or 0.0))


def far_field(load: CoarserLoad) -> tuple[FarFieldChange, ...]:
    """Solve one load with a housing twice as large, and with its wall held if it is free and free if it is held.

    Parameters
    ----------
    load : CoarserLoad
    """
    changes = []
    for name, model in _variations(load.solver.case, load.mesh):
        # Close to blow-off the seal may open with another support: that is told by the blow-off pressure.
        with suppress(InputError, ConvergenceError):
            changes.append(_change(name, load, load.solve(replace(load.solver, model=model))))
    return tuple(changes)


def far_field_sentence(result: SealResult) -> str:
    """The influence of the far field in one sentence; empty if nothing was compared."""
    if not result.far_field:
        return ""
    told = [
        f"{change.name} changes the peak pressure by {_in_words(change.peak_pressure)}"
        + ("" if change.leak_rate is None else f" and the leak rate by {_in_words(change.leak_rate)}")
        for change in result.far_field
    ]
    load = load_name(result.strongest, result.loads)
    which = "" if len(result.loads) == 1 else ", the load with the largest closing force"
    return f"Far from the contact, at {load}{which}: {'; '.join(told)}."


def _in_words(change: float) -> str:
    return f"{100 * change:+.2g} %" if abs(change) >= _LEAST else f"less than {100 * _LEAST:g} %"


def _variations(case: Case, mesh: SealMesh) -> Iterator[tuple[str, ContactModel]]:
    materials = {"closure": case.closure.material, "seat": case.seat.material}
    held = supports(case)
    if interference(case):
        return  # another size or support is another fit: that is no question of the far field
    # The larger housing is no question of this case if it cannot be built.
    with suppress(GeometryError, MeshingError):
        larger = _larger_housing(case)
        if larger is not None:
            model = condense(build_contact(larger, mesh.sizing), materials, held)
            yield "a housing twice as wide and high", model
    other = Supports(wall="fixed" if held.wall == "free" else "free")
    name = "holding its wall" if other.wall == "fixed" else "leaving its wall free"
    yield name, condense(mesh, materials, other)


def _larger_housing(case: Case) -> ContactGeometry | None:
    closure = case.closure.body()
    seat: Any = case.seat.body(closure)
    known = {field.name for field in fields(seat)} if is_dataclass(seat) else set()
    if not set(_LENGTHS) <= known:
        return None
    larger = replace(seat, **{name: _LARGER * getattr(seat, name) for name in _LENGTHS})
    return ContactGeometry.of(closure.outline, larger.outline)


def _change(name: str, base: CoarserLoad, changed: ContactSolution) -> FarFieldChange:
    before, after, flow = base.contact.profile, changed.profile, base.solver.flow
    leak_rate = None
    if flow is not None:
        leaks = flow.leak(before, base.fluid_pressure).leak_rate
        if 0 < leaks < float("inf"):
            leak_rate = flow.leak(after, base.fluid_pressure).leak_rate / leaks - 1
    return FarFieldChange(
        name, after.peak_pressure / before.peak_pressure - 1, after.fwhm / before.fwhm - 1, leak_rate
    )
