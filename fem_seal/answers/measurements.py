"""Which width the interval of a leak rate is expected to have after a measurement.

One of the samples is taken for the truth, the instrument shows its values with its error, and each sample keeps the
weight with which it agrees with what is shown. The mean width over several truths is what is expected. No contact is
solved: a polynomial through the samples gives the leak rates of many more.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import leak
from fem_seal.answers.response_surface import fit, variables
from fem_seal.answers.uncertainty import LeakInterval
from fem_seal.arrays import FloatArray
from fem_seal.case.roughness import PARTS, FinishTable, Roughness
from fem_seal.files import own_tables
from fem_seal.sampling import sobol_points
from fem_seal.seal.findings import Bounds

LEAK_TEST, LINE_SCAN = "leak_test", "line_scan"
# Draws from the polynomial, how many of them are truths, and the samples that it goes through.
_DRAWS, TRUTHS, _FIT_SAMPLES = 8192, 32, 512
# Error of a left-out sample over the scatter above which the polynomial says nothing, and the smallest scatter of ln Q.
_ROUGH, _SMALLEST_SCATTER = 0.3, 1e-6
# A measurement that leaves fewer draws, counted by their weights, cannot be told.
_FEWEST = 25.0
# Of the correlation between loads; the others are too small to count.
_PARTS = 6
# ln of equal weights of all draws, of one truth.
EVEN_WEIGHTS = np.zeros((1, 1))
# A run over which an instrument is to go, over the cutoff: five and one before and after (ISO 21920-3).
_CUTOFFS = 7.0


@dataclass(frozen=True)
class Measurement:
    """A measurement that would narrow an interval.

    Parameters
    ----------
    instrument : str
        Key in templates/instruments.toml.
    accuracy : mapping
        Standard deviation of ln of what it measures, by uncertain input or "leak_rate" [-].
    left : float or None
        Expected upper over lower end after it [-]; None where the samples cannot tell.
    at : int or None
        Number of the load at which a leak rate is measured.
    """

    instrument: str
    accuracy: Mapping[str, float]
    left: float | None
    at: int | None = None


def instruments() -> dict[str, dict[str, Any]]:
    """Instruments with their accuracies and where these come from, see templates/instruments.toml."""
    return own_tables("instruments.toml")


@dataclass(frozen=True)
class LineScans:
    """Line scans of all rough faces, one of each.

    Parameters
    ----------
    length : float
        Of the longest [m].
    scatter : float
        Standard deviation of ln h that they leave, h the rms height of the gap [-].
    shares : mapping
        Of each spectrum of the case in h^2 [-].
    """

    length: float
    scatter: float
    shares: Mapping[str, float]


def line_scans(roughness: Roughness) -> LineScans:
    """Scans seven cutoffs long, those of a drawing's finish or of the rms height.

    Parameters
    ----------
    roughness : Roughness
    """
    from leak.surfaces.random import height_scatter

    lengths: dict[str, float] = {}
    across: dict[str, leak.PowerSpectrum] = {}
    heights: dict[str, float] = {}
    for key, part in roughness.parts.items():
        if isinstance(part, FinishTable):
            surface = part.surface()
            across[key], heights[key] = surface.across, surface.spectrum.rms_height
            lengths[key] = _CUTOFFS * part.finish.band.lambda_c
        else:
            across[key] = part.build()
            heights[key] = across[key].rms_height
            lengths[key] = _CUTOFFS * leak.implied_filter("Rq", heights[key]).lambda_c
    shares = {key: height**2 / sum(h**2 for h in heights.values()) for key, height in heights.items()}
    scatters = [shares[key] * height_scatter(spectrum, lengths[key]) for key, spectrum in across.items()]
    return LineScans(max(lengths.values()), math.hypot(*scatters), shares)


@dataclass(frozen=True, eq=False)
class Draws:
    """Inputs and leak rates of many draws from the joint distribution of an interval.

    Parameters
    ----------
    confidence : float
        Share of the draws between both ends.
    values : mapping of ndarray, shape (draws,)
        Of each uncertain input: ln of its value, or what differences between scans do to ln Q.
    log_rate : ndarray, shape (readings, loads, draws)
        ln of the leak rate with the theory's own error [ln m^3/s]; NaN at loads where a sample is sealed or blown open.
    doubt, noise : ndarray, shapes (draws,) and (truths, inputs + 1)
        Place within what else a leak rate may be off by, and normal error of each instrument.
    """

    confidence: float
    values: Mapping[str, FloatArray] = field(repr=False)
    log_rate: FloatArray = field(repr=False)
    doubt: FloatArray = field(repr=False)
    noise: FloatArray = field(repr=False)

    @classmethod
    def of(cls, interval: LeakInterval, log_peaks: FloatArray | None = None) -> Draws | None:
        """Draws from the samples of an interval; None where no polynomial goes through them.

        Parameters
        ----------
        interval : LeakInterval
        log_peaks : ndarray, shape (loads,), optional
            Decimal logarithms of the peak pressures [Pa], by which the theory's own error at one load belongs to that
            at another (`leak.error_correlation`); unless given it is the same at all.
        """
        from scipy.special import ndtri

        with np.errstate(divide="ignore"):
            log_rate = np.log([interval.leak_rate, *interval.others.values()])
        finite = np.isfinite(log_rate).all(axis=(0, 2))
        columns = variables(interval.values)
        if not columns or not finite.any():
            return None
        inputs = np.concatenate(columns, axis=1)
        outputs = log_rate[:, finite].reshape(-1, interval.samples).T
        surface = fit(inputs[:_FIT_SAMPLES], outputs[:_FIT_SAMPLES], inputs)
        if np.any(surface.error > np.maximum(_ROUGH * outputs.std(axis=0), _SMALLEST_SCATTER)):
            return None
        count = len(columns)
        if interval.error_scores is None:
            loads = len(interval.leak_rate)
            root = error_root(np.zeros(loads) if log_peaks is None else log_peaks)[:, -_PARTS:]
            doubt, *places = sobol_points(_DRAWS, 2 * count + 2 + root.shape[1], interval.seed).T
            scores = root @ ndtri(places[2 * count + 1 :])
            # independent inputs: each with its own distribution
            draws = [
                np.quantile(col, place)[:, None] if col.shape[1] == 1 else col[(place * len(col)).astype(int)]
                for col, place in zip(columns, places[:count], strict=True)
            ]
        else:
            # what a leak test has left belongs together
            doubt, *places = sobol_points(interval.samples, 2 * count + 2, interval.seed).T
            scores, draws = interval.error_scores, columns
        ln_q = np.full((*log_rate.shape[:2], len(doubt)), math.nan)
        ln_q[:, finite] = surface(np.concatenate(draws, axis=1)).T.reshape(len(ln_q), -1, len(doubt))
        for rates, error, score in zip(ln_q.swapaxes(0, 1), interval.own_error, scores, strict=True):
            if error is not None:
                rates += error.bias + error.spread * score
        mean = ln_q[0, finite].mean(axis=0)
        values = {
            name: column[:, 0] if interval.values[name].ndim == 1 else _effect(column, mean)
            for name, column in zip(interval.values, draws, strict=True)
        }
        noise = ndtri(np.array(places[count : 2 * count + 1]).T[:TRUTHS])
        return cls(interval.confidence, values, ln_q, doubt, noise)

    def weigh(self, accuracy: Mapping[str, float], truth: Mapping[str, float] | None = None) -> FloatArray:
        """ln of the weights of all draws after a measurement of inputs, shape (truths, draws).

        Parameters
        ----------
        accuracy : mapping
            Standard deviation of ln of each value [-].
        truth : mapping, optional
            The only one, ln of its values, shown without an error.
        """
        total = np.zeros((1, 1))
        for (name, values), noise in zip(self.values.items(), self.noise.T, strict=False):
            if name in accuracy:
                shows = np.array([truth[name]]) if truth else values[:TRUTHS] + accuracy[name] * noise
                total = total - 0.5 * ((values - shows[:, None]) / accuracy[name]) ** 2
        return total

    def weigh_test(self, at: int, accuracy: float, doubt: Bounds) -> FloatArray:
        """The same after a leak test at a load, shape (readings, truths, draws); each reading has its turn as truth.

        Parameters
        ----------
        at : int
        accuracy : float
        doubt : Bounds
            Factors by which the leak rate may be off there.
        """
        rates = self.rates_with_doubt(at, doubt)
        turn = np.arange(TRUTHS)
        shows = rates[turn % len(rates), turn] + accuracy * self.noise[:, -1]
        return np.asarray(-0.5 * ((rates[:, None] - shows[:, None]) / accuracy) ** 2)

    def rates_with_doubt(self, number: int, doubt: Bounds) -> FloatArray:
        """ln of the leak rates at a load with what else they may be off by, evenly, shape (readings, draws)."""
        low, high = np.log(doubt)
        return np.asarray(self.log_rate[:, number] + low + (high - low) * self.doubt)

    def ends(self, log_rate: FloatArray, log_weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower end in the reading that leaks less and upper end in the one that leaks more, each (truths,).

        Parameters
        ----------
        log_rate : ndarray, shape (readings, draws)
        log_weights : ndarray, shape (truths, draws), or that for each reading
        """
        shares = 0.5 - 0.5 * self.confidence, 0.5 + 0.5 * self.confidence
        weights = np.broadcast_to(log_weights, (len(log_rate), log_weights.shape[-2], log_rate.shape[1]))
        quantiles = [
            [weighted_quantiles(rates, np.exp(row - row.max()), shares) for row in rows]
            for rates, rows in zip(log_rate, weights, strict=True)
        ]
        low, high = np.moveaxis(np.array(quantiles), -1, 0)
        return low.min(axis=0), high.max(axis=0)

    def width(self, log_rate: FloatArray, log_weights: FloatArray) -> float | None:
        """Mean over the truths of ln(upper/lower end); None where too few draws have a weight."""
        weights = np.exp(log_weights - log_weights.max(axis=-1, keepdims=True))
        effective = weights.sum(axis=-1) ** 2 / (weights**2).sum(axis=-1)
        if log_weights.size > 1 and np.median(effective) < _FEWEST:
            return None
        low, high = self.ends(log_rate, log_weights)
        return float((high - low).mean())


