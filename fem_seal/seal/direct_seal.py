"""Direct simulation of a seal: strips of its contact with their roughness, beside what the chain says.

A strip has the macroscopic gap of the solved contact: under the chain's own pressure the mean planes of its smooth
bodies are as far apart as in the chain, and from there on they give way as half-spaces. The roughness is pressed as it
stands, so that p(u), the separation of scales and the flow through a contact few waves wide are all put to the test.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.case.tables import Asperities
from fem_seal.contact.solution import ContactSolution
from fem_seal.profile import PressureProfile
from fem_seal.seal.direct import LOAD_STEP, DirectSettings
from fem_seal.seal.leak_model import FlowModel, log_peaks
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.pieces import work
from fem_seal.seal.problem import SealProblem
from leak import RoughContact
from leak.direct import Strip, rest_gap
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS

# Raised when a finished piece would come out differently.
_VERSION = 1
# A strip is so many standard deviations of the pressure wide, beyond which nothing of the flow's resistance lies, and
# so many waves that make the height, so that what they do across a narrow contact is in it.
_STDS, _WAVES = 13.0, 6.0
# Beyond the line of contact points the faces are apart by more than the roughness: so many rms heights, and a slope.
_APART = 20.0
# Pressures below this share of the largest resist the flow by nothing that counts.
_FAINT = 1e-6
# Least load steps of metal that flows.
_LEAST_STEPS = 4


class StripPiece(NamedTuple):
    """What is calculated in one go."""

    place: int
    asperities: Asperities
    sample: int


class StripRecord(NamedTuple):
    """What is kept of a pressed strip."""

    conductance: float
    """12 eta times the leak rate per length and pressure difference [m^2]."""
    contact_area: float
    """Share of the points that touch within a standard deviation of the centre [-]."""
    profile: tuple[float, ...]
    """Pressure over x, mean along the strip [Pa]."""


@dataclass(frozen=True)
class SealPlace:
    """A contact of a load whose strips are simulated.

    Parameters
    ----------
    name : {"round", "least loaded", "most loaded"}
        Where around the axis.
    fluid_pressure, applied_force : float
        [Pa], [N]
    line_load : float
        [N/m]
    profile : PressureProfile
        Of the chain.
    strip : Strip
    chain_conductance, held_conductance : float
        12 eta times the chain's leak rate per length and pressure difference, with all waves of the spectrum and with
        those that the strip holds, of asperities that yield as the case has it [m^2].
    leak_rate : float
        Of the chain, all around with this line load [m^3/s].
    interval : tuple of float or None
        Ends that the chain prints [m^3/s]; None where it prints none, and at a place of a seal that is not round.
    flight : float or None
        Of a gas at the mean of its pressures, see `leak.direct.rarefied_gap` [m]; None for a liquid.
    """

    name: str
    fluid_pressure: float
    applied_force: float
    line_load: float
    profile: PressureProfile
    strip: Strip
    chain_conductance: float
    held_conductance: float
    leak_rate: float
    interval: tuple[float, float] | None
    flight: float | None


@dataclass(frozen=True, eq=False)
class SealSimulation:
    """Strips of all places.

    Parameters
    ----------
    surface : RoughContact
    places : tuple of SealPlace
    asperities : tuple of {"elastic", "capped", "von-mises"}
    settings : DirectSettings
        With the yield stress of metal that flows.
    """

    surface: RoughContact
    places: tuple[SealPlace, ...]
    asperities: tuple[Asperities, ...]
    settings: DirectSettings

    def pieces(self) -> list[StripPiece]:
        """All strips."""
        return [
            StripPiece(place, asperities, sample)
            for asperities in self.asperities
            for sample in range(self.settings.samples)
            for place in range(len(self.places))
        ]

    def keys(self, piece: StripPiece) -> list[str]:
        """Hash of everything that a piece depends on."""
        place, strip = self.places[piece.place], self.places[piece.place].strip
        assert strip.grid_spectrum is not None  # the surface is rough
        yields = {
            "elastic": None,
            "capped": self.surface.hardness,
            "von-mises": (self.settings.yield_stress, self.settings.poissons_ratio, LOAD_STEP),
        }[piece.asperities]
        # the chain's last digits are those of its solver
        about = [
            _VERSION, self.surface.effective_modulus, yields, strip.points, strip.points_per_wave, strip.peklenik,
            f"{strip.width:.9g} {place.line_load:.9g} {place.flight}", self.settings.seed + piece.sample,
        ]  # fmt: skip
        digest = hashlib.sha256(repr(about).encode())
        digest.update(np.round(strip.macroscopic_gap / self.surface.spectrum.rms_height, 6).tobytes())
        digest.update(strip.grid_spectrum.wavenumber.tobytes() + strip.grid_spectrum.density.tobytes())
        return [digest.hexdigest()[:20]]

    def record(self, values: Mapping[str, Any]) -> StripRecord:
        """A record as it stands in a file."""
        return StripRecord(**{**values, "profile": tuple(values["profile"])})

    def records(self, piece: StripPiece) -> Iterator[StripRecord]:
        """Press a strip."""
        place, steps = self.places[piece.place], 1
        if piece.asperities == "von-mises":
            assert self.settings.yield_stress is not None
            longest = LOAD_STEP * HARDNESS_OVER_YIELD_STRESS * self.settings.yield_stress
            steps = max(_LEAST_STEPS, math.ceil(place.profile.peak_pressure / longest))
        state = place.strip.press(
            place.line_load,
            effective_modulus=self.surface.effective_modulus,
            seed=self.settings.seed + piece.sample,
            asperities=piece.asperities,
            hardness=self.surface.hardness,
            yield_stress=self.settings.yield_stress,
            poissons_ratio=self.settings.poissons_ratio,
            load_steps=steps,
            flight=place.flight,
        )
        n = place.strip.points[0]
        reach = max(1, round(place.profile.std / place.strip.width * n))
        touches = state.pressure[n // 2 - reach : n // 2 + reach + 1] > 0.0
        yield StripRecord(state.conductance, float(touches.mean()), tuple(state.profile.tolist()))


@dataclass(frozen=True)
class SealRow:
    """A place with asperities of one kind, and the chain there.

    Parameters
    ----------
    place : SealPlace
    asperities : {"elastic", "capped", "von-mises"}
    leak_rates : tuple of float
        Of each sample, all around with this line load, with the waves that the strip holds [m^3/s].
    profile : ndarray
        Pressure over x, mean of the samples [Pa].
    contact_area : float
        Near the centre [-].
    """

    place: SealPlace
    asperities: Asperities
    leak_rates: tuple[float, ...]
    profile: FloatArray
    contact_area: float

    @property
    def leak_rate(self) -> float:
        """Mean of the samples, which lie side by side around the axis [m^3/s]."""
        return float(np.mean(self.leak_rates))

    @property
    def deviation(self) -> float:
        """Standard deviation of the samples [m^3/s]; nan of one."""
        return float(np.std(self.leak_rates, ddof=1)) if len(self.leak_rates) > 1 else math.nan

    @property
    def chain_held(self) -> float:
        """The chain's leak rate with the waves that the strip holds [m^3/s]."""
        return self.place.leak_rate * self.place.held_conductance / self.place.chain_conductance

    @property
    def with_all_waves(self) -> float:
        """The mean with what the chain says of the waves that the grid does not hold [m^3/s]."""
        chain_rate = self.chain_held
        return self.leak_rate * self.place.leak_rate / chain_rate if chain_rate > 0.0 else math.nan

    @property
    def measures(self) -> tuple[float, float]:
        """Peak pressure [Pa] and FWHM [m] of the Gaussian with the line load and standard deviation of the pressure.

        The pressure itself is one of single summits: its highest value says nothing of the contact.
        """
        p, n = self.profile, len(self.profile)
        # about the middle of the strip, the chain's centroid: that of few samples lies where their highest summits do
        x = ((np.arange(n) + 0.5) / n - 0.5) * self.place.strip.width
        std = math.sqrt(float(np.average(x**2, weights=p)))
        return self.place.line_load / (math.sqrt(2.0 * math.pi) * std), 2.0 * math.sqrt(
            2.0 * math.log(2.0)
        ) * std


