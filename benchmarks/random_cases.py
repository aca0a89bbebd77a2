"""Random valid cases: every one converges to a balanced, resolved contact or is refused with the reason.

    python benchmarks/random_cases.py [COUNT] [--seed N]

A Latin hypercube over geometry, materials, interface law and load. A case that is refused must say so in one sentence
(InputError, GeometryError, ConvergenceError); anything else counts as a failure and ends the run with exit code 1.
"""

from __future__ import annotations

import argparse
import math
import re
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import fem_seal
from fem_seal.contact.solution import ContactSolution
from fem_seal.errors import ConvergenceError, SealError
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.problem import SealProblem, expected_forces
from leak import crossover_line
from meshes import MeshesError

# Ranges of the hypercube; logarithmic except for angle and ratios.
RADIUS = (1e-3, 0.1)
ANGLE = (20.0, 70.0)
LOAD = (1e3, 5e8)
DECAY = (1e-9, 50e-6)
MODULUS = (1e9, 600e9)
# Contacts narrower than this share of touch radius and curvature are line contacts of half-spaces within a per cent.
NARROW = 0.01


@dataclass(frozen=True)
class Outcome:
    """What became of one case.

    Parameters
    ----------
    kind : str
        "solved", "refused" or "failed".
    text : str
        Why, if it was not solved.
    seconds : float
    """

    kind: str
    text: str
    seconds: float


def cases(count: int, seed: int = 0) -> Iterator[dict[str, Any]]:
    """Tables of random cases."""
    from scipy.stats import qmc

    for row in qmc.LatinHypercube(8, rng=np.random.default_rng(seed)).random(count).tolist():
        R, load, u0, E1, E2 = (
            math.exp(math.log(low) + share * math.log(high / low))
            for share, (low, high) in zip(row, (RADIUS, LOAD, DECAY, MODULUS, MODULUS), strict=False)
        )
        angle = ANGLE[0] + row[5] * (ANGLE[1] - ANGLE[0])
        yield {
            **bodies(R, angle, row[6]),
            "closure_material": material(E1, 0.45 * row[7]),
            "seat_material": material(E2, 0.45 * (1 - row[7])),
            "interface": {"law": "exponential", "u0": f"{u0!r} m", "p_c": "5 GPa"},
            "load": {"fluid_pressure": [f"{load!r} Pa"]},
        }


def material(modulus: float, poissons_ratio: float) -> dict[str, Any]:
    """Table of an elastic material."""
    return {"youngs_modulus": f"{modulus!r} Pa", "poissons_ratio": float(poissons_ratio)}


def bodies(size: float, angle: float, choice: float) -> dict[str, Any]:
    """Closure and seat of about this size; `choice` in [0, 1) picks the pair and varies what else it has."""

    def m(share: float) -> str:
        return f"{share * size!r} m"

    def degrees(value: float) -> str:
        return f"{value!r} deg"

    r0 = math.sin(math.radians(angle))
    ball = {"shape": "ball", "radius": m(1)}
    cone = {"shape": "cone", "angle": degrees(angle)}
    poppet = {"shape": "cone", "angle": degrees(angle), "mean_radius": m(r0), "outer_radius": m(1.4 * r0)}
    pairs: list[Callable[[float], tuple[dict[str, Any], dict[str, Any]]]] = [
        lambda s: (ball, cone),
        lambda s: (ball | {"cavity_radius": m(0.3 + 0.4 * s)}, cone),
        lambda s: (ball, {"shape": "conical-land", "angle": degrees(angle), "land_width": m(0.02 + 0.3 * s)}),
        lambda s: (ball, {"shape": "sphere", "radius": m(1.001 + s), "contact_angle": degrees(angle)}),
        lambda s: (ball, {"shape": "sphere", "radius": m(1.001 + s), "bore_radius": m(0.8 * r0)}),
        lambda s: (ball, {"shape": "torus", "centre_radius": m(1.1 * r0), "radius": m(0.05 + 0.2 * s)}),
        lambda s: (
            ball,
            {"shape": "sharp-edge", "bore_radius": m(r0), "edge_radius": m(10 ** (-3 + 2 * s) * r0)},
        ),
        lambda s: (poppet, {"shape": "sharp-edge", "bore_radius": m(r0), "edge_radius": m(0.02 * r0)}),
        lambda s: (poppet, {"shape": "cone", "angle": degrees(angle + 0.5 + 3 * s)}),
        lambda s: (
            poppet,
            {
                "shape": "conical-land",
                "angle": degrees(angle),
                "land_width": m(0.1 * r0),
                "land_radius": m(r0 * (0.95 + 0.1 * s)),
            },
        ),
        lambda s: (
            {"shape": "torus", "centre_radius": m(1), "radius": m(0.02 + 0.3 * s)},
            {"shape": "flat", "bore_radius": m(0.5)},
        ),
        lambda s: ({"shape": "torus", "centre_radius": m(1), "radius": m(0.02 + 0.3 * s)}, cone),
        lambda s: ({"shape": "spherical-tip", "radius": m(1.5 + s), "stem_radius": m(1)}, cone),
        lambda s: (
            {"shape": "disc", "radius": m(1)},
            {"shape": "torus", "centre_radius": m(0.7), "radius": m(0.02 + 0.2 * s)},
        ),
    ]
    number, rest = divmod(choice * len(pairs), 1)
    closure, seat = pairs[int(number)](rest)
    return {"closure": closure, "seat": seat}