def weighted_quantiles(values: FloatArray, weights: FloatArray, shares: Sequence[float]) -> FloatArray:
    """Values that shares of the weight stay below.

    Parameters
    ----------
    values, weights : ndarray, shape (n,)
    shares : sequence of float
    """
    order = np.argsort(values)
    cumulative = np.cumsum(weights[order])
    return np.interp(np.array(shares) * cumulative[-1], cumulative - 0.5 * weights[order], values[order])


def error_root(log_peaks: FloatArray) -> FloatArray:
    """What makes independent normal numbers to the theory's errors at all loads, shape (loads, loads); large ones last.

    Parameters
    ----------
    log_peaks : ndarray, shape (loads,)
        See `leak.error_correlation`.
    """
    values, vectors = np.linalg.eigh(leak.error_correlation(log_peaks))
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def _effect(columns: FloatArray, response: FloatArray) -> FloatArray:
    """What columns do to a response, linearly."""
    deviations = columns - columns.mean(axis=0)
    return np.asarray(deviations @ np.linalg.lstsq(deviations, response - response.mean(), rcond=None)[0])


def accuracies(
    values: Mapping[str, FloatArray], scatter: Mapping[str, float]
) -> Iterator[tuple[str, dict[str, float]]]:
    """Instruments with the accuracy of what they measure of a seal: each input alone, then all of one instrument.

    Parameters
    ----------
    values : mapping of ndarray
        ln of the uncertain inputs.
    scatter : mapping
        Standard deviation of ln of what one unit of `scatters` means, by input [-].
    """
    for instrument, table in instruments().items():
        accuracy = {}
        for name, column in values.items():
            kind = "spectrum" if name in PARTS else "scan_length" if name.startswith("scan_length") else name
            if kind in table.get("accuracies", {}):
                accuracy[name] = table["accuracies"][kind]
            elif kind in table.get("shares", {}):
                accuracy[name] = table["shares"][kind] * float(column.std())
            elif kind in table.get("scatters", {}) and name in scatter:
                accuracy[name] = table["scatters"][kind] * scatter[name]
        yield from ((instrument, {name: value}) for name, value in accuracy.items())
        if len(accuracy) > 1:
            yield instrument, accuracy
