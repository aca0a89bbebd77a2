"""Bolts that close a seal: their preload from a torque, their stiffness, and their force under a fluid pressure.

Bolts are springs. Tightened without fluid they carry the preload F0 at the approach a0 of the bodies; when a fluid
pressure moves the closure to the approach a, they carry

    F = F0 + k (a0 - a) + dF,    k = 1/(L/(n E A) + 1/k_flange),

with n bolts of modulus E, stress area A and clamped length L, in series with the stiffness k_flange of parts that are
not among the bodies, and dF by the different expansion of bolts and clamped parts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from fem_seal.arrays import FloatArray, IntArray
from leak.numerics.roots import root_of_rising

# ISO 898-1, nominal stress area of coarse threads [mm2], by nominal diameter [mm]: table of EN ISO 898-1 as printed by
# usefastener.com, opened. Above M39, where ISO 898-1 ends, its formula with the pitches of ISO 261, from memory.
_AREAS: dict[int, float] = {
    **{3: 5.03, 4: 8.78, 5: 14.2, 6: 20.1, 7: 28.9, 8: 36.6, 10: 58.0, 12: 84.3, 14: 115.0, 16: 157.0},
    **{18: 192.0, 20: 245.0, 22: 303.0, 24: 353.0, 27: 459.0, 30: 561.0, 33: 694.0, 36: 817.0, 39: 976.0},
    **{42: 1121.0, 45: 1306.0, 48: 1473.0, 52: 1758.0, 56: 2030.0, 60: 2362.0, 64: 2676.0},
}
STRESS_AREAS = MappingProxyType({f"M{size}": 1e-6 * area for size, area in _AREAS.items()})
"""Stress area of metric coarse threads by their size [m^2]."""


def nominal_diameter(size: str) -> float | None:
    """Nominal diameter of a metric thread, "M12" or "M12x1.25" [m]; None if the text is none.

    Parameters
    ----------
    size : str

    Examples
    --------
    >>> nominal_diameter("M12"), nominal_diameter("1/2-13 UNC")
    (0.012, None)
    """
    match = re.fullmatch(r"\s*M\s*(\d{1,3})\s*(x\s*\d+(\.\d+)?)?\s*", size, flags=re.IGNORECASE)
    return 1e-3 * float(match[1]) if match and float(match[1]) > 0 else None


def preload_of_torque(torque: float, nut_factor: float, diameter: float) -> float:
    """Preload F = T/(K d) of one bolt [N].

    Parameters
    ----------
    torque : float
        T [N m].
    nut_factor : float
        K [-].
    diameter : float
        Nominal diameter d of the thread [m].

    References
    ----------
    Budynas and Nisbett, Shigley's Mechanical Engineering Design, section 8-8, T = K F d (from memory; the formula as
    in mechconcepts.tech/bolt-torque-calculation, opened).

    Examples
    --------
    >>> round(preload_of_torque(82.0, 0.2, 0.012))
    34167
    """
    return torque / (nut_factor * diameter)


@dataclass(frozen=True)
class BoltCircle:
    """Bolts one by one around the axis; each keeps its share of the force of all.

    Parameters
    ----------
    radius : float
        Of the circle on which they stand [m].
    head : float
        Diameter under which a bolt presses evenly [m].
    angles : tuple of float
        Around the axis [rad].
    tightness : tuple of float
        Preload of each over the one that is given, none of them negative, not all zero.
    force : float
        Of all together [N]; one where only their shares count.

    Examples
    --------
    Four bolts, the third of them loose:

    >>> circle = BoltCircle(0.04, 0.013, (0.0, math.pi / 2, math.pi, 3 * math.pi / 2), (1.0, 1.0, 0.0, 1.0))
    >>> circle.period, circle.equivalent_number, round(abs(circle.moment) / circle.radius, 4)
    (1, 3.0, 0.3333)
    """

    radius: float
    head: float
    angles: tuple[float, ...]
    tightness: tuple[float, ...]
    force: float = 1.0

    @property
    def equivalent_number(self) -> float:
        """Bolts as tight as the tightest that have the force of all."""
        return sum(self.tightness) / max(self.tightness)

    @property
    def moment(self) -> complex:
        """About the axis, a of Re(a exp(i phi)): it presses hardest where that is largest [N m]."""
        share = complex(self._sums(np.array([1.0]))[0])
        return self.force * self.radius * share if abs(share) > _NONE else 0j

    @property
    def period(self) -> int:
        """How often they repeat themselves around the axis."""
        # a sum over m bolts that vanishes for 2 m waves in a row does for all
        waves = np.arange(1, 2 * len(self.angles) + 1)
        return math.gcd(*waves[np.abs(self._sums(waves)) > _NONE].tolist())

    @property
    def loosest(self) -> tuple[tuple[int, float], ...]:
        """Number, from 1 on, and angle [rad] of the loosest bolts; none where all are as tight."""
        least, tightest = min(self.tightness), max(self.tightness)
        numbered = enumerate(zip(self.angles, self.tightness, strict=True), start=1)
        return tuple((n, angle) for n, (angle, tight) in numbered if tight == least < tightest)

    def wave(self, n: int) -> complex:
        """Force of n waves per full turn, a of Re(a exp(i n phi)) [N].

        Of a force that is even under a head its harmonics are 2 J1(x)/x of those at the middle, x = n head/(2 radius).

        Parameters
        ----------
        n : int
            One or more.
        """
        from scipy.special import j1

        x = 0.5 * n * self.head / self.radius
        return 2.0 * self.force * complex(self._sums(np.array([n]))[0]) * 2.0 * float(j1(x)) / x

    def _sums(self, waves: FloatArray | IntArray) -> FloatArray:
        """sum_j s_j exp(-i n phi_j) with the shares s_j of the force."""
        shares = np.array(self.tightness) / sum(self.tightness)
        return np.asarray(np.exp(-1j * np.outer(waves, self.angles)) @ shares)


# Share of the force that is none, of angles with the digits of a case file.
_NONE = 1e-9


@dataclass(frozen=True)
class Bolts:
    """All bolts of a joint.

    Parameters
    ----------
    number : int
    stress_area : float
        Of one bolt [m^2].
    stiffness : float
        k of all bolts together, with what is in series [N/m].
    thermal_force : float
        Change of their force by heat while the approach stays [N].
    torque_factor : float or None
        K d, torque of one bolt over its preload [m]; None where it is not known.
    scatter : float
        By which the preload may be off, relative.
    faces : int
        How many times the approach of one contact the bolts follow: twice with a gasket.
    circle : BoltCircle or None
        Where they stand, and how tight each of them is; None where they press evenly all around.
    """

    number: int
    stress_area: float
    stiffness: float
    thermal_force: float = 0.0
    torque_factor: float | None = None
    scatter: float = 0.0
    faces: int = 1
    circle: BoltCircle | None = None

    @property
    def equivalent_number(self) -> float:
        """Bolts as tight as the tightest that have the force of all."""
        return self.number if self.circle is None else self.circle.equivalent_number

    def stress(self, force: float) -> float:
        """Stress on the stress area of the tightest bolt under a force of all [Pa].

        Parameters
        ----------
        force : float
            [N]
        """
        return force / (self.equivalent_number * self.stress_area)

    def torque(self, preload: float) -> float | None:
        """Torque of the tightest bolt for a preload of all [N m]; None where the nut factor is not known.

        Parameters
        ----------
        preload : float
            [N]
        """
        return None if self.torque_factor is None else self.torque_factor * preload / self.equivalent_number


def held_force(bolts: Bolts, preload: float, approach: Callable[[float], float], at_preload: float) -> float:
    """Force of all bolts where they and the contact hold each other [N]; zero where they are loose.

    The root F of F = F0 + k (a0 - a(F)) + dF, with the approaches of all faces together.

    Parameters
    ----------
    bolts : Bolts
    preload : float
        F0 [N].
    approach : callable
        Approach a [m] under an applied force [N], at the fluid pressure of the load; rises with the force.
    at_preload : float
        Approach a0 under the preload, without fluid [m].

    Examples
    --------
    Bolts of 1e8 N/m on a contact of 3e8 N/m, of which a fluid takes 10 kN away:

    >>> round(held_force(Bolts(4, 84.3e-6, 1e8), 40e3, lambda F: (F - 10e3) / 3e8, 40e3 / 3e8), 3)
    42500.0
    """
    stiffness = bolts.faces * bolts.stiffness
    sum_of_forces = preload + bolts.thermal_force
    first = preload - sum_of_forces + stiffness * (approach(preload) - at_preload)
    if first == 0.0:
        return preload
    # a step of one leads beyond the root if the contact answers as it did on the way to the preload
    unit = _WIDENING * first / (1.0 + stiffness * max(at_preload, 0.0) / preload)

    def excess(step: float) -> float:
        force = preload - step * unit
        gap = sum_of_forces - force - stiffness * (approach(force) - at_preload) if step else -first
        return gap / first

    # it rises with the force, by one at least
    step = root_of_rising(excess, 0.0, first / unit, 0.0, _ACCURACY * preload / abs(unit))
    return max(preload - step * unit, 0.0)


# Accuracy of a force over the preload, and how much longer than expected the first step is.
_ACCURACY, _WIDENING = 1e-9, 1.2


def stiffness_of(
    number: int, modulus: float, stress_area: float, length: float, in_series: float = math.inf
) -> float:
    """Stiffness k of all bolts in series with other parts [N/m].

    Parameters
    ----------
    number : int
    modulus : float
        E [Pa].
    stress_area : float
        A of one bolt [m^2].
    length : float
        Clamped length L [m].
    in_series : float
        Stiffness of parts that are not among the bodies; infinite where they are rigid [N/m].

    Examples
    --------
    >>> round(stiffness_of(4, 210e9, 84.3e-6, 0.04) / 1e6)
    1770
    """
    return 1.0 / (length / (number * modulus * stress_area) + 1.0 / in_series)
