"""What follows from a case in closed form, before anything is solved."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_seal.errors import InputError
from fem_seal.interface import exponential_law, rough_contact
from fem_seal.laws import HardContact, InterfaceLaw
from fem_seal.load_limits import refused_loads
from fem_seal.loads import blow_off_of_sealed_area, closing_force, expected_force, line_load

if TYPE_CHECKING:
    from fem_seal.case import Case
    from leak import CrossoverLine, GaussianLine, HertzLine

# Share by which the decay length of a law may have fallen at the peak before the crossover is called another contact.
_STIFFER = 0.05


@dataclass(frozen=True)
class DerivedLoad:
    """One load of a case with its closed pressure profiles.

    Parameters
    ----------
    fluid_pressure : float
        [Pa]
    closing_force : float
        Axial force F_N that presses the closure on the seat [N]; with closing "penetration" what is expected of it.
    line_load : float
        f_N [N/m].
    hertz : HertzLine or None
        Smooth elastic bodies; None for faces that fit each other along a stretch, and for a load that cannot be
        calculated, as the other profiles.
    gaussian : GaussianLine or None
        Rigid bodies with the exponential law; None for a smooth interface.
    crossover : CrossoverLine or None
        Elastic bodies with the exponential law, exact for half-spaces; None for a smooth interface.
    blow_off_pressure : float or None
        Fluid pressure that lifts the closure off the circle of first touch [Pa]; None where it closes.
    force_for_target : float or None
        Force of spring or actuator for the target leak rate [N], from a Gaussian profile of the expected width; None
        without a target, or if no sensible force reaches it.
    """

    fluid_pressure: float
    closing_force: float
    line_load: float
    hertz: HertzLine | None
    gaussian: GaussianLine | None
    crossover: CrossoverLine | None
    blow_off_pressure: float | None
    force_for_target: float | None


@dataclass(frozen=True)
class Derived:
    """Closed-form numbers of a case.

    Parameters
    ----------
    touch_radius : float
        Radius r0 of the circle of first touch [m].
    effective_modulus : float
        E* [Pa].
    relative_radius : float
        Radius of relative curvature across the contact line [m]; inf for faces that fit each other along a stretch.
    hardness : float or None
        Penetration hardness used for the asperities [Pa]; None without asperity plasticity.
    rms_height, rms_slope : float or None
        Of the combined roughness [m], [-]; None without roughness.
    decay_length : float or None
        u0 of p = p_c exp(-u/u0) [m]: as given, gamma times rms height, or of the spectrum at low pressure;
        None for a smooth interface.
    law_pressure : float or None
        p_c [Pa].
    loads : tuple of DerivedLoad
        One per fluid pressure.
    """

    touch_radius: float
    effective_modulus: float
    relative_radius: float
    hardness: float | None
    rms_height: float | None
    rms_slope: float | None
    decay_length: float | None
    law_pressure: float | None
    loads: tuple[DerivedLoad, ...]


def derive(case: Case) -> Derived:
    """Closed-form numbers of a case: geometry, loads, and the Hertz, Gaussian and crossover profiles.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Derived
        With law "persson" the exponential of the elastic spectrum at low pressure stands for the law.
    """
    surface, refused = rough_contact(case), refused_loads(case)
    decay_length, law_pressure = exponential_law(case, surface)
    return Derived(
        touch_radius=case.touch_radius,
        effective_modulus=case.effective_modulus,
        relative_radius=case.contact.relative_radius,
        hardness=surface.hardness if surface else None,
        rms_height=surface.spectrum.rms_height if surface else None,
        rms_slope=surface.spectrum.rms_slope if surface else None,
        decay_length=decay_length,
        law_pressure=law_pressure,
        loads=tuple(
            _derive_load(case, *point, decay_length, profiles=number not in refused)
            for number, point in enumerate(case.load.points)
        ),
    )


def closed_form_limits(case: Case, derived: Derived) -> str:
    """Why the closed forms are not what a run finds: a law or faces that change within the contact; "" if they are.

    Parameters
    ----------
    case : Case
    derived : Derived
        Of the same case.
    """
    law = _stiffening_law(case)
    for load in derived.loads:
        closed = load.crossover or load.hertz
        if closed is None:
            continue
        if law is not None and load.crossover is not None:
            there = float(law.decay_length(np.array([math.log(closed.peak_pressure)]))[0])
            if there < (1 - _STIFFER) * load.crossover.u0:
                return (
                    f"from {load.fluid_pressure / 1e5:.6g} bar on p(u) of this surface is no exponential: its decay "
                    f"length falls from {1e6 * load.crossover.u0:.3g} um at low pressure to {1e6 * there:.3g} um at "
                    "the peak. The crossover is for the former; the calculated contact is narrower, its peak higher"
                )
        # Beyond two standard deviations there is a twentieth of the load; Hertz's contact ends there.
        inside = case.contact.breaks[np.abs(case.contact.breaks) < 2 * closed.std]
        if len(inside):
            nearest = 1e6 * float(np.abs(inside).min())
            return (
                f"from {load.fluid_pressure / 1e5:.6g} bar on the contact is wider than the stretch on which the faces "
                f"bend as they do at first touch ({nearest:.3g} um to one side of it): the closed forms (Hertz, "
                "crossover) do not hold there, and the calculated peak differs from theirs"
            )
    return ""


def nearly_open(derived: Derived) -> str:
    """Which loads the fluid carries on the sealed area, so that only a run decides about them; "" if there are none.

    Parameters
    ----------
    derived : Derived
    """
    carried = [load.fluid_pressure / 1e5 for load in derived.loads if math.isnan(load.closing_force)]
    if not carried:
        return ""
    return (
        f"at {', '.join(f'{pressure:.6g}' for pressure in carried)} bar the fluid carries the closing force on the "
        "sealed area, or nearly so: the seal is open or close to it, and only a run decides"
    )


def _stiffening_law(case: Case) -> InterfaceLaw | None:
    """The law of the rough surface; None where it is an exponential or hard contact."""
    if case.interface.law != "persson":
        return None
    from fem_seal.pipeline import interface_law

    law = interface_law(case, rough_contact(case))
    assert not isinstance(law, HardContact)  # that is law = "smooth"
    return law


def _derive_load(
    case: Case, fluid_pressure: float, axial_force: float, decay_length: float | None, *, profiles: bool
) -> DerivedLoad:
    from leak import crossover_line, gaussian_line, hertz_line

    r0, R, E = case.touch_radius, case.contact.relative_radius, case.effective_modulus
    profiles = profiles and not math.isinf(R)
    side = case.load.pressure_side
    force = expected_force(r0, fluid_pressure, axial_force, side, case.load.closing)
    if force > closing_force(r0, fluid_pressure, axial_force, side):
        # what a run begins with where the fluid carries the spring or nearly so, and no estimate of the force
        force, profiles = math.nan, False
    f = line_load(force, r0, case.contact.angle)
    return DerivedLoad(
        fluid_pressure=fluid_pressure,
        closing_force=force,
        line_load=f,
        hertz=hertz_line(f, R, E) if profiles else None,
        gaussian=gaussian_line(f, R, decay_length) if decay_length and profiles else None,
        crossover=crossover_line(f, R, E, decay_length) if decay_length and profiles else None,
        blow_off_pressure=blow_off_of_sealed_area(r0, axial_force) if side == "inner" else None,
        force_for_target=_force_for_target(case, fluid_pressure),
    )


def _force_for_target(case: Case, fluid_pressure: float) -> float | None:
    target = case.load.target_leak_rate
    if target is None:
        return None
    from fem_seal.inverse_questions import expected_contact_force
    from fem_seal.pipeline import interface_law

    try:
        force = expected_contact_force(case, interface_law(case, rough_contact(case)), fluid_pressure, target)
    except InputError:
        return None
    return force - closing_force(case.touch_radius, fluid_pressure, 0.0, case.load.pressure_side)
