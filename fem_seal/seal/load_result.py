"""Results: a load with its contact and leak rate, and what tells it from the other loads of a seal."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Self, TypeVar

import numpy as np

from fem_seal.profile import PressureProfile, join_lands, tightest_profile
from fem_seal.seal.leak_model import Conductivity, FlowModel, LeakModel
from fem_seal.units import DIGITS, Display, Unit, digits_within
from fem_seal.wording import Words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from fem_seal.arrays import FloatArray
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.errors import Problem
    from fem_seal.seal.circumference import Circumference
    from fem_seal.seal.problem import SealProblem
    from leak import LeakResult
    from leak.flow.turned_contact import FaceContact


@dataclass(frozen=True, eq=False)
class LoadResult:
    """One load of a case, which works out what it is asked for.

    Parameters
    ----------
    fluid_pressure : float
        Pressure difference across the seal [Pa].
    applied_force : float
        Force of spring or actuator on the closure [N], positive where it closes.
    contact : ContactSolution
    rough : LeakModel or None
        Surfaces and fluid; None without roughness.
    circumference : Circumference or None
        Line load around the axis, of which `contact` carries the mean; None for a round seal.
    opening : OpeningMargin or None
        How far the load is from opening the seal; None where neither fluid nor spring opens it, or it is not known.
    mesh_error : DiscretisationError or None
        What the mesh leaves uncertain; None where nobody asked.
    """

    fluid_pressure: float
    applied_force: float
    contact: ContactSolution
    rough: LeakModel | None = None
    circumference: Circumference | None = None
    opening: OpeningMargin | None = None
    mesh_error: DiscretisationError | None = None

    def with_values(self, **values: object) -> Self:
        """A load that knows more; what was worked out already stays, which `dataclasses.replace` would forget.

        Parameters
        ----------
        values : object
            Values of optional fields, or of cached properties in place of what they would work out.
        """
        fields = vars(self).keys()
        # a value in place of a plain property would never be read
        kinds = {
            name: getattr(type(self), name, property() if name not in fields else None) for name in values
        }
        if strange := [name for name, kind in kinds.items() if isinstance(kind, property)]:
            raise AttributeError(f"{type(self).__name__} has no optional {', '.join(strange)}")
        other = object.__new__(type(self))
        vars(other).update(vars(self), **values)
        return other

    @property
    def others(self) -> Mapping[str, LoadResult]:
        """The load in scenarios of which a number stands beside wherever its own is told; none of one alone."""
        return {}

    def digits_of(self, name: str) -> int:
        """Significant digits that the error of the mesh leaves of one of its numbers, four at most.

        Parameters
        ----------
        name : {"peak_pressure", "fwhm", "std", "leak_rate"}
            Stresses in the bodies are as good as the peak pressure.
        """
        if self.mesh_error is None:
            return DIGITS
        # where the strongest load is sealed, nothing is known of what the others leak but the contact that it follows
        error = getattr(self.mesh_error, name)
        share = max(self.mesh_error.peak_pressure, self.mesh_error.std) if error is None else error
        return max(digits_within(share), 1)

    @property
    def pressure_digits(self) -> int:
        """Significant digits of contact pressures and stresses: what errors and the distance from opening leave."""
        of_force = DIGITS if self.opening is None else self.opening.digits
        return min(of_force, self.digits_of("peak_pressure"))

    @property
    def of_profile(self) -> bool:
        """Whether its contact is a given pressure profile, of whose bodies and their forces nothing is known."""
        return isinstance(self.contact, GivenContact)

    @property
    def contacts(self) -> tuple[ContactSolution, ...]:
        """The contact at the mean line load and, of a seal that is not round, at the largest."""
        return (self.contact,) if self.circumference is None else (self.contact, *self.circumference.extremes)

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and force of spring or actuator [N]."""
        return self.fluid_pressure, self.applied_force

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Nominal pressure profile on each contact line, from the axis outwards."""
        return self.contact.profiles

    @property
    def whole_profile(self) -> PressureProfile:
        """All of the contact as one profile, with its lands."""
        return join_lands(self.profiles)

    @property
    def tightest(self) -> PressureProfile:
        """The profile on the line that is pressed hardest."""
        return self.contact.profile

    @property
    def peak_pressure(self) -> float:
        """Highest contact pressure [Pa]."""
        return self.tightest.peak_pressure

    @property
    def std(self) -> float:
        """Square root of the second central moment of the pressure on the line that is pressed hardest [m]."""
        return self.tightest.std

    @property
    def contact_force(self) -> float:
        """Force F_N that the solid contact carries [N]."""
        return self.contact.contact_force

    @property
    def line_load(self) -> float:
        """f_N [N/m]."""
        return self.contact.line_load

    @cached_property
    def leak(self) -> LeakResult | None:
        """Flow through the contact, with its form error; None without roughness or fluid."""
        if self.circumference is None:
            return self.leak_round
        return None if self.around is None else self.around.leak

    @cached_property
    def leak_round(self) -> LeakResult | None:
        """The same of the round seal."""
        return None if self.rough is None else self.rough.leak(self.whole_profile, self.fluid_pressure)

    @cached_property
    def around(self) -> Circumference | None:
        """Line load, pressure and leak around the axis; None for a round seal."""
        circumference = self.circumference
        flow = None if self.rough is None else self.rough.at(self.fluid_pressure)
        if circumference is None or flow is None:
            return circumference
        from fem_seal.seal.circumference import LeakCurve

        return circumference.with_leak(LeakCurve(circumference.local, flow))

    @cached_property
    def leak_before_sealing(self) -> float:
        """What leaks at most where the percolation threshold decides [m^3/s]; zero where it does not."""
        if self.rough is None or self.circumference is not None:
            return 0.0
        return self.rough.leak_before_sealing(self.whole_profile, self.fluid_pressure)

    @cached_property
    def critical_separation(self) -> float | None:
        """u_c at the peak pressure [m]; None without roughness."""
        return None if self.rough is None else self.rough.critical_separation(self.contact.profile)

    @cached_property
    def largest_stress(self) -> tuple[float, tuple[str, float, float]]:
        """Largest von Mises stress in both bodies [Pa], name of the body and place (r, z) [m]."""
        worst = max(self.contact.fields.values(), key=lambda field: float(field.von_mises.max()))
        node = int(np.argmax(worst.von_mises))
        r, z = worst.points[node].tolist()
        return float(worst.von_mises[node]), (worst.name, r, z)


def load_results(
    problem: SealProblem,
    points: Iterable[tuple[float, float]],
    contacts: Sequence[ContactSolution],
    circumferences: Sequence[Circumference | None],
    table: Callable[[FlowModel, FaceContact, Sequence[float]], Conductivity] | None = None,
    others: Sequence[ContactSolution] = (),
) -> tuple[LoadResult, ...]:
    """Loads of a problem on contacts that are known; one that comes again is the same, and so is its leak rate.

    Parameters
    ----------
    problem : SealProblem
    points : iterable of tuple
        Fluid pressure [Pa] and applied force [N] of each.
    contacts : sequence of ContactSolution
    circumferences : sequence of Circumference or None
        Each contact around the axis; None for a round seal.
    table : callable, optional
        Conductivity of a flow and a surface, over peak pressures given as decimal logarithms.
    others : sequence of ContactSolution
        Others over whose pressures the conductivity is tabulated as well.
    """
    results: dict[Hashable, LoadResult] = {}
    bare = [
        results.setdefault((point, id(contact)), LoadResult(*point, contact, circumference=circumference))
        for point, contact, circumference in zip(points, contacts, circumferences, strict=True)
    ]
    all_contacts = [*others, *(contact for load in results.values() for contact in load.contacts)]
    rough = LeakModel.of(problem.surface, problem.flow, all_contacts, table) if all_contacts else None
    result_of = {load: load.with_values(rough=rough) for load in results.values()}
    return tuple(result_of[load] for load in bare)


def on_new_surfaces(load: LoadResult) -> LoadResult:
    """A load as if no place had carried more before; itself where none has.

    Parameters
    ----------
    load : LoadResult
    """
    if load.of_profile or load.contact.first_loading is load.contact:
        return load
    circumference = load.circumference and replace(load.circumference, before=None)
    return replace(load, contact=load.contact.first_loading, circumference=circumference)


def strongest_load(loads: Sequence[LoadResult]) -> int:
    """Number of the load with the largest closing force F_N."""
    return max(range(len(loads)), key=lambda n: loads[n].line_load)


def highest_load(loads: Sequence[AnyLoad]) -> int:
    """Number of the load with the highest fluid pressure; of several, the one that spring or actuator closes most."""
    return max(range(len(loads)), key=lambda n: loads[n].point)


@dataclass(frozen=True, eq=False)
class GivenContact:
    """A contact of which nothing but the pressure profile is known.

    Parameters
    ----------
    whole_profile : PressureProfile
        With its lands.
    step : str, optional
        What the load step is called that it comes from.
    """

    whole_profile: PressureProfile
    step: str = ""
    largest = None
    history = ()

    @property
    def profiles(self) -> tuple[PressureProfile, ...]:
        """Of each land, from the axis outwards."""
        return self.whole_profile.lands

    @property
    def profile(self) -> PressureProfile:
        """Of the land that is pressed hardest."""
        return tightest_profile(self.profiles)

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Contact pressure [Pa]."""
        return self.whole_profile.pressure

    @property
    def line_load(self) -> float:
        """Int p dx [N/m]."""
        return self.whole_profile.moment(0)


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
class OpeningMargin:
    """Distance of a load from opening the seal.

    Parameters
    ----------
    force : float
        By which the force of spring or actuator may fall at this fluid pressure before the seal opens [N].
    pressure : float
        By which the fluid pressure may change under this force: rise where it lifts the closure, fall where it holds
        it against the spring [Pa].
    share : float
        Either of them over what acts; the same number, as force and pressure that open the seal are in proportion.
    """

    force: float
    pressure: float
    share: float

    @property
    def digits(self) -> int:
        """Significant digits that what the solid contact carries is worth, see `digits_near_opening`."""
        return digits_near_opening(self.share)


