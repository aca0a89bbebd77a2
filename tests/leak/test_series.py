"""Contacts in series against closed forms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from leak import LeakResult, ProfileError
from leak.flow.series import SeriesContact, chamber_pressures, in_series

Flow = Callable[[float, float], float]


def viscous_gas(resistance: float) -> Flow:
    """Flow of an ideal gas in the continuum."""
    return lambda a, b: (a * a - b * b) / resistance


def with_slip(resistance: float, slip: float) -> Flow:
    """The same with slip."""
    return lambda a, b: (a * a - b * b + 2 * slip * (a - b)) / resistance


def liquid(resistance: float, points: int = 3) -> SeriesContact:
    """A contact with a resistance [Pa s/m^3]."""

    def leak(inner: float, outer: float) -> LeakResult:
        drop = abs(inner - outer)
        return LeakResult(drop / resistance, resistance, np.linspace(inner, outer, points))

    return SeriesContact(leak, points)


def test_squares_of_gas_pressures_fall_by_the_resistances() -> None:
    R = np.array([3.0, 1.0, 7.0])
    found = chamber_pressures([viscous_gas(one) for one in R], 4e5, 1e5, [None, None])
    assert found == pytest.approx(np.sqrt(16e10 - 15e10 * np.cumsum(R)[:-1] / R.sum()), rel=1e-12)


@given(
    st.lists(st.floats(-6, 6), min_size=2, max_size=5),
    st.floats(2, 8),
    st.floats(0, 1),
    st.floats(-3, 3),
    st.booleans(),
)
def test_as_much_flows_through_every_contact(
    logs: list[float], log_high: float, share: float, log_slip: float, turned: bool
) -> None:
    high = 10.0**log_high
    ends = (share * 0.99 * high, high) if turned else (high, share * 0.99 * high)
    flows = [with_slip(10.0**one, 10.0 ** (log_slip + n) * high) for n, one in enumerate(logs)]
    p = [ends[0], *chamber_pressures(flows, *ends, [None] * (len(logs) - 1)), ends[1]]
    found = [flow(p[n], p[n + 1]) for n, flow in enumerate(flows)]
    # a chamber whose pressure differs from that beside it by round-off alone
    lost = [1e-15 * high * abs(flow(high, 0.0)) / high for flow in flows]
    assert np.ptp(found) <= 1e-10 * abs(found[0]) + 10 * max(lost)
    assert all(min(ends) <= one <= max(ends) for one in p)


def test_pressures_that_are_given_part_the_series() -> None:
    R = [2.0, 3.0, 5.0, 7.0]
    flows = [lambda a, b, r=one: (a - b) / r for one in R]
    assert chamber_pressures(flows, 10.0, 0.0, [None, 4.0, None]).tolist() == pytest.approx(
        [10 - 6 * 2 / 5, 4.0, 4 - 4 * 5 / 12], rel=1e-12
    )


def test_the_pressure_falls_where_contacts_seal() -> None:
    def sealed(a: float, b: float) -> float:
        return 0.0

    open_ = viscous_gas(1.0)
    assert chamber_pressures([open_, sealed, open_], 4e5, 0.0, [None, None]).tolist() == [4e5, 0.0]
    assert chamber_pressures([sealed, sealed, open_], 4e5, 0.0, [None, None]).tolist() == [2e5, 0.0]


def test_leaves_is_what_gets_out() -> None:
    lands = [liquid(1e12), liquid(3e12)]
    sealed = in_series(lands, 4e5, 0.0, [None])
    assert sealed.leak_rate == pytest.approx(1e-7) and sealed.resistance == pytest.approx(4e12)
    vented = in_series(lands, 4e5, 0.0, [0.0])
    assert vented.leak_rate == pytest.approx(4e-7)
    barrier = in_series(lands, 4e5, 0.0, [6e5])
    assert barrier.leak_rate == pytest.approx(2e-7)
    assert [one.leak_rate for one in barrier.lands] == pytest.approx([2e-7, 2e-7])
    # from outside inwards
    assert in_series(lands, 0.0, 4e5, [None]).leak_rate == pytest.approx(1e-7)


def test_a_contact_that_does_not_touch_resists_nothing() -> None:
    lands = [liquid(1e12), SeriesContact(None, 4), liquid(3e12)]
    found = in_series(lands, 4e5, 0.0, [None, None])
    assert found.leak_rate == pytest.approx(1e-7)
    assert found.lands[1].leak_rate == found.lands[0].leak_rate and len(found.fluid_pressure) == 10
    assert found.fluid_pressure[3:7] == pytest.approx(3e5)
    with pytest.raises(ProfileError, match="does not touch"):
        in_series([SeriesContact(None, 3), liquid(1e12)], 4e5, 0.0, [1e5])


@pytest.mark.parametrize(
    ("touching", "ends", "given", "flows"),
    [
        # one after the other as much flows through all, from either side
        ((False, True, True), (4e5, 0.0), [None, None], [1e-7, 1e-7, 1e-7]),
        ((True, True, False), (0.0, 4e5), [None, None], [1e-7, 1e-7, 1e-7]),
        ((False, True, False), (4e5, 0.0), [None, None], [4e-7, 4e-7, 4e-7]),
        # what is let out before an open land does not get to it, what is let out behind it does
        ((True, False, True), (4e5, 0.0), [0.0, None], [4e-7, 0.0, 0.0]),
        ((True, False, True), (4e5, 0.0), [None, 0.0], [4e-7, 4e-7, 0.0]),
        # a port feeds the land beyond
        ((True, False, True), (4e5, 0.0), [6e5, None], [2e-7, 2e-7, 2e-7]),
        ((True, True, False), (4e5, 0.0), [None, 0.0], [1e-7, 1e-7, 0.0]),
    ],
)
def test_an_open_land_passes_what_those_beside_it_let_through(
    touching: tuple[bool, ...], ends: tuple[float, float], given: list[float | None], flows: list[float]
) -> None:
    resistances = iter([1e12, 3e12])
    lands = [liquid(next(resistances)) if one else SeriesContact(None, 3) for one in touching]
    found = in_series(lands, *ends, given)
    assert [one.leak_rate for one in found.lands] == pytest.approx(flows, rel=1e-9)
