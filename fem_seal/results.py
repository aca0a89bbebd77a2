"""What a calculation leaves behind."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from fem_seal.caution import VALID, Validity

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

    from fem_seal.case import Case
    from fem_seal.condensation import ContactModel
    from fem_seal.contact_solution import ContactSolution
    from fem_seal.elastoplastic_path import Unloaded
    from fem_seal.far_field import FarFieldChange
    from fem_seal.opening import OpeningMargin
    from fem_seal.profile import PressureProfile
    from fem_seal.theory_variants import TheoryVariant
    from fem_seal.uncertainty import LeakInterval
    from leak import LeakResult, RoughContact
    from meshes import SealMesh


@dataclass(frozen=True, eq=False)
class LoadResult:
    """One load of a case.

    Parameters
    ----------
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    axial_force : float
        Force F_N that the solid contact carries [N].
    line_load : float
        f_N [N/m].
    contact : ContactSolution
    leak, leak_elastic : LeakResult or None
        With and without asperity plasticity on the same contact; None without roughness or fluid.
    critical_separation, critical_separation_elastic : float or None
        u_c at the peak pressure [m].
    max_von_mises : float
        Largest von Mises stress in both bodies [Pa].
    max_von_mises_at : tuple
        Name of the body and place (r, z) [m] of `max_von_mises`.
    applied_force : float
        Force of spring or actuator on the closure [N], positive where it closes.
    effective_radius : float or None
        Radius of the circle whose area times the fluid pressure is the fluid's force on the closure [m]; None unless
        the fluid gets between the surfaces.
    blow_off_pressure : float or None
        Fluid pressure that lifts the closure off at this applied force [Pa], infinite if none does; None if not asked.
    force_for_target : float or None
        Smallest applied force for which the leak rate stays below the target [N]; None if not asked or not found.
    validity : Validity
        How far the numbers can be trusted, and why no further; see docs/validity.md.
    target_validity : Validity or None
        The same of `force_for_target`; None without it.
    opening : OpeningMargin or None
        How far the load is from opening the seal; None where neither fluid nor spring opens it, or it is not known.
    """

    fluid_pressure: float
    axial_force: float
    line_load: float
    contact: ContactSolution
    leak: LeakResult | None
    leak_elastic: LeakResult | None
    critical_separation: float | None
    critical_separation_elastic: float | None
    max_von_mises: float
    max_von_mises_at: tuple[str, float, float]
    applied_force: float = 0.0
    effective_radius: float | None = None
    blow_off_pressure: float | None = None
    force_for_target: float | None = None
    validity: Validity = VALID
    target_validity: Validity | None = None
    opening: OpeningMargin | None = None

    @property
    def digits(self) -> int:
        """Significant digits that numbers which follow from the contact force are worth, four at most."""
        return 4 if self.opening is None else self.opening.digits

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and force of spring or actuator [N]."""
        return self.fluid_pressure, self.applied_force

    @property
    def gap_pressure(self) -> NDArray[np.float64] | None:
        """Fluid pressure at the points of the contact line [Pa]; None where nothing is known of it."""
        return self.contact.loads.gap_pressure if self.leak is None else self.leak.fluid_pressure


def strongest_load(loads: Sequence[LoadResult]) -> int:
    """Number of the load with the largest closing force F_N."""
    return max(range(len(loads)), key=lambda n: loads[n].axial_force)


@dataclass(frozen=True, eq=False)
class TargetContact:
    """The contact that leaks as much as the target, at one of the fluid pressures of a case.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    applied_force : float
        Force of spring or actuator that it takes [N].
    contact : ContactSolution
    critical_separation : float
        u_c at the peak pressure [m].
    """

    fluid_pressure: float
    applied_force: float
    contact: ContactSolution
    critical_separation: float

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and force of spring or actuator [N]."""
        return self.fluid_pressure, self.applied_force


@dataclass(frozen=True, eq=False)
class GivenContact:
    """A contact of which nothing but the pressure profile is known.

    Parameters
    ----------
    profile : PressureProfile
    """

    profile: PressureProfile


@dataclass(frozen=True, eq=False)
class GivenLoad:
    """The leak of a given pressure profile.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    contact : GivenContact
    leak : LeakResult
    critical_separation : float
        u_c at the peak pressure [m].
    applied_force : float
        Not known, and the same for all [N].
    """

    fluid_pressure: float
    contact: GivenContact
    leak: LeakResult
    critical_separation: float
    applied_force: float = 0.0

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and force of spring or actuator [N]."""
        return self.fluid_pressure, self.applied_force


