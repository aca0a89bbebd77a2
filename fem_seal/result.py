"""`run` solves a case, `direct` simulates its surface; a `SealResult` has tables and files."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import fields, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from fem_seal.answers import opening, target
from fem_seal.answers.chain import solve, solve_map
from fem_seal.answers.solution import SealSolution
from fem_seal.arrays import FloatArray
from fem_seal.case.case import CaseSource, case_of
from fem_seal.errors import InputError, errors_in
from fem_seal.processes import returned_memory
from fem_seal.seal.problem import problems_of

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from fem_seal.answers.calibration import Calibration
    from fem_seal.case.tables import Asperities
    from fem_seal.seal.direct import DirectTable
    from fem_seal.seal.direct_seal import SealRow


# What completion does not offer: steps of the calculation.
_INTERNAL = {"every_load", "load_problems", "missing_load_findings", "with_answers", "with_loads"}


class SealResult(SealSolution):
    """Everything that a case gave.

    Parameters
    ----------
    case : Case
        Without the loads that could not be calculated.
    problem : SealProblem
        The same as the calculation knows it; `surface` is its RoughContact, None without roughness.
    seal_mesh : SealMesh
    model : ContactModel
    loads : tuple of CaseLoad
        In the order of the case, with what is said of each; `verdicts` is what is claimed.
    unloaded : UnloadedBodies or None
        Residual stress and imprint after the last load; None if both bodies are elastic.
    earlier : ContactSolution or None
        At the largest load before those of the case; None without one.
    answers : mapping
        All that was asked of the seal, by name; the following are some of them.
    discretisation_error : DiscretisationError
    far_field : tuple of Comparison
        What another housing and another support of its wall do to the strongest load.
    form : FormAnswers or None
        What the form error means at the highest load; None for a round seal.
    particles : tuple of ParticleAnswers
        What particles in the fluid do to the leak of each load that leaks, if the case has [fluid.particles].
    compression : Compression or None
        Line load and compression of a gasket along its loads, and its springback; None for a valve seat.
    interface_variants : tuple of Comparison
        Elastic and plastic p(u), for `law = "spectrum"` with a hardness, of a run with `full`; else empty.
    uncertainty : LeakInterval or None
        Leak rates with an interval, if the case has a table [uncertainty].
    judgement : SealVerdict or None
        Whether the seal keeps what [requirement] asks of it; `verdict` and `margin` are its short form.
    sensitivities : tuple of Sensitivity
        What changes the leak rate, the strongest first, if asked for.
    warnings : tuple of str
        Everything to know before believing the result, the worst first; each load's `validity` says what it means.
    timings : dict
        Wall time of each step [s].

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> result = fem_seal.run(case)
    >>> result.loads[0].leak is None
    True
    >>> [round(force) for force in result["contact_force"]]
    [1257]
    >>> list(result.table.columns[:3])
    ['fluid_pressure_Pa', 'applied_force_N', 'contact_force_N']
    """

    def __repr__(self) -> str:
        from fem_seal.output.notebook import result_text

        return f"<{type(self).__name__} of {result_text(self)}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the table of the loads, leak rates and pressure profiles."""
        from fem_seal.output.notebook import result_html

        return result_html(self)

    def __dir__(self) -> list[str]:
        return sorted(
            name for name in super().__dir__() if not name.startswith("_") and name not in _INTERNAL
        )

    def __getitem__(self, name: str) -> pd.Series[Any]:
        """A column of the table, with or without its unit: ``result["leak_rate"]``; KeyError if there is none."""
        from fem_seal.output.columns import column_named

        return self.table[column_named(name, self.table.columns, self.case)]

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row per load, the columns of leak.csv: those that belong to the tables of the case."""
        from fem_seal.output.tables import leak_table

        return leak_table(self)

    @cached_property
    def all_columns(self) -> pd.DataFrame:
        """The same with every column that there is, also those that stay empty in this case or repeat another one."""
        from fem_seal.output.tables import leak_table

        return leak_table(self, all_columns=True)

    @property
    def mesh(self) -> Any:
        """Of a map of contact pressure: triangles with what presses and flows, for pyvista; of several loads blocks.

        Names of the arrays end in the unit, such as ``contact_pressure_Pa``.
        """
        import pyvista

        from fem_seal.output.pressure_map import arrays_of

        blocks = []
        for points, triangles, of_points, of_cells in map(arrays_of, self.loads):
            blocks.append(pyvista.PolyData.from_regular_faces(points, triangles))
            blocks[-1].point_data.update(of_points)
            blocks[-1].cell_data.update(of_cells)
        return blocks[0] if len(blocks) == 1 else pyvista.MultiBlock(blocks)

    def write(self, folder: str | os.PathLike[str], *, full: bool = False, all_columns: bool = False) -> Path:
        """Write tables, summary, VTK files, mesh and report into a folder, all of them or none.

        They take the places of those of an earlier run together; a file ``UNFINISHED.txt`` stands in the folder
        meanwhile, and stays there only if the process is killed in these milliseconds.

        A file that cannot be made does not keep the others from being written; a Python warning names it.

        Parameters
        ----------
        folder : path
            Made if it does not exist.
        full : bool
            Whether the report has all numbers, pictures and tables.
        all_columns : bool
            Whether leak.csv and summary.json have every column, as `all_columns` has.

        Raises
        ------
        InputError
            If another process writes into the folder.
        OutputError
            If a file cannot be written.
        """
        import warnings

        from fem_seal.output.files import write
        from fem_seal.output.folders import folder_lock

        with folder_lock(Path(folder)), returned_memory():
            for failure in write(self, Path(folder), full=full, all_columns=all_columns):
                warnings.warn(failure, stacklevel=2)
        return Path(folder)

    def report(self, path: str | os.PathLike[str], *, full: bool = False) -> Path:
        """Write the report alone: one HTML page that needs no other file.

        Parameters
        ----------
        path : path
            Of the file, such as ``"report.html"``.
        full : bool
            With all numbers, pictures and tables; otherwise what decides, on a page that is read in some minutes.

        Raises
        ------
        OutputError
            If the file cannot be written.
        """
        from fem_seal.output.report.page import write_report

        with returned_memory():
            return write_report(self, Path(path), full=full)

    @overload
    def plot(self, what: Figure | None = None, *, figure: Figure | None = None) -> Figure: ...

    @overload
    def plot(self, what: str, ax: Axes | None = None) -> Axes: ...

    def plot(
        self, what: str | Figure | None = None, ax: Axes | None = None, *, figure: Figure | None = None
    ) -> Axes | Figure:
        """Draw the leak rate and the pressure profiles over the loads, or one picture by its name.

        Parameters
        ----------
        what : str or matplotlib.figure.Figure, optional
            "leak": leak rate over the loads, with its interval. "contact": pressure profiles. "gap": mean gap between
            the surfaces. "around": leak, or else line load, around the axis of a seal that is not round. "surface":
            power spectrum of the roughness. "sensitivities": what changes the leak rate most. "map": where a given map
            of contact pressure leaks. Without a name "leak" and "contact" or "map" side by side, in a figure if one is
            given.
        ax : matplotlib.axes.Axes, optional
            To draw the named picture into; those of a new figure unless given.
        figure : matplotlib.figure.Figure, optional
            To draw both into, such as `matplotlib.pyplot.figure()` for a window; a new one unless given.

        Returns
        -------
        matplotlib.axes.Axes or matplotlib.figure.Figure
            The axes of a named picture, the figure of both. A notebook shows either; ``savefig`` of the figure, or of
            ``axes.figure``, writes a file.

        Raises
        ------
        InputError
            If there is no picture of that name, or nothing to show in it.

        Examples
        --------
        >>> import fem_seal
        >>> case = fem_seal.Case(
        ...     closure=dict(shape="ball", radius=0.02, material="steel"),
        ...     seat=dict(shape="cone", angle="45 deg", material="steel"),
        ...     interface=dict(law="smooth"),
        ...     load=dict(fluid_pressure=["5 bar", "20 bar"]),
        ... )
        >>> result = fem_seal.run(case)
        >>> result.plot("contact").get_ylabel()
        'contact pressure  [MPa]'
        >>> [axes.get_title(loc="left") for axes in result.plot().axes]
        ['Contact pressure']
        >>> result.plot().savefig("seal.png")  # doctest: +SKIP
        """
        from fem_seal.output.plots import plot, result_figure

        if ax is None and (what is None or not isinstance(what, str)):
            return result_figure(self, what or figure)
        return plot(self, what if isinstance(what, str) else None, ax)

    def view(self, png: str | os.PathLike[str] | None = None, load: int | None = None) -> None:
        """Show the seal in space, cut open, with the contact pressure on the seat's face.

        Parameters
        ----------
        png : path, optional
            Draw into this file; no display is needed. Unless given, a window opens, with a slider over the loads, and
            stays until it is closed.
        load : int, optional
            Number of the load, from 1; the last one unless given.

        Raises
        ------
        InputError
            If there is no such load.
        DrawingError
            If there is no display for a window, or VTK cannot draw on this machine.
        OutputError
            If the file cannot be written.

        Examples
        --------
        >>> result.view()  # doctest: +SKIP
        >>> result.view("seal.png", load=1)  # doctest: +SKIP
        """
        from fem_seal.output.pictures.three_d import view, write_for_view

        with TemporaryDirectory(prefix="fem-seal-") as folder:
            write_for_view(self, Path(folder))
            view(Path(folder), None if png is None else Path(png), load, self.case.display)


def leak_of_pressure_map(
    source: Any,
    case: CaseSource,
    progress: Callable[[str], None] | None = None,
    *,
    field: str | None = None,
    gap_field: str | None = None,
    columns: str | None = None,
    pressure_unit: str | None = None,
    length_unit: str | None = None,
    axis: str | None = None,
) -> SealResult:
    """Leak rate of a map of contact pressure from any finite-element program, over a face of any shape.

    Parameters
    ----------
    source : str, pathlib.Path, pyvista.DataSet or meshio.Mesh
        A mesh with the contact pressure on its points or cells (VTK, gmsh, MED, XDMF, Exodus), a table of points, or
        a mesh of pyvista or meshio.
    case : Case, path or mapping
        With materials, roughness, fluid and load; closure and seat need no shapes.
    progress : callable, optional
        Called with a status message before each step.
    field, gap_field : str, optional
        Names of the contact pressure and of the gap; found unless given.
    columns : str, optional
        Of a table: names and units of its columns.
    pressure_unit, length_unit : str, optional
        Where the file has none.
    axis : {"x", "y", "z"}, optional
        Around which points of a table are unrolled; found unless given.

    Returns
    -------
    SealResult
        Its `table` has a row for each step and fluid pressure, its mesh says what flows where; there are no bodies.

    Raises
    ------
    InputError
        If the file is no such map, or does not tell its units or where the fluid stands; the message says what to give.

    Examples
    --------
    >>> found = fem_seal.leak_of_pressure_map("wedge.vtu", "wedge.toml")     # doctest: +SKIP
    >>> found.table[["step", "leak_rate_m3_per_s"]]                          # doctest: +SKIP
    >>> found.mesh.plot(scalars="contact_pressure_Pa")                       # doctest: +SKIP
    """
    from fem_seal.answers.map_files import MapOptions, read_map

    case = case_of(case)
    options = MapOptions(field, gap_field, columns, pressure_unit, length_unit, axis)
    with TemporaryDirectory(prefix="fem-seal-") as folder, returned_memory(), errors_in(case.display):
        if not isinstance(source, (str, os.PathLike)):
            mesh = (
                source.cast_to_unstructured_grid() if hasattr(source, "cast_to_unstructured_grid") else source
            )
            (mesh.write if mesh is source else mesh.save)(path := Path(folder) / "mesh.vtu")
            source = path
        solution = solve_map(case, read_map(source, options, case.hardness), progress)
    return SealResult(**{one.name: getattr(solution, one.name) for one in fields(solution)})


def run(
    case: CaseSource,
    progress: Callable[[str], None] | None = None,
    *,
    sensitivities: bool | None = None,
    verdict_force: bool | None = None,
    full: bool = False,
) -> SealResult:
    """Solve every load of a case.

    Parameters
    ----------
    case : Case, path or mapping
        Itself, its file or its tables, as `load_case` takes them.
    progress : callable, optional
        Called with a status message before each step.
    sensitivities : bool, optional
        Whether to look for what changes the leak rate most; with a requirement unless given, not where a body yields:
        there it takes as long as some twenty paths of loads.
    verdict_force : bool, optional
        Whether to look for the force with which the verdict passes, of a case with a target leak rate: unless given,
        not where a body yields. It takes some ten contacts, and two to four times the mesh, its error and the samples
        of the case; where a body yields each of these is a whole path of loads.
    full : bool
        Whether to calculate what only the full report and `all_columns` show: the leak rates by the theory that the
        case does not use, and of ``law = "spectrum"`` those with elastic and plastic p(u).

    Returns
    -------
    SealResult
        In SI units: pressures [Pa], gaps [m], leak rates [m^3/s]. Loads that cannot be calculated - they open the seal,
        are more than the faces or a body that yields carry, or do not converge - are not among its `loads`; a row of
        its table without numbers and a warning say why. What comes after contact and leak and fails is told in a
        warning: stress, error estimate, answers, variants, interval.

    Raises
    ------
    NoLoadLeftError
        If no load can be calculated.
    GeometryError
        If the bodies do not fit together.
    MeshingError
        If gmsh cannot be loaded or fails.
    ConvergenceError
        If no contact converges.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> result = fem_seal.run(case)
    >>> print(f"{result.loads[0].contact.profile.peak_pressure / 1e6:.0f} MPa")
    192 MPa
    """
    case = case_of(case)
    with returned_memory(), errors_in(case.display):
        solution = solve(case, progress, sensitivities=sensitivities, verdict_force=verdict_force, full=full)
    return SealResult(**{field.name: getattr(solution, field.name) for field in fields(solution)})


def calibrate(
    case: CaseSource,
    measured: str | os.PathLike[str] | pd.DataFrame,
    progress: Callable[[str], None] | None = None,
) -> Calibration:
    """What measured leak rates say about a seal: its uncertain inputs, its leak rates, conflicts, the next test.

    Parameters
    ----------
    case : Case, path or mapping
        With roughness and fluid; its loads are predicted, its uncertain inputs narrowed.
    measured : path or DataFrame
        Readings, see `fem_seal.case.measured.read_measured`.
    progress : callable, optional
        Called with a status message before each step.

    Raises
    ------
    InputError
        If a reading is wrong, or a load of the case or of a reading cannot be calculated.

    Examples
    --------
    >>> found = fem_seal.calibrate("seal.toml", "measured.csv")  # doctest: +SKIP
    >>> found.predictions[-1].posterior  # doctest: +SKIP
    (9.6e-07, 1.1e-06, 1.3e-06)
    """
    from fem_seal.answers import calibration
    from fem_seal.case.measured import read_measured, read_measured_text

    case = case_of(case)
    if isinstance(measured, (str, os.PathLike)):
        readings = read_measured(case, Path(measured))
    else:
        readings = read_measured_text(case, measured.to_csv(index=False))
    with returned_memory():
        return calibration.calibrate(case, readings, progress or (lambda text: None))


def applied_force_for_leak(case: CaseSource, target_leak_rate: float | None = None) -> FloatArray:
    """Smallest force of spring or actuator for which the leak rate stays below a target, at each fluid pressure.

    Parameters
    ----------
    case : Case, path or mapping
        With roughness and fluid.
    target_leak_rate : float, optional
        [m^3/s], of a gas at 101325 Pa and its temperature; the case's own target unless given.

    Returns
    -------
    ndarray, shape (loads,)
        [N], positive where it closes. Negative where the fluid alone closes more than is needed.

    Raises
    ------
    InputError
        If the case has no leak rate or no target, if even the largest force that keeps strains small leaks more, or if
        hardly any force is needed.
    ConvergenceError

    Examples
    --------
    >>> fem_seal.applied_force_for_leak(case, 1e-9)     # doctest: +SKIP
    array([312.6])
    """
    loads = target.contacts_at_target(problems_of(case_of(case)), target_leak_rate)
    return np.array([load.applied_force for load in loads])


def blow_off_pressures(case: CaseSource) -> FloatArray:
    """Fluid pressure at which the seal opens under the force of spring or actuator of each load [Pa], shape (loads,).

    Infinite where the fluid does not lift the closure. With closing = "sealed-area" this is the force over the area of
    the circle of first touch; with "penetration" the fluid's own way between the surfaces decides.

    Parameters
    ----------
    case : Case, path or mapping
        Its fluid pressures only size the mesh.

    Raises
    ------
    ConvergenceError

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> against = case.replace({"load.pressure_side": "inner", "load.applied_force": 2000.0})
    >>> print(f"{fem_seal.blow_off_pressures(against)[0] / 1e5:.1f} bar")
    31.8 bar
    """
    problems = problems_of(case_of(case))
    return np.asarray(np.min([opening.blow_off_pressures(problem) for problem in problems], axis=0))


def direct(
    case: CaseSource,
    *,
    folder: str | os.PathLike[str] | None = None,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
) -> DirectTable:
    """Simulate rough contact and flow of a case's surface directly, as `fem-seal direct` does.

    Parameters
    ----------
    case : Case, path or mapping
        Its [direct] says how; without that table the settings are the usual ones.
    folder : path, optional
        Where finished pieces are kept and looked for; that of [direct] unless given.
    jobs : int
        Processes; a script that asks for more than one needs ``if __name__ == "__main__":``.
    progress : callable, optional
        Told in words how far it is.

    Returns
    -------
    DirectTable
        `rows`, one for each pressure, with the samples' means and scatter and the theory beside them.

    Raises
    ------
    InputError
        The case has no roughness, or the grid holds none of it.
    LeakError
        A contact does not converge, or a measured map cannot be used.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     roughness={"spectrum": {
    ...         "kind": "self-affine", "rms_height": "1 um", "hurst": 0.8,
    ...         "q_low": "1e4 1/m", "q_rolloff": "5e4 1/m", "q_high": "1e6 1/m",
    ...     }},
    ...     leak={"plasticity": False},
    ...     load={"fluid_pressure": "20 bar"},
    ...     direct={"points": 64, "samples": 2, "pressure": ["50 MPa", "200 MPa"]},
    ... )
    >>> low, high = fem_seal.direct(case).rows
    >>> low.effective_gap > high.effective_gap > 0.0
    True
    """
    from fem_seal.seal.direct import BulkPath
    from fem_seal.seal.evaluate import evaluate
    from fem_seal.seal.problem import SealProblem, direct_settings
    from fem_seal.seal.rough_faces import rough_contact

    case, tell = case_of(case), progress or (lambda text: None)
    surface = rough_contact(case)
    if surface is None:
        raise InputError.at("roughness", "there is no surface to simulate; add the table", file=case.file)
    settings = direct_settings(case)
    if folder is not None:
        settings = replace(settings, folder=Path(folder))
    strained = None
    if settings.asperities == "von-mises":
        problem = SealProblem.of(case)
        if any(material.hardening is not None for material in problem.materials.values()):
            tell("solving the contact, for the strain of its metal")
            profiles = [load.tightest for load in evaluate(problem).loads]
            bulk = BulkPath.of(max(profiles, key=lambda profile: profile.highest))
            strained = replace(settings, bulk=bulk)
    table = settings.table(surface, jobs=jobs, progress=tell)
    if strained is None:
        return table
    tell("direct simulation over metal that is strained as in the contact")
    return replace(table, strained=strained.table(surface, jobs=jobs, progress=tell))


def direct_seal(
    case: CaseSource,
    *,
    folder: str | os.PathLike[str] | None = None,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
) -> list[SealRow]:
    """Simulate strips of a case's contact directly, as `fem-seal direct --seal` does, beside what `run` says.

    Parameters
    ----------
    case : Case, path or mapping
        With roughness and fluid. Its [direct] says how: the strip has its points along the contact and twice as many
        across. Elastic and, where there is a hardness, capped asperities unless it names one kind.
    folder, jobs, progress
        See `direct`.

    Returns
    -------
    list of SealRow
        One for each load, place around the axis and kind of asperities.

    Raises
    ------
    InputError
        The case has no roughness or no fluid.
    LeakError
        A contact does not converge, or the grid holds no wave of the roughness.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     roughness={"spectrum": {
    ...         "kind": "self-affine", "rms_height": "1 um", "hurst": 0.8,
    ...         "q_low": "1e4 1/m", "q_rolloff": "5e4 1/m", "q_high": "1e6 1/m",
    ...     }},
    ...     leak={"plasticity": False},
    ...     fluid={"name": "water"},
    ...     load={"fluid_pressure": "20 bar"},
    ...     direct={"points": 64, "samples": 2},
    ... )
    >>> (row,) = fem_seal.direct_seal(case)
    >>> bool(0.3 < row.leak_rate / row.chain_held < 3.0)
    True
    """
    from fem_seal.files import problem
    from fem_seal.seal.direct_seal import simulate_seal
    from fem_seal.seal.problem import direct_settings

    case = case_of(case)
    for key, table in (("roughness", case.roughness), ("fluid", case.fluid)):
        if table is None:
            message = "is missing, and a simulated seal has both roughness and fluid; add the table"
            raise InputError.at(key, message, file=case.file)
    if case.roughness is not None and case.roughness.is_turned:
        raise InputError(problem("strips_turned"), file=case.file)
    options = direct_settings(case)
    if options.map is not None:
        message = "is a map of a patch; strips of a seal have random roughness: remove it"
        raise InputError.at("direct.file", message, file=case.file)
    settings = replace(options, folder=options.folder if folder is None else Path(folder))
    tell = progress or (lambda text: None)
    result = run(case, tell, sensitivities=False, verdict_force=False)
    asperities = None if case.direct is None else case.direct.asperities
    yields = result.surface is not None and result.surface.hardness is not None
    kinds: tuple[Asperities, ...] = (
        (("elastic", "capped") if yields else ("elastic",)) if asperities is None else (asperities,)
    )
    return simulate_seal(
        result.problem, result.loads, result.leak_ranges, settings, kinds, jobs=jobs, progress=tell
    )[1]
