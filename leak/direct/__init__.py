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

from lazy_loader import attach_stub

# a name is loaded with its first use, so that a program loads only what it calls
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
