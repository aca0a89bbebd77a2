"""Turned faces in scans across their lay: the feed, the cusps between the grooves, and the fine roughness on them.

Grooves of a tool repeat, and their crests are sharper than their valleys. So the second and higher harmonics of the
feed keep step with the first, which they do in no Gaussian surface, however narrow its spectrum is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.polynomial.legendre import Legendre, legfit

from leak.arrays import FloatArray
from leak.surfaces.measured import MeasuredSurface, measure
from leak.surfaces.random import profile_density
from leak.surfaces.scans import LineScan, ScanSettings, Topography
from leak.surfaces.self_affine_fit import RollOff
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.turned import TurnedTexture

# Fewest feeds in a scan and points in a feed, the highest harmonic, and how many peaks of the spectrum are tried.
_FEWEST_FEEDS, _FEWEST_POINTS, _HARMONICS, _PEAKS = 3, 20, 8, 5
# How often chance may pass for a feed, or for a groove that is no parabola; the least second harmonic over the first
# (0.25 of parabolas, 0 of a sine); and the share of the feed beside each crest, blunted by varying feeds, that is left
# out of the fit.
_CHANCE, _LEAST_SECOND, _BESIDE_CREST = 2e-4, 0.05, 0.06
# Estimates of the fine roughness, each from what the one before leaves it of the heights of the grooves.
_PASSES = 2


@dataclass(frozen=True, eq=False)
class TurnedScan:
    """Cusps of a turned face as scans across its lay show them.

    Parameters
    ----------
    feed, feed_error : float
        Mean distance of the crests and its standard error [m].
    side_slope : float
        Mean slope of both sides at the crest [-].
    nose_radius : float
        Of the parabola through the mean groove [m].
    crest_height : float
        R_t, from the bottom of the mean groove to where its sides meet [m].
    parabola_deviation : float
        Rms distance of the mean groove, a polynomial of fourth degree, from its parabola over the crest height; 0 where
        chance explains it [-].
    crest_scatter : float
        Rms of the heights of the crests about their mean line, without the share of the fine roughness [m].
    periodic_share : float
        Of the variance of the scan without tilt, what the mean cusp explains [-].
    fine : PowerSpectrum
        Of what is left without mean cusp and heights of the grooves; C is constant between one and two feeds.
    rest : MeasuredSurface
        What is left as a surface of its own, with its roll-off and what to warn of.
    position, heights, cusp : ndarray, shape (n,)
        Across the lay, the profile without tilt and the mean cusp, of the first scan [m].

    Examples
    --------
    >>> import numpy as np, leak
    >>> fine = leak.PowerSpectrum.self_affine(rms_height=1e-7, hurst=0.8, q_low=3e4, q_rolloff=2.5e5, q_high=4e6)
    >>> texture = leak.TurnedTexture(feed=1e-4, nose_radius=8e-4, fine=fine)
    >>> x, h = leak.random_line_scan(fine, length=4e-3, points=8_000, seed=1)
    >>> found = leak.recognise_texture(leak.line_scan(x, h - texture.depth_at(np.abs((x + 3e-5) % 1e-4 - 5e-5))))
    >>> print(f"{found.feed * 1e3:.3f} mm")
    0.100 mm
    >>> leak.recognise_texture(leak.line_scan(x, h)) is None
    True
    """

    feed: float
    feed_error: float
    side_slope: float
    nose_radius: float
    crest_height: float
    parabola_deviation: float
    crest_scatter: float
    periodic_share: float
    fine: PowerSpectrum
    rest: MeasuredSurface = field(repr=False)
    position: FloatArray = field(repr=False)
    heights: FloatArray = field(repr=False)
    cusp: FloatArray = field(repr=False)

    @property
    def rolloff(self) -> RollOff:
        """Roll-off and Hurst exponent of the fine roughness."""
        return self.rest.rolloff

    @property
    def texture(self) -> TurnedTexture:
        """The face without scatter of its crests."""
        return TurnedTexture(self.feed, self.nose_radius, self.fine)


def recognise_texture(
    scans: Topography | Sequence[Topography], settings: ScanSettings | None = None
) -> TurnedScan | None:
    """The turned face that scans show; None where no feed stands out in most of them.

    Peaks of the spectrum are tried as the feed. Of each, the phase of the first harmonic in every feed gives the place
    along the scan in turns of the workpiece, so that a feed that varies slowly does no harm. The first harmonic must
    stand out of its neighbours, and the higher ones must have the phase of sharp crests, by a t-test against their
    neighbours. Of the feeds that pass, that counts which explains most of the variance.

    Of several scans the means count: of the feed, of the curvature of the nose, of the power of the fine roughness.
    Those that show no feed are left out.

    Parameters
    ----------
    scans : LineScan, HeightMap or a sequence of them
        Across the lay; a map lies as it will, its mean along its crests is taken. A form is taken off before
        (`scan.without_form`).
    settings : ScanSettings, optional
        Of the fine roughness, see `measure`.

    Returns
    -------
    TurnedScan or None
        Feed, nose radius and height of the crests [m].

    Raises
    ------
    ScanError
        Nothing is left without the cusps.

    References
    ----------
    Phases of harmonics of Gaussian processes: Y. C. Kim, E. J. Powers, IEEE Trans. Plasma Sci. 7, 120 (1979).

    Examples
    --------
    >>> import numpy as np, leak
    >>> x = np.arange(4_000) * 1e-6
    >>> rough = 1e-8 * np.random.default_rng(1).standard_normal(x.size)
    >>> cusps = (x % 1e-4 - 5e-5) ** 2 / 1.6e-3
    >>> print(f"{leak.recognise_texture(leak.line_scan(x, cusps + rough)).nose_radius * 1e3:.2f} mm")
    0.80 mm
    """
    each = (scans,) if isinstance(scans, Topography) else tuple(scans)
    found = [turned for scan in each if (turned := _recognise(scan, settings)) is not None]
    if 2 * len(found) <= len(each):
        return None
    return found[0] if len(found) == 1 else _mean(found, settings)


def _mean(found: Sequence[TurnedScan], settings: ScanSettings | None) -> TurnedScan:
    """One face of several scans."""

    def mean(name: str, power: int = 1) -> float:
        return float(np.mean([getattr(turned, name) ** power for turned in found])) ** (1.0 / power)

    rest = measure([turned.rest.scans[0] for turned in found], settings)
    feed = mean("feed")
    between = np.std([turned.feed for turned in found], ddof=1) / math.sqrt(len(found))
    return replace(
        found[0],
        feed=feed,
        feed_error=math.hypot(between, mean("feed_error", 2) / math.sqrt(len(found))),
        nose_radius=mean("nose_radius", -1),
        crest_scatter=mean("crest_scatter", 2),
        side_slope=mean("side_slope"),
        crest_height=mean("crest_height"),
        parabola_deviation=mean("parabola_deviation"),
        periodic_share=mean("periodic_share"),
        fine=_with_long_waves(rest.spectrum, 2.0 * np.pi / feed),
        rest=rest,
    )


def _recognise(scan: Topography, settings: ScanSettings | None) -> TurnedScan | None:
    flat = scan.without_form("tilt")
    across, step = _places_across(flat)
    nearest = np.rint(across.ravel()).astype(int)
    count = np.bincount(nearest)
    enough = np.flatnonzero(count >= 0.25 * count.max())
    rows = slice(int(enough[0]), int(enough[-1]) + 1)
    sums = np.bincount(nearest, weights=flat.heights.ravel())
    profile: FloatArray = sums[rows] / np.maximum(count[rows], 1)
    tried = [_Turns.along(profile, rate) for rate in _peak_rates(profile)]
    turns = max((t for t in tried if t is not None and t.is_turned), key=lambda t: t.share, default=None)
    return None if turns is None else _describe(flat, across - rows.start, step, turns, settings)


def _places_across(scan: Topography) -> tuple[FloatArray, float]:
    """Place of each height across the crests in steps, and this step [m]."""
    if isinstance(scan, LineScan):
        return np.arange(scan.heights.size, dtype=float), scan.spacing
    window = np.multiply.outer(*(np.hanning(n) for n in scan.heights.shape))
    padded = [4 * n for n in scan.heights.shape]
    power = np.abs(np.fft.rfft2(scan.heights * window, padded))
    i, j = np.unravel_index(int(np.argmax(power)), power.shape)
    q = np.array(
        [np.fft.fftfreq(padded[0], scan.spacing[0])[i], np.fft.rfftfreq(padded[1], scan.spacing[1])[j]]
    )
    x, y = (np.arange(n) * d for n, d in zip(scan.heights.shape, scan.spacing, strict=True))
    step = scan.resolution
    place = np.add.outer(x * q[0], y * q[1]) / max(float(np.hypot(*q)), 1e-300) / step
    return np.asarray(place - place.min()), step


def _peak_rates(profile: FloatArray) -> list[float]:
    """Turns per point at the highest peaks of the spectrum that may be a feed."""
    n = profile.size
    power = np.abs(np.fft.rfft(profile * np.hanning(n), 8 * n)) ** 2
    rate = np.arange(power.size) / (8.0 * n)
    is_peak = np.append(False, (power[1:-1] > power[:-2]) & (power[1:-1] >= power[2:]))
    is_peak = np.append(is_peak, False) & (rate * n > _FEWEST_FEEDS) & (rate * _FEWEST_POINTS < 1.0)
    peaks = np.flatnonzero(is_peak)
    return [float(rate[k]) for k in peaks[np.argsort(power[peaks])[::-1][:_PEAKS]]]


@dataclass(frozen=True, eq=False)
class _Turns:
    """A profile over the turns of its workpiece.

    `turn` has the place of each point in turns, `profile` the heights without `tilt`, `periods` those of whole turns,
    shape (turns, points); `rate_error` is the relative standard error of the mean feed.
    """

    turn: FloatArray
    profile: FloatArray
    tilt: FloatArray
    periods: FloatArray
    rate_error: float

    @classmethod
    def along(cls, profile: FloatArray, rate: float) -> _Turns | None:
        """By the phase of the first harmonic in each turn, as a polynomial over the turns."""
        turn = np.asarray(np.arange(profile.size) * rate, dtype=np.float64)
        per_turn, tilt = round(1.0 / rate), np.zeros_like(turn)
        for _ in range(6):
            turns = int(turn[-1] - turn[0])
            if turns < _FEWEST_FEEDS or np.diff(turn).min() <= 0.0:
                return None
            middle, periods = _whole_turns(turn, profile - tilt, per_turn)
            # means of whole turns know the tilt without the cusps
            tilt = tilt + np.polyval(np.polyfit(middle, periods.mean(axis=1), 1), turn)
            middle, periods = _whole_turns(turn, profile - tilt, per_turn)
            phase = _phases(periods, turn[0])
            degree = min(1 + turns // 8, 4)
            fit = np.polynomial.Polynomial.fit(middle, phase, degree)
            turn = turn + fit(turn)
        scatter = np.sqrt(np.sum((phase - fit(middle)) ** 2) / (turns - 1 - degree))
        return cls(
            turn,
            profile - tilt,
            tilt,
            periods,
            float(scatter / np.sqrt(np.sum((middle - middle.mean()) ** 2))),
        )

    @property
    def share(self) -> float:
        """Of the variance, what repeats each turn."""
        return float(self.periods.mean(axis=0).var() / self.periods.var())

    @property
    def is_turned(self) -> bool:
        """Whether the harmonics are those of sharp crests that repeat."""
        from scipy.stats import t as student

        n = len(self.periods)
        wave = np.fft.rfft(self.periods.ravel())
        reach = np.arange(1, min(n, _HARMONICS))
        k = np.arange(1, _HARMONICS + 1)
        beside = np.abs(wave[(n * k)[:, None] + np.concatenate([-reach, reach])]) ** 2
        noise = np.sqrt(0.5 * beside.mean(axis=1))
        first = wave[n] / abs(wave[n])
        in_step = np.real(wave[n * k] * first**-k)
        # amplitudes of the harmonics of a cusp go with 1/k^2: the sum of best signal over noise
        weight = (k**-2.0 / noise**2)[1:]
        score = float(weight @ in_step[1:] / np.sqrt(np.sum((weight * noise[1:]) ** 2)))
        freedom, limit = 4 * reach.size, math.sqrt(2.0 * math.log(1.0 / _CHANCE))
        is_line = in_step[0] > limit * noise[0] and in_step[1] > _LEAST_SECOND * in_step[0]
        return bool(is_line and student.sf(score, freedom) < _CHANCE)


def _whole_turns(turn: FloatArray, profile: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Middle of each whole turn, and the heights in it, shape (turns, points)."""
    place = turn[0] + (np.arange(int(turn[-1] - turn[0]) * points) + 0.5) / points
    return place.reshape(-1, points).mean(axis=1), np.interp(place, turn, profile).reshape(-1, points)


