"""Samples of the uncertain inputs of a seal: drawn once, each of them a problem with leak rates of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from itertools import chain, takewhile
from operator import add
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fem_seal.answers.answer import loads_of
from fem_seal.answers.case_load import CaseLoad, SolvedSeal
from fem_seal.answers.posterior import Posterior, columns_of
from fem_seal.answers.response_surface import variables
from fem_seal.arrays import FloatArray, IntArray
from fem_seal.case.roughness import (
    SHAPE,
    JoinedFaces,
    SelfAffine,
    UncertainFinish,
    UncertainHeight,
    fine_of,
    scanned_faces,
    self_affine_part,
    uncertain_finishes,
    uncertain_heights,
)
from fem_seal.case.tables import Uncertainty
from fem_seal.errors import ConvergenceError
from fem_seal.processes import fork_map
from fem_seal.sampling import UncertainInput, sobol_points
from fem_seal.seal.evaluate import Batch, evaluate_many
from fem_seal.seal.problem import SealProblem
from fem_seal.seal.scenarios import TEST_GAS
from fem_seal.seal.sources import NeighbourSource
from leak import TurnedContact, TurnedTexture

if TYPE_CHECKING:
    from fem_seal.case.case import Case
    from fem_seal.materials import Material
    from leak import PowerSpectrum
    from leak.flow.turned_contact import FaceContact

# Leak rates of samples [m^3/s], or why there are none: by number of the sample, number of the load, and whether bodies
# that yield have gone through all loads.
KnownRates: TypeAlias = dict[tuple[int, int, bool], FloatArray | ConvergenceError]

# Samples that are evaluated side by side; paths of loads one by one.
_AT_ONCE = 8
# Samples whose heights say how rough the roughest are.
_OF_HEIGHTS = 64
# Samples of a finish that are calculated at most for an interval.
MOST_OF_FINISH = 96
# Share of the samples that must converge where some may fail.
_FEWEST_CONVERGED = 0.7


@dataclass(frozen=True)
class UncertainScans:
    """The spectrum or the turned face, from the differences between n scans: their mean with random weights.

    The weights are uniform over all sets of n positive numbers with sum one (Bayesian bootstrap): what else the mean
    of n scans could have been.

    Parameters
    ----------
    name : {"spectrum", "seat", "closure"}
        Which spectrum of the case it is.
    scans : tuple of PowerSpectrum or TurnedTexture
        One of each scan; two or more.

    References
    ----------
    D. B. Rubin, Ann. Stat. 9, 130 (1981).
    """

    name: str
    scans: tuple[PowerSpectrum | TurnedTexture, ...]

    @property
    def dimensions(self) -> int:
        """Number of random numbers that it takes."""
        return len(self.scans) - 1

    def values(self, uniform: FloatArray) -> FloatArray:
        """Weights from numbers between 0 and 1, by breaking a stick; shape (n, scans - 1) to (n, scans)."""
        counts = len(self.scans) - 1 - np.arange(self.dimensions)
        shares = (1.0 - uniform) ** (1.0 / counts)
        sticks = np.cumprod(np.column_stack([np.ones(len(uniform)), shares]), axis=1)
        return np.asarray(sticks * np.column_stack([1.0 - shares, np.ones(len(uniform))]), dtype=float)

    def reported_values(self, values: FloatArray) -> FloatArray:
        """The weights, shape (n, scans)."""
        return values

    def mean(self, weights: FloatArray) -> PowerSpectrum | TurnedTexture:
        """Mean with weights, shape (scans,); those of 1e-6 or less are left out."""
        pairs = [(scan, weight) for scan, weight in zip(self.scans, weights, strict=True) if weight > 1e-6]
        spectrum = reduce(add, (fine_of(scan).scaled(float(np.sqrt(weight))) for scan, weight in pairs))
        cusps = [(scan.feed, 1.0 / scan.nose_radius) for scan, _ in pairs if isinstance(scan, TurnedTexture)]
        if not cusps:
            return spectrum
        feed, curvature = np.average(cusps, axis=0, weights=[weight for _, weight in pairs]).tolist()
        return TurnedTexture(feed, 1.0 / curvature, spectrum)


AnyInput = UncertainInput | UncertainScans | UncertainHeight | UncertainFinish


def uncertain_inputs(case: Case, settings: Uncertainty) -> tuple[AnyInput, ...]:
    """The uncertain inputs of a case, in the order of the table, then what a finish and too short scans leave open.

    Those of a further part follow that no part before it has.

    Parameters
    ----------
    case : Case
    settings : Uncertainty
        Its table [uncertainty], or another one.
    """
    return _different([_inputs_of_part(part, settings) for part in case.parts])


def _different(of_parts: Sequence[Sequence[AnyInput]]) -> tuple[AnyInput, ...]:
    """Inputs of all parts; those of one name are one input."""
    inputs: dict[str, AnyInput] = {}
    for uncertain in chain.from_iterable(of_parts):
        inputs.setdefault(uncertain.name, uncertain)
    return tuple(inputs.values())


def _inputs_of_part(case: Case, settings: Uncertainty) -> tuple[AnyInput, ...]:
    inputs: list[AnyInput] = [
        UncertainInput(name, spread.distribution, spread.relative)
        for name, spread in settings.spreads.items()
    ]
    if settings.spectrum is not None:
        inputs += [UncertainScans(key, scans) for key, scans in scanned_faces(case.roughness).items()]
    finishes = uncertain_finishes(case.roughness, names=settings.spreads)
    heights = uncertain_heights(case.roughness, between_scans=settings.spectrum is not None)
    return (*inputs, *finishes, *heights)


def drawn_values(inputs: Sequence[AnyInput], uniform: FloatArray) -> dict[str, FloatArray]:
    """Values of each input from numbers between 0 and 1, see the inputs.

    Parameters
    ----------
    inputs : sequence
    uniform : ndarray, shape (n, dimensions of all)
    """
    ends = np.cumsum([uncertain.dimensions for uncertain in inputs], dtype=int)
    return {
        uncertain.name: uncertain.values(uniform[:, end - uncertain.dimensions : end])
        for uncertain, end in zip(inputs, ends, strict=True)
    }


def changed_surface(
    case: Case,
    surface: FaceContact,
    factors: Mapping[str, float],
    means: Mapping[str, PowerSpectrum | TurnedTexture] | None = None,
    shares: Mapping[str, float] | None = None,
) -> FaceContact:
    """The rough contact with some of its inputs changed.

    Parameters
    ----------
    case : Case
    surface : FaceContact
        The case's own.
    factors : mapping
        Factor of each uncertain input by its key.
    means : mapping, optional
        Spectra and turned faces that stand instead of the case's own, by their key in [roughness].
    shares : mapping, optional
        Places in the ranges of what its finishes leave open.
    """
    means, shape = dict(means or {}), {key: factors[key] for key in SHAPE if key in factors}
    key = self_affine_part(case.roughness)
    if shape and key is not None:
        means[key] = _reshape(case, key, factors)
    assert case.roughness is not None
    joined = JoinedFaces(surface.spectrum, surface.peklenik)
    if means or shares or shape:
        joined = case.roughness.combine(means, shares, shape)
    height = factors.get("rms_height", 1.0)
    spectrum = joined.spectrum if height == 1.0 else joined.spectrum.scaled(height)
    hardness = surface.hardness
    surface = replace(
        surface,
        effective_modulus=surface.effective_modulus * factors.get("youngs_modulus", 1.0),
        hardness=None if hardness is None else hardness * factors.get("hardness", 1.0),
    )
    if isinstance(surface, TurnedContact):
        surface = replace(surface, **joined.of_crests, fine=spectrum)
        # of a drawing the cusps are higher, too
        return surface.steeper(height) if case.roughness.finishes else surface
    return replace(surface, spectrum=spectrum, peklenik=joined.peklenik)


def _reshape(case: Case, key: str, factors: Mapping[str, float]) -> PowerSpectrum:
    """Self-affine spectrum with other exponent or ends and the same rms height."""
    from leak import PowerSpectrum

    assert case.roughness is not None
    spectrum = case.roughness.parts[key]
    assert isinstance(spectrum, SelfAffine)
    q_high = spectrum.q_high * factors.get("q_high", 1.0)
    q_high = max(q_high, spectrum.q_rolloff, 1.001 * spectrum.q_low)
    return PowerSpectrum.self_affine(
        rms_height=spectrum.rms_height,
        hurst=min(max(spectrum.hurst * factors.get("hurst", 1.0), 0.01), 1.0),
        q_low=spectrum.q_low,
        q_rolloff=min(max(spectrum.q_rolloff * factors.get("q_rolloff", 1.0), spectrum.q_low), q_high),
        q_high=q_high,
    )


def sample_problem(
    problem: SealProblem, case: Case, values: Sequence[tuple[AnyInput, FloatArray]]
) -> SealProblem:
    """The problem of one sample.

    Parameters
    ----------
    problem : SealProblem
        Of the seal as given.
    case : Case
        What its finishes and scans follow from.
    values : sequence of (input, ndarray)
        Uncertain inputs with their values; that of the viscosity is left out, to which the leak rate is proportional.
    """
    factors: dict[str, float] = {}
    shares: dict[str, float] = {}
    means: dict[str, PowerSpectrum | TurnedTexture] = {}
    for uncertain, value in values:
        if isinstance(uncertain, UncertainScans):
            means[uncertain.name] = uncertain.mean(value)
        elif isinstance(uncertain, UncertainFinish):
            shares[uncertain.name] = float(value[0])
        elif isinstance(uncertain, UncertainInput):
            factors[uncertain.name] = float(value[0])
    for uncertain, value in values:
        if isinstance(uncertain, UncertainHeight):
            assert case.roughness is not None  # of the checks
            key = uncertain.key
            mean = means[key] if key in means else case.roughness.parts[key].build()
            fine = uncertain.spectrum(fine_of(mean), float(value[0]))
            means[key] = replace(mean, fine=fine) if isinstance(mean, TurnedTexture) else fine
    return changed_problem(problem, case, factors, means, shares)


def changed_problem(
    problem: SealProblem,
    case: Case,
    factors: Mapping[str, float],
    means: Mapping[str, PowerSpectrum | TurnedTexture] | None = None,
    shares: Mapping[str, float] | None = None,
) -> SealProblem:
    """The problem with some inputs of its surface, its Young's moduli or its form error changed.

    Parameters
    ----------
    problem : SealProblem
    case, factors, means, shares
        See `changed_surface`; a factor on "form" is one on all amplitudes.
    """
    assert problem.surface is not None  # of the checks
    form, stiffer = problem.form, factors.get("youngs_modulus", 1.0)
    return replace(
        problem,
        surface=changed_surface(case, problem.surface, factors, means, shares),
        materials=problem.materials if stiffer == 1.0 else stiffer_bodies(problem.materials, stiffer),
        form=form.scale(factors["form"]) if form is not None and "form" in factors else form,
        given_law=None,
    )


def stiffer_bodies(materials: Mapping[str, Material], factor: float) -> dict[str, Material]:
    """Materials with both Young's moduli times a factor."""
    return {
        name: replace(material, youngs_modulus=material.youngs_modulus * factor)
        for name, material in materials.items()
    }


