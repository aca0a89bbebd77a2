"""Direct simulation of a case's surface: samples over pressures, kept on disk as they are done, beside the theory."""

from __future__ import annotations

import base64
import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fem_seal.arrays import FloatArray
from fem_seal.case.tables import Asperities
from fem_seal.errors import InputError
from fem_seal.files import problem
from fem_seal.profile import PressureProfile
from fem_seal.seal.pieces import work
from leak import DirectError, GasConductivityTable, LoadMemory, RoughContact, TurnedContact
from leak.direct import (
    ContactState,
    Flow,
    Patch,
    PeriodicHalfSpace,
    PressedPatch,
    Streams,
    TexturePatch,
    elastoplastic_path,
    patch_flow,
    press,
    smoothed,
    streams,
)
from leak.flow.conductivity import AnyTable
from leak.flow.turned_contact import FaceContact, calculated_table
from leak.numerics.roots import bisect_roots
from leak.theory.bulk_flow import HARDNESS_OVER_YIELD_STRESS
from leak.theory.plasticity import READINGS, Reading

Branch = Literal["load", "unload", "cutoff"]
# Raised when a finished piece would come out differently.
_VERSION = 1
# Contact areas, in the theory, from which to which the pressures go unless they are given.
_LEAST_AREA, _MOST_AREA, _PRESSURES = 0.003, 0.30, 8
# Of a turned face from such an area to the pressure that seals.
_LEAST_OF_CRESTS, _PRESSURES_OF_CRESTS = 0.002, 12
# The gaps are counted in so many classes up to so many rms heights.
_CLASSES, _WIDEST = 60, 6.0
QUANTILES = (0.25, 0.5, 0.75, 0.9)
# Standard errors of the mean on either side of the interval: 95 % of many samples.
_SIGMAS = 2.0
# Factor upwards where nothing says what the shorter half of the waves does, since without it the first patch is tight.
_UNKNOWN = 10.0
# Metal that flows asks for small steps of the load: the longest over the hardness, and by what share the conductivity
# of rough surfaces is then too low at most, see leak.direct.press_elastoplastic.
LOAD_STEP, LOAD_STEP_ERROR = 0.025, 0.09
# The longest of the strain over the rms slope, that of benchmarks/bulk_flow.py.
_STRAIN_STEP = 0.025

# Pressures of a table: the factor between simulation and theory bends where the theory is smooth.
_TABLE_PRESSURES = 64


class BulkPath(NamedTuple):
    """Strain of the metal under a face in its plane, which grows with the pressure up to that of a contact.

    Parameters
    ----------
    meridional, hoop : float
        At the pressure, as it counts there, see `ContactSolution.strain` [-].
    pressure : float
        [Pa]
    """

    meridional: float
    hoop: float
    pressure: float

    @classmethod
    def of(cls, profile: PressureProfile) -> BulkPath:
        """Of the place of a contact that is pressed hardest.

        Parameters
        ----------
        profile : PressureProfile
        """
        return cls(*profile.peak_strain[:2], profile.highest)

    def total(self, largest: float) -> tuple[float, float]:
        """Strain under the largest pressure so far: of one that grows with it half counts [-].

        Parameters
        ----------
        largest : float
            [Pa]
        """
        share = 2.0 * min(largest / self.pressure, 1.0)
        return share * self.meridional, share * self.hoop

    def counted(self, pressure: float) -> tuple[float, float]:
        """What of it counts on first loading, int p d(strain)/p [-].

        Parameters
        ----------
        pressure : float
            [Pa]
        """
        share = min(pressure / self.pressure, self.pressure / pressure)
        return share * self.meridional, share * self.hoop


