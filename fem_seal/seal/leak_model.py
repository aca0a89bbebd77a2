"""Flow of a fluid through a rough contact, for any pressure profile."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

import leak
from fem_seal.profile import join_lands
from fem_seal.sampling import CUT_OFF
from fem_seal.seal.surface_profile import MapFace, SurfaceProfile
from leak.flow.conductivity import table_abscissa
from leak.flow.turned_contact import calculated_table
from leak.numerics.roots import root_between

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from fem_seal.contact.solution import ContactSolution
    from fem_seal.loads import PressureSide
    from fem_seal.profile import PressureProfile
    from fem_seal.seal.direct import DirectSettings
    from leak import (
        ConductivityTable,
        Gas,
        GasConductivityTable,
        Groove,
        LeakBounds,
        LeakResult,
        PressureLaw,
    )
    from leak.flow.leak_rate import Permeant
    from leak.flow.turned_contact import FaceContact


# A/A0 where direct simulations of the flow end.
DIRECT_END = 0.39
# Hardness and heights are known to ten per cent at best (one standard deviation of the logarithm), and the sealing
# pressure, which is proportional to the one, to the other, or to a mean of both, no better.
INPUTS_KNOWN_TO = 0.1
# Density of a liquid of which none is known [kg/m^3].
_DENSITY = 1000.0
# Decades between the highest pressure and the end of a table.
MARGIN = 0.3

# A short table reaches so many decades below the lowest peak, where resistance is below 1e-4 of the whole, and above
# the highest; so many points it has at least, and for each unit of what its values are smooth in, up to this share of
# the sealing pressure.
_SHORT_BELOW, _SHORT_ABOVE, _SHORT_LEAST, _SHORT_DENSITY, _SHORT_END = 2.0, 0.05, 8, 1.7, 0.95

Conductivity: TypeAlias = "ConductivityTable | GasConductivityTable"


@dataclass(frozen=True)
class FlowModel:
    """A liquid or a gas, and how its way between rough surfaces is calculated.

    Parameters
    ----------
    fluid : str
        Its name.
    viscosity : float
        Of a liquid at atmospheric pressure [Pa s].
    density : float or None
        Of a gas at 101325 Pa [kg/m^3]; None if unknown.
    gas : Gas or None
        None for a liquid.
    outlet_pressure : float
        Of a gas: absolute pressure on the low side [Pa].
    fluid_in_gap : {"uncoupled", "local"}
        Whether the pressure of a liquid is taken off the load of the asperities, place by place.
    pressure_side : {"outer", "inner"}
        Side of the high pressure.
    direct : DirectSettings or None
        How the conductivity is simulated; None where it is the theory's effective medium.
    end : {-1, 0, 1}
        Of the interval that a simulation gives.
    pressure_law : PressureLaw or None
        How a liquid thickens and is compressed; None where nothing is known of it.
    chambers : tuple of float or None
        Pressure above the low side that each chamber between lands is held at, None where it follows from the flow
        [Pa]; empty where it does in all of them.
    faces : int
        Equal contacts through which it flows side by side.
    bore_radius : float
        Of what the fluid has to pass beside the contact [m]; infinite where nothing is narrower than that.
    """

    fluid: str
    viscosity: float
    density: float | None = None
    gas: Gas | None = None
    outlet_pressure: float = 0.0
    fluid_in_gap: Literal["uncoupled", "local"] = "uncoupled"
    pressure_side: PressureSide = "outer"
    direct: DirectSettings | None = None
    end: int = 0
    pressure_law: PressureLaw | None = None
    chambers: tuple[float | None, ...] = ()
    faces: int = 1
    bore_radius: float = field(default=math.inf, compare=False)

    def effective_viscosity(self, fluid_pressure: float) -> float | None:
        """Of a liquid: the viscosity of one that does not thicken and leaks as much [Pa s]; None for a gas.

        Parameters
        ----------
        fluid_pressure : float
            Pressure difference [Pa].
        """
        if self.gas is not None:
            return None
        return self.viscosity * leak.effective_viscosity_ratio(self.pressure_law, fluid_pressure)

    def through_open_bore(self, fluid_pressure: float, contact_radius: float) -> float:
        """What an open bore lets through, or the open circle of the contact where that is narrower [m^3/s].

        Parameters
        ----------
        fluid_pressure : float
            Pressure difference [Pa].
        contact_radius : float
            [m]
        """
        return self.without_friction(math.pi * min(self.bore_radius, contact_radius) ** 2, fluid_pressure)

    def without_friction(self, area: float, fluid_pressure: float) -> float:
        """What an opening lets through without friction, a gas at most choked [m^3/s].

        Parameters
        ----------
        area : float
            Where it is narrowest [m^2].
        fluid_pressure : float
            Pressure difference [Pa].
        """
        from leak.flow.leak_rate import gas_through_bore, liquid_through_bore
        from leak.standards import STANDARD_PRESSURE

        radius = math.sqrt(area / math.pi)
        if self.gas is None:
            return liquid_through_bore(radius, fluid_pressure, self.density or _DENSITY)
        high = self.outlet_pressure + fluid_pressure
        flow = gas_through_bore(radius, self.gas, high, self.outlet_pressure)
        return flow / self.gas.density(STANDARD_PRESSURE)

    def through_gap(self, x: FloatArray, radius: FloatArray, gap: FloatArray, fluid_pressure: float) -> float:
        """What flows through all equal gaps like this one, with nothing in them [m^3/s].

        Parameters
        ----------
        x, radius, gap : ndarray, shape (n,)
            Along the flow, distance from the axis and gap [m].
        fluid_pressure : float
            Pressure difference [Pa].
        """
        from leak.flow.leak_rate import gap_resistance, gas_through_gap

        resistance = gap_resistance(x, radius, gap) / self.faces
        viscosity = self.effective_viscosity(fluid_pressure)
        if self.gas is None or viscosity is not None:
            return fluid_pressure / (resistance * (viscosity or self.viscosity))
        high = self.outlet_pressure + fluid_pressure
        return gas_through_gap(resistance, float(gap.min()), self.gas, high, self.outlet_pressure)

    @property
    def elastic(self) -> FlowModel:
        """The same where nothing yields in a simulation; itself without one."""
        direct = self.direct
        if direct is None or direct.elastic is direct:
            return self
        return replace(self, direct=direct.elastic)

    def table(self, surface: FaceContact, p_min: float, p_max: float, num: int | None = None) -> Conductivity:
        """Flow conductivity of a surface over a range of contact pressures.

        Parameters
        ----------
        surface : FaceContact
        p_min, p_max : float
            [Pa]
        num : int, optional
            Number of pressures; by default as many as the error asks for.
        """
        if self.direct is not None:
            of_gas = self.gas is not None
            return self.direct.conductivity(surface, p_min, p_max, num, end=self.end, of_gas=of_gas)
        return calculated_table(surface, p_min, p_max, num, of_gas=self.gas is not None)

    def table_around(self, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
        """Flow conductivity of a surface over all pressures that occur in contacts with some peak pressures.

        The range reaches six decades below the smallest peak, where the table goes on by the low-pressure law. It is
        rounded out to whole decades, so that neighbouring contacts share one table.

        Parameters
        ----------
        surface : FaceContact
        log_peaks : sequence of float
            Decimal logarithms of the peak pressures [Pa].
        """
        return self.table(surface, *range_around(log_peaks))

    def short_table(self, surface: FaceContact, log_peaks: Sequence[float]) -> Conductivity:
        """Flow conductivity around the peak pressures of a few contacts, the only ones that this surface has.

        Parameters
        ----------
        surface : FaceContact
        log_peaks : sequence of float
            Decimal logarithms of the peak pressures [Pa].
        """
        if self.direct is not None:
            return self.table_around(surface, log_peaks)
        low, high = 10.0 ** (min(log_peaks) - _SHORT_BELOW), 10.0 ** (max(log_peaks) + _SHORT_ABOVE)
        sealing = surface.sealing_pressure
        ends = np.log([low, min(high, _SHORT_END * sealing)])
        way = np.diff(table_abscissa(ends, math.log(sealing)))
        return self.table(surface, low, high, max(_SHORT_LEAST, math.ceil(_SHORT_DENSITY * float(way[0]))))

    def permeant(self, table: Conductivity, high: float, low: float = 0.0) -> Permeant:
        """What flows between two pressures.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
        high, low : float
            Above the low side of the seal [Pa].
        """
        from leak.flow.leak_rate import GasPermeant, LiquidPermeant

        if isinstance(table, leak.ConductivityTable):
            sigma = table.at(self.viscosity)
            liquid = LiquidPermeant.of(sigma, high, self.pressure_law, self.viscosity, self.density)
            return replace(liquid, low=low) if low else liquid
        assert self.gas is not None  # the table is one of a gas
        outlet = self.outlet_pressure
        return GasPermeant.of(table, self.gas, outlet + high, outlet + low)

    def conductivity_at(self, table: Conductivity, pressure: FloatArray, fluid_pressure: float) -> FloatArray:
        """sigma_eff at contact pressures, of a gas at the mean of its pressures at both ends [m^3/(Pa s)].

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
        pressure : ndarray, shape (n,)
            [Pa]
        fluid_pressure : float
            Pressure difference [Pa].

        Returns
        -------
        ndarray, shape (n,)
            Zero where sealed.
        """
        sigma = self._sigma(table, np.log(pressure))
        return sigma(np.array(self.outlet_pressure + 0.5 * fluid_pressure)) if callable(sigma) else sigma

    def _sigma(
        self, table: Conductivity, log_pressure: FloatArray
    ) -> FloatArray | Callable[[FloatArray], FloatArray]:
        """sigma_eff at ln(p/Pa), of a gas over its pressure."""
        if isinstance(table, leak.ConductivityTable):
            return table.at(self.viscosity).at_log_pressure(log_pressure)
        assert self.gas is not None  # the table is one of a gas
        return leak.rarefied_conductivity(table, self.gas, log_pressure)

    def in_contact(self, table: Conductivity, surface: FaceContact, profile: PressureProfile) -> Conductivity:
        """Table of a contact, which may be only a few waves wide; that of crests or of a simulation knows no width.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
            Of the endless surface.
        surface : FaceContact
        profile : PressureProfile
        """
        if self.direct is not None or isinstance(surface, leak.TurnedContact):
            return table
        from leak.flow.short_medium import in_profile

        radius = float(np.interp(profile.centroid, profile.x, profile.radius))
        return in_profile(surface, table, profile.contact_for(table), radius)

    def leak_of(
        self, table: Conductivity, surface: FaceContact, profile: PressureProfile, fluid_pressure: float
    ) -> LeakResult:
        """Leak of one contact, or of several lands in series, and of all that are equal to it.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
            For all pressures of the contact.
        surface : FaceContact
            Of which the table is.
        profile : PressureProfile
            Not after a larger load with fluid_in_gap = "local", of which the theory says nothing then.
        fluid_pressure : float
            Pressure difference [Pa].

        Returns
        -------
        LeakResult
            A `leak.CoupledLeakResult` for fluid_in_gap = "local".
        """
        profile = profile.at_rest(surface)
        return self.leak_by(self.in_lands(table, surface, profile), profile, fluid_pressure)

    def in_lands(
        self, table: Conductivity, surface: FaceContact, profile: PressureProfile
    ) -> list[Conductivity]:
        """Table of each land of a contact over metal that is not strained, see `in_contact`.

        Parameters
        ----------
        table, surface, profile
            See `leak_of`.
        """
        return [self.in_contact(table, surface, land) if land.touches else table for land in profile.lands]

    def leak_by(
        self, tables: Sequence[Conductivity], profile: PressureProfile, fluid_pressure: float
    ) -> LeakResult:
        """`leak_of` by the table of each land itself, see `in_lands`.

        Parameters
        ----------
        tables : sequence of ConductivityTable or GasConductivityTable
        profile : PressureProfile
            Over metal that is not strained, see `PressureProfile.at_rest`.
        fluid_pressure : float
            Pressure difference [Pa].
        """
        ends = (fluid_pressure, 0.0) if self.pressure_side == "inner" else (0.0, fluid_pressure)
        if isinstance(profile, SurfaceProfile):
            if profile.share is None:
                ways = [self.permeant(table, fluid_pressure) for table in tables]
                return self._of_all_faces(profile.leak(*ways))
            flow = self._leak_across(tables[0], profile, *ends)
            return self._of_all_faces(flow.scaled(profile.share * flow.leak_rate))
        lands = profile.lands
        if len(lands) > 1:
            from leak.flow.series import SeriesContact, in_series

            chambers = self.chambers or (None,) * (len(lands) - 1)
            contacts = [
                SeriesContact(partial(self._leak_across, table, land) if land.touches else None, len(land.x))
                for table, land in zip(tables, lands, strict=True)
            ]
            return self._of_all_faces(in_series(contacts, *ends, chambers))
        return self._of_all_faces(self._leak_across(tables[0], lands[0], *ends))

    def _of_all_faces(self, flow: LeakResult) -> LeakResult:
        return flow if self.faces == 1 else flow.scaled(self.faces * flow.leak_rate)

    def _leak_across(
        self, table: Conductivity, profile: PressureProfile, inner: float, outer: float
    ) -> LeakResult:
        """Leak of one land between pressures on its inner and its outer side, above the low side of the seal [Pa]."""
        x, pressure, side = profile.x, profile.pressure, "inner" if inner > outer else "outer"
        high, low = max(inner, outer), min(inner, outer)
        if self.fluid_in_gap == "local" and isinstance(table, leak.ConductivityTable):
            assert profile.largest is None and low == 0.0  # the case's own checks refuse it
            return leak.coupled_leak_flow(
                x,
                pressure,
                table.at(self.viscosity),
                high,
                profile.radius,
                pressure_side=side,
                ends=profile.ends,
                pressure_law=self.pressure_law,
            ).with_density(self.density)
        from leak.flow.leak_rate import flow_through

        permeant = self.permeant(table, high, low)
        contact = profile.contact_for(table)
        flow = permeant.result(*flow_through(contact, x, pressure, permeant, side)).above_outlet
        return replace(flow, fluid_pressure=low + flow.fluid_pressure) if low and self.gas else flow

    def bounds(
        self,
        table: Conductivity,
        surface: FaceContact,
        profile: PressureProfile,
        fluid_pressure: float,
        grooves: Sequence[Groove],
    ) -> LeakBounds[Any]:
        """Leak of a contact with grooves across it, and of all that are equal to it.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
        surface : FaceContact
            Of which the table is.
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        grooves : sequence of Groove
        """
        from leak.flow.scratch import flow_along

        profile = profile.at_rest(surface)
        table = self.in_contact(table, surface, profile)
        permeant = self.permeant(table, fluid_pressure)
        x, pressure, contact = profile.x, profile.pressure, profile.contact_for(table)
        modulus, side = surface.effective_modulus, self.pressure_side
        bounds = flow_along(contact, x, pressure, grooves, permeant, modulus, side)
        if self.faces == 1:
            return bounds
        no_grooves, upper = (self._of_all_faces(flow.above_outlet) for flow in (bounds.without, bounds.upper))
        return leak.LeakBounds(no_grooves, upper, lambda: self._of_all_faces(bounds.lower.above_outlet))

    def goes_round(
        self, table: Conductivity, profile: PressureProfile, pressure: FloatArray, fluid_pressure: float
    ) -> float:
        """Share by which more leaks where the fluid may also go round than where it keeps to its angle.

        Parameters
        ----------
        table : ConductivityTable or GasConductivityTable
        profile : PressureProfile
            Whose x and radius hold for all angles.
        pressure : ndarray, shape (angles, points)
            Contact pressure at uniform angles around the axis [Pa].
        fluid_pressure : float
            Pressure difference [Pa].
        """
        from leak.flow.around import flow_round

        with np.errstate(divide="ignore"):
            log_pressure = np.maximum(np.log(pressure.T), -600.0)
        permeant, sigma = self.permeant(table, fluid_pressure), self._sigma(table, log_pressure)
        flow = leak.AroundFlow(*flow_round(profile.x, profile.radius, sigma, permeant, self.pressure_side))
        return flow.leak_rate / flow.radial_leak_rate - 1.0


@dataclass(frozen=True)
class ProfileLeak:
    """How the fluid of a seal gets through any pressure profile, at one pressure difference.

    Parameters
    ----------
    leak : callable
        Flow through a profile.
    bounds : callable
        Flow through a profile with grooves in it.
    conductivity : callable
        sigma_eff of the roughness at contact pressures [Pa], see `FlowModel.conductivity_at`.
    """

    leak: Callable[[PressureProfile], LeakResult]
    bounds: Callable[[PressureProfile, Sequence[Groove]], LeakBounds[Any]]
    conductivity: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class _Tables:
    """Conductivities over the pressures of some contacts, each made once for all readings, ends and gases.

    Parameters
    ----------
    table : callable
        Conductivity of a flow and a surface, over peak pressures given as decimal logarithms.
    peaks : sequence of float
        Decimal logarithms of the peak pressures [Pa].
    """

    table: Callable[[FlowModel, FaceContact, Sequence[float]], Conductivity]
    peaks: Sequence[float]
    tables: dict[Hashable, Conductivity] = field(default_factory=dict, repr=False)

    def __call__(self, flow: FlowModel, surface: FaceContact) -> Conductivity:
        # a table is that of all liquids, or of all gases
        name = surface, flow.direct, flow.end, flow.gas is None
        if name not in self.tables:
            self.tables[name] = self.table(flow, surface, self.peaks)
        return self.tables[name]


def range_around(log_peaks: Sequence[float]) -> tuple[float, float]:
    """Range of a table for contacts with some peak pressures, see `FlowModel.table_around` [Pa].

    Parameters
    ----------
    log_peaks : sequence of float
        Decimal logarithms of the peak pressures [Pa].
    """
    return 10.0 ** math.floor(min(log_peaks) - 6), 10.0 ** math.ceil(max(log_peaks) + MARGIN)


def log_peaks(contacts: Sequence[ContactSolution], surface: FaceContact | None) -> list[float]:
    """Decimal logarithms of peak pressures of some contacts, remembered ones too, and as they act on a surface [Pa]."""
    profiles = [contact.whole_profile for contact in contacts]
    if surface is not None:
        profiles += [profile.at_rest(surface) for profile in profiles]
    peaks = [peak for profile in profiles for peak in (profile.pressure.max(), profile.highest)]
    return [math.log10(peak) for peak in dict.fromkeys(peaks)]


def share_beyond_sealing(excess: float) -> float:
    """Share of what leaks before sealing that may still leak beyond it, by what hardness and heights leave open.

    About exp(-z^2/2) at z standard deviations, and zero from four of them on: 1.5 times the sealing pressure.

    Parameters
    ----------
    excess : float
        ln of the pressure over the sealing pressure, not negative.

    Examples
    --------
    >>> [round(share_beyond_sealing(math.log(times)), 4) for times in (1.0, 1.1, 1.2, 1.5)]
    [1.0, 0.6265, 0.1552, 0.0]
    """
    share_of_most = excess / (CUT_OFF * INPUTS_KNOWN_TO)
    return float(max(1.0 - share_of_most**2, 0.0) ** (0.5 * CUT_OFF**2))


@dataclass(frozen=True, eq=False)
class LeakModel:
    """Rough surfaces and the fluid between them, with what contacts share of it, made when it is asked for.

    Parameters
    ----------
    surface : FaceContact
    flow : FlowModel or None
        None without a fluid.
    make : callable
        Conductivity of a flow between surfaces; None where it could not be calculated.
    peaks : tuple of float
        Peak pressures of the contacts as they act on the surface [Pa]: u_c of all takes little longer than of one.
    """

    surface: FaceContact
    flow: FlowModel | None
    make: Callable[[FlowModel, FaceContact], Conductivity | None]
    peaks: tuple[float, ...] = ()

    @classmethod
    def of(
        cls,
        surface: FaceContact | None,
        flow: FlowModel | None,
        contacts: Sequence[ContactSolution],
        table: Callable[[FlowModel, FaceContact, Sequence[float]], Conductivity] | None = None,
    ) -> LeakModel | None:
        """With a table over all pressures of some contacts; None without roughness.

        Parameters
        ----------
        surface : FaceContact or None
        flow : FlowModel or None
        contacts : sequence of ContactSolution
        table : callable, optional
            Conductivity of a flow and a surface, over peak pressures given as decimal logarithms.
        """
        if surface is None:
            return None
        make = _Tables(table or FlowModel.table_around, log_peaks(contacts, surface))
        peaks = tuple(contact.profile.at_rest(surface).peak_pressure for contact in contacts)
        return cls(surface, flow, make, peaks)

    @property
    def is_direct(self) -> bool:
        """Whether the flow is simulated, and has an interval of its own."""
        return self.flow is not None and self.flow.direct is not None

    @cached_property
    def table(self) -> Conductivity | None:
        """Flow conductivity of the surface; None without a fluid."""
        return None if self.flow is None else self.make(self.flow, self.surface)

    @property
    def without_thread(self) -> LeakModel:
        """The same whose turned face has rings; itself where no thread leads through the contact."""
        surface = self.surface
        if not isinstance(surface, leak.TurnedContact):
            return self
        return replace(self, surface=surface.rings)

    def leak(self, profile: PressureProfile, fluid_pressure: float) -> LeakResult | None:
        """Leak of one of the contacts; None without a fluid.

        Parameters
        ----------
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        """
        if self.flow is None or self.table is None:
            return None
        if isinstance(profile, SurfaceProfile) and profile.share is None:
            ways = self.ways_over(profile.face)
            tables = [table for way in ways for table in self.flow.in_lands(*way, profile)]
            return self.flow.leak_by(tables, profile, fluid_pressure)
        return self.flow.leak_of(self.table, self.surface, profile, fluid_pressure)

    def ways_over(self, face: MapFace) -> list[tuple[Conductivity, FaceContact]]:
        """Flow conductivity with its surface, and those in the other direction where the lay is known on a face.

        Parameters
        ----------
        face : MapFace
        """
        assert self.flow is not None  # of all who ask
        other = self.surface.other_way
        # simulations of the flow are made in one direction
        is_one = face.lay is None or other is self.surface or self.is_direct
        ways = (
            [(self.table, self.surface)]
            if is_one
            else [(self.table, self.surface), (self.make(self.flow, other), other)]
        )
        return [(table, surface) for table, surface in ways if table is not None]

    def leak_pressed_up_to(
        self, most: float, profile: PressureProfile, fluid_pressure: float
    ) -> LeakResult | None:
        """Leak of one of the contacts if no place were pressed harder; None without a fluid.

        Parameters
        ----------
        most : float
            Contact pressure [Pa].
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        """
        if self.flow is None or self.table is None:
            return None
        pressed_profile = profile.at_rest(self.surface).pressed_up_to(most)
        tables = self.flow.in_lands(self.table, self.surface, pressed_profile)
        return self.flow.leak_by(tables, pressed_profile, fluid_pressure)

    def leak_without_load(self, profile: PressureProfile, fluid_pressure: float) -> float:
        """What the gap of one of the contacts lets through if its rough faces just touched [m^3/s].

        Without the asperities in it, so that it depends on no theory of them, and no more than its narrowest place lets
        through without friction, a gas choked; infinite where no gap is known.

        Parameters
        ----------
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        """
        if self.flow is None:
            return math.inf
        distance, rates = self.surface.touch_distance, []
        for land in profile.lands:
            gap = land.gap - land.gap.min() + distance
            if np.isfinite(gap).all():
                narrowest = 2.0 * math.pi * self.flow.faces * float((land.radius * gap).min())
                rates.append(self.flow.through_gap(land.x, land.radius, gap, fluid_pressure))
                rates.append(self.flow.without_friction(narrowest, fluid_pressure))
        return min(rates, default=math.inf)

    @property
    def crests_open_up_to(self) -> float:
        """Pressure beyond which nobody knows how far the crests of a turned face are closed [Pa]."""
        assert isinstance(self.surface, leak.TurnedContact)  # of all who ask
        if self.flow is None or self.flow.direct is None:
            return self.surface.nearly_sealed_pressure
        return self.flow.direct.table(self.surface).all_open_up_to

    def leak_before_sealing(self, profile: PressureProfile, fluid_pressure: float) -> float:
        """Leak of one of the contacts if no place were pressed harder than direct simulations reach [m^3/s].

        A harder pressed place leaks no more, so that close to the percolation threshold it is an upper bound. Beyond
        the sealing pressure it fades out as the chance does that harder or higher asperities seal later, see
        `share_beyond_sealing`.

        Parameters
        ----------
        profile : PressureProfile
        fluid_pressure : float
            Pressure difference [Pa].
        """
        flow, surface = self.flow, self.surface
        if flow is None or self.table is None:
            return 0.0
        if isinstance(surface, leak.TurnedContact):
            open_flow = self.leak_pressed_up_to(self.crests_open_up_to, profile, fluid_pressure)
            return 0.0 if open_flow is None else open_flow.leak_rate
        if self.is_direct:
            return 0.0
        # what a larger load or flowing metal has sealed is as tight as they made it
        profile = join_lands([land.equivalent(self.table, surface) for land in profile.lands])
        tables = [table.liquid for table in flow.in_lands(self.table, surface, profile)]
        peak = max(land.peak_pressure for land in profile.lands)
        low, high = math.log(1e-6 * peak), math.log(peak)

        def beyond_sealing(log_pressure: float) -> float:
            # of an acting pressure, as the tables are
            log_p = np.array(log_pressure)
            return min(float(table.table_log_p(log_p)) - math.log(table.sealing_pressure) for table in tables)

        def beyond_simulations(log_pressure: float) -> float:
            return float(surface.contact_area(math.exp(log_pressure))) - DIRECT_END

        if beyond_simulations(high) <= 0.0:
            return 0.0
        sealing = root_between(beyond_sealing, low, high) if beyond_sealing(high) > 0.0 else high
        limit = math.exp(root_between(beyond_simulations, low, high))
        open_flow = self.leak_pressed_up_to(limit, profile, fluid_pressure)
        return 0.0 if open_flow is None else share_beyond_sealing(high - sealing) * open_flow.leak_rate

    def at(self, fluid_pressure: float) -> ProfileLeak | None:
        """Flow at a pressure difference [Pa]; None without a fluid."""
        flow, table = self.flow, self.table
        if flow is None or table is None:
            return None
        return ProfileLeak(
            lambda profile: flow.leak_of(table, self.surface, profile, fluid_pressure),
            lambda profile, grooves: flow.bounds(table, self.surface, profile, fluid_pressure, grooves),
            lambda pressure: flow.conductivity_at(table, pressure, fluid_pressure),
        )

    def critical_separation(self, profile: PressureProfile) -> float:
        """u_c at the peak pressure of one of the contacts [m].

        Parameters
        ----------
        profile : PressureProfile
            Its peak is best one of `peaks`.
        """
        profile = profile.at_rest(self.surface)
        at, peak = profile.peak
        if profile.largest is not None:
            largest = float(np.interp(at, profile.x, profile.largest))
            if not isinstance(self.surface, leak.TurnedContact):
                return float(self.surface.critical_separation(peak, largest=largest))
        separation = self._separations.get(peak)
        return float(self.surface.critical_separation(peak)) if separation is None else separation

    @cached_property
    def _separations(self) -> dict[float, float]:
        separations = self.surface.critical_separation(np.array(self.peaks)) if self.peaks else ()
        return dict(zip(self.peaks, np.asarray(separations).tolist(), strict=True))
