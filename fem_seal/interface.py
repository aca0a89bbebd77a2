"""From the tables of a case to its rough contact and its exponential law."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fem_seal.case import Case
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
