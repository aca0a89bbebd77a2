"""Cases of a gasket between two flanges that are alike or not."""

from __future__ import annotations

from typing import Any

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3, "hardness": "3 GPa"}
DISC = {"shape": "disc", "diameter": "60 mm", "material": STEEL}
CONE = {
    "shape": "conical-face",
    "angle": "20 deg",
    "bore_diameter": "34 mm",
    "face_diameter": "48 mm",
    "material": {**STEEL, "youngs_modulus": "190 GPa"},
}


def surface(rms_height: str) -> dict[str, Any]:
    return {
        "kind": "self-affine",
        "rms_height": rms_height,
        "hurst": 0.8,
        "q_low": "5e3 1/m",
        "q_rolloff": "5e4 1/m",
        "q_high": "3e6 1/m",
    }


def tables(closure: dict[str, Any], rough: dict[str, Any], **others: Any) -> dict[str, Any]:
    return {
        "closure": closure,
        "gasket": {"shape": "ring", "mean_diameter": "40 mm", "section_diameter": "4 mm", "material": STEEL},
        "roughness": rough,
        "fluid": {"name": "helium"},
        "load": {"fluid_pressure": "1 bar", "applied_force": "3 kN", "pressure_side": "inner"},
        "uncertainty": {"samples": 64, "hardness": {"relative": 0.1}},
        "requirement": {"leak_rate": "1 mbar l/s"},
        "mesh": {"contact_size": "12 um"},
        **others,
    }


FINE, COARSE = {"closure": surface("0.4 um")}, {"closure": surface("1.2 um")}
BOTH = {"closure": FINE["closure"], "seat": COARSE["closure"]}
