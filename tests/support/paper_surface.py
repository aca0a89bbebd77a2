"""The rough surface of the reference numbers: sandblasted steel with an rms height of 1.9 um on a smooth steel ball."""

from __future__ import annotations

from typing import Any

import leak

E, HARDNESS = 115e9, 3.5e9


def spectrum(**change: float) -> leak.PowerSpectrum:
    """Its power spectrum, some of its numbers changed."""
    values = {"rms_height": 1.9e-6, "hurst": 0.6, "q_low": 1e3, "q_rolloff": 37268.0, "q_high": 3141592.6}
    return leak.PowerSpectrum.self_affine(**(values | change))


def surface(**settings: Any) -> leak.RoughContact:
    """The contact, elastic unless a hardness is given."""
    return leak.RoughContact(spectrum(), effective_modulus=E, **settings)