def digits_near_opening(share: float) -> int:
    """Significant digits that what the solid contact carries is worth, four at most.

    It is the difference of spring and fluid: their relative errors count 1/share times, and each factor of ten costs a
    digit.

    Parameters
    ----------
    share : float
        See `OpeningMargin.share`.
    """
    return min(max(DIGITS + round(math.log10(share)), 1), DIGITS) if share > 0 else 1


@dataclass(frozen=True)
class MissingLoad:
    """A load of a case that could not be calculated.

    Parameters
    ----------
    number : int
        Among all loads of the case.
    fluid_pressure : float
        [Pa]
    applied_force : float
        Of spring or actuator, with bolts their preload [N].
    problem : Problem
        Why.
    bolted : bool
        Whether the force is a preload.
    """

    number: int
    fluid_pressure: float
    applied_force: float
    problem: Problem
    bolted: bool = False

    @property
    def point(self) -> tuple[float, float]:
        """Fluid pressure [Pa] and applied force [N]."""
        return self.fluid_pressure, self.applied_force

    @property
    def column_values(self) -> dict[str, float]:
        """What is known of it, by the names of columns."""
        force = "bolt_preload_N" if self.bolted else "applied_force_N"
        return {"fluid_pressure_Pa": self.fluid_pressure, force: self.applied_force}