@dataclass(frozen=True)
class InterfaceVariant:
    """What another choice of the interface law does to the load with the largest closing force.

    Parameters
    ----------
    name : str
    peak_pressure, fwhm, std : float
        [Pa], [m], [m].
    leak_rate : float or None
        [m^3/s].
    """

    name: str
    peak_pressure: float
    fwhm: float
    std: float
    leak_rate: float | None


@dataclass(frozen=True)
class DiscretisationError:
    """Estimated error of the load with the largest closing force, from the same solve on elements twice as large.

    A third of the difference: what the finer solution's error would be if it fell with the second power of the
    element size. It falls with the fourth, so that this is an upper estimate. Where a body yields, the load steps are
    twice as large, too, and it is the whole difference: their error falls with the first power of their size.

    Parameters
    ----------
    peak_pressure, fwhm, std : float
        Relative.
    leak_rate : float or None
        Relative.
    """

    peak_pressure: float
    fwhm: float
    std: float
    leak_rate: float | None


@dataclass(frozen=True)
class SealResult:
    """Everything that a case gave.

    Parameters
    ----------
    case : Case
        Without the loads that could not be calculated.
    seal_mesh : SealMesh
    model : ContactModel
    surface : RoughContact or None
        With the hardness if asperities yield; None without roughness.
    loads : tuple of LoadResult
        In the order of the case.
    discretisation_error : DiscretisationError
    interface_variants : tuple of InterfaceVariant
        Elastic and plastic p(u), for `law = "persson"` with a hardness; else empty.
    warnings : tuple of str
        Everything to know before believing the result, the worst first; each load's `validity` says what it means.
    timings : dict
        Wall time of each step [s].
    uncertainty : LeakInterval or None
        Leak rates with an interval, if the case has a table [uncertainty].
    theory_variants : tuple of TheoryVariant
        Leak rates with every reading of the theory, if asked for.
    far_field : tuple of FarFieldChange
        What another housing and another support of its wall do to the strongest load.
    unloaded : Unloaded or None
        Residual stress and imprint after the last load; None if both bodies are elastic.
    """

    case: Case
    seal_mesh: SealMesh
    model: ContactModel
    surface: RoughContact | None
    loads: tuple[LoadResult, ...]
    discretisation_error: DiscretisationError
    interface_variants: tuple[InterfaceVariant, ...] = ()
    warnings: tuple[str, ...] = ()
    timings: dict[str, float] = field(default_factory=dict)
    uncertainty: LeakInterval | None = None
    theory_variants: tuple[TheoryVariant, ...] = ()
    far_field: tuple[FarFieldChange, ...] = ()
    unloaded: Unloaded | None = None

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per load, the columns of leak.csv."""
        from fem_seal.tables import leak_table

        return leak_table(self)

    @property
    def strongest(self) -> LoadResult:
        """The load with the largest closing force; for it error, far field and interface laws are compared."""
        return self.loads[strongest_load(self.loads)]

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Pressure profile of each load."""
        return tuple(load.contact.profile for load in self.loads)

    @property
    def contact(self) -> tuple[ContactSolution, ...]:
        """Contact solution of each load."""
        return tuple(load.contact for load in self.loads)

    def write(self, folder: str | os.PathLike[str]) -> Path:
        """Write tables, summary, VTK files, mesh and report into a folder, all of them or none.

        They take the places of those of an earlier run together; a file ``UNFINISHED.txt`` stands in the folder
        meanwhile, and stays there only if the process is killed in these milliseconds.

        A file that cannot be made does not keep the others from being written; a Python warning names it.

        Parameters
        ----------
        folder : path
            Made if it does not exist.

        Raises
        ------
        InputError
            If another process writes into the folder.
        OutputError
            If a file cannot be written.
        """
        import warnings

        from fem_seal.folder_lock import alone
        from fem_seal.result_files import write

        with alone(Path(folder)):
            for failure in write(self, Path(folder)):
                warnings.warn(failure, stacklevel=2)
        return Path(folder)
