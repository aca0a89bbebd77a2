"""What a finish on a drawing was taken for: its spectrum, the filter of its value, and the ranges it leaves open."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from fem_seal.units import given, number, quantity, trimmed

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.case.finish import FinishTable
    from leak import FinishedSurface
    from leak.surfaces.finish import Spread

_LAYS = {
    "none": "none",
    "circular": "around the axis, across the flow",
    "radial": "across the sealing face, along the flow",
    "straight": "straight across the part: all directions to the flow",
    "crossed": "crossing directions",
}


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
    rows = []
    groups: dict[FinishTable, list[str]] = {}
    for key, one in faces.items():
        groups.setdefault(one, []).append(key)
    for table, keys in groups.items():
        rows += list(_rows(table, _WHOSE.get(" and ".join(keys), keys[0])))
    return rows


_WHOSE = {"seat and closure": "each face", "spectrum": "both faces together"}


def _rows(table: FinishTable, whose: str) -> Iterator[tuple[str, str]]:
    finish, face = table.finish, table.surface()
    yield f"finish of {whose}", f"{finish.process.name}, {finish.parameter} {given('length', finish.value)}"
    yield (
        "  measured between",
        f"λs {given('length', finish.band.lambda_s)} and λc {given('length', finish.band.lambda_c)}, across the lay",
    )
    expected = face.expected
    others = [(name, expected.value(name)) for name in ("Ra", "Rq", "Rz") if name != finish.parameter]
    yield "  expected with it", ", ".join(f"{name} {quantity('length', value)}" for name, value in others)
    yield (
        "  whole spectrum",
        f"rms height {quantity('length', face.spectrum.rms_height)}, rms slope {number(face.spectrum.rms_slope)}",
    )
    for name, text in _assumed(finish.spreads, face):
        yield f"  {name}", text


def _assumed(spreads: Mapping[str, Spread], face: FinishedSurface) -> Iterator[tuple[str, str]]:
    def known(name: str, text: str, shown: Any) -> str:
        if name not in spreads:
            return f"{text} (given)"
        return f"{text} (assumed; {shown(spreads[name].low)} to {shown(spreads[name].high)})"

    across = face.across
    yield "Hurst exponent", known("hurst", number(face.hurst, 2), trimmed)
    rolloff, shortest = (2.0 * math.pi / one for one in (face.q_rolloff, across.q_high))
    yield "roll-off", known("q_rolloff", quantity("length", rolloff), _length)
    yield "shortest wave", known("q_high", quantity("length", shortest), _length)
    yield "longest wave", f"{quantity('length', 2.0 * math.pi / across.q_low)} (none longer)"
    lay = _LAYS[face.lay]
    if "lay" in spreads:
        lay += f", {known('lay', trimmed(face.aspect), trimmed)} times longer along it"
    elif face.aspect > 1.0:
        lay += f", {trimmed(face.aspect)} times longer along it (given)"
    else:
        lay = "none"
    yield "lay", lay
    if "rms_height" in spreads and spreads["rms_height"].high > spreads["rms_height"].low:
        low, _, high = spreads["rms_height"]
        yield (
            "height of real surfaces",
            f"{number(low, 3)} to {number(high, 3)} times the one of Gaussian heights",
        )


def _length(value: float) -> str:
    return given("length", float(f"{value:.3g}"))