AnyLoad = LoadResult | MissingLoad
Row = TypeVar("Row")


def in_order(
    of_loads: Iterable[Row], missing_loads: Iterable[MissingLoad], row: Callable[[MissingLoad], Row]
) -> list[Row]:
    """One entry per load of a case: those of the loads that were calculated, and those of the others between them.

    Parameters
    ----------
    of_loads : iterable
    missing_loads : iterable of MissingLoad
        In their order.
    row : callable
        The entry of a load that could not be calculated.
    """
    rows = list(of_loads)
    for load in missing_loads:
        rows.insert(load.number, row(load))
    return rows


def load_name(load: AnyLoad, loads: Sequence[AnyLoad], display: Display | None = None) -> str:
    """What tells a load from the others: "20 bar", "20 bar with 400 N", or "20 bar (load 3)" where a path comes back.

    Parameters
    ----------
    load : LoadResult or MissingLoad
    loads : sequence
        All of them, in their order.
    display : Display, optional
        Those of the field unless given.
    """
    return load_words(load, loads).text(display)


def load_values(load: AnyLoad, loads: Sequence[AnyLoad], display: Display | None = None) -> str:
    """Pressure of a load and, if more forces act at this pressure, its force: "20 bar", "20 bar with 400 N".

    Parameters
    ----------
    load : LoadResult or MissingLoad
    loads : sequence
        All of them.
    display : Display, optional
        Those of the field unless given.
    """
    return _values(load, loads, "").text(display)


