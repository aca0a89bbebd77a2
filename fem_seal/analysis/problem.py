"""From the tables of a case to what is solved: rough contact, law, bodies, element sizes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from fem_seal.bodies.held_body import Supports
from fem_seal.case.load_limits import refused_loads
from fem_seal.case.tables import curves
from fem_seal.contact.laws import HardContact, Law
from fem_seal.contact.model import ContactModel, condense
from fem_seal.contact.refit import rounded
from fem_seal.contact.sizing import element_sizes
from fem_seal.errors import InputError
from fem_seal.loads import expected_force, line_load, plastic_half_width
from meshes import SealMesh, Sizing, build_contact

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from leak import RoughContact

# Ratio of decay length to rms height of Fischer et al. 2020, below eq. 8.
DEFAULT_GAMMA = 0.4


def rough_contact(case: Case) -> RoughContact | None:
    """The case's rough contact, with the hardness if its asperities yield; None without roughness.

    Parameters
    ----------
    case : Case
    """
    from leak import RoughContact

    if case.roughness is None:
        return None
    spectrum, peklenik = case.roughness.combined()
    return RoughContact(
        spectrum,
        effective_modulus=case.effective_modulus,
        hardness=case.hardness if case.leak.plasticity else None,
        percolation_threshold=case.leak.percolation_threshold,
        peklenik=peklenik,
    )


def exponential_law(case: Case, surface: RoughContact | None) -> tuple[float | None, float | None]:
    """Decay length u0 [m] and pressure p_c [Pa] of p = p_c exp(-u/u0); None, None for a smooth interface.

    Parameters
    ----------
    case : Case
    surface : RoughContact or None
        The case's rough contact.

    Returns
    -------
    u0, p_c : float or None
        With law "exponential" as given, or gamma times rms height and p_c of the spectrum; with law "persson"
        the elastic spectrum's at low pressure.
    """
    interface = case.interface
    if interface.law == "smooth":
        return None, None
    if surface is None:
        return interface.u0, interface.p_c
    if interface.law == "persson":
        return surface.u0, surface.p_c
    gamma = DEFAULT_GAMMA if interface.gamma is None else interface.gamma
    return interface.u0 or gamma * surface.spectrum.rms_height, interface.p_c or surface.p_c


def build_mesh(case: Case) -> SealMesh:
    """Mesh of a case, sized for all its loads.

    Parameters
    ----------
    case : Case

    Raises
    ------
    GeometryError, MeshingError
    """
    return build_contact(case.contact, sizing(case, interface_law(case, rough_contact(case))))


def interface_law(case: Case, surface: RoughContact | None) -> Law:
    """The law between contact pressure and gap that the case asks for.

    Parameters
    ----------
    case : Case
    surface : RoughContact or None
        The case's rough contact.
    """
    from leak import ExponentialLaw

    if case.interface.law == "smooth":
        return HardContact()
    if case.interface.law == "persson":
        assert surface is not None  # the case's own checks demand a roughness
        return surface.interface_law(plastic=case.interface.plastic)
    u0, p_c = exponential_law(case, surface)
    assert u0 is not None and p_c is not None
    return ExponentialLaw(p_c=p_c, u0=u0)


def axial_forces(case: Case) -> list[float]:
    """Force F_N that the solid contact carries at each load, with closing = "penetration" its estimate [N]."""
    return expected_forces(case)


def sizing(case: Case, law: Law) -> Sizing:
    """Element sizes and contact zone for all loads of a case.

    Parameters
    ----------
    case : Case
    law : Law
        See `interface_law`.

    Raises
    ------
    InputError
        If [mesh] contact_size is out of range for this contact.
    """
    return sizing_for(case, law, axial_forces(case))


def sizing_for(case: Case, law: Law, forces: Sequence[float]) -> Sizing:
    """The same for other forces F_N than those of the case [N]."""
    contact = case.contact
    line_loads = [line_load(force, contact.touch_radius, contact.angle) for force in forces]
    size = case.mesh.contact_size
    try:
        elastic = element_sizes(law, line_loads, contact, case.effective_modulus, size)
    except InputError as error:
        raise error.in_file(case.file) from None
    size_given = size is not None
    found = for_yielding(elastic, case, line_loads, size_given=size_given) if curves(case) else elastic
    return rounded(found, contact, size_given=size_given)


def condensed_on(case: Case, sizing: Sizing) -> ContactModel:
    """The bodies of a case, meshed with a sizing and condensed."""
    return condensed(case, build_contact(case.contact, sizing))


def supports(case: Case) -> Supports:
    """How the seat of a case is held."""
    return Supports(wall=getattr(case.seat, "wall", "free"))


def interference(case: Case) -> float:
    """Interference of the press fit of a case's seat, on the radius [m]; zero without one."""
    return getattr(case.seat, "interference", None) or 0.0


def condensed(case: Case, seal_mesh: SealMesh) -> ContactModel:
    """The bodies of a case on a mesh, condensed."""
    materials = {"closure": case.closure.material, "seat": case.seat.material}
    return condense(seal_mesh, materials, supports(case))


def expected_forces(case: Case) -> list[float]:
    """Force F_N that the solid contact is expected to carry at each load that can be calculated [N].

    With closing "sealed-area" it is the force, with "penetration" an estimate.

    Parameters
    ----------
    case : Case
    """
    load, refused = case.load, refused_loads(case)
    return [
        expected_force(case.touch_radius, pressure, spring, load.pressure_side, load.closing)
        for number, (pressure, spring) in enumerate(load.points)
        if number not in refused
    ]


# The pressure falls off over some distance beyond the plateau, and the face rises beside it.
_BEYOND = 1.3
# Every element of a body that yields costs in every iteration; a plateau needs no more of them than this.
_ELEMENTS = 100
# As `fem_seal.contact.refit` demands it of the narrowest profile.
_PER_STD = 4.0


def for_yielding(
    sizing: Sizing, case: Case, line_loads: Iterable[float], *, size_given: bool = False
) -> Sizing:
    """A sizing for elastic bodies, wide enough for those that yield, and no finer than they need.

    Parameters
    ----------
    sizing : Sizing
    case : Case
    line_loads : iterable of float
        f_N of every load [N/m].
    size_given : bool
        Whether the element size is the user's own.
    """
    softest = min(curve.yield_stress for curve in curves(case))
    half = _BEYOND * plastic_half_width(max(line_loads), softest)
    if half <= sizing.core:
        return sizing
    lower, upper = case.contact.reach
    start, end = sizing.zone
    # Beyond the plateau the pressure falls off as it does between elastic bodies.
    zone = max(start - half, lower), min(end + half, upper)
    # The core of an elastic sizing is three standard deviations of the narrowest contact.
    coarsest = min(2 * half / _ELEMENTS, sizing.core / 3 / _PER_STD)
    size = sizing.contact_size if size_given else max(sizing.contact_size, coarsest)
    return replace(sizing, zone=zone, core=half, contact_size=size)
