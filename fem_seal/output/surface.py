"""Output of `fem-seal surface`: key figures of a measured surface, its spectrum and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem_seal.files import as_json, worded_rows, write_bytes, write_text
from fem_seal.units import Display, attributes

if TYPE_CHECKING:
    from leak import MeasuredSurface, RoughnessParameters, TurnedScan


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


def turned_scan(surface: MeasuredSurface) -> TurnedScan | None:
    """The turned face that most of the scans show; None where they do not.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    from leak import recognise_texture

    return recognise_texture(surface.scans, surface.settings)


def _turned_numbers(turned: TurnedScan) -> dict[str, Any]:
    lengths = ("feed_m", "feed_error_m", "nose_radius_m", "crest_height_m", "crest_scatter_m")
    return {
        **attributes(turned, *lengths, "side_slope", "parabola_deviation", "periodic_share"),
        "fine_rms_height_m": turned.fine.rms_height,
        "fine_hurst": turned.rolloff.hurst,
        "fine_rolloff_wavenumber_per_m": turned.rolloff.wavenumber,
    }


def surface_numbers(surface: MeasuredSurface) -> dict[str, Any]:
    """Key figures of a measured surface in SI, as `surface --json` prints them.

    Parameters
    ----------
    surface : MeasuredSurface
    """
    turned = turned_scan(surface)
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
        "turned": turned and _turned_numbers(turned),
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
    roughness = roughness_of(surface)
    values: dict[str, Any] = {
        "surface": surface,
        "interval": tuple(surface.rms_height * factor for factor in surface.rolloff.height.interval),
        "roughness": roughness,
    }
    turned = turned_scan(surface)
    lay = surface.anisotropy is not None and surface.lay_angle is not None and surface.peklenik is not None
    return [
        *(row for scan in surface.scans for row in worded_rows(display, "scan", scan=scan)),
        *worded_rows(display, "surface", **values),
        *(("  note", text) for text in roughness.remarks),
        *worded_rows(display, "surface_spectrum", lay=lay, **values),
        *(worded_rows(display, "surface_turned", turned=turned) if turned else ()),
    ]


def write_surface(surface: MeasuredSurface, folder: Path) -> tuple[Path, ...]:
    """Write spectrum.csv, surface.json and surface.svg into a folder, and turned.svg of a turned face.

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
    from fem_seal.output.pictures.surface import scan_picture, turned_picture

    spectrum = surface.spectrum
    rows = [
        f"{q!r},{C!r}" for q, C in zip(spectrum.wavenumber.tolist(), spectrum.density.tolist(), strict=True)
    ]
    with style():
        pictures = {"surface": scan_picture(Display(), surface)}
        if turned := turned_scan(surface):
            pictures["turned"] = turned_picture(Display(), turned)
    return (
        write_text(folder / "spectrum.csv", "\n".join(["q [1/m],C [m^4]", *rows]) + "\n"),
        write_text(folder / "surface.json", as_json(surface_numbers(surface)) + "\n"),
        *(write_bytes(folder / f"{name}.svg", picture.svg) for name, picture in pictures.items()),
    )
