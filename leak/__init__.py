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

from leak.conductivity import Conductivity, ConductivityTable, dimension_number, effective_medium
from leak.errors import (
    ConductivityError,
    FluidError,
    LawError,
    LeakError,
    ProfileError,
    SpectrumError,
    SurfaceError,
)
from leak.fluids import FLUIDS, Liquid, liquid
from leak.interface_law import ExponentialLaw, RoughSurfaceLaw, TabulatedLaw
from leak.leak_rate import LeakResult, leak_flow, leak_rate
from leak.line_contact import (
    CrossoverLine,
    GaussianLine,
    HertzLine,
    LineProfile,
    crossover_line,
    gaussian_line,
    hertz_line,
)
from leak.persson import relative_contact_area
from leak.plasticity import AreaFractions, area_fractions, remaining_fraction
from leak.rough_contact import RoughContact
from leak.spectrum import PowerSpectrum

__all__ = [
    "FLUIDS",
    "AreaFractions",
    "Conductivity",
    "ConductivityError",
    "ConductivityTable",
    "CrossoverLine",
    "ExponentialLaw",
    "FluidError",
    "GaussianLine",
    "HertzLine",
    "LawError",
    "LeakError",
    "LeakResult",
    "LineProfile",
    "Liquid",
    "PowerSpectrum",
    "ProfileError",
    "RoughContact",
    "RoughSurfaceLaw",
    "SpectrumError",
    "SurfaceError",
    "TabulatedLaw",
    "area_fractions",
    "crossover_line",
    "dimension_number",
    "effective_medium",
    "gaussian_line",
    "hertz_line",
    "leak_flow",
    "leak_rate",
    "liquid",
    "relative_contact_area",
    "remaining_fraction",
]
