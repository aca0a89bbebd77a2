"""Effect of a lay: contact patches longer and more numerous than isotropic ones.

Both numbers were fitted to direct simulations of stretched surfaces, pressed elastically, and judged by others
(theory/anisotropy in the manual). Both are one for an isotropic surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import FloatArray

# Fitted to half of the direct results: how much more of endless ridges touches where little does. The fit gives an
# exponent of the aspect of 1 + 1.05 sqrt(A/(A0 a_c)).
_MORE = 0.35


def inclusion_aspect(peklenik: float, share: ArrayLike) -> FloatArray:
    """Length along x over that along y of the inclusions of the effective medium.

    gamma^(1 + sqrt(A/(A0 a_c))). Without contact they are as long as the roughness, for which Tripp's result is exact;
    patches of contact are longer: gamma^(4/3), like ellipses of Hertz, at A/A0 = 0.05, gamma^2 where they percolate.

    Parameters
    ----------
    peklenik : float
        gamma_T of the heights [-].
    share : array_like
        Contact area over that at which no path is open, A/(A0 a_c), 0 to 1 [-].

    Examples
    --------
    >>> [round(float(aspect), 2) for aspect in inclusion_aspect(5.0, [0.0, 0.1, 1.0])]
    [5.0, 8.32, 25.0]
    """
    return np.asarray(float(peklenik) ** (1.0 + np.sqrt(np.clip(share, 0.0, 1.0))))


def touching_pressure(peklenik: float, share: ArrayLike) -> FloatArray:
    """Factor on the pressure at which an isotropic surface of the same spectrum touches as much as a stretched one.

    1 + 0.35 ((gamma - 1)/(gamma + 1))^2 [1 - (A/(A0 a_c))^2]: long patches carry less pressure. It falls to one where
    no path is open, so that the theory's sealing pressure does not depend on the lay, and p times it rises with p.

    Parameters
    ----------
    peklenik, share
        See `inclusion_aspect`.

    Examples
    --------
    >>> [round(float(factor), 3) for factor in touching_pressure(0.2, [0.0, 0.5, 1.0])]
    [1.156, 1.117, 1.0]
    """
    return np.asarray(1.0 + _MORE * _stretch(peklenik) * (1.0 - np.clip(share, 0.0, 1.0) ** 2))


def touching_pressure_at_equal_gap(peklenik: float, share: ArrayLike) -> FloatArray:
    """`touching_pressure` where the mean gap is that of `leak.theory.gap_law`.

    1 + 1.4 ((gamma - 1)/(gamma + 1))^2 s (1 - s), s = A/(A0 a_c): the same height at the middle, and one where little
    touches, where the gap is that of the heights, which know no lay.

    Parameters
    ----------
    peklenik, share
        See `inclusion_aspect`.

    Examples
    --------
    >>> [round(float(factor), 3) for factor in touching_pressure_at_equal_gap(0.2, [0.0, 0.5, 1.0])]
    [1.0, 1.156, 1.0]
    """
    s = np.clip(share, 0.0, 1.0)
    return np.asarray(1.0 + 4.0 * _MORE * _stretch(peklenik) * s * (1.0 - s))


def _stretch(peklenik: float) -> float:
    return ((peklenik - 1.0) / (peklenik + 1.0)) ** 2