@dataclass(frozen=True, eq=False)
class DirectSettings:
    """How the surfaces of a problem are simulated; see [direct] of the case file.

    Parameters
    ----------
    points, samples, seed, waves, points_per_wave, amplitudes
        Of random patches.
    size : float or None
        Side of a patch [m]; from the spectrum unless given.
    pressures, unload : tuple of float
        [Pa]; the usual ones if `pressures` is empty.
    direction : {"both", "x", "y"} or None
        None: as the surface has it.
    map : callable or None
        Gives a measured, periodic map and its side [m]; None for random patches.
    folder : Path or None
        Where finished pieces are kept.
    asperities : {"elastic", "capped", "von-mises"}
        What yields; a surface without a hardness is elastic in the reading "capped".
    yield_stress : float or None
        Of "von-mises" [Pa]; of the surface's hardness unless given.
    poissons_ratio : float
        Of the metal that flows [-].
    bulk : BulkPath or None
        How metal that flows is strained in its plane, along the flow and across it; None where it is not.
    """

    points: int = 256
    samples: int = 3
    seed: int = 1
    waves: float = 8.0
    points_per_wave: float = 4.0
    amplitudes: Literal["exact", "gaussian"] = "exact"
    size: float | None = None
    pressures: tuple[float, ...] = ()
    unload: tuple[float, ...] = ()
    direction: Literal["both", "x", "y"] | None = None
    map: Callable[[], tuple[FloatArray, float]] | None = None
    folder: Path | None = None
    asperities: Asperities = "capped"
    yield_stress: float | None = None
    poissons_ratio: float = 0.3
    bulk: BulkPath | None = None

    @cached_property
    def elastic(self) -> DirectSettings:
        """The same where nothing yields."""
        return self if self.asperities == "elastic" else replace(self, asperities="elastic")

    def of(self, surface: FaceContact) -> DirectSimulation:
        """What is simulated of a surface.

        Parameters
        ----------
        surface : FaceContact

        Raises
        ------
        InputError
            The grid holds no wave of the surface.
        LeakError
            The map cannot be used.
        """
        heights, size = (None, self.size) if self.map is None else self.map()
        points = self.points if heights is None else heights.shape[0]
        per_wave = self.points_per_wave if heights is None else 2.0
        across = surface.peklenik != 1.0 or isinstance(surface, TurnedContact)
        try:
            patch = (
                TexturePatch(surface.texture, points, 2 if surface.other is None else 1)
                if isinstance(surface, TurnedContact)
                else Patch.of(
                    surface.spectrum,
                    points=points,
                    size=size,
                    waves=self.waves,
                    points_per_wave=per_wave,
                    peklenik=surface.peklenik,
                )
            )
        except DirectError as error:
            raise InputError.at("direct", str(error)) from None
        settings = replace(
            self,
            samples=self.samples if heights is None else 1,
            direction=self.direction or ("x" if across else "both"),
            yield_stress=self.yield_stress_of(surface) if self.asperities == "von-mises" else None,
        )
        surface = surface.elastic if self.asperities == "elastic" else surface
        simulation = DirectSimulation(surface, patch, settings, heights)
        if self.pressures:
            return simulation
        rough = simulation.patch_surface
        if settings.yield_stress is not None and rough.hardness is None:
            rough = replace(rough, hardness=HARDNESS_OVER_YIELD_STRESS * settings.yield_stress)
        return replace(simulation, settings=replace(settings, pressures=usual_pressures(rough)))

    def yield_stress_of(self, surface: FaceContact) -> float | None:
        """Of metal that flows [Pa]; None where no hardness says it.

        Parameters
        ----------
        surface : FaceContact
        """
        if self.yield_stress is not None:
            return self.yield_stress
        return None if surface.hardness is None else surface.hardness / HARDNESS_OVER_YIELD_STRESS

    def table(
        self, surface: FaceContact, *, jobs: int = 1, progress: Callable[[str], None] = lambda text: None
    ) -> DirectTable:
        """The simulation of a surface, done once.

        Parameters
        ----------
        surface : FaceContact
        jobs, progress
            See `simulate_surface`.
        """
        tables, of = self._tables, _simulated(surface)
        if of not in tables:
            tables[of] = simulate_surface(self.of(of), jobs=jobs, progress=progress)
        return tables[of]

    @cached_property
    def _tables(self) -> dict[FaceContact, DirectTable]:
        return {}

    def conductivity(
        self,
        surface: FaceContact,
        p_min: float,
        p_max: float,
        num: int | None = None,
        *,
        end: int = 0,
        of_gas: bool = False,
    ) -> AnyTable:
        """What the simulation of a surface says of its conductivity, of a turned face with its thread.

        Parameters
        ----------
        surface : FaceContact
        p_min, p_max, num, end, of_gas
            See `DirectTable.conductivity_table`.
        """
        is_turned = isinstance(surface, TurnedContact)
        if isinstance(surface, TurnedContact) and surface.crest_scatter > 0.0:
            # alike crests are simulated
            return self.of_neighbour(replace(surface, crest_scatter=0.0), surface, end=end, of_gas=of_gas)
        table = self.table(surface).conductivity_table(p_min, p_max, num, end, of_gas=of_gas or is_turned)
        return _with_thread(table, surface, of_gas)

    def of_neighbour(
        self,
        surface: FaceContact,
        neighbour: FaceContact,
        theory: Callable[[FaceContact], AnyTable] | None = None,
        *,
        end: int = 0,
        of_gas: bool = False,
    ) -> AnyTable:
        """Conductivity of another surface of the same kind that is not simulated: its theory, corrected.

        The theory is multiplied by what the simulation of the one surface found over its theory, at the same pressure
        over the hardness; of asperities that never yield over E* times their rms slope.

        Parameters
        ----------
        surface, neighbour : FaceContact
            That which is simulated, and the other one.
        theory : callable, optional
            Table of a surface that is not turned.
        end, of_gas
            See `conductivity`.
        """
        of, other = _simulated(surface), _on_its_own(neighbour)
        if self.asperities == "elastic":
            of, other = of.elastic, other.elastic
        scale = _bearing_pressure(other) / _bearing_pressure(of)
        # of a turned face there is one for all pressures, and its thread takes that of gases
        if theory is None or isinstance(other, TurnedContact):
            table = calculated_table(other, 1.0, 2.0, None, of_gas=True)
        else:
            table = theory(other)
        table = self.table(of).corrected(table, of, scale, end)
        return _with_thread(table, neighbour, of_gas)


