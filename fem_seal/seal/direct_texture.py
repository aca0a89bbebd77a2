"""Direct simulation of a face as machined for a case: its states kept on disk, once for all faces that are similar."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from fem_seal.errors import InputError
from fem_seal.materials import HARDNESS_OVER_YIELD_STRESS
from fem_seal.seal.direct import DirectSettings
from fem_seal.seal.pieces import work
from leak import TurnedContact
from leak.direct import PressedPatch, TextureResult, simulate_texture, texture_points

# Raised when a finished piece would come out differently.
_VERSION = 1
# From a contact area, in the theory, to the pressure that seals, unless pressures are given; as many take a minute.
_LEAST_AREA, _PRESSURES = 0.002, 12


class TexturePiece(NamedTuple):
    """What is calculated in one go: a pressure, or all of the path of metal that flows."""

    seed: int
    pressures: tuple[float, ...]


class TextureRecord(NamedTuple):
    """What is kept of a pressed face: areas, gap over the feed, conductivities over its cube."""

    contact_area: float
    yielded_area: float
    mean_gap: float
    k_across: float
    k_along: float


@dataclass(frozen=True, eq=False)
class TextureSimulation:
    """A face at some pressures.

    Parameters
    ----------
    surface : TurnedContact
    settings : DirectSettings
        Samples, seed, what yields, pressures and folder; the grid is that of `leak.direct.texture_points`.
    """

    surface: TurnedContact
    settings: DirectSettings

    @cached_property
    def pressures(self) -> tuple[float, ...]:
        """Rising [Pa]."""
        if self.settings.pressures:
            return tuple(sorted(set(self.settings.pressures)))
        low, high = _LEAST_AREA * self.surface.contact_pressure, self.surface.sealing_pressure
        return tuple(float(f"{p:.4g}") for p in np.geomspace(low, high, _PRESSURES))

    @property
    def seeds(self) -> tuple[int, ...]:
        """Of its samples."""
        return tuple(range(self.settings.seed, self.settings.seed + self.settings.samples))

    @cached_property
    def metal(self) -> dict[str, float | None]:
        """What yields, as `leak.direct.simulate_texture` takes it."""
        hardness, stress = self.surface.hardness, self.settings.yield_stress
        if self.settings.asperities == "von-mises":
            if stress is None and hardness is not None:
                stress = hardness / HARDNESS_OVER_YIELD_STRESS
            if stress is None:
                raise InputError.at("direct.yield_stress", "is needed where the surface has no hardness")
            return {"yield_stress": stress, "poissons_ratio": self.settings.poissons_ratio}
        return {"hardness": None if self.settings.asperities == "elastic" else hardness}

    def pieces(self) -> list[TexturePiece]:
        """All that is to be calculated, each on its own."""
        if self.settings.asperities == "von-mises":
            return [TexturePiece(seed, self.pressures) for seed in self.seeds]
        return [TexturePiece(seed, (p,)) for p in self.pressures for seed in self.seeds]

    def keys(self, piece: TexturePiece) -> list[str]:
        """Hash of all that each record depends on: lengths over the feed, stresses over E*.

        Parameters
        ----------
        piece : TexturePiece
        """
        feed, E, fine = self.surface.feed, self.surface.effective_modulus, self.surface.fine
        stresses = {
            name: value and value / (1.0 if name == "poissons_ratio" else E)
            for name, value in self.metal.items()
        }
        lengths = [feed / self.surface.nose_radius, *(fine.wavenumber * feed), *(fine.density / feed**4)]
        about = [_VERSION, texture_points(self.surface.texture), piece.seed, *map(_digits, lengths)]
        about += [f"{name} {_digits(value)}" for name, value in stresses.items()]
        pressures = [_digits(p / E) for p in piece.pressures]
        return [
            hashlib.sha256(repr([*about, pressures[:count]]).encode()).hexdigest()[:20]
            for count in range(1, len(pressures) + 1)
        ]

    def record(self, values: Mapping[str, Any]) -> TextureRecord:
        """A record as it stands in a file.

        Parameters
        ----------
        values : mapping
        """
        return TextureRecord(**values)

    def records(self, piece: TexturePiece) -> Iterator[TextureRecord]:
        """Press the face of a piece.

        Parameters
        ----------
        piece : TexturePiece
        """
        states: dict[tuple[int, float], PressedPatch] = {}
        self.result(states, piece.pressures, (piece.seed,))
        feed = self.surface.feed
        for state in states.values():
            area, yielded, gap, across, along = state
            yield TextureRecord(area, yielded, gap / feed, across / feed**3, along / feed**3)

    def result(
        self,
        states: dict[tuple[int, float], PressedPatch],
        pressures: tuple[float, ...],
        seeds: tuple[int, ...],
    ) -> TextureResult:
        """Means of the states, which are calculated where they are missing.

        Parameters
        ----------
        states, pressures, seeds
            See `leak.direct.simulate_texture`.
        """
        return simulate_texture(
            self.surface.texture,
            effective_modulus=self.surface.effective_modulus,
            pressures=pressures,
            seeds=seeds,
            finished=states,
            **self.metal,  # type: ignore[arg-type]
        )


def simulate_face(
    surface: TurnedContact,
    settings: DirectSettings,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] = lambda text: None,
) -> TextureResult:
    """Do what is missing of the simulation of a face and put it together.

    Parameters
    ----------
    surface : TurnedContact
    settings : DirectSettings
        See `TextureSimulation`.
    jobs, progress
        See `fem_seal.seal.pieces.work`.

    Raises
    ------
    LeakError
        A pressure reaches the hardness, or a contact does not converge.
    """
    simulation, feed = TextureSimulation(surface, settings), surface.feed
    records_of = work(simulation, simulation.pieces(), settings.folder, jobs=jobs, progress=progress)
    states = {
        (piece.seed, p): PressedPatch(
            x.contact_area, x.yielded_area, x.mean_gap * feed, x.k_across * feed**3, x.k_along * feed**3
        )
        for piece, records in records_of.items()
        for p, x in zip(piece.pressures, records, strict=True)
    }
    return simulation.result(states, simulation.pressures, simulation.seeds)


def _digits(value: float | None) -> str:
    """To what a face is another: the last digits of a number depend on how it was calculated."""
    return f"{value:.9g}" if value is not None else ""
