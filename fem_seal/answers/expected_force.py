"""The force on the contact that a target leak rate takes, by closed forms."""

from __future__ import annotations

import math

from fem_seal.errors import InputError
from fem_seal.loads import contact_force
from fem_seal.seal.load_solver import SealFlow
from fem_seal.seal.problem import SealProblem, largest_force
from fem_seal.units import briefly, given, quantity
from fem_seal.validity.words import sentence
from leak.numerics.roots import root_between

# Step of the force while a target is looked for, and how far down from the largest sensible force.
_STEP = 4.0
_LEAST = 1e-9
# Leak rates are compared within this factor of the target: sealed and blown open have to be something, too.
_FARTHEST = 1e6


def expected_contact_force(flow: SealFlow, fluid_pressure: float, target: float) -> float:
    """Force F_N at which a Gaussian profile of the expected width leaks as much as the target [N].

    Parameters
    ----------
    flow : SealFlow
    fluid_pressure : float
        [Pa]
    target : float
        [m^3/s]

    Raises
    ------
    InputError
        If no sensible force does.
    """
    problem = flow.problem

    def excess(log_force: float) -> float:
        profile = flow.expected_profile(math.exp(log_force))
        return log_excess(flow.leak(profile, fluid_pressure).leak_rate, target)

    highest = math.log(largest_force(problem))
    area = math.pi * problem.touch_radius**2
    at = min(math.log(abs(contact_force(problem.touch_radius, fluid_pressure)) + 1e-12 * area), highest)
    step = math.log(_STEP) * (1 if excess(at) > 0 else -1)
    while True:
        ahead = min(at + step, highest)
        if excess(ahead) * step <= 0:
            return math.exp(root_between(excess, at, ahead, xtol=1e-3))
        bar = fluid_pressure / 1e5
        if ahead == highest:
            least = flow.leak(flow.expected_profile(math.exp(highest)), fluid_pressure).leak_rate
            force = briefly("force", largest_force(problem))
            values = {"force": force, "leaves": quantity("flow", least), "bar": bar}
            raise target_problem(problem, "too_small", target, **values)
        if ahead < highest + math.log(_LEAST):
            raise target_problem(problem, "always_met", target, bar=bar)
        at = ahead


def target_remarks(problem: SealProblem) -> tuple[str, ...]:
    """Why the target leak rate of a problem cannot be met, before anything is solved; empty if it can.

    Parameters
    ----------
    problem : SealProblem
    """
    flow, target = SealFlow.of(problem), problem.loads.target_leak_rate
    if flow is None or target is None:
        return ()
    remarks = []
    for pressure in dict.fromkeys(problem.loads.fluid_pressure):
        try:
            expected_contact_force(flow, pressure, target)
        except InputError as error:
            remarks.append(str(error))
    return tuple(remarks)


def log_excess(leak_rate: float, target: float) -> float:
    """ln of a leak rate over the target, within bounds: sealed and blown open are something, too."""
    return math.log(min(max(leak_rate / target, 1 / _FARTHEST), _FARTHEST))


def target_problem(problem: SealProblem, name: str, target: float | None, **values: object) -> InputError:
    """What is wrong with a target leak rate, in the words of templates/findings.toml.

    Parameters
    ----------
    problem : SealProblem
    name : str
    target : float or None
        [m^3/s]
    **values
        What the words have in braces.
    """
    shown = None if target is None else given("flow", target)
    message = sentence("target", name, **values)
    return InputError.at("load.target_leak_rate", message, shown, file=problem.file)