def _simulated(surface: FaceContact) -> FaceContact:
    """What is simulated of a surface: crests of one height."""
    alone = _on_its_own(surface)
    return replace(alone, crest_scatter=0.0) if isinstance(alone, TurnedContact) else alone


def _on_its_own(surface: FaceContact) -> FaceContact:
    """As a simulation takes a surface: its reading of asperities that yield and its thread are the theory's."""
    return surface.rings if isinstance(surface, TurnedContact) else surface.capped


def _with_thread(table: AnyTable, surface: FaceContact, of_gas: bool) -> AnyTable:
    """Of a turned face the table with its thread, which takes one of all gases."""
    if isinstance(surface, TurnedContact) and isinstance(table, GasConductivityTable):
        table = surface.with_thread(table)
    return table if of_gas else table.liquid


def _bearing_pressure(surface: FaceContact) -> float:
    """What about bears the load where surfaces touch [Pa]."""
    if isinstance(surface, TurnedContact):
        return surface.contact_pressure
    return surface.hardness or surface.effective_modulus * surface.spectrum.rms_slope


@dataclass(frozen=True, eq=False)
class DirectSimulation:
    """What is simulated: patches of a surface, or one map, at some pressures.

    Parameters
    ----------
    surface : FaceContact
        The whole surface, as the theory takes it.
    patch : Patch or TexturePatch
        The piece of it, of a turned face with its crests; of a measured map its grid and side.
    settings : DirectSettings
        With the pressures and the direction of the flow; the yield stress of metal that flows by von Mises, None where
        the pressure is capped at the surface's hardness, if any.
    heights : ndarray or None
        A measured map, periodic, shape (n, n) [m]; None for random patches.
    """

    surface: FaceContact
    patch: Patch | TexturePatch
    settings: DirectSettings
    heights: FloatArray | None = None

    @property
    def asperities(self) -> Asperities:
        """What yields."""
        if self.settings.yield_stress is not None:
            return "von-mises"
        return "elastic" if self.surface.hardness is None else "capped"

    @property
    def load_step(self) -> float | None:
        """Longest of metal that flows [Pa]; None where every pressure is pressed by itself."""
        stress, bulk = self.settings.yield_stress, self.settings.bulk
        if stress is None:
            return None
        longest = LOAD_STEP * HARDNESS_OVER_YIELD_STRESS * stress
        if bulk is None:
            return longest
        most = max(map(abs, bulk.total(bulk.pressure)))
        return longest / max(
            1.0, most * longest / bulk.pressure / (_STRAIN_STEP * self.patch.grid_spectrum.rms_slope)
        )

    @cached_property
    def patch_surface(self) -> FaceContact:
        """The surface with the waves that the patch holds, for the theory of the very same thing."""
        held = self.patch.grid_spectrum
        if isinstance(self.surface, TurnedContact):
            return replace(self.surface, fine=held)
        return replace(self.surface, spectrum=held)

    @property
    def has_crests(self) -> bool:
        """Whether it is a turned face: periodic patches side by side along its crests."""
        return isinstance(self.patch, TexturePatch)

    @property
    def readings(self) -> tuple[Reading, ...]:
        """In which the theory stands beside it."""
        return (Reading.CAPPED,) if self.has_crests else READINGS["paper"]

    def map(self, sample: int) -> FloatArray:
        """Heights of a sample, from 0 on [m]."""
        if self.heights is not None:
            return self.heights
        seed = self.settings.seed + sample
        if isinstance(self.patch, TexturePatch):
            return self.patch.heights(seed)
        return self.patch.heights(seed, self.settings.amplitudes)

    @cached_property
    def rms_height(self) -> float:
        """Of the patch [m]."""
        if self.heights is None and not self.has_crests:
            return self.patch.grid_spectrum.rms_height
        return float(np.std(self.map(0)))

    @property
    def gap_edges(self) -> FloatArray:
        """Between which gaps are counted together [m]."""
        return np.linspace(0.0, _WIDEST * self.rms_height, _CLASSES + 1)

    def pieces(self) -> list[Piece]:
        """All that is to be calculated, each on its own.

        The first sample is also pressed without its shorter half of the waves, to see what the cutoff does; of a turned
        face the theory says that. Metal that flows remembers its path, which is then one piece.
        """
        pressures, unload = self.settings.pressures, self.settings.unload
        samples = range(self.settings.samples)
        if self.settings.yield_stress is not None:
            path, release = tuple(sorted(set(pressures))), tuple(sorted(set(unload), reverse=True))
            cutoff = [] if self.has_crests else [Piece(0, "cutoff", path)]
            return [*(Piece(sample, "load", path, release) for sample in samples), *cutoff]
        pieces = [Piece(sample, "load", (p,)) for p in pressures for sample in samples]
        pieces += [Piece(0, "cutoff", (p,)) for p in pressures if not self.has_crests]
        return pieces + [Piece(sample, "unload", unload) for sample in samples if unload]

    def key(self, piece: Piece) -> str:
        """Hash of everything that a piece depends on."""
        surface, patch, spectrum = self.surface, self.patch, self.patch.grid_spectrum
        shape = surface.texture.cusp_parameters if isinstance(surface, TurnedContact) else surface.peklenik
        settings = self.settings
        flow: tuple[object, ...] = settings.yield_stress, settings.poissons_ratio, LOAD_STEP, piece.unload
        if settings.bulk is not None:
            flow = *flow, *settings.bulk, settings.direction == "y", self.load_step
        yields = surface.hardness if self.settings.yield_stress is None else flow
        about = [
            _VERSION, surface.effective_modulus, yields, patch.points, patch.size,
            shape, self.gap_edges[-1], piece.branch, piece.pressures,
        ]  # fmt: skip
        if piece.branch == "unload":
            about.append(max(self.settings.pressures))
        if piece.branch == "cutoff":
            about.append(self.second_cutoff)
        digest = hashlib.sha256(repr(about).encode())
        if self.heights is not None:
            digest.update(self.heights.tobytes())
        else:
            digest.update(repr((self.settings.seed + piece.sample, self.settings.amplitudes)).encode())
            digest.update(spectrum.wavenumber.tobytes() + spectrum.density.tobytes())
        return digest.hexdigest()[:20]

    def keys(self, piece: Piece) -> list[str]:
        """Of each record of a piece, which is known by all that came before it.

        Parameters
        ----------
        piece : Piece
        """
        return [self.key(piece.until(count)) for count in range(1, len(piece.states) + 1)]

    def record(self, values: Mapping[str, Any]) -> PieceRecord:
        """A record as it stands in a file.

        Parameters
        ----------
        values : mapping
        """
        lists = ("gap_quantiles", "gap_counts")
        return PieceRecord(**{**values, **{name: tuple(values[name]) for name in lists}})

    def records(self, piece: Piece) -> Iterator[PieceRecord]:
        """Press the sample of a piece at its pressures.

        Parameters
        ----------
        piece : Piece
        """
        H, heights, start = self.surface.hardness, self.map(piece.sample), None
        if piece.branch == "cutoff":
            heights = smoothed(heights, self.patch.size, self.second_cutoff)
        if self.settings.yield_stress is not None:
            yield from _press_path(self, piece, heights)
            return
        if piece.branch == "unload":
            state = press(self.body, heights, max(self.settings.pressures), hardness=H)
            heights, start = heights - state.overlap, state.pressure
        for p in piece.pressures:
            state = press(self.body, heights, p, hardness=H, start=start)
            start = None if start is None else state.pressure
            yield _record(self, state)

    @property
    def second_cutoff(self) -> float:
        """Shortest wave of the map that is compared [m]."""
        return 2.0 * self.patch.shortest_wavelength

    @cached_property
    def body(self) -> PeriodicHalfSpace:
        """The half-space under the patch."""
        return PeriodicHalfSpace(self.patch.points, self.patch.size, self.surface.effective_modulus)

    def gap_cubed(self, record: PieceRecord) -> float:
        """u_eff^3 in the direction of the flow [m^3]."""
        x, y = record.gap_cubed_along, record.gap_cubed_across
        return {"both": 0.5 * (x + y), "x": x, "y": y}[self.settings.direction or "both"]


