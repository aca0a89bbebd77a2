"""The pressure integral in Yang and Persson's mean separation, a function of one variable, tabulated once."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from leak.arrays import FloatArray

# F beyond this x is below 1e-18 of any value that matters.
KERNEL_END = 6.5
_KERNEL_START = 1e-4
_KERNEL_STEP = 5e-4
_LOG_START = float(np.log(_KERNEL_START))


@dataclass(frozen=True)
class Kernel:
    """F(x) = int_x^inf [gamma + 3 (1-gamma) erf^2(t)] exp(-t^2) dt/t and f = -x dF/dx, tabulated over ln x.

    F = (gamma/2) E1(x^2) + 3 (1-gamma) K(x), K(x) = int_x^inf erf^2(t) exp(-t^2) dt/t: the pressure integral of
    the mean separation (Yang & Persson, J. Phys.: Condens. Matter 20, 215214 (2008)). Good to 1e-7.
    """

    gamma: float
    K0: float
    F: FloatArray
    F_rise: FloatArray
    f: FloatArray
    f_rise: FloatArray

    def __call__(self, log_x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """F and f at ln x; below the table F goes on as its logarithm, above it both are zero."""
        t = log_x - _LOG_START
        t *= 1.0 / _KERNEL_STEP
        last = self.F.size - 1.0
        np.minimum(t, last, out=t)
        i = np.maximum(t, 0.0)
        i = np.minimum(i, last - 1.0, out=i).astype(np.intp)
        t -= i
        F = self.F_rise.take(i)
        F *= t
        F += self.F.take(i)
        np.maximum(t, 0.0, out=t)
        f = self.f_rise.take(i)
        f *= t
        f += self.f.take(i)
        return F, f


@lru_cache(maxsize=8)
def kernel(gamma: float) -> Kernel:
    """The tabulated kernel for one value of Yang and Persson's gamma."""
    count = int(np.ceil(np.log(KERNEL_END / _KERNEL_START) / _KERNEL_STEP)) + 1
    log_x = np.log(_KERNEL_START) + _KERNEL_STEP * np.arange(count)
    x = np.exp(log_x)
    # by the C library: importing scipy.special takes longer than this table
    erf = np.array([math.erf(one) for one in x.tolist()])
    gauss = np.exp(-(x**2))
    k = erf**2 * gauss
    dk = (4.0 / np.sqrt(np.pi)) * x * erf * gauss**2 - 2.0 * x**2 * k
    K = _above(k, dk)
    F = gamma * _above(gauss, -2.0 * x**2 * gauss) + 3.0 * (1.0 - gamma) * K
    f = gamma * gauss + 3.0 * (1.0 - gamma) * k
    F[-1] = f[-1] = 0.0
    return Kernel(
        gamma, float(K[0] + 2.0 / np.pi * x[0] ** 2), F, np.diff(F, append=0.0), f, np.diff(f, append=0.0)
    )


def _above(k: FloatArray, dk: FloatArray) -> FloatArray:
    """Integral of k over ln x from each point to the end: corrected trapezoids, of fourth order with dk/dln x."""
    cells = 0.5 * _KERNEL_STEP * (k[1:] + k[:-1]) + _KERNEL_STEP**2 / 12.0 * (dk[:-1] - dk[1:])
    return np.concatenate([np.cumsum(cells[::-1])[::-1], [0.0]])
