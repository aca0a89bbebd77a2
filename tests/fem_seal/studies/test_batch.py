"""Designs side by side find what each finds alone, fail alone, and are timed alone."""

import math
import threading
import time
from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import fem_seal
from fem_seal.contact.laws import ScaledLaw
from fem_seal.contact.newton import ContactProblem, solve, solve_many
from fem_seal.errors import ConvergenceError
from fem_seal.seal.evaluate import Batch
from fem_seal.studies.time_limit import Block, Watch
from leak import ExponentialLaw, PowerSpectrum, RoughContact

STEEL = fem_seal.Material("steel", 210e9, 0.3)
SPECTRUM = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)


@pytest.fixture(scope="module")
def model():
    import meshes

    ball = meshes.Ball(0.02)
    sizing = meshes.Sizing(2e-5, 1e-4, (-1e-3, 1e-3), 0.2, 0.3, 4e-3)
    mesh = meshes.build(ball, meshes.ConicalSeat.around(0.785, ball), sizing)
    return fem_seal.condense(mesh, {"closure": STEEL, "seat": STEEL})


@pytest.fixture(scope="module")
def laws():
    """Of one shape, from smooth to rough."""
    shape = RoughContact(SPECTRUM, effective_modulus=115e9).interface_law()
    return [ScaledLaw(shape, height, math.log(1.1 * height)) for height in (0.1, 0.5, 1.0, 1.7, 3.0)]


@pytest.mark.parametrize("shapes", [1, 3])
def test_contacts_that_are_solved_together_are_those_of_each_alone(model, laws, shapes):
    if shapes > 1:
        other = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.6, q_low=1e4, q_rolloff=2e4, q_high=1e6)
        rougher = RoughContact(other, effective_modulus=115e9).interface_law()
        laws = [*laws, rougher, ScaledLaw(rougher, 0.5, 0.1), ExponentialLaw(p_c=5e9, u0=0.76e-6)]
    pressings = [
        ContactProblem(model, law, force)
        for force in (200.0, 1257.0, 5e3)
        for law in laws[:: 1 if force > 1e3 else 2]
    ]
    found = solve_many(pressings)
    assert len({one.iterations for one in found}) > 1
    for one, asked in zip(found, pressings, strict=True):
        own = solve(asked.model, asked.law, contact_force=asked.contact_force)
        assert np.array_equal(one.log_pressure, own.log_pressure)
        assert np.array_equal(one.gap, own.gap)
        assert (one.approach, one.residuals) == (own.approach, own.residuals)
        assert abs(one.force_error) < 1e-9


def test_a_contact_that_has_no_solution_leaves_the_others_theirs(model, laws):
    stiff = replace(laws[0], height=1e-4)
    needed = max(solve(model, law, contact_force=1257.0).iterations for law in laws[1:3])
    settings = fem_seal.ContactSettings(max_iterations=needed + 1)
    first, never, last = solve_many(
        [ContactProblem(model, law, 1257.0, settings=settings) for law in (laws[2], stiff, laws[1])]
    )
    assert isinstance(never, ConvergenceError)
    assert f"did not converge in {needed + 1} iterations" in str(never)
    for one, law in ((first, laws[2]), (last, laws[1])):
        own = solve(model, law, contact_force=1257.0, settings=settings)
        assert np.array_equal(one.log_pressure, own.log_pressure)


def test_a_design_fails_alone():
    batch = Batch()
    assert batch.map(range(3), lambda number: 1.0 / (number - 1)) == {0: -1.0, 2: 1.0}
    assert isinstance(batch.failed[1], ZeroDivisionError)
    # and is left out from there on
    assert batch.map(range(3), lambda number: number) == {0: 0, 2: 2}


