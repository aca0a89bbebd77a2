"""Form error of a seal: harmonics of the gap around the axis, and scratches across the seat."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from fem_seal.arrays import FloatArray
from fem_seal.bolts import BoltCircle

if TYPE_CHECKING:
    from leak import Groove

Direction = Literal["radial", "axial", "normal"]


@dataclass(frozen=True)
class Wave:
    """A deviation amplitude cos(waves phi - phase).

    Parameters
    ----------
    waves : int
        Per turn.
    amplitude : float
        [m]
    phase : float
        [rad]

    Examples
    --------
    >>> print(Wave(2, 1e-6).at(0.0))
    1e-06
    """

    waves: int
    amplitude: float
    phase: float = 0.0

    def at(self, angle: FloatArray | float) -> FloatArray:
        """Deviation at angles [rad] around the axis [m]."""
        return self.amplitude * np.cos(self.waves * angle - self.phase)

    @property
    def phasor(self) -> complex:
        """Complex amplitude a of Re(a exp(i waves phi)) [m]."""
        return complex(self.amplitude * np.exp(-1j * self.phase))


@dataclass(frozen=True)
class WaveTolerance:
    """A zone that holds one wave of unknown number.

    Parameters
    ----------
    amplitude : float
        Of the gap, half the zone times what of it lies along the contact normal [m].
    waves : tuple of int
        Fewest and most waves per turn.
    """

    amplitude: float
    waves: tuple[int, int]

    @property
    def candidates(self) -> range:
        """Numbers of waves that are tried."""
        return range(self.waves[0], self.waves[1] + 1)


@dataclass(frozen=True)
class PlacedGroove:
    """A scratch at its angle, or the lay that winds all around.

    Parameters
    ----------
    groove : Groove
    angle : float or None
        Around the axis [rad]; None all around.
    """

    groove: Groove
    angle: float | None = None


@dataclass(frozen=True)
class FormError:
    """Deviations of closure and seat from round, as they change the gap along the contact normal.

    Parameters
    ----------
    waves : tuple of Wave
        Of the gap, positive where it gets wider; one for each number of waves.
    guided : bool
        Whether the closure is guided and takes a lateral force and a moment.
    tolerance : WaveTolerance or None
        A wave whose number is not known.
    highest : int
        Largest number of waves that was named, also with amplitude zero.
    remarks : tuple of str
        What is to be said about a measured trace.
    grooves : tuple of PlacedGroove
        Scratches across the face, and the lay of turning.
    moment : float
        Of the load about the centre of the circle of first touch, pressing at angle zero [N m]; not with a guide.
    bolts : BoltCircle or None
        Bolts one by one, with the force of a load once this is known; None where they press evenly.
    """

    waves: tuple[Wave, ...] = ()
    guided: bool = False
    tolerance: WaveTolerance | None = None
    highest: int = 1
    remarks: tuple[str, ...] = ()
    grooves: tuple[PlacedGroove, ...] = ()
    moment: float = 0.0
    bolts: BoltCircle | None = None

    @property
    def uneven(self) -> bool:
        """Whether the line load differs from place to place."""
        return bool(self.felt_waves or self.moment or self.bolts)

    @property
    def carried_moment(self) -> complex:
        """That the contact carries, a of Re(a exp(i phi)): of the load, and of bolts of different tightness [N m]."""
        return self.moment + (0j if self.bolts is None else self.bolts.moment)

    @property
    def felt_waves(self) -> tuple[Wave, ...]:
        """The waves that load the contact: a closure that is not guided gives way to the first."""
        return tuple(wave for wave in self.waves if wave.amplitude and (self.guided or wave.waves > 1))

    @property
    def symmetry(self) -> int:
        """How often the felt waves, the moment and the bolts repeat themselves around the axis."""
        if self.moment:
            return 1
        waves = [wave.waves for wave in self.felt_waves] + ([] if self.bolts is None else [self.bolts.period])
        return math.gcd(*waves) or max(self.highest, 1)

    def gap(self, angle: FloatArray) -> FloatArray:
        """What the felt waves add to the gap at angles [rad] around the axis [m]."""
        return sum((wave.at(angle) for wave in self.felt_waves), np.zeros_like(angle))

    def scale(self, factor: float) -> FormError:
        """The same form with all deviations a number of times as large."""
        waves = tuple(replace(wave, amplitude=factor * wave.amplitude) for wave in self.waves)
        tolerance = self.tolerance and replace(self.tolerance, amplitude=factor * self.tolerance.amplitude)
        return replace(self, waves=waves, tolerance=tolerance)

    def with_waves(self, number: int) -> FormError:
        """The form with its tolerance filled by one number of waves, widest where the rest of it is widest."""
        if self.tolerance is None:
            return self
        angle = np.linspace(0.0, 2 * np.pi, 3600, endpoint=False)
        moment = self.carried_moment
        least_pressed = math.pi - float(np.angle(moment)) if moment else 0.0
        widest = float(angle[np.argmax(self.gap(angle))]) if self.felt_waves else least_pressed
        tolerance_wave = Wave(number, self.tolerance.amplitude, number * widest)
        return replace(
            self,
            waves=combine_waves([*self.waves, tolerance_wave]),
            tolerance=None,
            highest=max(self.highest, number),
        )


def combine_waves(waves: Iterable[Wave]) -> tuple[Wave, ...]:
    """The same deviation with one wave for each number.

    Parameters
    ----------
    waves : iterable of Wave
    """
    phasors: dict[int, complex] = {}
    for wave in waves:
        phasors[wave.waves] = phasors.get(wave.waves, 0j) + wave.phasor
    return tuple(
        Wave(n, abs(phasor), -math.atan2(phasor.imag, phasor.real)) for n, phasor in sorted(phasors.items())
    )


def along_normal(direction: Direction, normal: tuple[float, float]) -> float:
    """Share of a deviation that lies along the contact normal.

    Parameters
    ----------
    direction : {"radial", "axial", "normal"}
        Larger radius, higher, or along the normal.
    normal : tuple of float
        (n_r, n_z), from the seat towards the closure.
    """
    return {"radial": normal[0], "axial": normal[1], "normal": 1.0}[direction]


def rigid_wave(
    normal: tuple[float, float],
    initial_contact_radius: float,
    eccentricity: float = 0.0,
    eccentricity_angle: float = 0.0,
    tilt: float = 0.0,
    tilt_angle: float = 0.0,
    tilt_height: float = 0.0,
) -> tuple[Wave, ...]:
    """Change of the gap where the closure stands beside the axis or leans.

    h = n_r e cos(phi - phi_e) + psi [-n_r z_t - n_z r0] cos(phi - phi_t), with z = 0 on the circle of first touch. For
    a ball that leans about its centre the bracket is zero.

    Parameters
    ----------
    normal : tuple of float
        (n_r, n_z), from the seat towards the closure.
    initial_contact_radius : float
        r0 [m].
    eccentricity, eccentricity_angle : float
        Distance of the closure from the axis [m] and where to [rad].
    tilt, tilt_angle : float
        Angle by which the closure leans [rad] and where its top leans to [rad].
    tilt_height : float
        z of the point about which it leans, over the circle of first touch [m].
    """
    lever = -normal[0] * tilt_height - normal[1] * initial_contact_radius
    return (Wave(1, normal[0] * eccentricity, eccentricity_angle), Wave(1, tilt * lever, tilt_angle))


@dataclass(frozen=True)
class Trace:
    """A measured trace around the axis.

    Parameters
    ----------
    angle : ndarray, shape (m,)
        [rad]
    deviation : ndarray, shape (m,)
        [m]
    """

    angle: FloatArray
    deviation: FloatArray

    @property
    def widest_gap(self) -> float:
        """Largest angle between neighbours [rad]."""
        angles = np.sort(np.mod(self.angle, 2 * np.pi))
        return float(np.max(np.diff(angles, append=angles[0] + 2 * np.pi)))

    @property
    def most_waves(self) -> int:
        """Largest number of waves that the trace tells: more than two points for each of them, also in its widest gap.

        Of a wave with just two points the part that vanishes at both is not seen.
        """
        return max(math.ceil(math.pi / self.widest_gap * (1 - 1e-6)) - 1, 0)

    def waves(self, highest: int) -> tuple[Wave, ...]:
        """Waves of 1 to `highest` by least squares; the least-squares circle is the mean and the first of them.

        Parameters
        ----------
        highest : int
            At most `most_waves`.
        """
        n = np.arange(1, highest + 1)
        phase = self.angle[:, None] * n
        columns = np.hstack([np.ones((len(self.angle), 1)), np.cos(phase), np.sin(phase)])
        coefficients = np.linalg.lstsq(columns, self.deviation, rcond=None)[0]
        cosine, sine = coefficients[1 : highest + 1], coefficients[highest + 1 :]
        return tuple(
            Wave(int(number), math.hypot(c, s), math.atan2(s, c))
            for number, c, s in zip(n, cosine, sine, strict=True)
        )

    def residual(self, waves: Iterable[Wave]) -> float:
        """Rms of what waves leave of the deviation, its mean aside [m]."""
        rest = self.deviation - sum(wave.at(self.angle) for wave in waves)
        return float(np.std(rest))
