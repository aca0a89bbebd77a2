"""Direct numerical simulation of a rough patch: contact by boundary elements, Reynolds flow through what stays open.

Not a theory: the map of heights itself is pressed and flowed through, so that the theory can be judged, or replaced,
for the surface at hand. What it cannot hold are wavelengths longer than the patch and shorter than two grid cells.

Examples
--------
>>> import leak
>>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=4e5)
>>> heights = leak.random_map(spectrum, size=6e-4, points=64, seed=1)
>>> result = leak.direct.simulate(heights, 6e-4, [1e7], effective_modulus=100e9, hardness=2e9)
>>> sigma = result.flow_conductivity(viscosity=1e-3)
>>> bool(sigma[0] > 0.0)
True
"""

from leak.direct.contact import ContactState, PeriodicHalfSpace, press
from leak.direct.elastoplastic import ElastoplasticState, press_elastoplastic
from leak.direct.flow import Flow, Streams, patch_flow, periodic_flow, rarefied_gap, streams
from leak.direct.patch import Patch, periodic_map, refined, smoothed
from leak.direct.simulation import (
    DirectBranch,
    DirectResult,
    PressedPatch,
    cutoff_study,
    grid_study,
    simulate,
    size_study,
)
from leak.direct.strip import Strip, StripState, rest_gap

__all__ = [
    "ContactState",
    "DirectBranch",
    "DirectResult",
    "ElastoplasticState",
    "Flow",
    "Patch",
    "PeriodicHalfSpace",
    "PressedPatch",
    "Streams",
    "Strip",
    "StripState",
    "cutoff_study",
    "grid_study",
    "patch_flow",
    "periodic_flow",
    "periodic_map",
    "press",
    "press_elastoplastic",
    "rarefied_gap",
    "refined",
    "rest_gap",
    "simulate",
    "size_study",
    "smoothed",
    "streams",
]