def _phases(periods: FloatArray, start: float) -> FloatArray:
    """Of the first harmonic in each turn [turns]."""
    place = start + (np.arange(periods.shape[1]) + 0.5) / periods.shape[1]
    return np.unwrap(np.angle(periods @ np.exp(-2j * np.pi * place))) / (2.0 * np.pi)


def _describe(
    scan: Topography, across: FloatArray, step: float, turns: _Turns, settings: ScanSettings | None
) -> TurnedScan | None:
    """Mean groove, heights of the grooves and what is left; None if the nose is none."""
    since, points = turns.turn - _crest(turns), turns.periods.shape[1]
    since = since - math.floor(since[0])
    feed = step / float(np.polyfit(np.arange(since.size), since, 1)[0])
    whole = int(since[-1]) - 1
    place = (np.arange(points) + 0.5) / points
    grooves = np.interp(np.add.outer(1.0 + np.arange(whole), place), since, turns.profile)
    inside = np.abs(place - 0.5) < 0.5 - _BESIDE_CREST
    groove = _mean_groove(2.0 * place[inside] - 1.0, grooves[:, inside])
    levels = grooves[:, inside].mean(axis=1) - grooves[:, inside].mean()
    curvature = float(groove.parabola.deriv(2)(0.0))
    if not 0.0 < 4.0 * curvature < feed:
        return None
    # grooves that the ends of the scan cut are as high as their neighbours
    offset = levels[np.clip(np.floor(since).astype(int) - 1, 0, whole - 1)]
    cusp = groove.shape(2.0 * (since % 1.0) - 1.0)
    points_across = np.arange(since.size)
    tilt, mean, level = (np.interp(across, points_across, part) for part in (turns.tilt, cusp, offset))
    rest = scan.heights - tilt - mean
    crests, kept = float(np.var(0.5 * (levels[1:] + levels[:-1]))), 0.0
    for _ in range(_PASSES):
        fine = measure(replace(scan, heights=rest - (1.0 - kept) * level), settings)
        spectrum = _with_long_waves(fine.spectrum, 2.0 * np.pi / feed)
        # of the heights of the grooves the fine roughness has so much itself
        noise = math.pi / feed * float(profile_density(spectrum, 0.0))
        kept = math.sqrt(noise / crests) if noise < crests else 1.0
    return TurnedScan(
        feed=feed,
        feed_error=feed * turns.rate_error,
        side_slope=2.0 / feed * groove.end_slope,
        nose_radius=feed**2 / (4.0 * curvature),
        crest_height=groove.height,
        parabola_deviation=groove.deviation / groove.height,
        crest_scatter=math.sqrt(max(crests - noise, 0.0)),
        periodic_share=1.0 - float(rest.var() / np.var(scan.heights - tilt)),
        fine=spectrum,
        rest=fine,
        position=np.arange(since.size) * step,
        heights=turns.profile,
        cusp=cusp,
    )


