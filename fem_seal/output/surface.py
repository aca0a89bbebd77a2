"""Output of `fem-seal surface`: key figures of a measured surface, its spectrum and a picture."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.files import as_json, write_bytes, write_text
from fem_seal.output.case_words import worded_rows
from fem_seal.units import Display, attributes, number, percent
from fem_seal.wording import say

if TYPE_CHECKING:
    from leak import MeasuredSurface, RoughnessParameters


def parameter_numbers(surface: MeasuredSurface) -> dict[str, Any]:
    """Ra, Rq, Rz, Rsk and Rku in SI, with their filter.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    roughness = roughness_of(surface)
    return {
        **attributes(roughness, "Ra_m", "Rq_m", "Rz_m", "Rsk", "Rku"),
        **attributes(roughness.filter, "lambda_c_m", "lambda_s_m"),
        "sections": roughness.sections,
        "evaluation_length_m": roughness.length,
        "profiles": roughness.profiles,
        "remarks": list(roughness.remarks),
    }


def roughness_of(surface: MeasuredSurface) -> RoughnessParameters:
    """Roughness parameters of the scans, without their form.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    from leak import roughness_parameters

    return roughness_parameters(surface.scans)


def surface_numbers(surface: MeasuredSurface) -> dict[str, Any]:
    """Key figures of a measured surface in SI, as `surface --json` prints them.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    return {
        "rms_height_m": surface.rms_height,
        "rms_slope": surface.measured.rms_slope,
        **attributes(surface, "skewness", "kurtosis", "anisotropy", "lay_angle_rad"),
        "peklenik_flow_across_lay": surface.peklenik and surface.peklenik[0],
        "peklenik_flow_along_lay": surface.peklenik and surface.peklenik[1],
        "rolloff_wavenumber_per_m": surface.rolloff.wavenumber,
        **attributes(surface.rolloff, "hurst", "hurst_error", "hurst_interval", "confidence"),
        "true_rms_height_interval_m": [
            surface.rms_height * factor for factor in surface.rolloff.height.interval
        ],
        "roughness_parameters": parameter_numbers(surface),
        "q_low_per_m": surface.q_low,
        "q_high_per_m": surface.q_high,
        "range_limited_by": surface.limit,
        "tip_radius_m": surface.tip_radius,
        "variance_above_range": surface.height_above,
        "spectrum_rms_height_m": surface.spectrum.rms_height,
        "spectrum_rms_slope": surface.spectrum.rms_slope,
        **attributes(surface.settings, "detrend", "window", "outliers"),
        "scans": [
            {
                "file": scan.name,
                "points": list(scan.heights.shape),
                "length_m": scan.length,
                "rms_height_m": rms_height,
            }
            for scan, rms_height in zip(surface.scans, surface.scan_rms_heights, strict=True)
        ],
        "warnings": list(surface.warnings),
    }


def surface_lines(display: Display, surface: MeasuredSurface) -> list[tuple[str, str]]:
    """Key figures of a measured surface in words: name and value."""
    points = [" x ".join(map(str, scan.heights.shape)) for scan in surface.scans]
    roughness, rolloff = roughness_of(surface), surface.rolloff
    values: dict[str, Any] = {
        "surface": surface,
        "rms_height": _with_scatter(display, surface),
        "interval": tuple(surface.rms_height * factor for factor in rolloff.height.interval),
        "roughness": roughness,
        "of_profiles": "" if roughness.profiles == 1 else f", mean of {roughness.profiles} profiles",
        "short": display.quantity(roughness.filter.lambda_s, "given length")
        if roughness.filter.lambda_s
        else "none",
        "sections": "the whole scan" if roughness.sections == 0 else f"{roughness.sections} sections",
    }
    lay = surface.anisotropy is not None and surface.lay_angle is not None and surface.peklenik is not None
    has_row = {
        "anisotropy": lay,
        "key peklenik": lay,
        "tip radius": surface.tip_radius is not None,
        "continued spectrum": surface.spectrum != surface.measured,
    }
    scans = zip(surface.scans, points, strict=True)
    return [
        *((scan.name, f"{n} points over {display.quantity(scan.length, 'length')}") for scan, n in scans),
        *worded_rows(display, "surface", **values),
        *(("  note", text) for text in roughness.remarks),
        *worded_rows(
            display,
            "surface_spectrum",
            without=[name for name, there in has_row.items() if not there],
            lay_angle=None if surface.lay_angle is None else math.degrees(surface.lay_angle),
            rolloff=_rolloff(display, surface),
            hurst=_hurst(display, surface),
            wavelengths=tuple(2 * math.pi / q for q in (surface.q_high, surface.q_low)),
            **values,
        ),
    ]


def _with_scatter(display: Display, surface: MeasuredSurface) -> str:
    text = display.quantity(surface.rms_height, "length")
    if len(surface.scans) > 1:
        low, high = min(surface.scan_rms_heights), max(surface.scan_rms_heights)
        text += f" (scans: {display.quantity(low, 'length')} to {display.quantity(high, 'length')})"
    if surface.height_above > 1e-3:
        text += f", {percent(surface.height_above)} of the variance above the reliable range"
    return text


def _rolloff(display: Display, surface: MeasuredSurface) -> str:
    q = surface.rolloff.wavenumber
    if q is None:
        return "none in the reliable range"
    return f"q = {number(q)} 1/m, wavelength {display.quantity(2 * math.pi / q, 'length')}"


def _hurst(display: Display, surface: MeasuredSurface) -> str:
    fit = surface.rolloff
    if fit.hurst is None or fit.hurst_interval is None:
        return "not determined: no part of the spectrum is long and clear enough"
    text = say(display, "surface", "hurst_fit", fit=fit)
    return text if 0.0 < fit.hurst <= 1.0 else f"{text}; outside 0 to 1: not self-affine"


def write_surface(surface: MeasuredSurface, folder: Path) -> tuple[Path, ...]:
    """Write spectrum.csv, surface.json and surface.svg into a folder.

    spectrum.csv has the columns q [1/m] and C [m^4] and goes into a case as ``kind = "table"``.

    Parameters
    ----------
    surface : MeasuredSurface
    folder : pathlib.Path

    Raises
    ------
    OutputError
        If a file cannot be written.
    """
    from fem_seal.output.pictures.style import style
    from fem_seal.output.pictures.surface import scan_picture

    spectrum = surface.spectrum
    rows = [
        f"{q!r},{C!r}" for q, C in zip(spectrum.wavenumber.tolist(), spectrum.density.tolist(), strict=True)
    ]
    with style():
        picture = scan_picture(Display(), surface)
    return (
        write_text(folder / "spectrum.csv", "\n".join(["q [1/m],C [m^4]", *rows]) + "\n"),
        write_text(folder / "surface.json", as_json(surface_numbers(surface)) + "\n"),
        write_bytes(folder / "surface.svg", picture.svg),
    )
