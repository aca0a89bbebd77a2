"""Solid metal gaskets: the upper half of a section that is its own mirror image about the mid-plane, z = 0.

Their faces touch the flange above; the flange below is the mirror image of that. The half is the "seat" of a contact:
its bottom, the mid-plane, does not move along the axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from meshes.geometry.curve import Curve, Point, Segment
from meshes.geometry.outline import Outline, chain
from meshes.shapes.shape import (
    NamedFace,
    check_angle,
    check_exceeds,
    check_length,
    check_not_negative,
    check_positive,
    round_part,
    straight_part,
)

# Of ring joints and their grooves to the horizontal plane [rad].
FLANK_ANGLE = math.radians(67.0)


def half_section(face: Curve) -> Outline:
    """Half of a gasket: its upper surface, upright sides below the ends of it, and the mid-plane z = 0.

    Parameters
    ----------
    face : Curve
        From its inner end outwards, segments named "seat_face"; both ends at or above z = 0 [m].

    Examples
    --------
    >>> import meshes
    >>> face = meshes.chain([(0.010, 1e-3), (0.012, 1e-3)], "seat_face")
    >>> print(f"{half_section(face).area * 1e6:.0f} mm^2")
    2 mm^2
    """
    start, end = face.segments[0].start, face.segments[-1].end
    corners: list[tuple[Point, str]] = [
        (start, "seat_inner"),
        ((start[0], 0.0), "seat_bottom"),
        ((end[0], 0.0), "seat_outer"),
        (end, ""),
    ]
    sides = tuple(Segment(a, b, name) for (a, name), (b, _) in pairwise(corners) if a != b)
    return Outline("seat", (*face.reversed.segments, *sides))


@dataclass(frozen=True)
class SolidRing:
    """Solid ring of round section.

    Between flat flanges it touches at its mean diameter, with R_rel = section_radius.

    Parameters
    ----------
    mean_radius : float
        Distance of the centre of the section from the axis [m].
    section_radius : float
        Of the section [m].

    Examples
    --------
    >>> import meshes
    >>> print(f"{meshes.SolidRing(0.02, 2e-3).outline.area * 1e6:.2f} mm^2 of half a section")
    6.28 mm^2 of half a section
    """

    mean_radius: float
    section_radius: float

    def __post_init__(self) -> None:
        check_positive("gasket", mean_radius=self.mean_radius, section_radius=self.section_radius)
        fits, must = self.section_radius < self.mean_radius, "must be below mean_radius = {}"
        check_length("gasket", "section_radius", self.section_radius, fits, must, self.mean_radius)

    @property
    def outline(self) -> Outline:
        """The upper half of the section."""
        r, a = self.mean_radius, self.section_radius
        inner, top, outer = (r - a, 0.0), (r, a), (r + a, 0.0)
        centre = (r, 0.0)
        arcs = (Segment(inner, top, "seat_face", centre), Segment(top, outer, "seat_face", centre))
        return half_section(Curve(arcs))


@dataclass(frozen=True)
class LensRing:
    """Lens ring: spherical faces, thickest at the bore, in conical flanges, as in DIN 2696.

    On a conical flange face inclined by beta to the horizontal plane it touches at
    r0 = spherical_radius sin(beta), with R_rel = spherical_radius.

    Parameters
    ----------
    spherical_radius : float
        Of both faces [m].
    inner_radius, outer_radius : float
        Of bore and rim [m].
    rim_height : float
        Height of the cylindrical rim, from face to face [m].

    Examples
    --------
    >>> import meshes
    >>> lens = meshes.LensRing(0.06, 0.014, 0.025, 8e-3)
    >>> print(f"{2 * lens.outline.extent[1][1] * 1e3:.1f} mm thick at the bore")
    15.6 mm thick at the bore
    """

    spherical_radius: float
    inner_radius: float
    outer_radius: float
    rim_height: float

    def __post_init__(self) -> None:
        check_positive("gasket", inner_radius=self.inner_radius, rim_height=self.rim_height)
        check_exceeds("gasket", "outer_radius", self.outer_radius, self.inner_radius, "inner_radius =")
        check_exceeds(
            "gasket", "spherical_radius", self.spherical_radius, self.outer_radius, "outer_radius ="
        )

    @property
    def outline(self) -> Outline:
        """The upper half of the section."""
        R, inner, outer = self.spherical_radius, self.inner_radius, self.outer_radius
        level = 0.5 * self.rim_height - math.sqrt(R**2 - outer**2)
        ends = [(r, level + math.sqrt(R**2 - r**2)) for r in (inner, outer)]
        return half_section(Curve((Segment(ends[0], ends[1], "seat_face", (0.0, level)),)))


@dataclass(frozen=True)
class DeltaRing:
    """Delta ring: an isosceles triangle whose base looks inwards, its upper and lower edge rounded.

    The edges are the first to touch, at the bottom of the grooves of both flanges or on flat faces, with R_rel =
    edge_radius there; pressure on the base widens the ring.

    Parameters
    ----------
    inner_radius : float
        Of the base of the triangle [m].
    height : float
        Length of the base, from edge to edge before rounding [m].
    angle : float
        Inclination of both flanks to the horizontal plane [rad].
    edge_radius : float
        Of the rounding of both edges [m].

    References
    ----------
    Delta-Dichtungen, technik-kommt-an.de (isosceles wedge, base on the side of the pressure, higher than both grooves);
    SPETORING R delta seal, spetech.com.pl (line contact at the bottoms of the grooves, then on their flanks).

    Examples
    --------
    >>> import math, meshes
    >>> ring = meshes.DeltaRing(0.05, 0.01, math.radians(60), 5e-4)
    >>> print(f"{ring.outline.area * 1e6:.2f} mm^2 of half a section")
    6.61 mm^2 of half a section
    """

    inner_radius: float
    height: float
    angle: float
    edge_radius: float

    def __post_init__(self) -> None:
        check_positive(
            "gasket", inner_radius=self.inner_radius, height=self.height, edge_radius=self.edge_radius
        )
        check_angle("gasket", "angle", self.angle)

    @property
    def outline(self) -> Outline:
        """The upper half of the section."""
        inner, half = self.inner_radius, 0.5 * self.height
        apex = (inner + half / math.tan(self.angle), 0.0)
        face = chain([(inner, 0.0), (inner, half), apex], "seat_face", self.edge_radius)
        # the base is no face: it stands upright, where nothing is above it
        return half_section(face.without_first())

    @property
    def named_face(self) -> NamedFace:
        """The rounded edge."""
        return round_part("rounded edge", self.outline, self.edge_radius)


@dataclass(frozen=True)
class DoubleConeRing:
    """Double-cone ring: conical faces at the outer side, between flat ends and a cylindrical rim, edges rounded.

    A conical flange face of the same angle fits it: they touch first in the middle, with R_rel = inf.

    Parameters
    ----------
    inner_radius, outer_radius : float
        Of bore and rim [m].
    height : float
        From end to end [m].
    rim_height : float
        Height of the cylindrical rim between the cones [m].
    angle : float
        Inclination of the cones to the horizontal plane [rad], usually 60 deg.
    edge_radius : float
        Of the rounding of the edges of the cones [m].

    Examples
    --------
    >>> import math, meshes
    >>> ring = meshes.DoubleConeRing(0.2, 0.23, 0.06, 0.028, math.radians(60), 1e-3)
    >>> print(f"cones from r = {ring.end_radius * 1e3:.1f} mm to 230 mm")
    cones from r = 220.8 mm to 230 mm
    """

    inner_radius: float
    outer_radius: float
    height: float
    rim_height: float
    angle: float
    edge_radius: float

    def __post_init__(self) -> None:
        check_positive("gasket", inner_radius=self.inner_radius, rim_height=self.rim_height)
        check_angle("gasket", "angle", self.angle)
        check_not_negative("gasket", "edge_radius", self.edge_radius)
        check_exceeds("gasket", "height", self.height, self.rim_height, "rim_height =")
        check_exceeds("gasket", "outer_radius", self.outer_radius, self.inner_radius, "inner_radius =")
        must = "the cones would reach the bore; make the rim_height larger or the ring wider"
        check_length("gasket", "height", self.height, self.end_radius > self.inner_radius, must)

    @property
    def end_radius(self) -> float:
        """Radius at which a cone begins, at the flat end [m]."""
        return self.outer_radius - 0.5 * (self.height - self.rim_height) / math.tan(self.angle)

    @property
    def outline(self) -> Outline:
        """The upper half of the section."""
        top, rim = 0.5 * self.height, 0.5 * self.rim_height
        corners = [(self.inner_radius, top), (self.end_radius, top), (self.outer_radius, rim)]
        return half_section(
            chain([*corners, (self.outer_radius, 0.0)], "seat_face", self.edge_radius).without_last()
        )

    @property
    def named_face(self) -> NamedFace:
        """The cone between its rounded edges."""
        return straight_part("conical face", self.outline, -self.angle)


@dataclass(frozen=True)
class OctagonalRing:
    """Octagonal ring joint, as ASME B16.20 has it: four conical flanks, for a groove with the same flanks.

    In a groove of the same angle both flanks of a half touch, each in its middle, with R_rel = inf.

    Parameters
    ----------
    mean_radius : float
        Of the middle of the ring, half the pitch diameter [m].
    width, height : float
        Of the section, from side to side and from flat to flat [m].
    flat_width : float
        Of the flats at both ends [m].
    angle : float
        Inclination of the flanks to the horizontal plane [rad]: 67 deg, 23 deg to the axis.
    edge_radius : float
        Of the rounding at both ends of every flank [m].

    References
    ----------
    ASME B16.20, ring joint gaskets type R, octagonal (dimensions P, A, H, C, R1), as printed in lists of manufacturers.

    Examples
    --------
    >>> import meshes
    >>> ring = meshes.OctagonalRing(0.047625, 11.13e-3, 16e-3, 7.75e-3, edge_radius=1.5e-3)
    >>> print(f"sides {ring.side_height * 1e3:.1f} mm high, {2 * ring.outline.area * 1e6:.0f} mm^2 of section")
    sides 8.0 mm high, 164 mm^2 of section
    """

    mean_radius: float
    width: float
    height: float
    flat_width: float
    angle: float = FLANK_ANGLE
    edge_radius: float = 0.0

    def __post_init__(self) -> None:
        check_positive("gasket", flat_width=self.flat_width, height=self.height)
        check_angle("gasket", "angle", self.angle)
        check_not_negative("gasket", "edge_radius", self.edge_radius)
        check_exceeds("gasket", "width", self.width, self.flat_width, "flat_width =")
        check_exceeds("gasket", "mean_radius", self.mean_radius, 0.5 * self.width, "half the width,")
        must = "the flanks would meet; make it larger, or flat_width"
        check_length("gasket", "height", self.height, self.side_height > 0, must)

    @property
    def side_height(self) -> float:
        """Of the cylindrical sides between the flanks [m]."""
        return self.height - (self.width - self.flat_width) * math.tan(self.angle)

    @property
    def outline(self) -> Outline:
        """The upper half of the section."""
        top, side = 0.5 * self.height, 0.5 * self.side_height
        r, a, c = self.mean_radius, 0.5 * self.width, 0.5 * self.flat_width
        corners = [(r - a, 0.0), (r - a, side), (r - c, top), (r + c, top), (r + a, side), (r + a, 0.0)]
        return half_section(chain(corners, "seat_face", self.edge_radius).without_first().without_last())

    @property
    def named_face(self) -> NamedFace:
        """The inner flank between its rounded edges."""
        return straight_part("flank", self.outline, self.angle)
