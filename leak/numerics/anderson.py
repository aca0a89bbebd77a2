"""Anderson's acceleration of fixed-point iterations."""

from __future__ import annotations

import numpy as np

from leak.arrays import FloatArray

# Square of the relative size below which changes of residuals are taken as dependent on each other.
_DEPENDENT = 1e-12


def mixing_weights(residuals: FloatArray) -> FloatArray:
    """Weights with the sum one of the last iterates, whose combined residual is smallest, shape (n,).

    Parameters
    ----------
    residuals : ndarray, shape (n, points)
        image(x) - x of iterates x, the last one last.

    References
    ----------
    D. G. Anderson, J. ACM 12, 547 (1965): the next x is the combination of the images. For a map that is linear along a
    few directions it converges like GMRES.

    Examples
    --------
    An image that is linear in x is met after two iterates: x = 1 + x/2 from 0 and 1.

    >>> weights = mixing_weights(np.array([[1.0], [0.5]]))
    >>> float(weights @ [1.0, 1.5])
    2.0
    """
    if len(residuals) == 1:
        return np.ones(1)
    from scipy.linalg.lapack import dgelss

    change = residuals[-1] - residuals[:-1]
    products = change @ change.T
    size = np.sqrt(products.diagonal())
    size[size == 0.0] = 1.0
    share = (
        dgelss(products / (size[:, None] * size), change @ residuals[-1] / size, cond=_DEPENDENT)[1] / size
    )
    return np.append(share, 1.0 - share.sum())
