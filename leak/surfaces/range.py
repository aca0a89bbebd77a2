"""Reliable range of a scan: its length, sampling, filter and stylus tip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from leak.errors import ScanError, um
from leak.surfaces.periodogram import Periodogram
from leak.surfaces.scans import Topography
from leak.surfaces.settings import ScanSettings

# Bins per decade in which the end of a spectrum is looked for.
_PER_DECADE = 10
# Waves this weak against the strongest one are not there at all; and where the mean power in bins falls by more than
# this from one to the next, never to return, the heights were filtered or calculated.
_NOTHING, _SHARP = 1e-9, 1e-3
# A spectrum needs two octaves.
_LEAST_RANGE = 4.0


@dataclass(frozen=True)
class ReliableRange:
    """Wavenumbers that a scan can tell [1/m], and what limits them at the upper end."""

    q_low: float
    q_high: float
    limit: str


def reliable_range(scan: Topography, modes: Periodogram, settings: ScanSettings) -> ReliableRange:
    """Wavenumbers that a scan without form can tell; ScanError if they span less than two octaves."""
    limits = {"sampling": np.pi / scan.resolution}
    present = np.flatnonzero(modes.power > _NOTHING * modes.power.max())
    end = _sharp_end(modes)
    if end is not None:
        limits["no shorter waves in the data"] = end
    if settings.shortest_wavelength is not None:
        limits["shortest wavelength"] = 2.0 * np.pi / settings.shortest_wavelength
    tip = settings.tip_radius or scan.tip_radius
    if tip is not None:
        limits["tip radius"] = _tip_limit(modes, tip)
    limit = min(limits, key=lambda name: limits[name])
    low, high = max(2.0 * np.pi / scan.length, modes.wavenumber[present[0]]), limits[limit]
    if high < _LEAST_RANGE * low:
        raise ScanError(
            f"{scan.name or 'scan'}: nothing reliable is left between its length, {um(scan.length)}, and the "
            f"shortest wave, {um(2 * np.pi / high)} ({limit})"
        )
    return ReliableRange(low, high, limit)


def _tip_limit(modes: Periodogram, tip_radius: float) -> float:
    """Wavenumber up to which a profile bends less than the tip can follow [1/m]."""
    along = np.mean(modes.vector**4, axis=1)
    curvature = np.sqrt(np.cumsum(modes.shares * along))
    reached = np.flatnonzero(curvature > 0.5 / tip_radius)
    return float(modes.wavenumber[reached[0]]) if reached.size else np.inf


def _sharp_end(modes: Periodogram) -> float | None:
    """Wavenumber above which there is nothing, as in filtered or calculated heights [1/m]; None without one.

    A spectrum that ends within the range of the fit would make it ring.
    """
    q, power = modes.wavenumber, modes.power
    edges = np.geomspace(q[0], q[-1], max(int(_PER_DECADE * np.log10(q[-1] / q[0])), 1) + 1)
    bins = np.clip(np.searchsorted(edges, q, side="right") - 1, 0, edges.size - 2)
    count = np.bincount(bins, minlength=edges.size - 1)
    mean = np.bincount(bins, power, minlength=edges.size - 1)[count > 0] / count[count > 0]
    highest_after = np.maximum.accumulate(mean[::-1])[::-1]
    drops = np.flatnonzero(highest_after[1:] < _SHARP * mean[:-1])
    if not drops.size:
        return None
    before = np.unique(bins)[drops[0]]
    strong = np.flatnonzero((power > 0.1 * mean[drops[0]]) & (bins <= before + 1))
    return float(q[strong[-1]])


def share_above(modes: Periodogram, q: float) -> float:
    """Share of the variance in waves above a wavenumber [-]."""
    shares = modes.shares
    return float(np.sum(shares[modes.wavenumber > q * (1 + 1e-9)]) / np.sum(shares))
