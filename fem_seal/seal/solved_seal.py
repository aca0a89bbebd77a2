"""A seal with solved loads, the input of every answer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Self

from fem_seal.seal.load_result import LoadResult, highest_load, strongest_load

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.contact.load_path import Unloaded
    from fem_seal.contact.model import ContactModel
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.errors import LoadProblem
    from fem_seal.profile import PressureProfile
    from fem_seal.seal.findings import Caution
    from fem_seal.seal.problem import SealProblem
    from leak import RoughContact
    from meshes import SealMesh


@dataclass(frozen=True)
class SolvedSeal:
    """A case, its bodies on their mesh and its loads.

    Parameters
    ----------
    case : Case
        Without the loads that could not be calculated.
    problem : SealProblem
        The same as the calculation knows it.
    seal_mesh : SealMesh
    model : ContactModel
    loads : tuple of LoadResult
        In the order of the case.
    unloaded : Unloaded or None
        Residual stress and imprint after the last load; None if both bodies are elastic.
    earlier : ContactSolution or None
        At the largest load before those of the case; None without one.
    missing : mapping
        Fluid pressure [Pa] and applied force [N] of each load without a result, with the reason.
    left_out : tuple of Caution
        The same in words.
    """

    case: Case
    problem: SealProblem = field(repr=False)
    seal_mesh: SealMesh
    model: ContactModel
    loads: tuple[LoadResult, ...]
    unloaded: Unloaded | None = None
    earlier: ContactSolution | None = None
    missing: Mapping[tuple[float, float], LoadProblem] = field(default_factory=dict)
    left_out: tuple[Caution, ...] = ()

    def with_loads(self, loads: Sequence[LoadResult]) -> Self:
        """The same seal, whose loads know more."""
        return replace(self, loads=tuple(loads))

    @property
    def surface(self) -> RoughContact | None:
        """With the hardness if asperities yield; None without roughness."""
        return self.problem.surface

    @property
    def strongest(self) -> LoadResult:
        """The load with the largest closing force; for it error, far field and interface laws are compared."""
        return self.loads[strongest_load(self.loads)]

    @property
    def highest(self) -> LoadResult:
        """The load with the highest fluid pressure, which headline, report and terminal explain."""
        return self.loads[highest_load(self.loads)]

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Pressure profile of each load."""
        return tuple(load.contact.profile for load in self.loads)

    @property
    def contact(self) -> tuple[ContactSolution, ...]:
        """Contact solution of each load."""
        return tuple(load.contact for load in self.loads)

    @property
    def leak_ranges(self) -> tuple[tuple[float, float] | None, ...]:
        """`LoadResult.leak_interval` of each load [m^3/s]; None where nothing makes one."""
        return tuple(load.leak_interval if load.has_interval else None for load in self.loads)