def simulate_seal(
    problem: SealProblem,
    loads: Sequence[LoadResult],
    intervals: Sequence[tuple[float, float] | None],
    settings: DirectSettings,
    asperities: tuple[Asperities, ...],
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[SealSimulation, list[SealRow]]:
    """Simulate strips of each load.

    Parameters
    ----------
    problem : SealProblem
        With roughness and fluid.
    loads : sequence of LoadResult
        Solved by the chain.
    intervals : sequence of tuple or None
        Ends of the leak rate of each load, where it has an interval [m^3/s].
    settings : DirectSettings
        Grid points along the contact (twice as many across), samples, seed.
    asperities : tuple of {"elastic", "capped", "von-mises"}
    jobs, progress
        See `fem_seal.seal.pieces.work`.

    Raises
    ------
    LeakError
        A contact does not converge, or the strip holds no wave of the spectrum.
    """
    surface, flow = problem.surface, problem.flow
    assert isinstance(surface, RoughContact) and flow is not None  # of the checks
    pairs = zip(loads, intervals, strict=True)
    places = tuple(place for load, ends in pairs for place in _places(load, ends, surface, flow, settings))
    yield_stress = settings.yield_stress_of(surface) if "von-mises" in asperities else None
    simulation = SealSimulation(surface, places, asperities, replace(settings, yield_stress=yield_stress))
    records_of = work(simulation, simulation.pieces(), settings.folder, jobs=jobs, progress=progress)
    rows = []
    for number, place in enumerate(places):
        for kind in asperities:
            records = [records_of[StripPiece(number, kind, sample)][0] for sample in range(settings.samples)]
            rates = [place.leak_rate * record.conductance / place.chain_conductance for record in records]
            profile = np.mean([record.profile for record in records], axis=0)
            area = float(np.mean([record.contact_area for record in records]))
            rows.append(SealRow(place, kind, tuple(rates), profile, area))
    return simulation, rows


def _places(
    load: LoadResult,
    interval: tuple[float, float] | None,
    surface: RoughContact,
    flow: FlowModel,
    settings: DirectSettings,
) -> Iterator[SealPlace]:
    circumference = load.circumference
    if circumference is None:
        yield replace(_place("round", load, load.contact, surface, flow, settings), interval=interval)
        return
    for name, line_load in (
        ("least loaded", circumference.line_load.min()),
        ("most loaded", circumference.line_load.max()),
    ):
        yield _place(name, load, circumference.local.at(float(line_load)), surface, flow, settings)


def _place(
    name: str,
    load: LoadResult,
    contact: ContactSolution,
    surface: RoughContact,
    flow: FlowModel,
    settings: DirectSettings,
) -> SealPlace:
    profile = contact.profile
    strip = _strip(contact, surface, settings)
    assert strip.grid_spectrum is not None  # the surface is rough
    on_grid = replace(surface, spectrum=strip.grid_spectrum)
    peaks = log_peaks([contact], surface)
    table = flow.table_around(surface, peaks)
    faces = [(face, profile.at_rest(face)) for face in (surface, on_grid)]
    through, through_held = (
        _conductance(
            flow, flow.in_contact(flow.table_around(face, peaks), face, rest), rest, load.fluid_pressure
        )
        for face, rest in faces
    )
    leak = flow.leak_of(table, surface, profile, load.fluid_pressure).leak_rate
    mean = flow.outlet_pressure + 0.5 * load.fluid_pressure
    gas = flow.gas
    flight = (
        None
        if gas is None
        else gas.viscosity * gas.molecular_speed / float(gas.flow_pressure(np.array(mean)))
    )
    return SealPlace(
        name, *load.point, contact.line_load, profile, strip, through, through_held, leak, None, flight
    )


def _conductance(flow: FlowModel, table: Any, profile: PressureProfile, fluid_pressure: float) -> float:
    """12 eta over the integral of dx/sigma [m^2]; zero where the contact is sealed."""
    # far out the surfaces stand apart and resist next to nothing
    p = profile.pressure
    in_contact = p > _FAINT * p.max()
    sigma = flow.conductivity_at(table, p[in_contact], fluid_pressure)
    if not (sigma > 0.0).all():
        return 0.0
    return 12.0 * flow.viscosity / float(profile.arc_weight[in_contact] @ (1.0 / sigma))


def _strip(contact: ContactSolution, surface: RoughContact, settings: DirectSettings) -> Strip:
    """The contact's neighbourhood on a grid, its pressure in the middle."""
    profile, line = contact.profile, contact.model.line
    points = 2 * settings.points, settings.points
    width = max(_STDS * profile.std, _WAVES * 2.0 * math.pi / surface.spectrum.median_wavenumber)
    x = profile.centroid + ((np.arange(points[0]) + 0.5) / points[0] - 0.5) * width
    p = np.interp(x, profile.x, profile.pressure, left=0.0, right=0.0)
    p *= contact.line_load / (p.sum() * width / points[0])
    gap = np.interp(x, profile.x, profile.gap)
    # behind its ends the line goes on with the slope of its faces
    for beyond_end, end, step in ((x < line.x[0], 0, 1), (x > line.x[-1], -1, -2)):
        slope = abs((profile.gap[end] - profile.gap[step]) / (line.x[end] - line.x[step]))
        distance = np.abs(x[beyond_end] - line.x[end])
        gap[beyond_end] = profile.gap[end] + slope * distance
    lower, upper = profile.ends
    off_face = (x < (-math.inf if lower is None else lower)) | (x > (math.inf if upper is None else upper))
    rest = rest_gap(gap, p, width, surface.effective_modulus)
    rest[off_face] = np.maximum(rest[off_face], rest[~off_face].max() + _APART * surface.spectrum.rms_height)
    return Strip(
        surface.spectrum, points, width, rest, points_per_wave=settings.points_per_wave, peklenik=surface.peklenik
    )  # fmt: skip
