"""The theory beside direct numerical results: rough contact by boundary elements, Reynolds flow through its gap.

The surfaces are periodic, so the comparison is dimensionless: box length 1, E* = 1, rms slope 1.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import leak

FloatArray = NDArray[np.float64]

FILE = "direct_numerical.csv"


@dataclass(frozen=True)
class DirectSet:
    """Averages over surfaces of one spectrum; each array has one value per pressure.

    Parameters
    ----------
    name : str
    spectrum : leak.PowerSpectrum
        Box length 1, rms slope 1.
    surfaces : int
    pressure : ndarray
        p/(E* h'), h' the rms slope.
    area : ndarray
        A/A0 on the grid as it is.
    area_corrected : ndarray
        A/A0 with the grid's effect on the contact perimeter removed.
    gap : ndarray
        Mean gap over rms height.
    conductivity : ndarray
        12 eta sigma_eff over rms height cubed, geometric mean over the samples.
    scatter : ndarray
        Standard deviation of ln sigma_eff between samples.
    """

    name: str
    spectrum: leak.PowerSpectrum
    surfaces: int
    pressure: FloatArray
    area: FloatArray
    area_corrected: FloatArray
    gap: FloatArray
    conductivity: FloatArray
    scatter: FloatArray


def periodic_spectrum(rolloff: float, cutoff: float, hurst: float) -> leak.PowerSpectrum:
    """Spectrum of a periodic surface with roll-off and cutoff in waves per box; box length 1, rms slope 1.

    The waves that fit the box stand on a square lattice of wavenumbers 2 pi n. Each owns one cell of it, and all
    cells but that of n = 0 fill the plane outside a circle of radius 2 pi/sqrt(pi): there the isotropic spectrum
    begins. Its rms height agrees with the sum over the lattice to 1e-3; beginning at 2 pi would miss 1 %.
    """
    unit = leak.PowerSpectrum.self_affine(
        rms_height=1.0,
        hurst=hurst,
        q_low=2 * math.sqrt(math.pi),
        q_rolloff=2 * math.pi * rolloff,
        q_high=2 * math.pi * cutoff,
    )
    return leak.PowerSpectrum(unit.wavenumber, unit.density / unit.rms_slope**2)


def read_direct(folder: Path) -> list[DirectSet]:
    """The direct numerical results in a folder, one set per spectrum and grid."""
    with (folder / FILE).open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    names = list(dict.fromkeys(row["surface_set"] for row in rows))
    return [_set([row for row in rows if row["surface_set"] == name]) for name in names]


def _set(rows: Sequence[dict[str, str]]) -> DirectSet:
    def column(name: str) -> FloatArray:
        return np.array([float(row[name]) for row in rows])

    first = rows[0]
    spectrum = periodic_spectrum(
        float(first["rolloff_wavelengths_per_box"]),
        float(first["cutoff_wavelengths_per_box"]),
        float(first["hurst"]),
    )
    return DirectSet(
        first["surface_set"],
        spectrum,
        int(first["surfaces"]),
        column("pressure_over_modulus_and_rms_slope"),
        column("contact_area"),
        column("contact_area_perimeter_corrected"),
        column("mean_gap_over_rms_height"),
        column("conductivity_geometric_mean"),
        column("ln_conductivity_spread"),
    )


@dataclass(frozen=True)
class Variant:
    """One reading of the theory."""

    name: str
    surface: leak.RoughContact
    method: str = "bruggeman"

    def conductivity(self, pressure: FloatArray) -> FloatArray:
        """12 eta sigma_eff over rms height cubed."""
        u = np.asarray(self.surface.effective_separation(pressure, self.method))
        return (u / self.surface.spectrum.rms_height) ** 3


def variants(spectrum: leak.PowerSpectrum) -> list[Variant]:
    """The theory as used by default, first, and its other readings."""
    surface = leak.RoughContact(spectrum, effective_modulus=1.0)
    return [
        Variant("effective P(u), threshold 0.42", surface),
        Variant("plain P(u), 0.42", replace(surface, separation_width="plain")),
        Variant("effective P(u), 0.5", replace(surface, percolation_threshold=0.5)),
        Variant("plain P(u), 0.5", replace(surface, separation_width="plain", percolation_threshold=0.5)),
        Variant("critical junction, 0.42", surface, "critical-junction"),
        Variant("effective P(u), 0.42, gamma = 1", replace(surface, gamma=1.0)),
    ]


@dataclass(frozen=True)
class Comparison:
    """Theory over direct result, one value per pressure."""

    direct: DirectSet
    area: FloatArray
    gap: FloatArray
    conductivity: dict[str, FloatArray]

    @property
    def default(self) -> FloatArray:
        """Conductivity of the theory as used by default, over the direct one."""
        return next(iter(self.conductivity.values()))


def compare(direct: DirectSet) -> Comparison:
    """Area, mean gap and conductivity of the theory over the direct results."""
    surface = leak.RoughContact(direct.spectrum, effective_modulus=1.0)
    p = direct.pressure
    return Comparison(
        direct,
        np.asarray(surface.contact_area(p)) / direct.area_corrected,
        np.asarray(surface.mean_separation(p)) / surface.spectrum.rms_height / direct.gap,
        {
            variant.name: variant.conductivity(p) / direct.conductivity
            for variant in variants(direct.spectrum)
        },
    )


LOW_LOADS = "gap_direct.csv"


def low_loads(folder: Path) -> dict[float, FloatArray]:
    """Conductivity of the theory over direct results of other spectra at low loads, by p/(E* h').

    Parameters
    ----------
    folder : Path
        With `LOW_LOADS`.

    Returns
    -------
    dict
        From pressure to the ratios of the spectra.
    """
    with (folder / LOW_LOADS).open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["conductivity_over_hrms3"]]
    found: dict[float, list[float]] = {}
    for row in rows:
        hurst, rolloff, cutoff, pressure, direct = (
            float(row[name])
            for name in (
                "hurst",
                "rolloff_waves",
                "cutoff_over_rolloff",
                "p_over_Eh",
                "conductivity_over_hrms3",
            )
        )
        default = variants(periodic_spectrum(rolloff, rolloff * cutoff, hurst))[0]
        ratio = float(default.conductivity(np.array([pressure]))[0]) / direct
        found.setdefault(pressure, []).append(ratio)
    return {pressure: np.array(ratios) for pressure, ratios in found.items()}


def worst_factor(ratios: FloatArray) -> float:
    """Largest factor, up or down, by which ratios differ from one."""
    return float(np.exp(np.abs(np.log(ratios)).max())) if ratios.size else 1.0


def picture(sets: Sequence[DirectSet], path: Path) -> Path:
    """Draw A, mean gap and conductivity over pressure, theory as lines and direct results as marks."""
    import matplotlib
    from matplotlib.figure import Figure

    colours = ("#1f5a99", "#1f5a99", "#c8641a")
    style = {"font.size": 9, "svg.hashsalt": "direct", "axes.spines.top": False, "axes.spines.right": False}
    with matplotlib.rc_context(style):
        figure = Figure(figsize=(9.6, 3.6), layout="constrained")
        areas, gaps, flows = figure.subplots(1, 3)
        # one spectrum on two grids has one theory: drawn once
        drawn: list[leak.PowerSpectrum] = []
        for direct, colour, mark in zip(sets, colours, ("x", "o", "s"), strict=False):
            label = f"set {direct.name}"
            areas.plot(direct.pressure, direct.area_corrected, mark, color=colour, ms=4.5, label=label)
            gaps.plot(direct.pressure, direct.gap, mark, color=colour, ms=4.5)
            flows.errorbar(
                direct.area,
                direct.conductivity,
                [
                    direct.conductivity * -np.expm1(-direct.scatter),
                    direct.conductivity * np.expm1(direct.scatter),
                ],
                fmt=mark,
                color=colour,
                ms=4.5,
                elinewidth=0.8,
            )
            if direct.spectrum in drawn:
                continue
            drawn.append(direct.spectrum)
            surface = leak.RoughContact(direct.spectrum, effective_modulus=1.0)
            p = np.geomspace(0.008, 0.21, 60)
            areas.plot(p, surface.contact_area(p), color=colour, linewidth=1.3)
            gaps.plot(
                p,
                np.asarray(surface.mean_separation(p)) / direct.spectrum.rms_height,
                color=colour,
                linewidth=1.3,
            )
            at = direct.pressure
            for variant, line in zip(variants(direct.spectrum), ("-", ":", "--", "", "-.", ""), strict=True):
                if line:
                    flows.plot(direct.area, variant.conductivity(at), line, color=colour, linewidth=1.3)
        areas.set(xlabel="p / (E* h')", ylabel="A / A0", title="Contact area")
        gaps.set(xlabel="p / (E* h')", ylabel="mean gap / rms height", title="Mean gap")
        flows.set(
            xlabel="direct A / A0",
            ylabel="12 η σ_eff / (rms height)³",
            title="Flow conductivity",
            yscale="log",
            ylim=(1e-8, 10),
        )
        areas.legend(frameon=False, loc="upper left")
        keys = (
            ("-", "effective P(u), 0.42 (default)"),
            (":", "plain P(u), 0.42"),
            ("--", "threshold 0.5"),
            ("-.", "critical junction"),
        )
        lines = [
            flows.plot([], [], style, color="#444", linewidth=1.3, label=name)[0] for style, name in keys
        ]
        flows.legend(handles=lines, frameon=False, loc="lower left", fontsize=8)
        path.parent.mkdir(exist_ok=True)
        figure.savefig(path, metadata={"Date": None, "Creator": None})
    return path