def load_words(load: AnyLoad, loads: Sequence[AnyLoad]) -> Words:
    """What `load_name` says, for a sentence that is written later."""
    return _values(load, loads, _number(load, loads))


def _values(load: AnyLoad, loads: Sequence[AnyLoad], number: str) -> Words:
    forces = {other.applied_force for other in loads if other.fluid_pressure == load.fluid_pressure}
    # a dry contact has nothing but its force
    of_load = "{{ force | quantity('given force') }}"
    if load.fluid_pressure > 0:
        with_force = f" with {of_load}" if len(forces) > 1 else ""
        of_load = f"{{{{ pressure | quantity('given fluid pressure') }}}}{with_force}"
    return Words(of_load + number, {"pressure": load.fluid_pressure, "force": load.applied_force})


def distinct_loads(loads: Sequence[LoadResult]) -> list[int]:
    """Numbers of the loads, the line load rising, without those to which elastic bodies come back exactly.

    Parameters
    ----------
    loads : sequence of LoadResult
        All of them, in their order.
    """
    order = sorted(range(len(loads)), key=lambda n: loads[n].line_load)
    return list({(*loads[n].point, _number(loads[n], loads)): n for n in order}.values())


def _number(load: AnyLoad, loads: Sequence[AnyLoad]) -> str:
    comes_back = _yields(load) and [other.point for other in loads].count(load.point) > 1
    return f" (load {loads.index(load) + 1})" if comes_back else ""


def _yields(load: AnyLoad) -> bool:
    """Whether bodies yield under the load, so that the order of the loads matters."""
    from fem_seal.contact.load_path import ElastoplasticContact

    return isinstance(getattr(load, "contact", None), ElastoplasticContact)


@dataclass(frozen=True, eq=False)
class LoadAxis:
    """What changes from load to load, to draw results over.

    Parameters
    ----------
    name : str
    unit : Unit
    values : ndarray, shape (loads,)
        SI.
    names : tuple of str
        Of the loads, for a legend that is headed with `name`.
    order_matters : bool
        Whether the order of the loads matters, because a body remembers them.
    returns : bool
        Whether they come back to one that is not the same any more.
    """

    name: str
    unit: Unit
    values: FloatArray
    names: tuple[str, ...]
    order_matters: bool
    returns: bool

    @property
    def order(self) -> str:
        """How a picture shows the order of the loads: "joined", "numbered", or empty if it does not matter."""
        return ("numbered" if self.returns else "joined") if self.order_matters else ""

    @property
    def label(self) -> str:
        """Of the axis."""
        return f"{self.name}  [{self.unit.name}]"

    @property
    def numbers(self) -> FloatArray:
        """Values in the unit of the axis."""
        return self.values / self.unit.size


def load_axis(loads: Sequence[AnyLoad], display: Display | None = None) -> LoadAxis:
    """The fluid pressure, or the force of spring or actuator where it is all that changes.

    Parameters
    ----------
    loads : sequence of LoadResult
        In their order.
    display : Display, optional
        Those of the field unless given.
    """
    display = display or Display()
    pressures = np.array([load.fluid_pressure for load in loads])
    forces = np.array([load.applied_force for load in loads])
    path = any(_yields(load) for load in loads), any(_number(load, loads) for load in loads)
    if np.ptp(pressures) == 0 and np.ptp(forces) > 0:
        names = tuple(
            display.quantity(load.applied_force, "given force") + _number(load, loads) for load in loads
        )
        unit = display.unit_for("force", float(np.abs(forces).max()))
        return LoadAxis("applied force", unit, forces, names, *path)
    names = tuple(load_name(load, loads, display) for load in loads)
    unit = display.unit_for("fluid pressure", float(pressures.max()))
    return LoadAxis("fluid pressure", unit, pressures, names, *path)
