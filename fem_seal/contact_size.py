"""How wide the contact will be, and from it the contact zone and the element sizes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fem_seal.errors import InputError, Problem
from fem_seal.laws import HardContact, InterfaceLaw, Law
from meshes import ContactGeometry, Sizing

# Chosen so that peak, width and standard deviation change by less than 2e-4 on further refinement
# (tests/test_verification_contact.py). A soft interface spreads the pressure smoothly; the stiffer it is against the
# bodies, the sharper the pressure ends, and the smaller the elements must be to follow its edge.
_PER_STD_SOFT, _PER_STD_HARD = 6.0, 14.0
_GROWTH_SOFT = 0.08
_GROWTH_DEEP = 0.2

_MOST_ELEMENTS = 1500

# Pressure over peak pressure at which the zone may end.
_TAIL = 1e-7


@dataclass(frozen=True)
class ContactWidth:
    """Expected width of one contact.

    Parameters
    ----------
    std : float
        Standard deviation of the pressure profile [m].
    per_std : float
        Elements per standard deviation that resolve it.
    reach : float
        Distance from first touch at which the pressure has fallen to 1e-7 of its peak [m].
    """

    std: float
    per_std: float
    reach: float


def contact_width(
    law: Law, line_load: float, relative_radius: float, effective_modulus: float
) -> ContactWidth:
    """Width of a line contact before it is solved.

    The variance of the profile is the sum of the variances of the interface law alone, R u0, and of Hertz,
    a^2/4 - exact for the exponential law; u0 is taken at the peak pressure.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
    line_load : float
        f_N [N/m].
    relative_radius : float
        R_rel [m].
    effective_modulus : float
        E* [Pa].
    """
    R = relative_radius
    a = 2 * math.sqrt(line_load * R / (math.pi * effective_modulus))
    if isinstance(law, HardContact):
        return ContactWidth(a / 2, _PER_STD_HARD, 1.3 * a)
    log_peak = math.log(line_load / (math.sqrt(math.pi / 2) * a))
    for _ in range(4):
        law_variance = R * _decay_length(law, log_peak)
        std = math.sqrt(law_variance + a**2 / 4)
        log_peak = math.log(line_load / (math.sqrt(2 * math.pi) * std))
    tail = math.sqrt(2 * R * (_gap(law, log_peak + math.log(_TAIL)) - _gap(law, log_peak)))
    per_std = min(max(a / math.sqrt(law_variance), _PER_STD_SOFT), _PER_STD_HARD)
    return ContactWidth(std, per_std, a + tail)


def _decay_length(law: InterfaceLaw, log_pressure: float) -> float:
    return float(law.decay_length(np.array([log_pressure]))[0])


def _gap(law: InterfaceLaw, log_pressure: float) -> float:
    return float(law.gap(np.array([log_pressure]))[0])


def element_sizes(
    law: Law,
    line_loads: Sequence[float],
    contact: ContactGeometry,
    effective_modulus: float,
    contact_size: float | None = None,
) -> Sizing:
    """Sizes that resolve every load on one mesh: fine enough for the narrowest contact, wide enough for the widest.

    Parameters
    ----------
    law : InterfaceLaw or HardContact
    line_loads : sequence of float
        f_N of every load [N/m].
    contact : ContactGeometry
    effective_modulus : float
        E* [Pa].
    contact_size : float, optional
        Element size along the contact line [m], instead of the one found.

    Raises
    ------
    InputError
        If `contact_size` cannot resolve the narrowest profile, or needs an unreasonable number of elements.
    """
    widths = [contact_width(law, f, contact.relative_radius, effective_modulus) for f in line_loads]
    std, reach = min(w.std for w in widths), max(w.reach for w in widths)
    lower, upper = contact.reach
    far_size = contact.closure.largest_radius / 8
    sizing = Sizing(
        contact_size=min(min(w.std / w.per_std for w in widths), far_size),
        core=3 * std,
        # Contact ends where one of the faces ends, whatever the law says.
        zone=(max(-reach, 0.98 * lower), min(reach, 0.98 * upper)),
        growth_along=_GROWTH_SOFT * _PER_STD_SOFT / max(w.per_std for w in widths),
        growth_deep=_GROWTH_DEEP,
        far_size=far_size,
    )
    if contact_size is None:
        return sizing
    smallest = (sizing.zone[1] - sizing.zone[0]) / _MOST_ELEMENTS
    if not smallest <= contact_size <= std:
        raise InputError(
            Problem(
                "mesh.contact_size",
                f"allowed is {smallest * 1e6:.3g} um ({_MOST_ELEMENTS} elements along the contact line) to "
                f"{std * 1e6:.3g} um (standard deviation of the narrowest pressure profile); or leave it out: "
                f"{sizing.contact_size * 1e6:.3g} um",
                f"{contact_size * 1e6:.6g} um",
            )
        )
    return replace(sizing, contact_size=contact_size)