def _crest(turns: _Turns) -> float:
    """Turn of a crest: where harmonics that go with 1/k^2 add up best."""
    points = turns.periods.shape[1]
    wave = np.fft.rfft(turns.periods.mean(axis=0))
    wave[1:] /= np.arange(1, wave.size) ** 2
    return float(turns.turn[0]) + (int(np.argmax(np.fft.irfft(wave, 8 * points))) / 8.0 + 0.5) / points


@dataclass(frozen=True, eq=False)
class _Groove:
    """Mean groove from crest to crest, -1 to 1: its parabola, and its shape, which may be another."""

    parabola: Legendre
    shape: Legendre

    @property
    def end_slope(self) -> float:
        """Mean of both sides."""
        low, high = self.shape.deriv()(np.array([-1.0, 1.0]))
        return 0.5 * float(high - low)

    @property
    def height(self) -> float:
        """Of the crests over the bottom."""
        return float(self.shape(np.array([-1.0, 1.0])).mean() - self.shape(np.linspace(-1.0, 1.0, 401)).min())

    @property
    def deviation(self) -> float:
        """Rms distance of shape and parabola."""
        u = np.linspace(-1.0, 1.0, 401)
        return float(np.sqrt(np.mean((self.shape(u) - self.parabola(u)) ** 2)))


def _mean_groove(place: FloatArray, grooves: FloatArray) -> _Groove:
    """Another shape than the parabola only where its terms are more than their scatter over the grooves explains."""
    from scipy.stats import t as student

    n = len(grooves)
    parabola = Legendre.fit(place, grooves.mean(axis=0), 2, domain=[-1, 1])
    terms = legfit(place, grooves.T, 4)[3:]
    error = terms.std(axis=1, ddof=1) / math.sqrt(n)
    is_other = np.any(np.abs(terms.mean(axis=1)) > student.isf(_CHANCE, n - 1) * error)
    shape = Legendre.fit(place, grooves.mean(axis=0), 4, domain=[-1, 1]) if is_other else parabola
    return _Groove(parabola, shape)


def _with_long_waves(spectrum: PowerSpectrum, q_feed: float) -> PowerSpectrum:
    """With a constant C for waves of one to two feeds, which went with the heights of the grooves."""
    keep = spectrum.wavenumber > 1.5 * q_feed
    q, C = spectrum.wavenumber[keep], spectrum.density[keep]
    return PowerSpectrum(np.append(0.5 * q_feed, q), np.append(C[0], C))
