"""Leakage of rough contacts: power spectra, Persson's contact mechanics, flow conductivity, leak integral.

Plain arrays in, plain arrays out, all in SI units; nothing here knows about meshes or case files.

Examples
--------
>>> import leak
>>> spectrum = leak.PowerSpectrum.self_affine(
...     rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
... )
>>> surface = leak.RoughContact(spectrum, effective_modulus=115e9, hardness=3.5e9)
>>> line = leak.gaussian_line(line_load=20e3, radius=0.02, u0=0.139e-3**2 / 0.02)
>>> import numpy as np
>>> x = np.linspace(-4, 4, 201) * line.std
>>> table = surface.conductivity_table(1e3, 1e8)
>>> Q = leak.leak_rate(x, line.pressure(x), table.at(viscosity=1e-3), pressure_drop=2e6, radius=0.0141421)
>>> print(f"{Q * 1e9:.0f} mm^3/s")
393 mm^3/s
"""

from lazy_loader import attach_stub

# a name is loaded with its first use, so that a program loads only what it calls
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
