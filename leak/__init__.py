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

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from leak import direct
    from leak.errors import (
        ConductivityError,
        DirectError,
        FluidError,
        LawError,
        LeakError,
        ProfileError,
        ScanError,
        SpectrumError,
        SurfaceError,
    )
    from leak.flow.around import (
        AroundFlow,
        AroundGasFlow,
        around_flow,
        gas_around_flow,
        rarefied_conductivity,
    )
    from leak.flow.conductivity import (
        Conductivity,
        ConductivityTable,
        GasConductivity,
        GasConductivityTable,
        RemembersLoad,
    )
    from leak.flow.fluid_in_gap import CoupledLeakResult, coupled_leak_flow
    from leak.flow.gas_flow import GasLeakResult, gas_leak_flow
    from leak.flow.groove_section import EllipticGroove, GrooveSection, SinusoidalGroove
    from leak.flow.inertia import GasInertia, gas_inertia
    from leak.flow.leak_rate import LeakResult, leak_flow, leak_rate
    from leak.flow.medium import DirectionalGap, anisotropic_medium, dimension_number, effective_medium
    from leak.flow.memory import LoadMemory
    from leak.flow.nearby import NearbyTables
    from leak.flow.particles import (
        Clogging,
        GapDistribution,
        Paths,
        ShutConductivityTable,
        cloggings,
        parallel_paths,
        shut_conductivity,
        stopped,
        throttling_length,
    )
    from leak.flow.rough_contact import RoughContact, gas_conductivity_table
    from leak.flow.scratch import (
        Groove,
        LeakBounds,
        Scratch,
        SpiralLay,
        deepest_scratch,
        gas_scratch_flow,
        scratch_flow,
    )
    from leak.fluids.contamination import Concentration, ParticleCounts
    from leak.fluids.find import gas, is_gas, is_liquid, liquid
    from leak.fluids.library import FLUIDS, GASES
    from leak.fluids.pressure_law import (
        Barus,
        FlowPotential,
        PressureLaw,
        PressureTable,
        Roelands,
        Tait,
        effective_viscosity_ratio,
    )
    from leak.fluids.properties import Gas, Liquid
    from leak.fluids.real_gas import GasPotential, RealGas, real_gas_flow_ratio
    from leak.standards import (
        LeakageClass,
        LeakageLimit,
        bubbles_per_minute,
        drops_per_minute,
        leakage_class,
        leakage_limits,
        millibar_litres_per_second,
        millilitres_per_minute,
        nominal_size_of_bore,
    )
    from leak.surfaces.finish import Finish, FinishedSurface, Process, process_named
    from leak.surfaces.line_spectrum import profile_density
    from leak.surfaces.measured import MeasuredSurface, measure
    from leak.surfaces.profile_filter import (
        ExpectedRoughness,
        ProfileFilter,
        expected_roughness,
        implied_filter,
    )
    from leak.surfaces.profile_parameters import RoughnessParameters, roughness_parameters
    from leak.surfaces.random import random_line_scan, random_map
    from leak.surfaces.scan_files import read_topographies, read_topography
    from leak.surfaces.scans import HeightMap, LineScan, height_map, line_scan
    from leak.surfaces.settings import ScanSettings, SelfAffineContinuation
    from leak.surfaces.spectrum import PowerSpectrum
    from leak.surfaces.stretched import StretchedRoughness, stretched_roughness, stretched_spectrum
    from leak.theory.interface_law import ExponentialLaw, RoughSurfaceLaw, TabulatedLaw
    from leak.theory.line_contact import (
        CrossoverLine,
        GaussianLine,
        HertzLine,
        LineProfile,
        crossover_line,
        crossover_widths,
        gaussian_line,
        hertz_line,
    )
    from leak.theory.own_error import FlowError, flow_error
    from leak.theory.persson import relative_contact_area
    from leak.theory.plasticity import AreaFractions, area_fractions, remaining_fraction

