"""Contacts in series, with chambers between them whose pressure follows from the flow, or is given.

What enters a chamber leaves it: as much flows through the contacts on both sides of it, unless it is vented or has a
test port.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from leak.arrays import FloatArray
from leak.errors import ProfileError
from leak.flow.leak_result import LandFlow, LeakResult
from leak.numerics.roots import MOST_STEPS, ROUND_OFF

# Newton's method has arrived when flows differ by less than this share of the largest.
_CLOSE = 1e-12
# Of the pressure difference: step of the difference quotient.
_STEP = 1e-6

Flow = Callable[[float, float], float]


@dataclass(frozen=True)
class SeriesContact:
    """One of several contacts in series.

    Parameters
    ----------
    leak : callable or None
        Its leak between two different pressures on its inner and its outer side [Pa]; None where the faces do not touch
        and nothing resists.
    points : int
        Number of points at which it tells the fluid pressure.
    """

    leak: Callable[[float, float], LeakResult] | None
    points: int

    def flow(self, inner: float, outer: float) -> float:
        """Leak rate outwards [m^3/s], negative inwards."""
        assert self.leak is not None
        return 0.0 if inner == outer else math.copysign(self.leak(inner, outer).leak_rate, inner - outer)


def in_series(
    contacts: Sequence[SeriesContact], inner: float, outer: float, fixed_pressures: Sequence[float | None]
) -> LeakResult:
    """Leak of contacts in series.

    Parameters
    ----------
    contacts : sequence of SeriesContact
        From the axis outwards; one at least touches.
    inner, outer : float
        Pressures at both ends, the lower one zero [Pa].
    fixed_pressures : sequence of float or None
        Pressure in each chamber, one less than there are contacts [Pa]: zero in one that is vented, None where it
        follows from the flow.

    Returns
    -------
    LeakResult
        Its leak rate is what leaves the seal: all that gets to the low side, and into chambers that are vented.

    Raises
    ------
    ProfileError
        If the pressures in the chambers are not found.

    Examples
    --------
    >>> import leak
    >>> x = np.linspace(-0.5e-3, 0.5e-3, 101)
    >>> def land(inner, outer):
    ...     p, side = 50e6 * np.exp(-(x / 0.2e-3) ** 2), "inner" if inner > outer else "outer"
    ...     return leak.leak_flow(x, p, lambda p: 1e-10 / p, abs(inner - outer), 0.014, pressure_side=side)
    >>> both = in_series([SeriesContact(land, 101)] * 2, 2e5, 0.0, [None])
    >>> round(both.lands[0].outer_pressure), f"{both.leak_rate / land(1e5, 0.0).leak_rate:.9f}"
    (100000, '1.000000000')
    """
    touches = [n for n, contact in enumerate(contacts) if contact.leak is not None]
    if not touches:
        raise ProfileError("no land touches: the seal is open")
    # chambers that an open land does not part are one, and those beside an end belong to it
    chambers = [_chamber_pressures(fixed_pressures[begin:end]) for begin, end in pairwise(touches)]
    for end, part in ((inner, fixed_pressures[: touches[0]]), (outer, fixed_pressures[touches[-1] :])):
        _chamber_pressures([end, *part])
    pressures = chamber_pressures([contacts[n].flow for n in touches], inner, outer, chambers)
    pressure = [inner, *pressures.tolist(), outer]
    outwards, parts, results = [], {}, list[LeakResult]()
    for n, (p_in, p_out) in zip(touches, pairwise(pressure), strict=True):
        leak, flow = contacts[n].leak, 0.0
        if p_in != p_out and leak is not None:
            results.append(leak(p_in, p_out))
            flow, parts[n] = results[-1].leak_rate, results[-1].fluid_pressure
        outwards.append(math.copysign(flow, p_in - p_out))
    lands = []
    for n, contact in enumerate(contacts):
        k = int(np.searchsorted(touches, n))
        passes = _flow_outwards(n, touches, outwards, fixed_pressures)
        lands.append(LandFlow(pressure[k], pressure[k + (n in touches)], abs(passes)))
        parts.setdefault(n, np.full(contact.points, pressure[k]))
    # what arrives at places without pressure
    inflow = [-outwards[0], *(a - b for a, b in pairwise(outwards)), outwards[-1]]
    leaves = sum(max(flow, 0.0) for flow, p in zip(inflow, pressure, strict=True) if p == 0.0)
    most = max(results, key=lambda result: result.leak_rate).scaled(leaves)
    drop = abs(inner - outer)
    return replace(
        most,
        resistance=drop / leaves if leaves > 0.0 else math.inf,
        fluid_pressure=np.concatenate([parts[n] for n in range(len(contacts))]),
        lands=tuple(lands),
    )


def chamber_pressures(
    flows: Sequence[Flow], inner: float, outer: float, fixed_pressures: Sequence[float | None]
) -> FloatArray:
    """Pressures in the chambers between contacts in series.

    Parameters
    ----------
    flows : sequence of callable
        Flow through each contact from a pressure on its inner to one on its outer side [Pa], from the axis outwards;
        negative inwards, it rises with the former.
    inner, outer : float
        Pressures at both ends [Pa].
    fixed_pressures : sequence of float or None
        Pressure in each chamber, one less than there are contacts; None where it follows from the flow [Pa].

    Returns
    -------
    ndarray, shape (len(flows) - 1,)
        [Pa]. Where contacts seal, the pressure falls at those alone, evenly.

    Raises
    ------
    ProfileError
        If they are not found.

    Examples
    --------
    Two resistances, of which the inner one is three times the other:

    >>> resistances = [lambda a, b: (a - b) / 3e12, lambda a, b: (a - b) / 1e12]
    >>> f"{chamber_pressures(resistances, 4e5, 0.0, [None])[0]:.6f}"
    '100000.000000'
    """
    ends = [inner, *fixed_pressures, outer]
    places = [n for n, p in enumerate(ends) if p is not None]
    pressures: list[float] = []
    for begin, end in pairwise(places):
        pressures += [
            *_inner_pressures(flows[begin:end], float(ends[begin] or 0.0), float(ends[end] or 0.0)),
            ends[end] or 0.0,
        ]
    return np.array(pressures[:-1])


def _inner_pressures(flows: Sequence[Flow], first: float, last: float) -> list[float]:
    """Pressures between contacts in series, of which none is given."""
    if len(flows) == 1 or first == last:
        return [first] * (len(flows) - 1)
    total = np.array([flow(first, last) for flow in flows])
    share = (total == 0.0).astype(float) if (total == 0.0).any() else 1.0 / total
    p = first + (last - first) * np.append(0.0, np.cumsum(share / share.sum()))
    if (total == 0.0).any():
        return [float(value) for value in p[1:-1]]
    low, high = min(first, last), max(first, last)
    p[-1], step = last, _STEP * (high - low)
    for _ in range(MOST_STEPS):
        flow = np.array([f(a, b) for f, (a, b) in zip(flows, pairwise(p.tolist()), strict=True)])
        imbalance = flow[:-1] - flow[1:]
        if np.abs(imbalance).max() <= _CLOSE * np.abs(flow).max():
            break
        slope = np.zeros((len(imbalance), len(imbalance)))
        for n in range(len(imbalance)):
            shift = -step if p[n + 1] + step > high else step
            at = float(p[n + 1] + shift)
            change = np.zeros(len(flow))
            change[n] = flows[n](float(p[n]), at) - flow[n]
            change[n + 1] = flows[n + 1](at, float(p[n + 2])) - flow[n + 1]
            slope[:, n] = (change[:-1] - change[1:]) / shift
        new = p[1:-1] - np.linalg.solve(slope, imbalance)
        # at most half of the way to an end
        new = np.where(new < low, 0.5 * (low + p[1:-1]), np.where(new > high, 0.5 * (high + p[1:-1]), new))
        is_at_rest = np.abs(new - p[1:-1]).max() <= ROUND_OFF * high
        p[1:-1] = new
        if is_at_rest:
            break
    else:
        raise ProfileError("the pressures in the chambers between the contacts were not found")
    return [float(value) for value in p[1:-1]]


def _flow_outwards(
    n: int, touches: Sequence[int], outwards: Sequence[float], fixed_pressures: Sequence[float | None]
) -> float:
    """Flow outwards through a contact [m^3/s]; through one that is open that of the next ones which touch.

    Between two places that are held at one pressure nothing has to flow.
    """
    k = int(np.searchsorted(touches, n))
    if n in touches:
        return outwards[k]
    if k > 0 and not any(p is not None for p in fixed_pressures[touches[k - 1] : n]):
        return outwards[k - 1]
    if k < len(touches) and not any(p is not None for p in fixed_pressures[n : touches[k]]):
        return outwards[k]
    return 0.0


def _chamber_pressures(fixed_pressures: Sequence[float | None]) -> float | None:
    """Pressure of chambers that are open to each other [Pa]; None where it follows from the flow."""
    pressures = sorted({p for p in fixed_pressures if p is not None})
    if len(pressures) > 1:
        raise ProfileError(
            f"a land does not touch, so that places held at {pressures[0]:.6g} Pa and at {pressures[-1]:.6g} Pa are "
            "open to each other: press harder, or set the land less far back"
        )
    return pressures[0] if pressures else None
