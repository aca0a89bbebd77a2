"""Leak rate with an interval: what uncertain inputs do to it, by quasi-Monte Carlo."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fem_seal.case_checks import contradictions
from fem_seal.errors import ConvergenceError, InputError, Problem
from fem_seal.response_surface import ResponseSurface, fit
from fem_seal.uncertain_inputs import (
    AnyInput,
    UncertainHeight,
    UncertainInput,
    UncertainScans,
    changed_surface,
    uncertain_inputs,
)

if TYPE_CHECKING:
    from fem_seal.case_uncertainty import Uncertainty
    from fem_seal.condensation import ContactModel
    from fem_seal.contact_solution import ContactSolution
    from fem_seal.results import SealResult
    from leak import RoughContact

FloatArray = NDArray[np.float64]

_FIRST_RUNS = 16
# Left-out runs must be predicted this well: an error that adds 0.05 % to the width of the interval.
_ERROR_OF_STD = 0.03
_SMALLEST_ERROR = 2e-4
# Beside the runs of the polynomial: samples at both ends of the interval, calculated to see how well it does there.
_CHECKS = 4


@dataclass(frozen=True)
class LeakInterval:
    """Leak rates of all samples at all loads, and what is said about them.

    Parameters
    ----------
    inputs : tuple of str
        Keys of the uncertain inputs.
    confidence : float
        Share of the samples between `low` and `high`.
    seed : int
    runs : int
        Samples whose contact and leak rate were calculated; the others follow from a polynomial through them.
    leak_rate : ndarray, shape (loads, samples)
        [m^3/s], zero where sealed, infinite where the fluid has blown the contact open.
    shares : ndarray, shape (loads, inputs)
        First-order share of each input in the variance of ln Q; their sum falls short of one by what inputs do only
        together. NaN where a sample is sealed or blown open.
    error : float or None
        Largest relative error of the polynomial at samples that were calculated beside it, at both ends of the
        interval; None if every sample was calculated.
    """

    inputs: tuple[str, ...]
    confidence: float
    seed: int
    runs: int
    leak_rate: FloatArray = field(repr=False)
    shares: FloatArray
    error: float | None

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.leak_rate.shape[1])

    @cached_property
    def low(self) -> FloatArray:
        """Lower end of the interval at each load, shape (loads,) [m^3/s]."""
        return self._quantile(0.5 - 0.5 * self.confidence)

    @cached_property
    def median(self) -> FloatArray:
        """Leak rate that half of the samples exceed, shape (loads,) [m^3/s]."""
        return self._quantile(0.5)

    @cached_property
    def high(self) -> FloatArray:
        """Upper end of the interval at each load, shape (loads,) [m^3/s]."""
        return self._quantile(0.5 + 0.5 * self.confidence)

    def _quantile(self, share: float) -> FloatArray:
        # between a finite and an infinite leak rate there is nothing to interpolate
        method = "linear" if np.isfinite(self.leak_rate).all() else "nearest"
        return np.asarray(np.quantile(self.leak_rate, share, axis=1, method=method))  # type: ignore[call-overload]

    @cached_property
    def sealed(self) -> FloatArray:
        """Share of the samples that do not leak, shape (loads,)."""
        return (self.leak_rate == 0).mean(axis=1)


def leak_interval(
    result: SealResult,
    settings: Uncertainty | None = None,
    progress: Callable[[str], None] | None = None,
) -> LeakInterval:
    """Leak rate of a result with an interval from uncertain inputs.

    The samples are a scrambled Sobol sequence. For the first of them the whole chain is calculated: interface law,
    contact on the condensed bodies, flow conductivity, leak rate. If ln Q turns out to be a smooth function of the
    inputs, a polynomial through these runs gives the others; if not (a sample is sealed or blown open), all are
    calculated. A liquid's viscosity needs no runs: Q is inversely proportional to it.

    Parameters
    ----------
    result : SealResult
        Of a case with roughness and fluid.
    settings : Uncertainty, optional
        Instead of the case's own table [uncertainty].
    progress : callable, optional
        Told in words what is being done.

    Returns
    -------
    LeakInterval

    Raises
    ------
    InputError
        If the case has no roughness or no fluid, no input is uncertain, or one does not fit the case.
    ConvergenceError
        If the contact of a sample does not converge.

    References
    ----------
    A. B. Owen, SIAM J. Numer. Anal. 34, 1884 (1997): scrambled nets. B. Sudret, Reliab. Eng. Syst. Saf. 93, 964 (2008).

    Examples
    --------
    >>> from fem_seal.case_uncertainty import Spread, Uncertainty
    >>> settings = Uncertainty(samples=1024, hardness=Spread(relative=0.1))
    >>> leak_interval(fem_seal.run(case), settings).high                # doctest: +SKIP
    """
    if settings is not None:
        case = result.case.model_copy(update={"uncertainty": settings})
        result = replace(result, case=case)
    settings = result.case.uncertainty
    if settings is None:
        raise InputError(Problem("uncertainty", "is missing; say which inputs are uncertain"))
    wrong = contradictions(result.case)
    if wrong:
        raise InputError(*wrong)
    return _interval(_Study.of(result, settings), settings, progress or (lambda text: None))


def _interval(study: _Study, settings: Uncertainty, progress: Callable[[str], None]) -> LeakInterval:
    viscosity = study.viscosity
    runs, rates, surface = _runs(study, progress)
    error = None
    if surface is None:
        nominal = rates * viscosity[:, None]
    else:
        nominal = np.exp(surface(study.scores))
        checked = _ends(nominal / viscosity[:, None], settings.confidence)
        truth = study.leak_rates(checked)
        with np.errstate(divide="ignore"):
            error = float(np.abs(nominal[checked] / truth - 1).max())
        nominal[checked], nominal[: len(rates)] = truth, rates
        runs += len(checked)
    leak_rate = nominal / viscosity[:, None]
    return LeakInterval(
        tuple(one.name for one in study.inputs),
        settings.confidence,
        settings.seed,
        runs,
        leak_rate.T,
        _shares(study, nominal, surface),
        error,
    )


def _runs(study: _Study, progress: Callable[[str], None]) -> tuple[int, FloatArray, ResponseSurface | None]:
    """Calculate samples until a polynomial through them is good enough; None instead of it if all are calculated."""
    total = len(study.uniform)
    if not study.calculated:
        nominal = np.array([[load.leak.leak_rate for load in study.result.loads if load.leak is not None]])
        return 0, np.repeat(nominal, total, axis=0) / study.viscosity[:, None], None
    count, rates = 0, np.empty((0, len(study.result.loads)))
    goal = min(total, _FIRST_RUNS * 2 ** min(study.scores.shape[1] - 1, 3))
    while count < total:
        progress(f"uncertainty: samples {count + 1} to {goal} of {total}")
        rates = np.concatenate([rates, study.leak_rates(range(count, goal))])
        count = goal
        if np.all((rates > 0) & np.isfinite(rates)) and count < total:
            surface = fit(study.scores[:count], np.log(rates), study.scores)
            allowed = np.maximum(_ERROR_OF_STD * np.sqrt(surface.variance), _SMALLEST_ERROR)
            if np.all(surface.error <= allowed):
                return count, rates, surface
            goal = min(total, 2 * count)
        else:
            goal = total
    return count, rates / study.viscosity[:, None], None


def _ends(leak_rate: FloatArray, confidence: float) -> list[int]:
    """Samples at the ends of the interval of the last load."""
    order = np.argsort(leak_rate[:, -1])
    last = len(order) - 1
    places = np.array([0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence]) * last
    near = [int(order[min(last, int(place) + n)]) for place in places for n in range(_CHECKS // 2)]
    return sorted(set(near))


def _shares(study: _Study, nominal: FloatArray, surface: ResponseSurface | None) -> FloatArray:
    """First-order shares in the variance of ln Q, shape (loads, inputs)."""
    loads, inputs = nominal.shape[1], study.inputs
    if not np.all((nominal > 0) & np.isfinite(nominal)):
        return np.full((loads, len(inputs)), np.nan)
    own = float(np.log(study.viscosity).var())
    if surface is None and study.calculated:
        surface = fit(study.scores, np.log(nominal), study.scores)
    variances = np.zeros((loads, len(inputs)))
    total = np.full(loads, own)
    if surface is not None:
        total += surface.variance
    for n, one in enumerate(inputs):
        if one in study.calculated and surface is not None:
            variances[:, n] = surface.variance_of(study.columns(one))
        elif one not in study.calculated:
            variances[:, n] = own
    return variances / total[:, None]


@dataclass(frozen=True)
class _Study:
    """All samples of the inputs of one result.

    Parameters
    ----------
    uniform : ndarray, shape (samples, dimensions)
        Numbers between 0 and 1.
    """

    result: SealResult
    inputs: tuple[AnyInput, ...]
    uniform: FloatArray

    @classmethod
    def of(cls, result: SealResult, settings: Uncertainty) -> _Study:
        inputs = uncertain_inputs(result.case)
        dimensions = sum(one.dimensions for one in inputs)
        return cls(result, inputs, _sobol(settings.samples, dimensions, settings.seed))

    @cached_property
    def calculated(self) -> tuple[AnyInput, ...]:
        """Inputs whose effect is not known beforehand: all but a liquid's viscosity."""
        return tuple(one for one in self.inputs if one.name != "viscosity")

    @cached_property
    def values(self) -> dict[str, FloatArray]:
        """Factors (samples, 1) or weights (samples, scans) of each input."""
        values, column = {}, 0
        for one in self.inputs:
            values[one.name] = one.values(self.uniform[:, column : column + one.dimensions])
            column += one.dimensions
        return values

    @cached_property
    def viscosity(self) -> FloatArray:
        """Factor of the viscosity of each sample, shape (samples,)."""
        if "viscosity" not in self.values:
            return np.ones(len(self.uniform))
        return self.values["viscosity"][:, 0]

    @cached_property
    def scores(self) -> FloatArray:
        """Variables of the polynomial, shape (samples, dimensions of `calculated`)."""
        parts = [one.scores(self.values[one.name]) for one in self.calculated]
        return np.concatenate(parts, axis=1) if parts else np.empty((len(self.uniform), 0))

    def columns(self, wanted: AnyInput) -> list[int]:
        """Columns of `scores` that belong to an input."""
        first = 0
        for one in self.calculated:
            if one is wanted:
                break
            first += one.dimensions
        return list(range(first, first + wanted.dimensions))

    def leak_rates(self, samples: Sequence[int]) -> FloatArray:
        """Leak rates at the case's own viscosity, calculated, shape (samples, loads) [m^3/s]."""
        # numpy and LAPACK leave Python's lock for most of the time, so two samples run side by side
        with ThreadPoolExecutor(2) as pool:
            return np.array(list(pool.map(self._leak_rates, samples)))

    def _leak_rates(self, sample: int) -> list[float]:
        from fem_seal import pipeline

        result, case = self.result, self.result.case
        factors = {
            one.name: float(self.values[one.name][sample, 0])
            for one in self.calculated
            if isinstance(one, UncertainInput)
        }
        surface = self._surface(sample, factors)
        contacts = self._contacts(surface, factors)
        # with the range of the case itself, as long as it will do, the table's own error is that of all samples
        table = pipeline.conductivity_table(case, surface, [*result.contact, *contacts])
        return [
            pipeline.leak_of_contact(case, table, contact, load.fluid_pressure).leak_rate
            for contact, load in zip(contacts, result.loads, strict=True)
        ]

    def _surface(self, sample: int, factors: dict[str, float]) -> RoughContact:
        assert self.result.surface is not None
        means = {
            one.name: one.spectrum(self.values[one.name][sample])
            for one in self.calculated
            if isinstance(one, UncertainScans)
        }
        for one in self.calculated:
            if isinstance(one, UncertainHeight):
                roughness = self.result.case.roughness
                assert roughness is not None
                mean = means[one.key] if one.key in means else roughness.parts[one.key].build()
                means[one.key] = one.spectrum(mean, float(self.values[one.name][sample, 0]))
        return changed_surface(self.result.case, self.result.surface, factors, means)

    def _contacts(self, surface: RoughContact, factors: dict[str, float]) -> list[ContactSolution]:
        """Contact of every load; that of the case itself where its law and its bodies have not changed."""
        from fem_seal.contact import solve
        from fem_seal.pipeline import interface_law

        result = self.result
        law = interface_law(result.case, surface)
        stiffness = factors.get("youngs_modulus", 1.0)
        if stiffness == 1 and law is self._law:
            return [load.contact for load in result.loads]
        model = _stiffer(result.model, stiffness)
        try:
            return [
                solve(model, law, axial_force=load.axial_force, loads=load.contact.loads, start=load.contact)
                for load in result.loads
            ]
        except ConvergenceError as error:
            changes = ", ".join(f"{name} times {factor:.4g}" for name, factor in factors.items())
            raise ConvergenceError(f"uncertainty, sample with {changes}: {error}") from error

    @cached_property
    def _law(self) -> object:
        from fem_seal.pipeline import interface_law

        return interface_law(self.result.case, self.result.surface)


def _sobol(samples: int, dimensions: int, seed: int) -> FloatArray:
    """Scrambled Sobol points inside the unit cube, shape (samples, dimensions)."""
    import warnings

    from scipy.stats.qmc import Sobol

    with warnings.catch_warnings():
        # another number than a power of two is balanced less well, but is what the user asked for
        warnings.simplefilter("ignore", UserWarning)
        points = Sobol(dimensions, scramble=True, seed=seed).random(samples)
    return np.clip(points, 1e-9, 1 - 1e-9)


def _stiffer(model: ContactModel, factor: float) -> ContactModel:
    """Model of the same bodies with both Young's moduli times a factor, as far as a contact needs it."""
    if factor == 1:
        return model

    def body(one):  # type: ignore[no-untyped-def]
        material = replace(one.material, youngs_modulus=one.material.youngs_modulus * factor)
        # The wall of a pressed-in housing moves as far as before; pressures move a stiffer body less.
        loads = {
            name: load if name == "wall" else replace(load, opening=load.opening / factor)
            for name, load in one.loads.items()
        }
        return replace(one, held=replace(one.held, material=material), loads=loads)

    return replace(
        model, closure=body(model.closure), seat=body(model.seat), compliance=model.compliance / factor
    )