def outcome(tables: dict[str, Any]) -> Outcome:
    """Solve one case and look whether its contact is balanced and resolved."""
    start = time.perf_counter()
    tables = dict(tables)
    for body in ("closure", "seat"):
        tables[body] = {**tables[body], "material": tables.pop(f"{body}_material")}
    try:
        case = fem_seal.Case(**tables)
        problem = SealProblem.of(case)
        contacts = evaluate(problem).solved_loads
        (contact,) = contacts.contacts
    except (SealError, MeshesError) as error:
        kind = "not converged" if isinstance(error, ConvergenceError) else "refused"
        return Outcome(kind, str(error), time.perf_counter() - start)
    except Exception as error:
        return Outcome("failed", f"{type(error).__name__}: {error}", time.perf_counter() - start)
    wrong = doubts(contact, expected_forces(problem)[0], problem.law.u0, problem.contact.breaks)
    return Outcome("failed" if wrong else "solved", wrong, time.perf_counter() - start)


def doubts(contact: ContactSolution, contact_force: float, u0: float, breaks: NDArray[np.float64]) -> str:
    """What is wrong with a solution; empty if nothing."""
    profile = contact.profile
    p = profile.pressure
    if not np.all(np.isfinite(p)):
        return "pressure is not finite"
    if abs(contact.force_error) > 1e-9 or not math.isclose(
        contact.contact_force, contact_force, rel_tol=1e-12
    ):
        return f"force balance {contact.force_error:.2g}"
    inner = profile.std / np.diff(contact.model.line.vertices).min()
    if inner < 3:
        return f"only {inner:.2g} elements per standard deviation"
    model = contact.model
    far_from_edges = np.abs(breaks - profile.centroid).min(initial=np.inf) > 8 * profile.std
    narrow = profile.std < NARROW * min(model.initial_contact_radius, model.relative_radius)
    if narrow and far_from_edges and math.isfinite(model.relative_radius):
        exact = crossover_line(contact.line_load, model.relative_radius, model.effective_modulus, u0)
        if abs(profile.peak_pressure / exact.peak_pressure - 1) > 0.01:
            return (
                f"peak pressure {profile.peak_pressure:.4g} Pa, exact crossover {exact.peak_pressure:.4g} Pa"
            )
    return ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, help="solve this one of the cases only")
    arguments = parser.parse_args()
    outcomes: list[Outcome] = []
    by_pair: dict[str, Counter[str]] = {}
    for n, tables in enumerate(cases(arguments.count, arguments.seed)):
        if arguments.only is not None and n != arguments.only:
            continue
        outcomes.append(outcome(tables))
        pair = f"{tables['closure']['shape']} on {tables['seat']['shape']}"
        by_pair.setdefault(pair, Counter())[outcomes[-1].kind] += 1
        # A mesh that cannot be made is no fault of the case either.
        if outcomes[-1].kind in ("failed", "not converged") or "gmsh" in outcomes[-1].text:
            print(f"case {n}: {outcomes[-1].kind}: {outcomes[-1].text}\n  {tables}", flush=True)
    counts = Counter(o.kind for o in outcomes)
    seconds = np.array([o.seconds for o in outcomes if o.kind == "solved"])
    print(f"{len(outcomes)} cases: " + ", ".join(f"{number} {kind}" for kind, number in counts.most_common()))
    for pair, kinds in sorted(by_pair.items()):
        print(f"  {pair:30s} " + ", ".join(f"{number} {kind}" for kind, number in kinds.most_common()))
    reasons = Counter(re.sub(r"\b\d[\d.e+-]*", "#", o.text)[:100] for o in outcomes if o.kind == "refused")
    for reason, number in reasons.most_common(12):
        print(f"  {number:5d} refused: {reason}...")
    if len(seconds):
        print(f"seconds per solved case: median {np.median(seconds):.2f}, longest {seconds.max():.2f}")
    return 1 if counts["failed"] else 0


if __name__ == "__main__":
    raise SystemExit(main())
