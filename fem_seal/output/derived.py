"""Closed-form numbers of a case, without solving it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fem_seal.answers.closed_forms import widths
from fem_seal.answers.leakage_class import limits
from fem_seal.output.case_words import finish_numbers, listed_dimensions, section

if TYPE_CHECKING:
    from fem_seal.answers.closed_forms import Derived
    from fem_seal.case.case import Case


def derived_numbers(case: Case, derived: Derived) -> dict[str, Any]:
    """Derived numbers of a case in SI, as `check --json` prints them."""
    fluid = case.fluid
    crossovers = [load.crossover for load in derived.loads if load.crossover]
    found = dict(zip(crossovers, widths(crossovers).tolist(), strict=True))
    return {
        "title": case.title,
        "touch_radius_m": derived.touch_radius,
        "contact_angle_rad": case.contact.angle,
        "relative_radius_m": derived.relative_radius,
        "dimensions": {
            name: {key: value for key, (value, _) in listed_dimensions(case, name).items()}
            for name in ("closure", "seat")
        },
        "sections": {name: drawn for name in ("closure", "seat") if (drawn := section(case, name))},
        "effective_modulus_Pa": derived.effective_modulus,
        "hardness_Pa": derived.hardness,
        "rms_height_m": derived.rms_height,
        "rms_slope": derived.rms_slope,
        "finishes": finish_numbers(case),
        "decay_length_m": derived.decay_length,
        "law_pressure_Pa": derived.law_pressure,
        "viscosity_Pa_s": fluid.viscosity if fluid else None,
        "loads": [
            {
                "fluid_pressure_Pa": load.fluid_pressure,
                "contact_force_N": load.contact_force,
                "line_load_N_per_m": load.line_load,
                "blow_off_pressure_Pa": load.blow_off_pressure,
                "force_for_target_leak_N": load.force_for_target,
                "hertz_peak_pressure_Pa": load.hertz.peak_pressure if load.hertz else None,
                "hertz_half_width_m": load.hertz.half_width if load.hertz else None,
                "gaussian_peak_pressure_Pa": load.gaussian.peak_pressure if load.gaussian else None,
                "gaussian_std_m": load.gaussian.std if load.gaussian else None,
                "crossover_peak_pressure_Pa": load.crossover.peak_pressure if load.crossover else None,
                "crossover_fwhm_m": found[load.crossover] if load.crossover else None,
                "crossover_std_m": load.crossover.std if load.crossover else None,
            }
            for load in derived.loads
        ],
    }


def requirement_numbers(case: Case) -> list[dict[str, Any]] | None:
    """What will be judged at which fluid pressure, as `check --json` prints it; None without a requirement."""
    required = case.requirement
    if required is None:
        return None
    return [
        {
            "fluid_pressure_Pa": pressure,
            "limit": limit.name,
            "allowed_m3_per_s": limit.leak_rate,
            "test_fluid": limit.test_fluid or None,
            "test_fluid_leaks_times": list(limit.ratio),
        }
        for pressure in dict.fromkeys(case.load.fluid_pressure)
        if required.judges(pressure)
        for limit in limits(case, pressure)
    ]