class Piece(NamedTuple):
    """What is calculated in one go: a sample at a pressure, all of its unloading, or its path where metal flows."""

    sample: int
    branch: Branch
    pressures: tuple[float, ...]
    unload: tuple[float, ...] = ()

    @property
    def states(self) -> list[tuple[Branch, int, float]]:
        """Branch, sample and pressure of each of its records."""
        return [
            *((self.branch, self.sample, p) for p in self.pressures),
            *(("unload", self.sample, p) for p in self.unload),
        ]

    def until(self, count: int) -> Piece:
        """As far as so many of its records.

        Parameters
        ----------
        count : int
        """
        release = max(count - len(self.pressures), 0)
        return self._replace(pressures=self.pressures[:count], unload=self.unload[:release])


class PressedMap(NamedTuple):
    """A map pressed, to be drawn; all of shape (n, n)."""

    gap: FloatArray
    """[m]"""
    touches: NDArray[np.bool_]
    yielded: NDArray[np.bool_]
    """At the hardness, or where metal below has flowed."""

    @classmethod
    def of(cls, state: ContactState, hardness: float | None) -> PressedMap:
        """Of elastic or capped contact.

        Parameters
        ----------
        state : ContactState
        hardness : float or None
            [Pa]
        """
        return cls(state.gap, state.pressure > 0.0, state.pressure >= (hardness or math.inf))

    def flow(self) -> tuple[Flow, Streams]:
        """Flow from its first row to its last, and where it goes."""
        flow = patch_flow(self.gap)
        return flow, streams(self.gap, flow)

    @classmethod
    def read(cls, text: str) -> PressedMap:
        """As `text` says.

        Parameters
        ----------
        text : str
        """
        with np.load(BytesIO(base64.b64decode(text))) as arrays:
            return cls(arrays["gap"].astype(float), arrays["touches"], arrays["yielded"])

    @property
    def text(self) -> str:
        """The map in letters, gaps in single precision."""
        stream = BytesIO()
        np.savez_compressed(
            stream, gap=self.gap.astype(np.float32), touches=self.touches, yielded=self.yielded
        )
        return base64.b64encode(stream.getvalue()).decode()