# The public names of each module; loaded on first use, so that a program loads only what it calls.
_NAMES = {
    "leak.errors": (
        "ConductivityError",
        "DirectError",
        "FluidError",
        "LawError",
        "LeakError",
        "ProfileError",
        "ScanError",
        "SpectrumError",
        "SurfaceError",
    ),
    "leak.flow.around": (
        "AroundFlow",
        "AroundGasFlow",
        "around_flow",
        "gas_around_flow",
        "rarefied_conductivity",
    ),
    "leak.flow.conductivity": (
        "Conductivity",
        "ConductivityTable",
        "GasConductivity",
        "GasConductivityTable",
        "RemembersLoad",
    ),
    "leak.flow.fluid_in_gap": ("CoupledLeakResult", "coupled_leak_flow"),
    "leak.flow.gas_flow": ("GasLeakResult", "gas_leak_flow"),
    "leak.flow.groove_section": ("EllipticGroove", "GrooveSection", "SinusoidalGroove"),
    "leak.flow.inertia": ("GasInertia", "gas_inertia"),
    "leak.flow.leak_rate": ("LeakResult", "leak_flow", "leak_rate"),
    "leak.flow.medium": ("DirectionalGap", "anisotropic_medium", "dimension_number", "effective_medium"),
    "leak.flow.memory": ("LoadMemory",),
    "leak.flow.nearby": ("NearbyTables",),
    "leak.flow.particles": (
        "Clogging",
        "GapDistribution",
        "Paths",
        "ShutConductivityTable",
        "cloggings",
        "parallel_paths",
        "shut_conductivity",
        "stopped",
        "throttling_length",
    ),
    "leak.flow.rough_contact": ("RoughContact", "gas_conductivity_table"),
    "leak.flow.scratch": (
        "Groove",
        "LeakBounds",
        "Scratch",
        "SpiralLay",
        "deepest_scratch",
        "gas_scratch_flow",
        "scratch_flow",
    ),
    "leak.fluids.contamination": ("Concentration", "ParticleCounts"),
    "leak.fluids.find": ("gas", "is_gas", "is_liquid", "liquid"),
    "leak.fluids.library": ("FLUIDS", "GASES"),
    "leak.fluids.pressure_law": (
        "Barus",
        "FlowPotential",
        "PressureLaw",
        "PressureTable",
        "Roelands",
        "Tait",
        "effective_viscosity_ratio",
    ),
    "leak.fluids.properties": ("Gas", "Liquid"),
    "leak.fluids.real_gas": ("GasPotential", "RealGas", "real_gas_flow_ratio"),
    "leak.standards": (
        "LeakageClass",
        "LeakageLimit",
        "bubbles_per_minute",
        "drops_per_minute",
        "leakage_class",
        "leakage_limits",
        "millibar_litres_per_second",
        "millilitres_per_minute",
        "nominal_size_of_bore",
    ),
    "leak.surfaces.finish": ("Finish", "FinishedSurface", "Process", "process_named"),
    "leak.surfaces.line_spectrum": ("profile_density",),
    "leak.surfaces.measured": ("MeasuredSurface", "measure"),
    "leak.surfaces.profile_filter": (
        "ExpectedRoughness",
        "ProfileFilter",
        "expected_roughness",
        "implied_filter",
    ),
    "leak.surfaces.profile_parameters": ("RoughnessParameters", "roughness_parameters"),
    "leak.surfaces.random": ("random_line_scan", "random_map"),
    "leak.surfaces.scan_files": ("read_topographies", "read_topography"),
    "leak.surfaces.scans": ("HeightMap", "LineScan", "height_map", "line_scan"),
    "leak.surfaces.settings": ("ScanSettings", "SelfAffineContinuation"),
    "leak.surfaces.spectrum": ("PowerSpectrum",),
    "leak.surfaces.stretched": ("StretchedRoughness", "stretched_roughness", "stretched_spectrum"),
    "leak.theory.interface_law": ("ExponentialLaw", "RoughSurfaceLaw", "TabulatedLaw"),
    "leak.theory.line_contact": (
        "CrossoverLine",
        "GaussianLine",
        "HertzLine",
        "LineProfile",
        "crossover_line",
        "crossover_widths",
        "gaussian_line",
        "hertz_line",
    ),
    "leak.theory.own_error": ("FlowError", "flow_error"),
    "leak.theory.persson": ("relative_contact_area",),
    "leak.theory.plasticity": ("AreaFractions", "area_fractions", "remaining_fraction"),
}
_HOME = {name: module for module, names in _NAMES.items() for name in names}

