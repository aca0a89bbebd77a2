"""Case tables of every family of shapes, and pairs of a closure and a seat."""

from __future__ import annotations

from fem_seal.case import shapes
from fem_seal.case.shapes import Body

STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
CLOSURES = {
    "ball": {"radius": "20 mm", "cavity_radius": "12 mm"},
    "cone": {"angle": "45 deg", "outer_radius": "18 mm"},
    "torus": {"centre_radius": "14 mm", "radius": "3 mm"},
    "spherical-tip": {"radius": "30 mm", "stem_radius": "22 mm"},
    "disc": {"radius": "16 mm"},
    "profile": {
        "outline": [
            {"to": ["0 mm", "0 mm"]},
            {"to": ["12 mm", "0 mm"]},
            {"to": ["17 mm", "5 mm"], "centre": ["12 mm", "5 mm"]},
            {"to": ["17 mm", "25 mm"]},
            {"to": ["0 mm", "25 mm"]},
            {"to": ["0 mm", "0 mm"]},
        ]
    },
}
SEATS = {
    "cone": {"angle": "45 deg"},
    "conical-land": {"angle": "45 deg", "land_width": "1 mm"},
    "sphere": {"radius": "26 mm", "contact_angle": "40 deg"},
    "torus": {"centre_radius": "13 mm", "radius": "4 mm"},
    "flat": {"bore_radius": "8 mm"},
    "flat-land": {"land_inner_diameter": "26 mm", "land_outer_diameter": "30 mm"},
    "lands": {
        "lands": [
            {"shape": "conical-land", "angle": "35 deg", "land_width": "1 mm"},
            {"shape": "conical-land", "angle": "50 deg", "land_width": "1 mm"},
        ]
    },
    "sharp-edge": {"bore_radius": "10 mm", "edge_radius": "0.5 mm"},
    "profile": {
        "outline": [
            {"to": ["9 mm", "-20 mm"]},
            {"to": ["40 mm", "-20 mm"]},
            {"to": ["40 mm", "12 mm"]},
            {"to": ["21 mm", "12 mm"]},
            {"to": ["9 mm", "0 mm"], "radius": "-60 mm"},
            {"to": ["9 mm", "-20 mm"]},
        ]
    },
}
# Every closure and every seat at least once, with a stretch of contact and a seat whose wall is pressed in.
PAIRS = [
    ("ball", "sphere"),
    ("ball", "sharp-edge"),
    ("ball", "lands"),
    ("cone", "conical-land"),
    ("torus", "flat"),
    ("spherical-tip", "torus"),
    ("disc", "cone"),
    ("disc", "flat-land"),
    ("profile", "cone"),
    ("ball", "profile"),
]


SHAPES = [*shapes.CLOSURES, *shapes.SEATS]


def dimensions_of(table: type[Body]) -> set[str]:
    return set(table.model_fields) - {"shape", "material", "wall", "base", "interference"}


def tables(closure: str, seat: str, **entries: object) -> dict[str, object]:
    return {
        "closure": {"shape": closure, **CLOSURES[closure], "material": STEEL},
        "seat": {"shape": seat, **SEATS[seat], "material": STEEL},
        "interface": {"law": "exponential", "u0": "2 um", "p_c": "1 GPa"},
        "load": {"fluid_pressure": "20 bar"},
        **entries,
    }