@dataclass(frozen=True)
class Samples:
    """All samples of the uncertain inputs of one seal.

    Parameters
    ----------
    seal : SolvedSeal
    of_parts : tuple of tuple
        Inputs of each part of the seal, with the same value where they have the same name.
    uniform : ndarray, shape (samples, dimensions)
        Numbers between 0 and 1.
    known_rates : KnownRates
        What has been calculated so far; samples of the same inputs with the same seed may share it.
    """

    seal: SolvedSeal
    of_parts: tuple[tuple[AnyInput, ...], ...]
    uniform: FloatArray
    known_rates: KnownRates = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, seal: SolvedSeal, settings: Uncertainty, known_rates: KnownRates | None = None) -> Samples:
        """The samples of a seal.

        Parameters
        ----------
        seal : SolvedSeal
        settings : Uncertainty
            The table [uncertainty].
        known_rates : dict, optional
            Of samples of the same inputs with the same seed, however many: they are the first of these.
        """
        of_parts = tuple(_inputs_of_part(part.case, settings) for part in seal.parts)
        inputs = _different(of_parts)
        if settings.posterior is None:
            dimensions = sum(uncertain.dimensions for uncertain in inputs)
            uniform = sobol_points(settings.samples, dimensions, settings.seed)
        else:
            columns = [name for each in inputs for name in columns_of(each.name, each.dimensions)]
            uniform = Posterior.read(settings.posterior).of_inputs(columns)
        return cls(seal, of_parts, uniform, {} if known_rates is None else known_rates)

    @classmethod
    def of_nothing(cls, seal: SolvedSeal) -> Samples:
        """The only sample of a seal of which nothing is uncertain."""
        return cls(seal, ((),) * len(seal.parts), np.empty((1, 0)))

    @cached_property
    def inputs(self) -> tuple[AnyInput, ...]:
        """All of them."""
        return _different(self.of_parts)

    @property
    def follow_paths(self) -> bool:
        """Whether bodies that yield must go through all loads in each sample, because their modulus is another one."""
        return self.seal.problem.follows_path and any(each.name == "youngs_modulus" for each in self.inputs)

    @property
    def scenario_count(self) -> int:
        """Leak rates of a sample at a load: that of the nominal scenario, then of those beside it."""
        return 1 + len(self.seal.loads[0].others)

    @property
    def of_finish(self) -> bool:
        """Whether a face has a finish, or crests lie on crests, a factor of ten or more."""
        roughness = [part.case.roughness for part in self.seal.parts]
        return any(each is not None and each.leaves_open for each in roughness)

    @cached_property
    def of_case(self) -> FloatArray:
        """Leak rates of the case itself, as those of a sample: shape (kinds, loads), see `leak_rates` [m^3/s]."""
        return np.array([_leak_rates(load) for load in self.seal.loads]).T

    @property
    def run_inputs(self) -> tuple[AnyInput, ...]:
        """Inputs whose effect is not known beforehand: all but a liquid's viscosity."""
        return tuple(each for each in self.inputs if each.name != "viscosity")

    @cached_property
    def values(self) -> dict[str, FloatArray]:
        """Factors (samples, 1) or weights (samples, scans) of each input."""
        return drawn_values(self.inputs, self.uniform)

    @property
    def viscosity(self) -> FloatArray:
        """Factor of the viscosity of each sample, shape (samples,)."""
        return self.values.get("viscosity", np.ones((len(self.uniform), 1)))[:, 0]

    @cached_property
    def scores(self) -> FloatArray:
        """Variables of a polynomial, shape (samples, dimensions of `evaluated`)."""
        parts = variables({x.name: x.reported_values(self.values[x.name]) for x in self.run_inputs})
        return np.concatenate(parts, axis=1) if parts else np.empty((len(self.uniform), 0))

    def columns(self, source: AnyInput) -> list[int]:
        """Columns of `scores` that belong to an input."""
        first = sum(each.dimensions for each in takewhile(lambda each: each is not source, self.run_inputs))
        return list(range(first, first + source.dimensions))

    def problems(self, number: int) -> tuple[SealProblem, ...]:
        """The problems of a sample, one for each part of the seal, with the viscosity of the case."""
        return tuple(
            sample_problem(part.problem, part.case, [(each, values[each.name][number]) for each in inputs])
            for part, inputs, values in zip(self.seal.parts, self.of_parts, self._part_values, strict=True)
        )

    @cached_property
    def _part_values(self) -> list[dict[str, FloatArray]]:
        """Values of the inputs of each part."""
        ends = np.cumsum([each.dimensions for each in self.inputs], dtype=int)
        columns = {
            each.name: self.uniform[:, end - each.dimensions : end]
            for each, end in zip(self.inputs, ends, strict=True)
        }
        for inputs in self.of_parts:
            if any(columns[each.name].shape[1] != each.dimensions for each in inputs):
                raise ConvergenceError("there must be as many scans of each face")
        return [{each.name: each.values(columns[each.name]) for each in inputs} for inputs in self.of_parts]

    def leak_rates(
        self, numbers: Sequence[int], loads: Sequence[int] | None = None, *, whole_paths: bool = False
    ) -> FloatArray:
        """Leak rates of some samples at the case's own viscosity, calculated once [m^3/s].

        Parameters
        ----------
        numbers : sequence of int
        loads : sequence of int, optional
            Numbers of the loads; all unless given.
        whole_paths : bool
            Whether bodies that yield go through all their loads, instead of being linearised at each load of the case.

        Returns
        -------
        ndarray, shape (samples, kinds, loads)
            Kinds are the readings of yielding asperities with the fluid of the case, then with the gas of the
            standards' tests where it is another one. NaN where a contact does not converge.
        """
        loads = range(len(self.seal.loads)) if loads is None else loads
        on_paths = self.seal.problem.follows_path and (whole_paths or self.follow_paths)
        fresh = [n for n in numbers if any((n, load, on_paths) not in self.known_rates for load in loads)]
        at_once = 1 if on_paths else _AT_ONCE
        # the first one makes what all share
        parts = [fresh[:1], *(fresh[first : first + at_once] for first in range(1, len(fresh), at_once))]

        def evaluate(part: Sequence[int]) -> list[list[FloatArray] | ConvergenceError]:
            return self._evaluate(part, loads, on_paths)

        outcomes = [*map(evaluate, parts[:1]), *fork_map(evaluate, parts[1:])] if fresh else []
        for number, outcome in zip(fresh, (each for part in outcomes for each in part), strict=True):
            for place, load in enumerate(loads):
                rates = outcome if isinstance(outcome, ConvergenceError) else outcome[place]
                self.known_rates[number, load, on_paths] = rates
        table = [[self.known_rates[n, load, on_paths] for load in loads] for n in numbers]
        none = np.full(self.of_case.shape[0], np.nan)
        rows = [[none if isinstance(rates, ConvergenceError) else rates for rates in row] for row in table]
        return np.array(rows).reshape(len(table), len(loads), -1).swapaxes(1, 2)

    def valid_rows(self, rates: FloatArray, fewest: float = _FEWEST_CONVERGED) -> IntArray:
        """Which rows of `leak_rates` are those of samples that converged.

        Parameters
        ----------
        rates : ndarray, shape (samples, ...)
        fewest : float
            Share of the samples that must converge.

        Raises
        ------
        ConvergenceError
            If they are too few.
        """
        rows = np.flatnonzero(~np.isnan(rates.reshape(len(rates), -1)).any(axis=1))
        if len(rows) < fewest * len(rates):
            why = next(each for each in self.known_rates.values() if isinstance(each, ConvergenceError))
            count = f"{len(rates) - len(rows)} of {len(rates)} samples did not converge"
            raise ConvergenceError(f"uncertainty: {count}, the first because {why}")
        return rows

    def _evaluate(
        self, numbers: Sequence[int], loads: Sequence[int], on_paths: bool
    ) -> list[list[FloatArray] | ConvergenceError]:
        """Of each sample its leak rates at each load, or why there are none."""
        batch = Batch()
        sources = [
            NeighbourSource(part.problem, part.model, part.seal_mesh, part.loads, tuple(loads), on_paths)
            for part in self.seal.parts
        ]
        problems = batch.map(numbers, self.problems)
        evaluations = evaluate_many(problems, dict.fromkeys(problems, sources), batch)

        def leak_rates(number: int) -> list[FloatArray]:
            return list(map(_leak_rates, loads_of(evaluations[number])))

        rates = batch.map(evaluations, leak_rates)
        for error in batch.failed.values():
            if not isinstance(error, ConvergenceError):
                raise error
        return [rates[n] if n in rates else batch.failed[n] for n in numbers]  # type: ignore[misc]

    def rougher(self, share: float) -> float:
        """Quantile of what the gaps of samples let through over those of the case, by h^3/eta [-].

        Parameters
        ----------
        share : float
            Of the samples that let less through.
        """
        numbers = range(min(len(self.uniform), _OF_HEIGHTS))
        heights = np.array([_rms_heights(self.problems(number)) for number in numbers])
        ratio = (heights / _rms_heights(self.seal.problems)) ** 3 / self.viscosity[: len(numbers), None]
        return float(np.quantile(ratio, share, axis=0).max())


def _rms_heights(problems: Iterable[SealProblem]) -> list[float]:
    """Of the surface of each problem [m]."""
    return [problem.surface.spectrum.rms_height for problem in problems if problem.surface is not None]


def _leak_rates(load: CaseLoad) -> FloatArray:
    """Leak rate of a load in each of the kinds of `Samples.leak_rates` [m^3/s]."""
    fluids = [load, *(other for name, other in load.scenarios.items() if name == TEST_GAS)]
    leaks = [
        state.leak for fluid in fluids for state in (fluid, *(fluid.scenarios[name] for name in load.others))
    ]
    return np.array([np.nan if leak is None else leak.leak_rate for leak in leaks])