__all__ = [
    "FLUIDS",
    "GASES",
    "AreaFractions",
    "AroundFlow",
    "AroundGasFlow",
    "Barus",
    "Clogging",
    "Concentration",
    "Conductivity",
    "ConductivityError",
    "ConductivityTable",
    "CoupledLeakResult",
    "CrossoverLine",
    "DirectError",
    "DirectionalGap",
    "EllipticGroove",
    "ExpectedRoughness",
    "ExponentialLaw",
    "Finish",
    "FinishedSurface",
    "FlowError",
    "FlowPotential",
    "FluidError",
    "GapDistribution",
    "Gas",
    "GasConductivity",
    "GasConductivityTable",
    "GasInertia",
    "GasLeakResult",
    "GasPotential",
    "GaussianLine",
    "Groove",
    "GrooveSection",
    "HeightMap",
    "HertzLine",
    "LawError",
    "LeakBounds",
    "LeakError",
    "LeakResult",
    "LeakageClass",
    "LeakageLimit",
    "LineProfile",
    "LineScan",
    "Liquid",
    "LoadMemory",
    "MeasuredSurface",
    "NearbyTables",
    "ParticleCounts",
    "Paths",
    "PowerSpectrum",
    "PressureLaw",
    "PressureTable",
    "Process",
    "ProfileError",
    "ProfileFilter",
    "RealGas",
    "RemembersLoad",
    "Roelands",
    "RoughContact",
    "RoughSurfaceLaw",
    "RoughnessParameters",
    "ScanError",
    "ScanSettings",
    "Scratch",
    "SelfAffineContinuation",
    "ShutConductivityTable",
    "SinusoidalGroove",
    "SpectrumError",
    "SpiralLay",
    "StretchedRoughness",
    "SurfaceError",
    "TabulatedLaw",
    "Tait",
    "anisotropic_medium",
    "area_fractions",
    "around_flow",
    "bubbles_per_minute",
    "cloggings",
    "coupled_leak_flow",
    "crossover_line",
    "crossover_widths",
    "deepest_scratch",
    "dimension_number",
    "direct",
    "drops_per_minute",
    "effective_medium",
    "effective_viscosity_ratio",
    "expected_roughness",
    "flow_error",
    "gas",
    "gas_around_flow",
    "gas_conductivity_table",
    "gas_inertia",
    "gas_leak_flow",
    "gas_scratch_flow",
    "gaussian_line",
    "height_map",
    "hertz_line",
    "implied_filter",
    "is_gas",
    "is_liquid",
    "leak_flow",
    "leak_rate",
    "leakage_class",
    "leakage_limits",
    "line_scan",
    "liquid",
    "measure",
    "millibar_litres_per_second",
    "millilitres_per_minute",
    "nominal_size_of_bore",
    "parallel_paths",
    "process_named",
    "profile_density",
    "random_line_scan",
    "random_map",
    "rarefied_conductivity",
    "read_topographies",
    "read_topography",
    "real_gas_flow_ratio",
    "relative_contact_area",
    "remaining_fraction",
    "roughness_parameters",
    "scratch_flow",
    "shut_conductivity",
    "stopped",
    "stretched_roughness",
    "stretched_spectrum",
    "throttling_length",
]


def __getattr__(name: str) -> Any:
    if name == "direct":
        return import_module("leak.direct")
    if name not in _HOME:
        raise AttributeError(f"module 'leak' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