class PieceRecord(NamedTuple):
    """What is kept of a pressed sample."""

    contact_area: float
    yielded_area: float
    mean_gap: float
    gap_cubed_along: float
    gap_cubed_across: float
    gap_quantiles: tuple[float, ...]
    gap_counts: tuple[int, ...]
    map: str = ""
    """`PressedMap.text` of the first sample where it takes minutes to press it again."""


@dataclass(frozen=True)
class DirectRow:
    """The samples at one pressure, and the theory there.

    Parameters
    ----------
    branch : {"load", "unload"}
    pressure, largest_pressure : float
        Now, and the largest before [Pa].
    contact_area, contact_area_scatter, yielded_area : float
        Means and standard deviation over the samples [-].
    mean_gap, mean_gap_scatter : float
        [m]
    gap_quantiles : tuple of float
        Gaps that `QUANTILES` of the area, contact included, stay below [m].
    effective_gap : float
        u_eff, of the geometric mean of the conductivities; 0 if no sample lets anything through [m].
    log_scatter : float
        Standard deviation of ln conductivity over the samples that let something through [-].
    blocked : int
        Samples that let nothing through.
    samples : int
    cutoff_ratio : float
        Conductivity without the shorter half of the waves over that with it, first sample; nan for unloading.
    theory : TheoryRow or None
        None for unloading.
    log_directions : float
        ln of the first sample's conductivity along x over the one along y; infinite if it is tight one way, nan if
        both.
    """

    branch: Branch
    pressure: float
    largest_pressure: float
    contact_area: float
    contact_area_scatter: float
    yielded_area: float
    mean_gap: float
    mean_gap_scatter: float
    gap_quantiles: tuple[float, ...]
    effective_gap: float
    log_scatter: float
    blocked: int
    samples: int
    cutoff_ratio: float
    theory: TheoryRow | None
    log_directions: float = math.nan

    @property
    def open_samples(self) -> int:
        """Samples that let something through."""
        return self.samples - self.blocked


@dataclass(frozen=True)
class TheoryRow:
    """What the theory says at one pressure.

    Parameters
    ----------
    contact_area, mean_gap
        Of the waves that the patch holds, asperities that yield in the reading "capped", without strain of the metal
        below; nan with it [-], [m].
    gap, whole : mapping
        u_eff of the waves that the patch holds, and of the whole spectrum, in each reading of asperities that yield
        [m].
    """

    contact_area: float
    mean_gap: float
    gap: Mapping[Reading, float]
    whole: Mapping[Reading, float]

    def cutoff_factor(self, reading: Reading) -> float:
        """Conductivity of the whole spectrum over that of the patch's waves in a reading [-]."""
        gap = self.gap[reading]
        return (self.whole[reading] / gap) ** 3 if gap > 0.0 else math.nan


