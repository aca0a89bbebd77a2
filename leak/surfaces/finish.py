"""From the word and the number on a drawing, "lapped, Ra 0.2 um", to a power spectrum, with the range that they leave.

A process says how rough surfaces made by it usually are in shape: Hurst exponent, longest and shortest waves, lay. The
value says how high they are, as the standard measures it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray
from leak.errors import SpectrumError, positive
from leak.files import own_tables
from leak.surfaces.profile_parameters import (
    RA_OVER_RQ,
    ExpectedRoughness,
    ProfileFilter,
    expected_roughness,
    implied_filter,
)
from leak.surfaces.scans import LEAST_RANGE
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.turned import TurnedRoughness, TurnedTexture

Lay = Literal["none", "circular", "radial", "straight", "crossed"]
Parameter = Literal["Ra", "Rq", "Rz"]
_UM = 1e-6


class Spread(NamedTuple):
    """Lowest, usual and highest value of something that a drawing does not say."""

    low: float
    usual: float
    high: float

    def at(self, share: ArrayLike, *, log: bool = True) -> FloatArray:
        """Value below which a share of all lies: half of them below the usual one, evenly to both ends.

        Parameters
        ----------
        share : array_like
            Between 0 and 1.
        log : bool
            Whether ratios or differences are even.
        """
        ends = np.log(self) if log else np.array(self, dtype=float)
        value = np.interp(np.asarray(share, dtype=float), [0.0, 0.5, 1.0], ends)
        return np.exp(value) if log else value

    def clip(self, low: float, high: float) -> Spread:
        """The same, kept between two bounds."""
        return Spread(*(min(max(end, low), high) for end in self))


# Waves shorter than any stylus sees go on: down to where the spectrum is believed to end.
SHORTEST_WAVE = Spread(0.1e-6, 0.5e-6, 2.5e-6)


@dataclass(frozen=True)
class Process:
    """A way of making a surface, and what it usually looks like.

    Parameters
    ----------
    name : str
    Ra : tuple of float
        Usual range, beyond which a value is unusual [m].
    hurst : Spread
        Hurst exponent [-].
    rolloff : Spread
        Wavelength of the roll-off across the lay: longer waves are no higher [m].
    aspect : Spread
        Correlation length along the lay over the one across it, 1 without a lay [-].
    lay : Lay
        How the lay usually lies on a seat: around the axis, across the sealing face, straight across the part, in
        crossing directions.
    rq_over_ra, rz_over_ra : tuple of float
        Range of ratios on real surfaces of the kind; Gaussian heights have 1.25, and 5 to 9.
    sources : tuple of str
        Keys of `SOURCES`.
    shortest : Spread
        Shortest wave [m].
    nose_radius, fine_height : Spread, optional
        Of a tool that leaves cusps its radius [m], and the rms height of the fine roughness on their crests, as
        measured, over the height of the crests [-]. Hurst exponent and waves are those of the fine roughness.

    Examples
    --------
    >>> process_named("turned").lay
    'circular'
    """

    name: str
    Ra: tuple[float, float]
    hurst: Spread
    rolloff: Spread
    aspect: Spread
    lay: Lay
    rq_over_ra: tuple[float, float]
    rz_over_ra: tuple[float, float]
    sources: tuple[str, ...]
    shortest: Spread = SHORTEST_WAVE
    nose_radius: Spread | None = None
    fine_height: Spread | None = None


# Machining leaves no steeper surfaces on average: a roll-off shorter than this many Rq would.
_FLATTEST = 40.0
# A tool is fed by half of its nose radius at most, and by half of the cutoff with which its cusps are measured.
_MOST_FEED = 0.5
# Directions over which a lay is averaged.
_DIRECTIONS = 2000
# Most nodes of the average around each end of a power law, and their distance in ln q where fewer do.
_BENDS, _BEND = 7, 0.4


def _process(name: str, entry: Mapping[str, Any]) -> Process:
    low, high = entry["Ra"]
    lengths = {
        key: Spread(*(end * _UM for end in entry[key])) for key in ("shortest", "nose_radius") if key in entry
    }
    return Process(
        name,
        (low * _UM, high * _UM),
        Spread(*entry["hurst"]),
        Spread(*(end * _UM for end in entry["rolloff"])),
        Spread(*entry["aspect"]),
        entry["lay"],
        tuple(entry["rq_over_ra"]),
        tuple(entry["rz_over_ra"]),
        tuple(entry["sources"]),
        **lengths,
        fine_height=Spread(*entry["fine_height"]) if "fine_height" in entry else None,
    )


_DATA = own_tables("leak.surfaces", "processes.toml")
SOURCES: dict[str, str] = _DATA["sources"]
PROCESSES = {name: _process(name, entry) for name, entry in _DATA["processes"].items()}
"""Processes by their word; "unspecified" stands for a drawing that gives a value alone, with the widest ranges."""


def process_named(word: str) -> Process:
    """The process of a word on a drawing.

    Raises
    ------
    SpectrumError
        Unknown; the message lists the known ones.

    Examples
    --------
    >>> process_named("lapped").hurst.usual
    0.8
    """
    key = " ".join(word.lower().replace("-", " ").replace("_", " ").split())
    if key not in PROCESSES:
        raise SpectrumError(f"process = {word!r}: must be one of {', '.join(PROCESSES)}")
    return PROCESSES[key]


@dataclass(frozen=True)
class Finish:
    """A finish as it stands on a drawing.

    Parameters
    ----------
    parameter : "Ra", "Rq" or "Rz"
    value : float
        Of a range its geometric mean [m].
    process : Process
    filter : ProfileFilter, optional
        With which the value is measured; what the value implies unless given (`implied_filter`).
    hurst, q_low, q_rolloff, q_high, aspect : float, optional
        What is known better than from the process [-], [1/m].
    lay : Lay, optional
    tolerance : float
        Largest value of a range over `value`, and `value` over the smallest [-]; 1 of a single value.
    nose_radius : float, optional
        Of the tool of a turned face [m].

    Examples
    --------
    >>> finish = Finish("Ra", 0.2e-6, process_named("lapped"))
    >>> surface = finish.surface()
    >>> print(f"{surface.expected.Ra * 1e6:.3f} um, rms height {surface.spectrum.rms_height * 1e6:.3f} um")
    0.200 um, rms height 0.260 um
    """

    parameter: Parameter
    value: float
    process: Process
    filter: ProfileFilter | None = None
    hurst: float | None = None
    q_low: float | None = None
    q_rolloff: float | None = None
    q_high: float | None = None
    aspect: float | None = None
    lay: Lay | None = None
    tolerance: float = 1.0
    nose_radius: float | None = None

    def __post_init__(self) -> None:
        positive(SpectrumError, self.parameter, self.value, "m")

    @property
    def band(self) -> ProfileFilter:
        """Filter of the value."""
        return self.filter or implied_filter(self.parameter, self.value)

    @property
    def spreads(self) -> dict[str, Spread]:
        """What the drawing leaves open, by name, with its range.

        Of a range of Ra, Rq or Rz the value, under the name of the parameter, whose logarithm is as likely everywhere;
        hurst, q_rolloff, q_high, rms_height (see `_height`) and lay; of a turned face nose_radius and fine_height, see
        `Process`, in place of these two.
        """
        spreads = {}
        if self.tolerance > 1.0:
            spreads[str(self.parameter)] = self._values
        if self.hurst is None:
            spreads["hurst"] = self.process.hurst
        if self.q_rolloff is None:
            spreads["q_rolloff"] = self._rolloff
        if self.q_high is None:
            spreads["q_high"] = self.process.shortest
        if self.process.nose_radius is not None and self.process.fine_height is not None:
            if self.nose_radius is None:
                spreads["nose_radius"] = self.process.nose_radius
            spreads["fine_height"] = self.process.fine_height
            return spreads
        spreads["rms_height"] = self._height
        if self.aspect is None and self.process.aspect.high > 1.0:
            spreads["lay"] = self.process.aspect
        return spreads

    @property
    def _values(self) -> Spread:
        return Spread(self.value / self.tolerance, self.value, self.value * self.tolerance)

    @property
    def _height(self) -> Spread:
        """Rq of real surfaces over the one of Gaussian heights with the same value [-]."""
        if self.parameter == "Rq":
            return Spread(1.0, 1.0, 1.0)
        low, high = (ratio * RA_OVER_RQ for ratio in self.process.rq_over_ra)
        if self.parameter == "Rz":
            gaussian = self.surface().expected
            ratio = gaussian.Rz / gaussian.Ra
            least, most = self.process.rz_over_ra
            low, high = low * ratio / most, high * ratio / least
        return Spread(min(low, 1.0), 1.0, max(high, 1.0))

    @property
    def _rolloff(self) -> Spread:
        """Wavelengths of the roll-off: none longer than what is measured, none that would be too steep."""
        if self.process.nose_radius is not None:
            return self.process.rolloff
        rq = self.value * {"Ra": 1.0 / RA_OVER_RQ, "Rq": 1.0, "Rz": 0.2}[self.parameter]
        longest = self.band.lambda_c if self.q_low is None else 2.0 * math.pi / self.q_low
        return self.process.rolloff.clip(_FLATTEST * rq, math.inf).clip(0.0, longest)

    def surface(
        self, shares: Mapping[str, float] | None = None, factors: Mapping[str, float] | None = None
    ) -> FinishedSurface:
        """The surface with what the drawing leaves open at its usual value, or elsewhere in its range.

        Parameters
        ----------
        shares : mapping, optional
            Place in the range of each of `spreads` that is not at its usual value: 0 the lowest, 1 the highest value;
            of "q_rolloff" and "q_high" of the wavelength.
        factors : mapping, optional
            Factors on "hurst", "q_rolloff" and "q_high", kept where a spectrum can have them.
        """
        shares, factors = shares or {}, factors or {}
        if self.tolerance > 1.0 and self.parameter in shares:
            value = float(self._values.at(shares[self.parameter]))
            # measured with one filter, whatever the value
            return replace(self, value=value, tolerance=1.0, filter=self.band).surface(shares, factors)
        values = {
            "hurst": self.hurst,
            "q_rolloff": None if self.q_rolloff is None else 2.0 * math.pi / self.q_rolloff,
            "q_high": None if self.q_high is None else 2.0 * math.pi / self.q_high,
            "lay": self.aspect,
            "nose_radius": self.nose_radius,
            "fine_height": None,
        }
        ranges = {
            "hurst": self.process.hurst,
            "q_rolloff": self._rolloff,
            "q_high": self.process.shortest,
            "lay": self.process.aspect,
            "nose_radius": self.process.nose_radius,
            "fine_height": self.process.fine_height,
        }
        at = {
            key: value if value is not None else float(spread.at(shares.get(key, 0.5), log=key != "hurst"))
            for key, value in values.items()
            if (spread := ranges[key]) is not None
        }
        height = float(self._height.at(shares["rms_height"])) if "rms_height" in shares else 1.0
        rolloff = at["q_rolloff"] / factors.get("q_rolloff", 1.0)
        shortest = at["q_high"] / factors.get("q_high", 1.0)
        hurst = min(max(at["hurst"] * factors.get("hurst", 1.0), 0.01), 1.0)
        if "fine_height" in at:
            return self._turn(hurst, rolloff, shortest, at["nose_radius"], at["fine_height"])
        if self.q_high is None:
            shortest = min(shortest, rolloff / LEAST_RANGE)
        longest = max(self.band.lambda_c, rolloff) if self.q_low is None else 2.0 * math.pi / self.q_low
        if factors:
            rolloff = min(max(rolloff, shortest), longest)
        return self._make_surface(hurst, longest, rolloff, shortest, at["lay"], height)

    def _make_surface(
        self, hurst: float, longest: float, rolloff: float, shortest: float, aspect: float, height: float
    ) -> FinishedSurface:
        q_low, q_rolloff, q_high = (2.0 * math.pi / length for length in (longest, rolloff, shortest))
        unit = PowerSpectrum.self_affine(
            rms_height=1.0, hurst=hurst, q_low=q_low, q_rolloff=q_rolloff, q_high=q_high
        )
        parameters = expected_roughness(unit, self.band)
        rms_height = height * self.value / parameters.value(self.parameter)
        across = PowerSpectrum(unit.wavenumber, unit.density * rms_height**2)
        return FinishedSurface(
            _average_directions(across, aspect),
            across,
            aspect,
            self.lay or self.process.lay,
            replace(parameters, Rq=parameters.Rq * rms_height),
            hurst,
            q_rolloff,
        )

    def _turn(
        self, hurst: float, rolloff: float, shortest: float, nose_radius: float, fine_height: float
    ) -> FinishedSurface:
        """Cusps and fine roughness that together are measured as high as the value says."""
        band = self.band

        def unit_of(longest: float) -> PowerSpectrum:
            wave = min(rolloff, longest)
            ends = {"q_low": longest, "q_rolloff": wave, "q_high": min(shortest, wave / LEAST_RANGE)}
            q = {key: 2.0 * math.pi / length for key, length in ends.items()}
            return PowerSpectrum.self_affine(rms_height=1.0, hurst=hurst, **q)

        # long waves do not change the number of waves
        waves = expected_roughness(unit_of(band.lambda_c), band).waves
        of_unit = TurnedRoughness(1.0, ExpectedRoughness(fine_height, waves, band))
        crest = self.value / of_unit.value(self.parameter)
        if self.nose_radius is None:
            # f^2 = 8 r R_t
            least = 8.0 * crest / _MOST_FEED**2
            nose_radius = max(min(nose_radius, (_MOST_FEED * band.lambda_c) ** 2 / (8.0 * crest)), least)
        feed = math.sqrt(8.0 * nose_radius * crest)
        if feed > 1.001 * _MOST_FEED * band.lambda_c:
            raise SpectrumError(
                f"lambda_c = {band.lambda_c:g} m: cusps of this {self.parameter} are {feed:g} m apart, and are not"
                " measured with such a filter; leave lambda_c out, or give a smaller nose radius or a longer cutoff"
            )
        rolloff = max(rolloff, _FLATTEST * fine_height * crest)
        unit = unit_of(2.0 * feed)
        fine = unit.scaled(fine_height * crest / expected_roughness(unit, band).Rq)
        expected = TurnedRoughness(crest, ExpectedRoughness(fine_height * crest, waves, band))
        texture = TurnedTexture(feed, nose_radius, fine)
        wave = min(rolloff, 2.0 * feed)
        return FinishedSurface(
            fine, fine, 1.0, self.process.lay, expected, hurst, 2.0 * math.pi / wave, texture
        )


def _average_directions(across: PowerSpectrum, aspect: float) -> PowerSpectrum:
    """Average over all directions of a surface with a lay, from the isotropic one with the same profiles across it.

    The same as `stretched_spectrum` on few nodes: the average is a power law but near the ends and the roll-off, over a
    factor `aspect` of wavenumbers at each. Contact mechanics takes as long as a spectrum has nodes; conductivities are
    those of the whole average to 0.6 %, or 1.6 % at an aspect of 10.
    """
    if aspect < 1.0 + 1e-6:
        return across
    # the isotropic surface that, stretched along the lay, has these profiles across it
    root = math.sqrt(aspect)
    isotropic = PowerSpectrum(across.wavenumber / root, across.density * aspect)
    nodes = min(_BENDS, 2 + int(math.log(aspect) / _BEND))
    # at the very end nothing is left
    ratios = aspect ** np.linspace(-0.5, 0.48, nodes)
    q = np.unique(np.concatenate([ratios * node for node in isotropic.wavenumber]))
    q = q[np.concatenate([[True], np.diff(np.log(q)) > 1e-6])]
    phi = (np.arange(_DIRECTIONS) + 0.5) * (0.5 * math.pi / _DIRECTIONS)
    stretch = np.sqrt(aspect * np.cos(phi) ** 2 + np.sin(phi) ** 2 / aspect)
    C = np.asarray(isotropic(q[:, None] * stretch)).mean(axis=1)
    positive = C > 0.0
    average = PowerSpectrum(q[positive], C[positive])
    return PowerSpectrum(q[positive], C[positive] * (isotropic.rms_height / average.rms_height) ** 2)


@dataclass(frozen=True)
class FinishedSurface:
    """One face with a finish, everything about it decided.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Angular average of C.
    across : PowerSpectrum
        Spectrum of the isotropic surface that has the same profiles as this one across its lay.
    aspect : float
        Correlation length along the lay over the one across it [-].
    lay : Lay
    expected : ExpectedRoughness
        What is measured on it on average, across the lay.
    hurst : float
        Hurst exponent [-].
    q_rolloff : float
        Wavenumber of the roll-off across the lay [1/m].
    texture : TurnedTexture, optional
        Cusps of a turned face, of which `spectrum` and `across` are the fine roughness.

    Examples
    --------
    >>> round(Finish("Ra", 0.8e-6, process_named("reamed")).surface().peklenik, 3)
    0.25
    >>> texture = Finish("Ra", 0.8e-6, process_named("turned")).surface().texture
    >>> print(f"{texture.feed * 1e3:.2f} mm, {texture.crest_height * 1e6:.1f} um")
    0.14 mm, 3.1 um
    """

    spectrum: PowerSpectrum
    across: PowerSpectrum
    aspect: float
    lay: Lay
    expected: ExpectedRoughness | TurnedRoughness
    hurst: float
    q_rolloff: float
    texture: TurnedTexture | None = None

    @property
    def peklenik(self) -> float:
        """Correlation length along the flow over that across it [-].

        A straight lay crosses the ring of a seat in all directions, and crossing lays have none on average: 1.
        """
        return {"circular": 1.0 / self.aspect, "radial": self.aspect}.get(self.lay, 1.0)
