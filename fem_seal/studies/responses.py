"""From one design to its responses, as fast as the physics allows: nothing is written and nothing drawn.

Every number of a row depends on that design alone - never on the designs calculated before it in the same process -,
so that a study gives the same table in whatever order and on however many workers it runs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from fem_seal import result as seal_result
from fem_seal.analysis.caution import Validity
from fem_seal.analysis.opening import opening_margin
from fem_seal.analysis.problem import SealProblem, expected_forces, sizing
from fem_seal.analysis.results import LoadResult, OpeningMargin
from fem_seal.analysis.warnings import load_validity
from fem_seal.case.case import Case
from fem_seal.contact.laws import Law
from fem_seal.contact.newton import solve
from fem_seal.contact.refit import solve_fitted
from fem_seal.contact.solution import ContactSettings, ContactSolution
from fem_seal.loads import blow_off_of_sealed_area, closing_force
from fem_seal.output.columns import COLUMNS, LEAK_COLUMNS, Row
from fem_seal.output.tables import leak_rows
from fem_seal.profile import PressureProfile
from fem_seal.studies.shared import TabulatedSurface, family_law, family_table, shared_model
from leak import ConductivityTable, LeakResult, RoughContact
from meshes import Sizing

# Columns of leak.csv that take a complete run of the case; all others cost milliseconds.
_COMPLETE = (
    "leak_rate_low_m3_per_s",
    "leak_rate_high_m3_per_s",
    "knudsen_number",
    "max_accumulated_plastic_strain",
    "load_steps",
)
FAST = tuple(name for name in LEAK_COLUMNS if name not in _COMPLETE)
# u_eff [m] above which u_c, which is of its size, need not be compared with molecules of half a nanometre.
_NARROW = 20e-9
# The residual is that of the state itself and so the relative error of its pressures: a hundredth of what the mesh
# leaves. Mostly Newton's last step falls far below it.
_SETTINGS = ContactSettings(gap_tolerance=1e-6, force_tolerance=1e-6)


@dataclass(frozen=True)
class Evaluation:
    """What a design gives.

    Parameters
    ----------
    values : dict
        Columns of leak.csv, SI.
    validity : Validity
        How far they can be trusted, by the checks of the load itself: errors of the mesh and of the far field are
        found once per geometry and are no part of it.
    """

    values: dict[str, float]
    validity: Validity


def evaluate(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> Evaluation:
    """Columns of leak.csv for a case with one load, and their validity.

    Parameters
    ----------
    case, columns, interpolate
        See `responses`. Where the yield stress of a body is known the stresses are calculated, too.

    Raises
    ------
    ConvergenceError, GeometryError, MeshingError
    """
    if takes_complete_run(case, columns):
        return _complete_run(case, columns)
    can_yield = any(body.material.yield_stress for body in (case.closure, case.seat))
    stress = can_yield or "max_von_mises_Pa" in columns
    design = _Design(SealProblem.of(case), stress, _leaks(columns), interpolate)
    return Evaluation(
        _read(design, columns), load_validity(design.problem, design.load, design.judged_surface)
    )


def responses(case: Case, columns: Sequence[str], *, interpolate: bool = True) -> dict[str, float]:
    """Columns of leak.csv for a case with one load.

    Parameters
    ----------
    case : Case
        With one fluid pressure.
    columns : sequence of str
        Names of `fem_seal.output.columns.LEAK_COLUMNS`. Those in `FAST` cost milliseconds once geometry and surface
        are known; any other (leak_rate_low_m3_per_s, leak_rate_high_m3_per_s, knudsen_number,
        max_accumulated_plastic_strain, load_steps) takes a complete run of the case. So does any column of a case
        with load.closing = "penetration", load.target_leak_rate, leak.fluid_in_gap = "local", seat.wall = "fixed" or
        a stress-strain curve.
    interpolate : bool
        Whether flow conductivities of surfaces that differ in height, hardness or modulus alone may be interpolated,
        see `fem_seal.studies.shared`.

    Raises
    ------
    ConvergenceError, GeometryError, MeshingError
    """
    if takes_complete_run(case, columns):
        return _complete_run(case, columns).values
    stress = "max_von_mises_Pa" in columns
    return _read(_Design(SealProblem.of(case), stress, _leaks(columns), interpolate), columns)


def _read(design: _Design, columns: Sequence[str]) -> dict[str, float]:
    row = Row(design)
    return {column: COLUMNS[column].number(row) for column in columns}


def _leaks(columns: Sequence[str]) -> bool:
    return any(column.startswith(("leak_rate", "lift_off")) for column in columns)


def takes_complete_run(case: Case, columns: Sequence[str]) -> bool:
    """Whether columns of a case take seconds or minutes, see `responses`."""
    return not (set(columns) <= set(FAST) and _plain(case))


def _plain(case: Case) -> bool:
    """Whether contact and leak are those of the short way below."""
    return (
        case.load.closing == "sealed-area"
        and case.load.target_leak_rate is None
        and case.leak.fluid_in_gap == "uncoupled"
        and getattr(case.seat, "wall", "free") == "free"
        and case.closure.material.hardening is None
        and case.seat.material.hardening is None
    )


def _complete_run(case: Case, columns: Sequence[str]) -> Evaluation:
    result = seal_result.run(case)
    row, (load, *_) = leak_rows(result)[0], result.loads
    cautions = load.validity.without("mesh").cautions
    if "force_for_target_leak_N" in columns and load.target_validity is not None:
        # here the force is what the design is judged by
        cautions += load.target_validity.cautions
    return Evaluation({column: row[column] for column in columns}, Validity.of(cautions))


@dataclass(frozen=True)
class _Design:
    """One problem with one load, as columns see it; everything is calculated when it is asked for."""

    problem: SealProblem
    stress: bool
    leaks: bool
    interpolate: bool

    @property
    def surface(self) -> RoughContact | None:
        return self.problem.surface

    @cached_property
    def law(self) -> Law:
        interface = self.problem.interface
        if interface.law == "persson" and not interface.plastic and self.surface is not None:
            return family_law(self.surface)
        return self.problem.law

    @cached_property
    def contact(self) -> ContactSolution:
        force = expected_forces(self.problem)[0]

        def solve_on(sizing: Sizing) -> list[ContactSolution]:
            model = shared_model(self.problem, sizing, stress=self.stress)
            return [solve(model, self.law, axial_force=force, settings=_SETTINGS)]

        (contact,) = solve_fitted(
            sizing(self.problem, self.law),
            self.problem.contact,
            solve_on,
            size_given=self.problem.contact_size is not None,
        )
        return contact

    @cached_property
    def profile(self) -> PressureProfile:
        return self.contact.profile

    @property
    def fluid_pressure(self) -> float:
        return self.problem.loads.points[0][0]

    @property
    def applied_force(self) -> float:
        return self.problem.loads.points[0][1]

    @property
    def axial_force(self) -> float:
        return self.contact.axial_force

    @property
    def line_load(self) -> float:
        return self.contact.line_load

    @property
    def effective_radius(self) -> None:
        """Only where the fluid gets between the surfaces, which takes a complete run."""

    @property
    def force_for_target(self) -> None:
        """Not asked, or it takes a complete run."""

    @cached_property
    def leak(self) -> LeakResult | None:
        return self._leak(self.surface)

    @property
    def leak_elastic(self) -> LeakResult | None:
        if self.surface is None or self.surface.hardness is None:
            return self.leak
        return self._leak(self.surface.elastic)

    def _leak(self, surface: RoughContact | None) -> LeakResult | None:
        flow = self.problem.flow
        if surface is None or flow is None:
            return None
        shared = self._family_table if surface is self.surface else self._shared_table(surface)
        table = shared or flow.table_of(surface, [self.contact])
        return flow.leak_of(table, self.contact.profile, self.fluid_pressure)

    def _shared_table(self, surface: RoughContact) -> ConductivityTable | None:
        flow = self.problem.flow
        return family_table(flow, surface, self.contact) if self.interpolate and flow is not None else None

    @cached_property
    def _family_table(self) -> ConductivityTable | None:
        return None if self.surface is None else self._shared_table(self.surface)

    @property
    def _known_table(self) -> ConductivityTable | None:
        """The table of a design whose leak rate is asked for; for the checks alone it would take too long."""
        return self._family_table if self.leaks else None

    @property
    def judged_surface(self) -> RoughContact | TabulatedSurface | None:
        """The surface as the checks of a load ask of it."""
        table = self._known_table
        if self.surface is None or table is None:
            return self.surface
        return TabulatedSurface(self.surface, table.sealing_pressure)

    @property
    def _narrow(self) -> bool:
        """Whether the gap at the peak is small enough to compare it with molecules."""
        table = self._known_table
        peak = self.profile.peak_pressure
        return table is None or float(table.effective_separation(min(peak, table.p_max))) < _NARROW

    @cached_property
    def load(self) -> LoadResult:
        """What the checks of a load look at."""
        contact = self.contact
        return LoadResult(
            fluid_pressure=self.fluid_pressure,
            axial_force=self.axial_force,
            line_load=self.line_load,
            contact=contact,
            # no check of a fluid that does not move the surfaces asks for it
            leak=None,
            leak_elastic=None,
            critical_separation=self.critical_separation if self._narrow else None,
            critical_separation_elastic=None,
            max_von_mises=math.nan,
            max_von_mises_at=("", math.nan, math.nan),
            applied_force=self.applied_force,
            opening=self.opening,
        )

    @property
    def critical_separation(self) -> float | None:
        return self._separation(self.surface)

    @property
    def critical_separation_elastic(self) -> float | None:
        return self._separation(None if self.surface is None else self.surface.elastic)

    def _separation(self, surface: RoughContact | None) -> float | None:
        if surface is None:
            return None
        return float(surface.critical_separation(self.profile.peak_pressure))

    @property
    def blow_off_pressure(self) -> float | None:
        if self.problem.loads.pressure_side == "outer":
            return None
        return blow_off_of_sealed_area(self.problem.touch_radius, self.applied_force, "inner")

    @property
    def opening(self) -> OpeningMargin | None:
        side = self.problem.loads.pressure_side
        held = -closing_force(self.problem.touch_radius, self.fluid_pressure, 0.0, side)
        return opening_margin(
            self.fluid_pressure, self.applied_force, side, opens=self.blow_off_pressure, held=held
        )

    @property
    def max_von_mises(self) -> float:
        return max(float(field.von_mises.max()) for field in self.contact.fields.values())
