"""The checks of one load where a conductivity table spares the search for what takes longer than a design."""

from __future__ import annotations

from dataclasses import replace

from fem_seal.seal.evaluate import Evaluation
from fem_seal.seal.findings import Validity
from fem_seal.seal.load_result import LoadResult
from fem_seal.seal.problem import SealProblem
from fem_seal.validity.checks import earlier_cautions, load_validity
from leak import ConductivityTable

# u_eff [m] above which u_c, which is of its size, need not be compared with molecules of half a nanometre.
_NARROW = 20e-9


def validity_by_table(problem: SealProblem, load: LoadResult) -> Validity:
    """How far the numbers of a load can be trusted, see `fem_seal.validity.checks.load_validity`.

    Parameters
    ----------
    problem, load
        See there.
    """
    table = None if load.rough is None or load.rough.flow is None else load.rough.table
    # a gas percolates where a liquid does
    table = getattr(table, "liquid", table)
    if problem.surface is None or not isinstance(table, ConductivityTable) or table.acting is not None:
        return load_validity(problem, load, problem.surface)
    # u_eff falls over the pressure: that of the next one in the table is a bound
    beyond = table.separation[table.pressure.searchsorted(load.peak_pressure) :]
    if len(beyond) and beyond[0] >= _NARROW:
        load = load.knowing(critical_separation=None)
    return load_validity(problem, load, problem.surface, sealing=table.sealing_pressure)


def validity_of(
    found: Evaluation, load: LoadResult, *, by_table: bool = True, usual_only: bool = False
) -> Validity:
    """How far the numbers of an evaluated load can be trusted, by its own checks and those of the load before it.

    Parameters
    ----------
    found : Evaluation
    load : LoadResult
        One of its loads, with what its mesh leaves uncertain where that is known.
    by_table : bool
        Whether the table may stand for the surface where bodies are shared.
    usual_only : bool
        Whether the range of a finish is left out.
    """
    problem, before = found.problem, found.solved.earlier
    if usual_only:
        problem = replace(problem, usual_only=True)
    if found.model.closure.solve is None:
        # without a way to stresses
        materials = {name: replace(one, yield_stress=None) for name, one in problem.materials.items()}
        problem = replace(problem, materials=materials)
    if by_table and found.seal_mesh is None:
        validity = validity_by_table(problem, load)
    else:
        validity = load_validity(problem, load, problem.surface, load.mesh_error)
    if before is None or problem.loads.earlier is None:
        return validity
    earlier = LoadResult(*problem.loads.earlier, before, mesh_error=load.mesh_error)
    return Validity.of((*validity.cautions, *earlier_cautions(problem, earlier)))
