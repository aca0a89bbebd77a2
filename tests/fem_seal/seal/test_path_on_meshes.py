"""Bodies that yield on a mesh that does not fit: the path is left there, said, and walked on the next mesh."""

from __future__ import annotations

import numpy as np
import pytest
from sample_results import case, cone

from fem_seal.contact import sizing as contact_sizing
from fem_seal.contact.load_path import PlaceOnPath
from fem_seal.errors import ConvergenceError
from fem_seal.seal import evaluate as module
from fem_seal.seal import load_solver
from fem_seal.seal.evaluate import evaluate
from fem_seal.seal.load_solver import Clock
from fem_seal.seal.problem import SealProblem, size_mesh
from meshes import MeshingError

SOFT = {
    "youngs_modulus": "210 GPa",
    "poissons_ratio": 0.3,
    "hardness": "1 GPa",
    "stress_strain": {"plastic_strain": [0, 0.2], "stress": ["40 MPa", "80 MPa"]},
}


def problem():
    # asperities so soft that few elements are enough
    law = {"law": "exponential", "u0": "5 um", "p_c": "1 GPa"}
    load = {"fluid_pressure": ["10 bar", "20 bar"]}
    return SealProblem.of(case(seat=cone(SOFT), interface=law, load=load))


@pytest.fixture
def wanted_twice(monkeypatch):
    """A first mesh that no contact fits, and the numbers of the loads that are asked for on each mesh."""
    first, better = size_mesh(problem()), contact_sizing.better_sizing
    found, solved = list[list[str]](), module.solve_loads

    def unfit(own, contact, profiles, **more):
        return own.refined(1.25) if own == first else better(own, contact, profiles, **more)

    def counted(solver, *arguments, **more):
        result = solved(solver, *arguments, **more)
        found.append(
            [*map(str, range(len(result.contacts))), *(["unloaded"] if result.unloaded_bodies else [])]
        )
        return result

    monkeypatch.setattr(contact_sizing, "better_sizing", unfit)
    monkeypatch.setattr(module, "solve_loads", counted)
    return found


def peaks(found):
    return [contact.profile.peak_pressure for contact in found.solved_loads.contacts]


def test_a_path_on_a_mesh_that_does_not_fit_is_left_after_its_first_load(wanted_twice):
    told = []
    found = evaluate(problem(), clock=Clock(told.append))
    assert wanted_twice == [["0"], ["0", "1", "unloaded"]]
    (anew,) = [text for text in told if "does not fit this mesh" in text]
    assert anew.endswith("from the first load on")
    estimates = [text for text in told if text.startswith("solving 2 contacts")]
    assert len(estimates) == 2 and all(": some seconds" in text for text in estimates)
    # as if the second mesh had been the first
    whole = load_solver.LoadSolver.on_mesh(problem(), size_mesh(problem()).refined(1.25))
    alone = load_solver.solve_loads(whole)
    np.testing.assert_allclose(
        peaks(found), [one.profile.peak_pressure for one in alone.contacts], rtol=1e-12
    )


def test_where_the_next_mesh_cannot_be_made_the_loads_go_on_on_the_first(wanted_twice, monkeypatch):
    source = type(module.OWN_BODIES)
    bodies, asked = source.bodies, []

    def once(self, *arguments):
        asked.append(1)
        if len(asked) > 1:
            raise MeshingError("no triangles")
        return bodies(self, *arguments)

    monkeypatch.setattr(source, "bodies", once)
    found = evaluate(problem())
    assert wanted_twice == [["0"], ["0", "1", "unloaded"]]
    assert found.solved_loads.unloaded_bodies is not None and len(peaks(found)) == 2


def test_a_load_that_does_not_converge_begins_anew_without_unloading(wanted_twice, monkeypatch):
    to, told = load_solver.load_path.__globals__["_Walk"].reach, []
    first = len(size_mesh(problem()).contact_vertices(problem().contact.breaks))

    def failing(self, end, begin, here, number=None, passed=None):
        if number == 1 and len(self.model.line.vertices) == first:
            raise ConvergenceError("no luck")
        assert not (number == 2 and len(self.model.line.vertices) == first)  # that would be unloading in vain
        return to(self, end, begin, here, number, passed)

    monkeypatch.setattr(contact_sizing, "better_sizing", lambda *arguments, **more: None)
    monkeypatch.setattr(load_solver.load_path.__globals__["_Walk"], "reach", failing)
    found = evaluate(problem(), clock=Clock(told.append))
    assert len(peaks(found)) == 2 and found.solved_loads.unloaded_bodies is not None
    assert sum("a load does not converge on this mesh" in text for text in told) == 1


@pytest.mark.parametrize(
    ("place", "share"), [(PlaceOnPath(1, 0.5, 8, 0.06), 1.5 / 4), (PlaceOnPath(3, 0.0, 0, 0.06), 3 / 4)]
)
def test_the_time_that_is_left_is_that_of_the_way_at_the_pace_so_far(place, share, monkeypatch):
    """Three loads and unloading, a minute so far."""
    now, told = [0.0], list[str]()
    monkeypatch.setattr(load_solver.time, "monotonic", lambda: now[0])
    way = [(n, (1e5, 0.0)) for n in range(3)]
    tell = load_solver._progress_teller(told.append, way, "before", 3, unload=True)
    now[0] = 60.0
    tell(place)
    left = told[0].split("; about ")[1].removesuffix(" left on this mesh").split()
    # a number of seconds is rounded to tens, one of minutes to one
    assert float(left[0]) * {"s": 1, "min": 60}[left[1]] == pytest.approx(60.0 * (1 / share - 1), rel=0.25)
