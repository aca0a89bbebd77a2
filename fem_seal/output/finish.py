"""What a finish on a drawing was taken for: its spectrum, the filter of its value, and the ranges it leaves open."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from fem_seal.output.prose import prose, worded_rows, written
from fem_seal.units import quantity, trimmed

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.finish import FinishTable
    from leak.surfaces.finish import Spread


def finish_numbers(case: Case) -> dict[str, dict[str, Any]]:
    """Each face with a finish by its key in [roughness], SI.

    Parameters
    ----------
    case : Case
    """
    faces = {} if case.roughness is None else case.roughness.finishes
    return {key: _numbers(one) for key, one in faces.items()}


def _numbers(table: FinishTable) -> dict[str, Any]:
    finish, face = table.finish, table.surface()
    spectrum = face.across
    return {
        "process": finish.process.name,
        "parameter": finish.parameter,
        "value_m": finish.value,
        "Ra_m": face.expected.Ra,
        "Rq_m": face.expected.Rq,
        "Rz_m": face.expected.Rz,
        "lambda_c_m": finish.band.lambda_c,
        "lambda_s_m": finish.band.lambda_s,
        "rms_height_m": face.spectrum.rms_height,
        "rms_slope": face.spectrum.rms_slope,
        "hurst": face.hurst,
        "q_low_per_m": spectrum.q_low,
        "q_rolloff_per_m": face.q_rolloff,
        "q_high_per_m": spectrum.q_high,
        "lay": face.lay,
        "lay_aspect": face.aspect,
        "peklenik": face.peklenik,
        "ranges": {name: list(spread) for name, spread in finish.spreads.items()},
    }


def finish_rows(case: Case) -> list[tuple[str, str]]:
    """The same for people: name and value; faces that are alike stand there once.

    Parameters
    ----------
    case : Case
    """
    faces = {} if case.roughness is None else case.roughness.finishes
    groups: dict[FinishTable, list[str]] = {}
    for key, one in faces.items():
        groups.setdefault(one, []).append(key)
    return [
        row for table, keys in groups.items() for row in _rows(table, _WHOSE.get(" and ".join(keys), keys[0]))
    ]


_WHOSE = {"seat and closure": "each face", "spectrum": "both faces together"}


def _rows(table: FinishTable, whose: str) -> list[tuple[str, str]]:
    finish, face = table.finish, table.surface()
    spreads, height = finish.spreads, finish.spreads.get("rms_height")
    lays = prose()["lays"]
    lay = lays["none"]
    if "lay" in spreads:
        lay = f"{lays[face.lay]}, {trimmed(face.aspect)}{_known(spreads, 'lay')} times longer along it"
    elif face.aspect > 1.0:
        lay = f"{lays[face.lay]}, {trimmed(face.aspect)} times longer along it (given)"
    others = [name for name in ("Ra", "Rq", "Rz") if name != finish.parameter]
    return worded_rows(
        "finish",
        without=() if height is not None and height.high > height.low else ("  height of real surfaces",),
        whose=whose,
        finish=finish,
        face=face,
        others=", ".join(f"{name} {quantity('length', face.expected.value(name))}" for name in others),
        hurst=_known(spreads, "hurst"),
        rolloff=2.0 * math.pi / face.q_rolloff,
        of_rolloff=_known(spreads, "q_rolloff", "given length"),
        shortest=2.0 * math.pi / face.across.q_high,
        of_shortest=_known(spreads, "q_high", "given length"),
        longest=2.0 * math.pi / face.across.q_low,
        lay=lay,
        height=height,
    )


def _known(spreads: Mapping[str, Spread], name: str, how: str = "trimmed") -> str:
    """Whether a number was given, or assumed and in which range."""
    if name not in spreads:
        return " (given)"
    low, _, high = (float(f"{one:.3g}") if "length" in how else one for one in spreads[name])
    return f" (assumed; {written(low, how)} to {written(high, how)})"