def test_an_error_in_common_work_is_the_affair_of_one():
    def inverses(asked):
        return [1.0 / one for one in asked]

    batch = Batch()
    found = batch.answer_together({3: 2.0, 5: 0.0, 8: 4.0}, inverses)
    assert (found[3], found[8]) == (0.5, 0.25)
    assert isinstance(found[5], ZeroDivisionError)
    assert batch.answer_together({}, inverses) == {}


def test_the_time_of_others_is_not_that_of_a_design(monkeypatch):
    turns, clock = [], SimpleNamespace(now=0.0)
    monkeypatch.setattr("fem_seal.seal.evaluate.time", SimpleNamespace(perf_counter=lambda: clock.now))

    @contextmanager
    def turn(number):
        turns.append(number)
        yield

    def takes(seconds):
        clock.now += seconds

    batch = Batch(turn)
    for _ in range(5):
        batch.map([0, 1], lambda number: takes(0.02 * number))
    assert batch.seconds == pytest.approx({0: 0.0, 1: 0.1})
    batch.answer_together({0: None, 1: None}, lambda asked: asked)
    assert turns == [0, 1] * 5 + [None]


def test_a_time_limit_counts_the_turns_of_a_block_alone():
    told = {"quick": threading.Event(), "slow": threading.Event()}
    blocks = {name: Block(lambda seconds: None, lambda ended, name=name: told[name].set()) for name in told}
    with Watch(0.4) as watch:
        for _ in range(12):
            for name, pause in (("quick", 0.005), ("slow", 0.06)):
                with watch.turn(blocks[name]):
                    time.sleep(pause)
    # 0.7 s all in all
    assert told["slow"].is_set()
    assert not told["quick"].is_set()


def test_quadrature_covers_each_cell_of_a_contact():
    from leak.flow.contact_profile import ContactProfile

    x = np.cumsum(np.random.default_rng(1).uniform(1e-6, 4e-6, 60))
    p = 5e7 * np.exp(-((x - x.mean()) ** 2) / (2 * 3e-5**2)) * (1 + 0.05 * np.sin(3e5 * x))
    profile = ContactProfile.through(x, p, np.full_like(x, 0.014))
    # all of the contact: f = 2 pi r is the length
    asked, weight, begin = profile.quadrature
    cells = np.add.reduceat(weight * 2 * math.pi * 0.014, begin)[1:-1]
    assert cells == pytest.approx(np.diff(x), rel=1e-12)
    assert len(asked) == len(weight)
    assert replace(profile, x=x[::2]).panels[1].log_pressure.shape[0] == 29


def test_workers_come_to_where_their_shares_meet():
    from fem_seal.studies.worker_pool import WorkQueue

    chunks = [object() for _ in range(12)]
    shares, place = WorkQueue(chunks, ["a", "b"]), {id(chunk): n for n, chunk in enumerate(chunks)}
    # b is twice as fast
    order = [(worker, place[id(shares.take_chunk(worker))]) for worker in "abb" * 4]
    assert sorted(n for _, n in order) == list(range(12))
    assert [n for worker, n in order if worker == "b"] == [11, 10, 9, 8, 7, 6, 5, 4]
    assert [n for worker, n in order if worker == "a"] == [0, 1, 2, 3]
    assert shares.take_chunk("c") is None


def test_points_that_follow_explicitly_cost_no_steps(model, laws, monkeypatch):
    from fem_seal.contact import newton

    settings = [fem_seal.ContactSettings(), fem_seal.ContactSettings(1e-6, 1e-6)]
    asked = [(law, one) for law in laws for one in settings]
    found = [solve(model, law, contact_force=1257.0, settings=one) for law, one in asked]
    monkeypatch.setattr(newton, "_LARGEST_SHARE", newton._LEAST_SHARE)
    for (law, one), fewer in zip(asked, found, strict=True):
        coupled = solve(model, law, contact_force=1257.0, settings=one)
        assert fewer.iterations <= coupled.iterations
        assert fewer.pressure.max() == pytest.approx(coupled.pressure.max(), rel=10 * one.gap_tolerance)