@dataclass(frozen=True, eq=False)
class DirectTable:
    """What a direct simulation found.

    Parameters
    ----------
    simulation : DirectSimulation
    rows : tuple of DirectRow
        Loading over rising pressure, then unloading over falling.
    gap_density : ndarray, shape (rows, classes)
        Share of the area per gap, samples together, contact left out [1/m].
    maps : mapping
        `PressedMap.text` of the first sample over the pressure of loading [Pa], where they are kept.
    strained : DirectTable or None
        The same over metal that is strained as in the contact of the case; None where it was not simulated.
    """

    simulation: DirectSimulation
    rows: tuple[DirectRow, ...]
    gap_density: FloatArray
    maps: Mapping[float, str] = field(default_factory=dict)
    strained: DirectTable | None = None

    def press_sample(self, pressure: float) -> PressedMap:
        """The first sample at a pressure of first loading.

        Parameters
        ----------
        pressure : float
            One of those simulated [Pa].
        """
        if pressure in self.maps:
            return PressedMap.read(self.maps[pressure])
        simulation = self.simulation
        H = simulation.surface.hardness
        return PressedMap.of(press(simulation.body, simulation.map(0), pressure, hardness=H), H)

    @property
    def loading(self) -> tuple[DirectRow, ...]:
        """Rows of first loading that let something through."""
        return tuple(row for row in self.rows if row.branch == "load" and row.effective_gap > 0.0)

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest pressure of loading at which something flows [Pa].

        Raises
        ------
        InputError
            Nothing flows at any of them.
        """
        rows = self.loading
        if not rows:
            raise InputError(problem("tight_patch"))
        return rows[0].pressure, rows[-1].pressure

    @property
    def all_open_up_to(self) -> float:
        """Largest pressure of loading at which all samples let something through, the least one without any [Pa]."""
        return max((row.pressure for row in self.loading if not row.blocked), default=self.range[0])

    def log_error(self, row: DirectRow) -> tuple[float, float]:
        """By how much ln conductivity may lie lower and higher [-].

        Two standard errors of the mean of the samples, and to one side what the waves may change that the patch cuts:
        as much as the shorter half of those that it holds, since each further octave changes less than the last, or as
        much as the theory says; but no more flows than at a lower pressure. Metal that flows lets more through than its
        load steps say.
        Samples that are tight count as such downwards: there the mean conductivity of all of them is the end. Crests of
        a turned face are long; two short ones in series let less through, by the square of their scatter.

        Parameters
        ----------
        row : DirectRow
            Of first loading, of which a sample lets something through.
        """
        scatter = self._scatter(row)
        changes = [0.0]
        if row.cutoff_ratio >= 0.0:
            # without its shorter waves the patch may be tight
            changes.append(-math.log(row.cutoff_ratio) if row.cutoff_ratio > 0.0 else math.inf)
        theory = row.theory
        if theory is not None and (ratio := theory.cutoff_factor(Reading.CAPPED)) > 0.0:
            changes.append(math.log(ratio))
        low, high = scatter - min(changes), scatter + max(changes)
        if not self.simulation.has_crests:
            low += math.log(row.samples / row.open_samples)
        elif row.samples > 1:
            # two short crests in series conduct less than long ones, whose places have this scatter, on average
            high += (scatter / _SIGMAS) ** 2 * row.samples
        if self.simulation.settings.yield_stress is not None:
            high += LOAD_STEP_ERROR
        lower = [other for other in self.loading if other.pressure < row.pressure]
        if lower:
            step = 3.0 * math.log(lower[-1].effective_gap / row.effective_gap)
            high = min(high, max(scatter, step + self.log_error(lower[-1])[1]))
        elif math.isinf(high):
            ratios = [] if theory is None else map(theory.cutoff_factor, theory.gap)
            high = scatter + max([math.log(_UNKNOWN), *(math.log(ratio) for ratio in ratios if ratio > 1.0)])
        return low, high

    def ends(self, row: DirectRow) -> tuple[float, float]:
        """Between which u_eff lies [m].

        Of patches that are all tight from nothing to the upper end at the last pressure at which one was open; nan if
        there is none.

        Parameters
        ----------
        row : DirectRow
            Of first loading.
        """
        if row.open_samples:
            low, high = self.log_error(row)
            return row.effective_gap * math.exp(-low / 3.0), row.effective_gap * math.exp(high / 3.0)
        lower = [other for other in self.loading if other.pressure < row.pressure]
        return 0.0, self.ends(lower[-1])[1] if lower else math.nan

    def _scatter(self, row: DirectRow) -> float:
        """Two standard errors of the mean of ln conductivity [-].

        If only one of several samples is open, they scatter at least as much as at the other pressures. Of one sample
        both directions are the samples; with only one direction there is nothing to tell it by: 0.
        """
        if row.open_samples < 1:
            return 0.0
        if self.simulation.has_crests and row.samples > 1:
            # fewer places stay open the higher the pressure is
            scatters = [x.log_scatter for x in self.loading if x.pressure <= row.pressure]
            return _SIGMAS * max(scatters) / math.sqrt(row.samples)
        if row.samples == 1:
            ratio = abs(row.log_directions) if self.simulation.settings.direction == "both" else 0.0
            return _SIGMAS * 0.5 * ratio if math.isfinite(ratio) else math.log(_UNKNOWN)
        scatter = row.log_scatter
        if row.open_samples == 1:
            scatter = max((x.log_scatter for x in self.loading if x.open_samples > 1), default=0.0)
        return _SIGMAS * scatter / math.sqrt(row.open_samples)

    def conductivity_table(
        self, p_min: float, p_max: float, num: int | None = None, end: int = 0, *, of_gas: bool = False
    ) -> AnyTable:
        """u_eff over pressure: as simulated, and outside the pressures simulated by the slope of the theory.

        Between the pressures, and beyond them, the theory of the waves that the patch holds is followed, in the
        reading "capped", by the factor that the simulation found.

        Parameters
        ----------
        p_min, p_max : float
            [Pa]
        num : int, optional
            Number of pressures; by default many enough for what a simulation adds to the theory.
        end : {-1, 0, 1}
            Of the interval `log_error`, 0 for what was simulated.
        of_gas : bool
            With the rarefaction of gases, in the theory.
        """
        surface = self.simulation.patch_surface.reading(Reading.CAPPED)
        theory = calculated_table(surface, p_min, p_max, num or _TABLE_PRESSURES, of_gas=of_gas)
        if self.simulation.has_crests:
            theory = _with_pressures(theory, [row.pressure for row in self.loading])
        elif theory.liquid.memory is not None:
            # what has yielded is decided by short waves, too
            memory = LoadMemory(self.simulation.surface)
            theory = theory.with_liquid(replace(theory.liquid, memory=memory))
        return self.corrected(theory, surface, 1.0, end)

    def corrected(self, theory: AnyTable, reference: FaceContact, scale: float, end: int) -> AnyTable:
        """A table times the factor that the simulation found.

        Parameters
        ----------
        theory : ConductivityTable or GasConductivityTable
        reference : FaceContact
            Over whose u_eff in the theory the factor is.
        scale : float
            Pressure in the table over that of the simulation at which the factor is taken.
        end : {-1, 0, 1}
            See `conductivity_table`.
        """
        from scipy.interpolate import PchipInterpolator

        p = np.array([row.pressure for row in self.loading])
        u = np.array([row.effective_gap for row in self.loading])
        if end:
            u = np.array([self.ends(row)[0 if end < 0 else 1] for row in self.loading])
        expected, liquid = np.asarray(reference.effective_separation(p)), theory.liquid
        # beyond the sealing of the theory it cannot be followed
        known = (expected > 0.0) & (u > 0.0)
        factor = np.log(u[known] / expected[known])
        log_p = liquid.table_log_p(np.log(scale * p[known]))
        at = np.clip(np.log(liquid.pressure), log_p[0], log_p[-1])
        # with one pressure the factor is the same everywhere
        correction = PchipInterpolator(log_p, factor)(at) if factor.size > 1 else factor[0]
        separation = liquid.separation * np.exp(correction)
        # samples scatter, but no more flows at a higher pressure
        separation = np.minimum.accumulate(separation) * (1.0 - 1e-9 * np.arange(separation.size))
        return theory.with_liquid(replace(liquid, separation=separation, method="direct"))


def _with_pressures(table: AnyTable, pressures: Sequence[float]) -> AnyTable:
    """A table with some more pressures below its sealing: those of a turned face are far apart at light load."""
    liquid = table.liquid
    sealing = min(liquid.sealing_pressure, liquid.pressure[-1])
    log_p = np.log(np.union1d(liquid.pressure, [p for p in pressures if p < sealing]))
    wider = replace(liquid, pressure=np.exp(log_p), separation=liquid.at_log_pressure(log_p))
    if not isinstance(table, GasConductivityTable):
        return wider
    log_rarefaction = table.log_rarefaction_at(log_p[:, None])(table.log_inverse_knudsen)
    return replace(table, liquid=wider, log_rarefaction=log_rarefaction)


def simulate_surface(
    simulation: DirectSimulation, *, jobs: int = 1, progress: Callable[[str], None] = lambda text: None
) -> DirectTable:
    """Do what is missing of a simulation and put it together.

    Each piece is written to the simulation's folder, whole, as soon as it is done.

    Parameters
    ----------
    simulation : DirectSimulation
    jobs : int
        Processes; 1 calculates in this one.
    progress : callable
        Told how far it is.

    Raises
    ------
    LeakError
        A pressure reaches the hardness, or a contact does not converge.
    """
    return _combine_records(
        simulation,
        work(simulation, simulation.pieces(), simulation.settings.folder, jobs=jobs, progress=progress),
    )


def _press_path(simulation: DirectSimulation, piece: Piece, heights: FloatArray) -> Iterator[PieceRecord]:
    """Of metal that flows, in load steps of equal length from one pressure to the next."""
    assert simulation.settings.yield_stress is not None and simulation.load_step is not None
    bulk, turned = simulation.settings.bulk, simulation.settings.direction == "y"

    def strain(largest: float) -> tuple[float, float]:
        assert bulk is not None  # of those who ask
        along, across = bulk.total(largest)
        return (across, along) if turned else (along, across)

    states = elastoplastic_path(
        simulation.body,
        heights,
        chain(piece.pressures, piece.unload),
        yield_stress=simulation.settings.yield_stress,
        longest_step=simulation.load_step,
        poissons_ratio=simulation.settings.poissons_ratio,
        strain=None if bulk is None else strain,
    )
    for number, state in enumerate(states):
        is_drawn = piece.branch == "load" and piece.sample == 0 and number < len(piece.pressures)
        pressed_map = PressedMap(state.gap, state.pressure > 0.0, state.has_yielded)
        yield _record(simulation, state.contact)._replace(
            yielded_area=state.yielded_area, map=pressed_map.text if is_drawn else ""
        )


def _record(simulation: DirectSimulation, state: ContactState) -> PieceRecord:
    numbers = PressedPatch.of(state, hardness=simulation.surface.hardness, periodic=simulation.has_crests)
    counts, _ = np.histogram(state.gap[state.gap > 0.0], simulation.gap_edges)
    quantiles = np.quantile(state.gap, QUANTILES)
    return PieceRecord(*numbers, tuple(quantiles.tolist()), tuple(counts.tolist()))


def _combine_records(simulation: DirectSimulation, records_of: dict[Piece, list[PieceRecord]]) -> DirectTable:
    record_of = {
        state: record
        for piece, records in records_of.items()
        for state, record in zip(piece.states, records, strict=True)
    }
    loads: list[tuple[Branch, float]] = [("load", p) for p in sorted(simulation.settings.pressures)]
    loads += [("unload", p) for p in sorted(simulation.settings.unload, reverse=True)]
    rows, densities = [], []
    for branch, p in loads:
        records = [record_of[branch, sample, p] for sample in range(simulation.settings.samples)]
        cutoff = record_of.get(("cutoff", 0, p)) if branch == "load" else None
        rows.append(_row(simulation, branch, p, records, cutoff))
        counts = np.sum([item.gap_counts for item in records], axis=0)
        cells = len(records) * simulation.patch.points**2
        densities.append(counts / cells / np.diff(simulation.gap_edges))
    maps = {p: text for (branch, _, p), x in record_of.items() if branch == "load" and (text := x.map)}
    return DirectTable(simulation, tuple(rows), np.array(densities), maps)


def _row(
    simulation: DirectSimulation,
    branch: Branch,
    pressure: float,
    records: Sequence[PieceRecord],
    cutoff: PieceRecord | None,
) -> DirectRow:
    area, gap = (np.array([getattr(x, name) for x in records]) for name in ("contact_area", "mean_gap"))
    gaps_cubed = np.array([simulation.gap_cubed(record) for record in records])
    logs = np.log(gaps_cubed[gaps_cubed > 0.0])
    several, first = len(records) > 1, float(gaps_cubed[0])
    mean, scatter = (
        (logs.mean() if logs.size else -math.inf),
        (float(logs.std(ddof=1)) if logs.size > 1 else math.nan),
    )
    if simulation.has_crests and logs.size:
        # side by side along the crests their conductivities add; a lognormal distribution of the same mean and scatter
        mean = math.log(gaps_cubed.mean())
        spread = gaps_cubed.std(ddof=1) / gaps_cubed.mean() if several else math.nan
        scatter = math.sqrt(math.log1p(spread**2))
    return DirectRow(
        branch=branch,
        pressure=pressure,
        largest_pressure=pressure if branch == "load" else max(simulation.settings.pressures),
        contact_area=float(area.mean()),
        contact_area_scatter=float(area.std(ddof=1)) if several else math.nan,
        yielded_area=float(np.mean([record.yielded_area for record in records])),
        mean_gap=float(gap.mean()),
        mean_gap_scatter=float(gap.std(ddof=1)) if several else math.nan,
        gap_quantiles=tuple(np.mean([record.gap_quantiles for record in records], axis=0).tolist()),
        effective_gap=math.exp(mean / 3.0),
        log_scatter=scatter,
        blocked=int(np.count_nonzero(gaps_cubed == 0.0)),
        samples=len(records),
        cutoff_ratio=simulation.gap_cubed(cutoff) / first if cutoff is not None and first > 0.0 else math.nan,
        theory=_theory(simulation, pressure) if branch == "load" else None,
        log_directions=_log_ratio(records[0].gap_cubed_along, records[0].gap_cubed_across),
    )


def _log_ratio(first: float, second: float) -> float:
    if first > 0.0 and second > 0.0:
        return math.log(first / second)
    return math.nan if first == second else math.copysign(math.inf, first - second)


def _theory(simulation: DirectSimulation, pressure: float) -> TheoryRow:
    patch, surface, readings = simulation.patch_surface, simulation.surface, simulation.readings
    capped, bulk = patch.reading(Reading.CAPPED), simulation.settings.bulk

    def gap(face: FaceContact) -> float:
        if bulk is None:
            return float(face.effective_separation(pressure))
        along, across = bulk.counted(pressure)
        ways = [(along, across), (across, along)][: 2 if simulation.settings.direction == "both" else 1]
        rest = [face.pressure_at_rest(pressure, *way) for way in ways]
        return float(np.cbrt((np.asarray(face.effective_separation(np.array(rest))) ** 3).mean()))

    return TheoryRow(
        contact_area=float(capped.contact_area(pressure)) if bulk is None else math.nan,
        mean_gap=float(capped.mean_separation(pressure)) if bulk is None else math.nan,
        gap={x: gap(patch.reading(x)) for x in readings},
        whole={x: gap(surface.reading(x)) for x in readings},
    )


def usual_pressures(surface: FaceContact) -> tuple[float, ...]:
    """Pressures in equal ratios, from a contact area of 0.3 % to one of 30 % in the theory; of crests to sealing [Pa].

    Parameters
    ----------
    surface : FaceContact
        With the waves that are simulated.
    """
    if isinstance(surface, TurnedContact):
        low, high = _LEAST_OF_CRESTS * surface.contact_pressure, surface.sealing_pressure
    else:
        low, high = (_pressure_of_area(surface, area) for area in (_LEAST_AREA, _MOST_AREA))
    count = _PRESSURES_OF_CRESTS if isinstance(surface, TurnedContact) else _PRESSURES
    return tuple(float(f"{p:.4g}") for p in np.geomspace(low, high, count))


def _pressure_of_area(surface: RoughContact, area: float) -> float:
    ends = np.log([[1e-12 * surface.effective_modulus], [surface.hardness or surface.effective_modulus]])
    return float(
        np.exp(bisect_roots(lambda x: np.asarray(surface.contact_area(np.exp(x))) < area, *ends)[0][0])
    )
