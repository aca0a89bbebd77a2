"""The resistance 1/sigma_eff of a gap over ln p as a smooth curve, and the implicit step of a fluid that opens it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import exp, inf, log

import numpy as np
from numpy.typing import NDArray

from leak.monotone_curve import spline_slopes

FloatArray = NDArray[np.float64]

# Table of ln(1/sigma) over ln p: spacing, how far below the largest pressure, and equal ratios of p_seal - p above.
_SPACING, _RANGE = 0.05, 60.0
_NEAR_SEALING = 14.0
# A conductivity below this is none: toward the sealing pressure sigma underflows before it vanishes [m^3/(Pa s)].
_NONE = 1e-200
_NEWTON_STEPS = 60
# Newton's error squares with each step.
_CLOSE = 1e-8


@dataclass(frozen=True, eq=False)
class ResistanceCurve:
    """ln(1/sigma_eff) over v = ln p: cubic between nodes; below them 1/sigma ~ u^-3 with u linear in v."""

    nodes: list[float]
    """v, increasing."""
    values: list[float]
    """ln(1/sigma) there."""
    slopes: list[float]
    """Its derivative there."""
    sealing_pressure: float
    """From here on sigma is as good as zero; infinite if not in the table's range [Pa]."""

    @classmethod
    def of(cls, sigma: Callable[[FloatArray], FloatArray], log_p_max: float) -> ResistanceCurve:
        """Table of a conductivity given as a function of ln p, up to `log_p_max` or the sealing pressure."""
        v = np.linspace(log_p_max - _RANGE, log_p_max, int(_RANGE / _SPACING) + 1)
        flows = sigma(v) > _NONE
        sealing = inf
        if not flows.all():
            first = int(np.argmin(flows))
            low, high = float(v[first - 1]), float(v[first])
            for _ in range(60):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if float(sigma(np.array([middle]))[0]) > _NONE else (low, middle)
            near = high + np.log1p(-np.exp(-np.arange(1.0, _NEAR_SEALING, 0.1)))
            v = np.concatenate([v[v < near[0] - 0.5 * _SPACING], near])
            sealing = exp(high)
        values = sigma(v)
        usable = np.isfinite(values) & (values > _NONE)
        v, G = v[usable], -np.log(values[usable])
        return cls(v.tolist(), G.tolist(), np.maximum(spline_slopes(v, G), 1e-12).tolist(), sealing)

    @property
    def lowest(self) -> float:
        """First node."""
        return self.nodes[0]

    @property
    def highest(self) -> float:
        """Last node below the sealing pressure; without one, the curve goes on."""
        return self.nodes[-1] if self.sealing_pressure < inf else inf

    def at(self, v: float) -> tuple[float, float]:
        """ln(1/sigma) and its derivative at v = ln p."""
        nodes = self.nodes
        if v <= nodes[0]:
            s = self.slopes[0] / 3.0
            stretch = 1.0 + s * (nodes[0] - v)
            return self.values[0] - 3.0 * log(stretch), 3.0 * s / stretch
        k = min(bisect_right(nodes, v), len(nodes) - 1) - 1
        h = nodes[k + 1] - nodes[k]
        t = (v - nodes[k]) / h
        y0, rise = self.values[k], self.values[k + 1] - self.values[k]
        d0, d1 = h * self.slopes[k], h * self.slopes[k + 1]
        c2, c3 = 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise
        return y0 + t * (d0 + t * (c2 + t * c3)), (d0 + t * (2.0 * c2 + 3.0 * t * c3)) / h

    def rise(self, room: float, log_flow: float, guess: float) -> tuple[float, float]:
        """Rise a/sigma(w) of the fluid pressure over a step, where w + a/sigma(w) = room, and ln w.

        w is the pressure left for the asperities. Newton on ln(w + a/sigma(w)) = ln(room) in v = ln w, where the left
        side rises and is convex: from above it converges without overshooting. No room: no contact, no rise.

        Parameters
        ----------
        room : float
            p less the fluid pressure before the step [Pa].
        log_flow : float
            ln a, a = Q dx/(2 pi r).
        guess : float
            Near ln w.
        """
        if not room > 0.0:
            return 0.0, guess
        target = log(room)
        top = min(target, self.highest)
        v = min(guess, top)
        for _ in range(_NEWTON_STEPS):
            G, dG = self.at(v)
            G += log_flow
            larger = v if v > G else G
            own, other = exp(v - larger), exp(G - larger)
            total = own + other
            step = (larger + log(total) - target) * total / (own + other * dG)
            new = min(v - step, top)
            moved, v = abs(new - v), new
            if moved < _CLOSE:
                break
        w = exp(v) if v > -700.0 else 0.0
        G = self.at(v)[0] + log_flow
        if v == self.highest < target:
            # So little flows that w stays at the last node, next to the sealing pressure.
            return room - w, v
        # Of two numbers that add up to `room` the smaller one is the accurate one.
        return (exp(G) if v > G else room - w), v

    def guess(
        self,
        drop: float,
        pressures: Sequence[tuple[float, float]],
        log_lengths: Sequence[tuple[float, float]],
    ) -> float:
        """Rough ln Q: that of the same contact without coupling, each place as far as it conducts."""
        total = 0.0
        for (_, p), (_, length) in zip(pressures, log_lengths, strict=True):
            if p > 0.0:
                total += exp(min(self.at(min(log(p), self.highest))[0] + length, 600.0))
        return log(drop) - log(total)
