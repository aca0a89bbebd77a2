"""A rough surface pressed against a smooth one: everything the theory says about it, in one place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike

from leak.arrays import LARGEST_LOG, FloatArray, IntArray
from leak.errors import ConductivityError, SurfaceError, positive
from leak.flow import conductivity as flow
from leak.flow import medium
from leak.flow.conductivity import AnyTable, ConductivityTable, GasConductivityTable
from leak.flow.rarefied import log_flow_factor
from leak.numerics.curves import MonotoneCurve, divide_stretches, sample_curve, spline_slopes
from leak.numerics.roots import MOST_STEPS, bisect_roots, root_of_rising
from leak.surfaces.spectrum import PowerSpectrum
from leak.surfaces.stretched import MOST_STRETCHED
from leak.theory.bulk_flow import BulkFlow, BulkStrain
from leak.theory.interface_law import RoughSurfaceLaw, gap_law
from leak.theory.own_error import FlowError, flow_error
from leak.theory.persson import (
    LowPressureLaw,
    Separations,
    area_argument,
    low_pressure_law,
    moment_of_all,
    relative_contact_area,
    separations,
)
from leak.theory.plasticity import (
    BEARING_GAP,
    CAPPED,
    READINGS,
    VON_MISES,
    AreaFractions,
    PlasticRoughness,
    Reading,
    Roughness,
    area_fractions,
    equivalent_pressure,
    remaining_fraction,
    remaining_moment,
)
from leak.theory.separation import LostArea, SeparationGrid, density, lost_area

_WIDTHS = ("effective", "plain")
# From here on to the hardness itself all is flat.
_BELOW_HARDNESS = 1.0 - 1e-9
# ln(p/hardness) between which the area touched is interpolated where the bulk flows; below them it goes with p.
_LOG_SHARES = np.linspace(-14.0, 0.0, 71)
# Share of the pressure that a small unloading takes off.
_UNLOADS = 1e-4
# Pressures are treated a few at a time, so that the work arrays stay in the processor's cache.
_CHUNK = 8
# P(u) itself is asked for far into its tails, where a flow conductivity does not look.
_DISTRIBUTION_REFINEMENT = 8
# Below this p/E* slope moments leave the range of floating-point numbers; separations are long linear in ln p.
_LEAST_RELATIVE_PRESSURE = 1e-100
# Below this ln(p/Pa) what acts on a capped surface is in a fixed ratio to p; gaps of the gap law go on much further.
_LEAST_LOG_PRESSURE, _WIDEST_LOG_PRESSURE = -600.0, -1e5


@dataclass(frozen=True)
class RoughContact:
    """Contact between a rough surface and a smooth one, elastic or with asperity plasticity.

    Two rough surfaces count as one with the sum of their spectra. Given a hardness, every separation and
    conductivity is that of asperities that yield, in one of two readings; `elastic` is the same surface without.
    From the hardness on, the theory's limit is taken: all area plastic, no gap, sealed.

    Parameters
    ----------
    spectrum : PowerSpectrum
        Combined roughness.
    effective_modulus : float
        E*, 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2 [Pa].
    hardness : float, optional
        Penetration hardness of the softer surface [Pa]; None for elastic asperities.
    theory : {"paper", "corrected"}
        "paper": mean gap and flow by Persson's theory as in Fischer et al. "corrected": the mean gap by
        `leak.theory.interface_law`, asperities that yield by von Mises (`leak.theory.plasticity`), and the flow
        through the paper's surface of the same mean gap.
    yielding : {"conserved", "capped", "von-mises"}, optional
        What becomes of the metal that yields. In the paper's theory "conserved", the default: the spectrum C_pl
        smoothed everywhere by plastic flow at the pressure asked for, valleys included (`leak.theory.plasticity`); or
        "capped": the pressure is limited by the hardness and the surface changes only where it touches
        (`leak.theory.plasticity`). In the corrected theory "von-mises".
    percolation_threshold : float
        Relative contact area A/A0 at which the open area stops percolating [-].
    gamma : float
        Yang and Persson's factor in the mean separation [-].
    separation_width : {"effective", "plain"}
        Width of the Gaussians in P(u), see `leak.theory.separation.lost_area`.
    peklenik : float
        Tripp (Peklenik) number gamma_T, 0.001 to 1000: correlation length along the flow over that across it, below
        one for a lay across the flow, as on a turned seat. `spectrum` is then the angular average, which alone
        enters the contact mechanics; gamma_T enters the flow, see `leak.flow.medium`. Flow in the other
        direction is that of 1/gamma_T [-].
    bulk : BulkStrain, optional
        Of the metal under the face, see `strained`.

    Raises
    ------
    SurfaceError, ConductivityError
        A value outside its meaning.

    References
    ----------
    B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001); C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20,
    215214 (2008); Fischer, Schmitz, Tiwari, Persson, "Fluid leakage in metallic seals".

    Examples
    --------
    >>> spectrum = PowerSpectrum.self_affine(
    ...     rms_height=1.9e-6, hurst=0.6, q_low=1e3, q_rolloff=3.7268e4, q_high=3.1415926e6
    ... )
    >>> surface = RoughContact(spectrum, effective_modulus=115e9, hardness=3.5e9)
    >>> print(f"{surface.effective_separation(50e6) * 1e6:.2f} um")
    2.30 um
    """

    spectrum: PowerSpectrum
    effective_modulus: float = field(kw_only=True)
    hardness: float | None = field(default=None, kw_only=True)
    theory: str = field(default="paper", kw_only=True)
    yielding: str = field(default="", kw_only=True)
    percolation_threshold: float = field(default=0.42, kw_only=True)
    gamma: float = field(default=0.45, kw_only=True)
    separation_width: str = field(default="effective", kw_only=True)
    peklenik: float = field(default=1.0, kw_only=True)
    bulk: BulkStrain | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if not isinstance(self.spectrum, PowerSpectrum):
            raise SurfaceError(f"spectrum = {self.spectrum!r}: must be a PowerSpectrum")
        positive(SurfaceError, "effective_modulus", self.effective_modulus, "Pa")
        if self.hardness is not None:
            positive(SurfaceError, "hardness", self.hardness, "Pa")
        if self.theory not in READINGS:
            raise SurfaceError(f"theory = {self.theory!r}: must be one of {tuple(READINGS)}")
        names = tuple(map(str, READINGS[self.theory]))
        if not self.yielding:
            object.__setattr__(self, "yielding", names[0])
        if self.yielding not in names:
            raise SurfaceError(
                f"yielding = {self.yielding!r}: must be one of {names} with theory = {self.theory!r}"
            )
        medium.dimension_number(self.percolation_threshold)
        if not 0.0 < self.gamma <= 1.0:
            raise SurfaceError(f"gamma = {self.gamma}: must lie in (0, 1] [-]")
        if self.separation_width not in _WIDTHS:
            raise SurfaceError(f"separation_width = {self.separation_width!r}: must be one of {_WIDTHS}")
        ratio = positive(SurfaceError, "peklenik", self.peklenik, "-")
        if not 1.0 / MOST_STRETCHED <= ratio <= MOST_STRETCHED:
            raise SurfaceError(f"peklenik = {self.peklenik}: must lie between 0.001 and 1000 [-]")
        if self.bulk is not None and (self.hardness is None or self.theory != "corrected"):
            raise SurfaceError(
                "bulk: only asperities that yield, by theory = 'corrected' with a hardness, are over metal that flows"
            )

    # ---------------------------------------------------------------- variants

    @property
    def readings(self) -> tuple[Reading, ...]:
        """What its theory may make of metal that yields; "elastic" alone without a hardness."""
        return (Reading.ELASTIC,) if self.hardness is None else READINGS[self.theory]

    def reading(self, reading: Reading) -> RoughContact:
        """The same surface with metal that yields read in another way; itself where its theory does not know that.

        Parameters
        ----------
        reading : Reading
        """
        if reading is Reading.ELASTIC:
            return self if self.hardness is None else self._never_yielding
        is_known = reading in self.readings and reading != self.yielding
        return replace(self, yielding=str(reading)) if is_known else self

    @cached_property
    def _never_yielding(self) -> RoughContact:
        return replace(self, hardness=None, yielding="", bulk=None)

    def strained(
        self, meridional: float, hoop: float, *, yield_stress: float | None = None, elastic: float = 0.0
    ) -> RoughContact:
        """The same surface over metal whose bulk is strained in the plane of the face, as far as it flows.

        Where the bulk flows nothing elastic holds the asperities from below: they sink under a pressure of about the
        yield stress. The strain is that of the softer body, from first loading on; another call replaces it. Simulated
        for H/(E* h') of 0.02 to 0.2, p/H of 0.02 to 0.3 and strains up to 0.4 h', h' the rms slope, with a lay up to 5.

        Parameters
        ----------
        meridional, hoop : float
            Total mean strain along the flow and across it, elastic part included [-].
        yield_stress : float, optional
            Of the asperities, a 2.9th of the hardness unless given [Pa].
        elastic : float
            Sum of both elastic strains that are there while the face is loaded, see `pressure_at_rest` [-].

        Raises
        ------
        SurfaceError
            Without a hardness, by the paper's theory, or a strain that is not between -1 and 1.

        References
        ----------
        W. R. D. Wilson, S. Sheu, Int. J. Mech. Sci. 30, 475 (1988); M. P. F. Sutcliffe, Int. J. Mech. Sci. 30, 847
        (1988); the numbers are those of direct simulations, `leak.theory.bulk_flow`.

        Examples
        --------
        >>> spectrum = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=4e4, q_high=1e6)
        >>> face = RoughContact(spectrum, effective_modulus=115e9, hardness=1e9, theory="corrected")
        >>> bool(face.strained(0.01, 0.0).contact_area(1e8) > face.contact_area(1e8))
        True
        """
        if self.hardness is None:
            raise SurfaceError("hardness = None: only asperities that yield sink into metal that flows")
        for name, strain in (("meridional", meridional), ("hoop", hoop), ("elastic", elastic)):
            if not -1.0 < strain < 1.0:
                raise SurfaceError(f"{name} = {strain}: must lie between -1 and 1 [-]")
        if yield_stress is not None:
            positive(SurfaceError, "yield_stress", yield_stress, "Pa")
        bulk = BulkStrain(meridional, hoop, yield_stress, elastic)
        return replace(self, bulk=bulk if meridional or hoop or elastic else None)

    @cached_property
    def _bulk_flow(self) -> BulkFlow | None:
        return None if self.bulk is None else self._flow_of(self.bulk)

    def _flow_of(self, bulk: BulkStrain) -> BulkFlow:
        assert self.hardness is not None  # of all who ask
        return BulkFlow.of(
            bulk,
            rms_slope=self.spectrum.rms_slope,
            hardness=self.hardness,
            effective_modulus=self.effective_modulus,
            peklenik=self.peklenik,
        )

    def pressure_at_rest(
        self, pressure: ArrayLike, meridional: ArrayLike, hoop: ArrayLike, elastic: ArrayLike = 0.0
    ) -> FloatArray:
        """Pressure at which the face over a bulk that is not strained lets as much through.

        Parameters
        ----------
        pressure : array_like
            Nominal [Pa].
        meridional, hoop : array_like
            Strain of the bulk at each of them, see `strained`; it counts for asperities that yield, by the corrected
            theory [-].
        elastic : array_like
            Sum of both elastic strains while the face is loaded, which make its summits softer or harder [-].

        Returns
        -------
        ndarray
            Of the broadcast shape; below the pressure only where metal is pressed together elastically [Pa].

        Examples
        --------
        >>> spectrum = PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=4e4, q_high=1e6)
        >>> face = RoughContact(spectrum, effective_modulus=115e9, hardness=1e9, theory="corrected")
        >>> bool(face.pressure_at_rest(1e8, 0.01, 0.0) > 1e8)
        True
        """
        strains = (np.asarray(strain) for strain in (meridional, hoop, elastic))
        p, m, h, e = np.broadcast_arrays(_checked_pressure(pressure), *strains)
        if self.hardness is None or self.theory != "corrected":
            return np.array(p)
        return self._at_rest(p, self._flow_of(BulkStrain(m, h, elastic=e)))

    @property
    def other_way(self) -> RoughContact:
        """The same surface for flow in the other direction; itself without a lay."""
        return self if self.peklenik == 1.0 else replace(self, peklenik=1.0 / self.peklenik)

    @property
    def elastic(self) -> RoughContact:
        """The same surface without asperity plasticity."""
        return self.reading(Reading.ELASTIC)

    @property
    def conserved(self) -> RoughContact:
        """The same surface, its volume conserved everywhere; itself where there is but one reading."""
        return self.reading(Reading.CONSERVED)

    @property
    def capped(self) -> RoughContact:
        """The same surface, changed only where it touches; itself where there is but one reading."""
        return self.reading(Reading.CAPPED)

    @cached_property
    def equivalent_elastic_surface(self) -> RoughContact | None:
        """The elastic surface of the paper's theory that, at `equivalent_pressure`, has the gaps of this one.

        None where the theory is asked at the pressure itself.
        """
        if self.theory == "corrected":
            paper = replace(self, hardness=None, theory="paper", yielding="", bulk=None)
            return paper if self.peklenik == 1.0 else _OfEqualGap(**vars(paper))
        return None if self.hardness is None or self.smoothed else self.elastic

    @property
    def wavelength_along_flow(self) -> float:
        """Of the waves with half of the height variance below them; a lay stretches them along the flow [m]."""
        return 2.0 * math.pi / self.spectrum.median_wavenumber * math.sqrt(self.peklenik)

    @property
    def touch_distance(self) -> float:
        """Between two rough faces that just touch [m]: of a million summits one is higher than five rms heights."""
        return 5.0 * self.spectrum.rms_height

    @property
    def knows_deviation(self) -> bool:
        """Whether its theory says how far direct simulation may find the flow, see `flow_error`."""
        return self.theory == "corrected"

    @property
    def exponential_at_low_pressure(self) -> bool:
        """Whether the pressure then falls exponentially with the gap, by `u0` and `p_c` of the spectrum."""
        return self.theory == "paper"

    @property
    def latest_sealing_pressure(self) -> float:
        """The largest `sealing_pressure` of all readings of metal that yields [Pa]."""
        return max(self.reading(reading).sealing_pressure for reading in self.readings)

    @property
    def smoothed(self) -> bool:
        """Whether C_pl stands in for C."""
        return self.hardness is not None and self.yielding == Reading.CONSERVED

    def equivalent_pressure(self, pressure: ArrayLike) -> FloatArray:
        """Nominal pressure at which the theory is asked for the gaps: that of `equivalent_elastic_surface` [Pa]."""
        p = self._elastic_pressure(_checked_pressure(pressure))
        if self.theory == "paper":
            return p
        # where no gap is left the pressure has no end
        with np.errstate(divide="ignore", over="ignore"):
            return np.exp(self._of_equal_gap(np.log(p)))

    def _elastic_pressure(self, p: FloatArray) -> FloatArray:
        """Pressure at which the surface without hardness has the same gaps, but where C_pl stands in for C [Pa]."""
        return p if self.hardness is None or self.smoothed else self._equivalent(p)

    def _of_equal_gap(self, log_pressure: FloatArray) -> FloatArray:
        """ln p at which the paper's theory has the mean gap of the gap law at ln(p/Pa)."""
        curve, unit = self._equal_gap
        # from the hardness on, where no gap is left, what acts has no end
        in_range = np.clip(log_pressure, _WIDEST_LOG_PRESSURE, LARGEST_LOG)
        return curve.value(in_range - unit) + unit + (log_pressure - in_range)

    @property
    def _equal_gap(self) -> tuple[MonotoneCurve, float]:
        """Acting over nominal ln p of elastic asperities, both without their unit, and ln of the unit in Pa."""
        height = self.spectrum.rms_height / self.spectrum.shape.rms_height
        return _equal_gap(self.spectrum.shape, self.gamma), math.log(self.effective_modulus * height)

    def log_equivalent_pressure(self, log_pressure: FloatArray) -> FloatArray:
        """`equivalent_pressure` as logarithms, where p itself may be too small for a floating-point number.

        Parameters
        ----------
        log_pressure : ndarray
            ln(p/Pa).
        """
        elastic = self._log_elastic(log_pressure)
        return elastic if self.theory == "paper" else self._of_equal_gap(elastic)

    def _log_elastic(self, log_pressure: FloatArray) -> FloatArray:
        """`_elastic_pressure` as logarithms."""
        in_range = np.maximum(log_pressure, _LEAST_LOG_PRESSURE)
        return log_pressure + (np.log(self._elastic_pressure(np.exp(in_range))) - in_range)

    def _equivalent(self, p: FloatArray, largest: FloatArray | None = None) -> FloatArray:
        """Pressure at which the elastic surface has the gaps of the one that yields where it touches."""
        assert self.hardness is not None  # of all who ask
        bearing, sealing = _bearing_and_sealing(self.elastic)
        if self._bulk_flow is not None:
            p = self._at_rest(p, self._bulk_flow)
            largest = None if largest is None else self._at_rest(largest, self._bulk_flow)
        return equivalent_pressure(
            p,
            hardness=self.hardness,
            effective_modulus=self.effective_modulus,
            rms_slope=self.spectrum.rms_slope,
            bearing_pressure=bearing,
            sealing_pressure=sealing,
            largest=largest,
            constants=CAPPED if self.theory == "paper" else VON_MISES,
        )

    def _at_rest(self, p: FloatArray, flow: BulkFlow) -> FloatArray:
        """`pressure_at_rest` over one bulk [Pa]."""
        assert self.hardness is not None  # of all who ask
        with np.errstate(divide="ignore"):
            log_share = np.log(p / self.hardness)
        acts = flow.pressure(np.exp(self._area_curve.value(np.minimum(log_share, 0.0))), p)
        return np.where(p < self.hardness, np.minimum(acts, self.hardness * _BELOW_HARDNESS), p)

    @cached_property
    def _area_curve(self) -> MonotoneCurve:
        """ln(A/A0) over ln(p/hardness) of the face over a bulk that is not strained."""
        assert self.hardness is not None  # of all who ask
        parts = area_fractions(*self._yield_variables(self.hardness * np.exp(_LOG_SHARES), None))
        log_area = np.log(parts.elastic + parts.plastic)
        return MonotoneCurve(_LOG_SHARES, log_area, spline_slopes(_LOG_SHARES, log_area))

    def equivalent_first_loading_pressure(self, pressure: ArrayLike, largest: ArrayLike) -> FloatArray:
        """Pressure of first loading that leaves the gaps of a place which carries less than it once did.

        The spring-back of direct simulation, see `leak.theory.plasticity.equivalent_pressure`, in either reading: of
        the volume that yields C_pl says where it goes, but not how much of a gap comes back.

        Parameters
        ----------
        pressure : array_like
            Nominal pressure [Pa].
        largest : array_like
            Largest one that the place has carried, counting where it exceeds `pressure` [Pa].

        Returns
        -------
        ndarray
            Between both, of the broadcast shape [Pa]; `pressure` where nothing larger was carried, where it is zero,
            and for elastic asperities; the largest one from the hardness on.
        """
        p = _checked_pressure(pressure)
        p, top = np.broadcast_arrays(p, np.maximum(p, _checked_pressure(largest)))
        result = np.array(p)
        if self.hardness is None:
            return result
        flat = (p > 0.0) & (top >= self.hardness)
        result[flat] = top[flat]
        harder = (p > 0.0) & (top > p) & ~flat
        if np.any(harder):
            acts = self._equivalent(p[harder], top[harder])
            ends = np.log(p[harder]), np.log(top[harder])
            result[harder] = np.exp(bisect_roots(lambda x: self._equivalent(np.exp(x)) < acts, *ends)[1])
        return result

    @cached_property
    def _low_pressure_law(self) -> LowPressureLaw:
        return low_pressure_law(self.spectrum, self.gamma)

    @property
    def u0(self) -> float:
        """Decay length of the elastic low-pressure law p = p_c exp(-u/u0) [m]."""
        return self._low_pressure_law.u0

    @property
    def p_c(self) -> float:
        """Prefactor of the elastic low-pressure law p = p_c exp(-u/u0) [Pa]."""
        return self._low_pressure_law.relative_p_c * self.effective_modulus

    # ---------------------------------------------------------------- areas

    def contact_area(self, pressure: ArrayLike, wavenumber: ArrayLike | None = None) -> FloatArray | float:
        """Relative contact area A/A0 seen with roughness up to `wavenumber` (all of it by default).

        With a hardness it is the sum of `elastic_area` and `plastic_area`.
        """
        parts = self._area_fractions(pressure, wavenumber)
        return _scalar(parts.elastic + parts.plastic)

    def most_contact_area(self, pressure: float) -> float:
        """What `contact_area` of all the roughness does not exceed, in a few numbers.

        The area that touches elastic asperities, erf(p/(2 sqrt(G))), is at most its tangent at p = 0; one boundary
        more, at the hardness, adds no more than p/hardness, by the maximum principle of the diffusion in the stress.

        Parameters
        ----------
        pressure : float
            Nominal pressure, not negative [Pa].
        """
        most = 2.0 * pressure / (np.pi * self.effective_modulus * np.sqrt(self.spectrum.whole_moment))
        most = most if self.hardness is None else most + pressure / self.hardness
        most, flow = float(most), self._bulk_flow
        return most if flow is None else float(flow.area(np.array(min(most, 1.0)), np.array(pressure)))

    def corrected_contact_area(self, pressure: ArrayLike) -> FloatArray | float:
        """A/A0 of all the roughness, corrected as in `leak.flow.medium.corrected_area`.

        With a hardness that of C_pl, or of the elastic surface with the gaps of the one that yields where it touches.

        Within 6 % of direct numerical results for elastic asperities, where `contact_area` is 15 to 30 % below. Zero at
        p = 0, one from the hardness on.
        """
        p = _checked_pressure(pressure)
        most = math.inf if self.hardness is None else self.hardness * _BELOW_HARDNESS
        acts = self._elastic_pressure(np.minimum(p, most)).ravel()
        area = self._corrected_area(acts, self._roughness_at(acts)).reshape(p.shape)
        return _scalar(np.where(p < most, np.where(p > 0.0, area, 0.0), 1.0))

    def elastic_area(self, pressure: ArrayLike, wavenumber: ArrayLike | None = None) -> FloatArray | float:
        """Relative area A_el/A0 in elastic contact; all of the contact area without a hardness."""
        return _scalar(self._area_fractions(pressure, wavenumber).elastic)

    def plastic_area(self, pressure: ArrayLike, wavenumber: ArrayLike | None = None) -> FloatArray | float:
        """Relative area A_pl/A0 that has yielded; zero without a hardness."""
        return _scalar(self._area_fractions(pressure, wavenumber).plastic)

    def _area_fractions(self, pressure: ArrayLike, wavenumber: ArrayLike | None) -> AreaFractions:
        if self.hardness is not None:
            parts = area_fractions(*self._yield_variables(pressure, wavenumber))
            if self._bulk_flow is None:
                return parts
            touched = self._bulk_flow.area(parts.elastic + parts.plastic, _checked_pressure(pressure))
            return AreaFractions(parts.elastic, touched - parts.elastic, 1.0 - touched)
        moment = self._slope_moment(wavenumber)
        elastic = relative_contact_area(_checked_pressure(pressure), moment, self.effective_modulus)
        return AreaFractions(elastic, 0.0 * elastic, 1.0 - elastic)

    def _yield_variables(
        self, pressure: ArrayLike, wavenumber: ArrayLike | None
    ) -> tuple[FloatArray, FloatArray]:
        """s = p/sigma_P and t = G/sigma_P^2."""
        assert self.hardness is not None  # of all who ask
        t = 0.25 * np.pi * (self.effective_modulus / self.hardness) ** 2 * self._slope_moment(wavenumber)
        return _checked_pressure(pressure) / self.hardness, t

    def _slope_moment(self, wavenumber: ArrayLike | None) -> FloatArray:
        return self.spectrum.slope_moment(self.spectrum.q_high if wavenumber is None else wavenumber)

    # ---------------------------------------------------------------- plastically smoothed spectrum

    def smoothing(self, pressure: ArrayLike, wavenumber: ArrayLike) -> FloatArray | float:
        """C_pl/C at nominal pressure p and wavenumber q; one without a hardness, and for a capped surface."""
        if not self.smoothed:
            return _scalar(np.ones(np.broadcast_shapes(np.shape(pressure), np.shape(wavenumber))))
        return _scalar(remaining_fraction(*self._yield_variables(pressure, wavenumber)))

    def plastic_spectrum(self, pressure: float, *, spacing: float = 0.004) -> PowerSpectrum:
        """C_pl at one nominal pressure, as a spectrum of its own.

        Parameters
        ----------
        pressure : float
            Nominal pressure, below the hardness [Pa].
        spacing : float
            Spacing of its nodes in ln q. At the default the log-log interpolation is good to 3e-4 even where C_pl
            has fallen by a hundred decades; `smoothing` is exact.
        """
        if self.hardness is None or not self.smoothed:
            return self.spectrum
        if not 0.0 <= float(pressure) < self.hardness:
            raise SurfaceError(f"pressure = {pressure}: must be below the hardness {self.hardness} [Pa]")
        fine = np.exp(divide_stretches(np.log(self.spectrum.wavenumber), spacing))
        q = np.unique(np.concatenate([fine, self.spectrum.wavenumber]))
        q = np.clip(q, self.spectrum.q_low, self.spectrum.q_high)
        C = np.asarray(self.spectrum(q)) * np.asarray(self.smoothing(float(pressure), q))
        is_left = C > 1e-250
        return PowerSpectrum(q[is_left], C[is_left])

    # ---------------------------------------------------------------- separations

    def mean_separation(self, pressure: ArrayLike, *, largest: ArrayLike | None = None) -> FloatArray | float:
        """Mean separation ubar(p) [m]; with a hardness that of C_pl at p. Infinite at p = 0.

        Parameters
        ----------
        pressure : array_like
            Nominal pressure [Pa].
        largest : array_like, optional
            See `effective_separation`.
        """

        def mean(p: FloatArray, roughness: Roughness) -> FloatArray:
            return self._mean(p, roughness).mean[:, 0]

        return self._over_pressure(pressure, mean, largest)

    def pressure(self, separation: ArrayLike) -> FloatArray | float:
        """Nominal pressure at which the mean separation is u, the inverse of `mean_separation` [Pa]."""
        return _scalar(np.asarray(self.interface_law(plastic=self.hardness is not None).pressure(separation)))

    def contact_stiffness(
        self, pressure: ArrayLike, *, largest: ArrayLike | None = None
    ) -> FloatArray | float:
        """dp/du of a small unloading, at which nothing yields and all spots stay [Pa/m].

        That which ultrasound measures; dp/du of `interface_law` on loading is less where asperities yield. Zero at
        p = 0, infinite from the hardness on.

        Parameters
        ----------
        pressure : array_like
            Nominal pressure [Pa].
        largest : array_like, optional
            See `effective_separation`.

        References
        ----------
        J.-Y. Kim, A. Baltazar, S. I. Rokhlin, J. Mech. Phys. Solids 52, 1911 (2004).
        """
        p = _checked_pressure(pressure)
        p, top = np.broadcast_arrays(p, p if largest is None else np.maximum(p, _checked_pressure(largest)))
        carries = (p > 0.0) & (top < (math.inf if self.hardness is None else self.hardness * _BELOW_HARDNESS))
        stiffness = np.where(p > 0.0, np.inf, 0.0)
        if np.any(carries):
            p, top = p[carries], top[carries]
            at, below = (
                np.log(self.equivalent_first_loading_pressure(share * p, top))
                for share in (1.0, 1.0 - _UNLOADS)
            )
            decay = self.interface_law(plastic=self.hardness is not None).decay_length(at)
            stiffness[carries] = -math.log1p(-_UNLOADS) * p / (decay * (at - below))
        return _scalar(stiffness)

    def interface_law(self, plastic: bool = False) -> RoughSurfaceLaw:
        """p(u) for a contact calculation: that of the elastic spectrum, or of C_pl at the local pressure.

        Raises
        ------
        SurfaceError
            `plastic` without a hardness.
        """
        if plastic and self.hardness is None:
            raise SurfaceError("hardness = None: the plastic interface law needs a hardness [Pa]")
        return _interface_law(self if plastic else self.elastic)

    def separation_distribution(
        self, pressure: float, separation: ArrayLike | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Separations u [m] and the density P(u) [1/m] at one nominal pressure.

        The delta at u = 0 of weight `contact_area` (that of C_pl with a hardness) is not part of the density.

        Parameters
        ----------
        pressure : float
            Nominal pressure, positive and below the hardness [Pa].
        separation : array_like, optional
            Where P(u) is wanted, shape (n,) [m]; by default a grid that holds all of it.
        """
        p = np.array([positive(SurfaceError, "pressure", pressure, "Pa")])
        if self.hardness is not None and p[0] >= self.hardness:
            raise SurfaceError(f"pressure = {pressure}: must be below the hardness {self.hardness} [Pa]")
        loss = self.lost_area(p, refinement=_DISTRIBUTION_REFINEMENT)
        if separation is None:
            height = self.spectrum.rms_height
            u = SeparationGrid.of(loss.mean_separation, height, count=1024).separation
        else:
            u = np.atleast_1d(np.asarray(separation, dtype=float))[None, :]
        order = u[0].argsort()
        P = np.empty(order.size)
        P[order] = density(loss, u[:, order])[0]
        return u[0], P

    def lost_area(self, pressure: FloatArray, refinement: float = 1.0, factor: float = 1.0) -> LostArea:
        """Area that loses contact from one magnification to the next.

        Parameters
        ----------
        pressure : ndarray, shape (P,)
            Nominal pressures, positive and below the hardness [Pa].
        refinement : float
            So many times more magnifications.
        factor : float
            So many times the pressure acts on the surface as it has yielded.
        """
        equivalent = self.equivalent_pressure(pressure)
        return self._lost_area(factor * equivalent, self._roughness_at(equivalent), refinement)

    def _lost_area(self, p: FloatArray, roughness: Roughness, refinement: float) -> LostArea:
        relative = p / self.effective_modulus
        return lost_area(
            self.spectrum, roughness, relative, self.gamma, self.separation_width, refinement=refinement
        )

    # ---------------------------------------------------------------- flow

    def critical_separation(
        self, pressure: ArrayLike, *, largest: ArrayLike | None = None
    ) -> FloatArray | float:
        """Separation u_c at the critical junction, u1 where A(zeta)/A0 is the percolation threshold [m].

        Zero where no magnification opens a path. References: Fischer et al., eq. (12).

        Parameters
        ----------
        pressure : array_like
            Nominal pressure [Pa].
        largest : array_like, optional
            See `effective_separation`.
        """
        return self._over_pressure(pressure, self._critical_separation, largest)

    def effective_separation(
        self,
        pressure: ArrayLike,
        method: str = "bruggeman",
        *,
        refinement: float = 1.0,
        largest: ArrayLike | None = None,
    ) -> FloatArray | float:
        """u_eff = (12 eta sigma_eff)^(1/3) along the flow [m]; independent of the fluid, zero where sealed.

        Parameters
        ----------
        pressure : array_like
            Nominal pressure [Pa].
        method : {"bruggeman", "critical-junction", "threshold-law"}
            Effective medium over all channels, the critical junction alone (u_eff = u_c), or the effective medium that
            goes over into the closed law of `leak.flow.medium` from A/A0 = 0.15 on. The last two know no direction
            and are refused unless peklenik = 1.
        refinement : float
            Every grid of the effective medium has so many times more points, which shows its error.
        largest : array_like, optional
            Largest nominal pressure that the place has carried, counting where it exceeds `pressure`; broadcast
            against it [Pa]. Asperities that yielded then do not come back: u_eff is that of first loading at
            `equivalent_first_loading_pressure`.
        """
        self._check_method(method)
        if method == "critical-junction":
            return self.critical_separation(pressure, largest=largest)
        u = self._effective_separation if method == "bruggeman" else self._near_threshold
        return self._over_pressure(pressure, partial(u, refinement=refinement), largest)

    def flow_conductivity(
        self, pressure: ArrayLike, viscosity: float, method: str = "bruggeman"
    ) -> FloatArray | float:
        """sigma_eff = u_eff^3/(12 eta) [m^3/(Pa s)]."""
        eta = positive(ConductivityError, "viscosity", viscosity, "Pa s")
        return _scalar(np.asarray(self.effective_separation(pressure, method)) ** 3 / (12.0 * eta))

    def rarefied_separation(
        self, pressure: FloatArray, log_inverse_knudsen: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """u_eff of the effective medium [m], and ln R of `GasConductivityTable`, not finite where it is sealed.

        Parameters
        ----------
        pressure : ndarray
            Nominal contact pressures between zero and the hardness, shape (n,) [Pa].
        log_inverse_knudsen : ndarray
            ln D_eff, shape (m,).

        Returns
        -------
        separation : ndarray, shape (n,)
        log_rarefaction : ndarray, shape (n, m)
        """
        n, height = medium.dimension_number(self.percolation_threshold), self.spectrum.rms_height
        u, log_R = np.empty(pressure.size), np.empty((pressure.size, log_inverse_knudsen.size))
        for part in _parts(np.arange(pressure.size)):
            equivalent = self.equivalent_pressure(pressure[part])
            loss, aspect = self._channels(equivalent, self._roughness_at(equivalent), 1.0)
            u[part], gas = medium.effective_gaps(loss, height, n, aspect, np.exp(log_inverse_knudsen))
            with np.errstate(divide="ignore", invalid="ignore"):
                log_R[part] = 3.0 * np.log(gas / u[part, None]) - log_flow_factor(log_inverse_knudsen)
        return u, log_R

    def flow_error(self, pressure: ArrayLike, *, waves: float = math.inf) -> FlowError:
        """How far the flow conductivity may be from direct simulation, see `leak.theory.own_error`.

        Parameters
        ----------
        pressure : array_like
            Nominal pressure, positive [Pa].
        waves : float
            Roll-off wave lengths squared that the sealing area holds; without end, the error of the theory alone [-].

        Raises
        ------
        ConductivityError
            The paper's theory, which does not know its error.
        """
        if not self.knows_deviation:
            raise ConductivityError(f"theory = {self.theory!r}: only 'corrected' knows its own error")
        p = _checked_pressure(pressure)
        relative = p / (self.effective_modulus * self.spectrum.rms_slope)
        area = np.asarray(self.corrected_contact_area(p))
        if self.hardness is None:
            return flow_error(relative, area, waves=waves)
        yield_share = 1.0 - p / self._elastic_pressure(p)
        touched = np.asarray(self.contact_area(p))
        error = flow_error(relative, np.maximum(area, touched), waves=waves, yielded=yield_share)
        if self._bulk_flow is None:
            return error
        at_rest = replace(self, bulk=None).contact_area(p)
        sunk = (self._bulk_flow.constants.spread * (1.0 - np.asarray(at_rest) / touched)) ** 2
        parts = {**error.parts, "bulk flow": sunk}
        return FlowError(error.bias, np.sqrt(error.spread**2 + sunk), parts)

    @cached_property
    def sealing_pressure(self) -> float:
        """Pressure from which A/A0 at full magnification exceeds the percolation threshold: nothing flows [Pa]."""
        return self._sealing_pressure(medium.area_argument_at(self.percolation_threshold))

    def sealing_pressure_by(self, method: str) -> float:
        """Pressure from which nothing flows, by a method of `effective_separation` [Pa].

        That of "threshold-law" is lower than `sealing_pressure`: its corrected area reaches the threshold earlier.
        """
        self._check_method(method)
        if method != "threshold-law":
            return self.sealing_pressure
        return self._sealing_pressure(medium.argument_at(self.percolation_threshold))

    def _sealing_pressure(self, z: float) -> float:
        """Pressure at which p/(2 sqrt(G)) at full magnification is z [Pa]."""
        elastic = float(z * np.sqrt(np.pi * self.spectrum.last_moment) * self.effective_modulus)
        if self.theory == "corrected":
            return _sealing_by_equal_gap(self, elastic)
        if self.hardness is None:
            return elastic
        low, high = 0.0, min(elastic, self.hardness)
        if not self.smoothed:
            return self._reaches(elastic, low, high)

        hardness, top_share = self.hardness, min(high / self.hardness, 1.0 - 1e-12)
        kappa = 0.25 * math.pi * (self.effective_modulus / hardness) ** 2

        def excess(log_odds: float) -> float:
            """All but straight in ln(s/(1 - s)), s = p/hardness: C_pl keeps all at a small s, (1 - s)^2 toward one."""
            s = 1.0 / (1.0 + math.exp(-log_odds))
            moment = remaining_moment(s, kappa, self.spectrum.last_moment)
            return math.log(s * hardness / (z * self.effective_modulus)) - 0.5 * math.log(math.pi * moment)

        log_odds = math.log(top_share / (1.0 - top_share))
        ends, start = (log_odds - _SEALING_RANGE, log_odds), min(log_odds, _USUAL_ODDS)
        log_odds = root_of_rising(excess, *ends, start, 1e-8)
        return hardness / (1.0 + math.exp(-log_odds))

    def _reaches(self, target: float, low: float, high: float) -> float:
        """Nominal pressure between `low` and `high` whose equivalent one is `target` [Pa]."""
        # 64 parts at a time cost as much as one; ten times is down to the last digit
        for _ in range(10):
            ends = np.linspace(low, high, 65)
            places = np.flatnonzero(self.equivalent_pressure(ends[1:-1]) >= target)
            part = int(places[0]) if len(places) else 63
            low, high = float(ends[part]), float(ends[part + 1])
        return high

    def conductivity_table(
        self, p_min: float, p_max: float, num: int | None = None, method: str = "bruggeman"
    ) -> ConductivityTable:
        """Table of u_eff over ln p that serves every fluid and every geometry; made once per surface and range.

        Parameters
        ----------
        p_min, p_max : float
            Range of nominal pressures [Pa]. Below p_min the table goes on by the low-pressure law.
        num : int, optional
            Number of pressures in the range, at least 8; by default as many, and where, as u_eff needs to be good to
            some 1e-5, 3e-4 at worst, but where less than a tenth of the sealing pressure is missing to it. By the law
            of the threshold 2e-3 around corrected areas of 0.15 and 0.25, where it begins and where it stands alone.
        method : {"bruggeman", "critical-junction", "threshold-law"}
            See `effective_separation`.
        """
        return _conductivity_table(self, *_checked_range(p_min, p_max, num), method).liquid

    # ---------------------------------------------------------------- inside

    def _roughness_at(self, p: FloatArray) -> Roughness:
        if self.hardness is None or not self.smoothed:
            return Roughness(self.spectrum.last_moment)
        return PlasticRoughness.at(
            p / self.hardness, self.effective_modulus, self.hardness, self.spectrum.last_moment
        )

    def _mean(self, p: FloatArray, roughness: Roughness) -> Separations:
        """Separations at the magnification where no roughness is seen yet."""
        relative = p / self.effective_modulus
        return separations(self.spectrum, roughness, relative, np.zeros((1, 1)), self.gamma, refinement=3.0)

    def _over_pressure(
        self,
        pressure: ArrayLike,
        function: Callable[[FloatArray, Roughness], FloatArray],
        largest: ArrayLike | None = None,
    ) -> FloatArray | float:
        """Apply `function` where 0 < p < hardness; separations are infinite at p = 0, zero from the hardness on."""
        p = (
            _checked_pressure(pressure)
            if largest is None
            else self.equivalent_first_loading_pressure(pressure, largest)
        )
        flat = p.ravel()

        def at(p: FloatArray) -> FloatArray:
            acts = self.equivalent_pressure(p)
            return function(acts, self._roughness_at(acts))

        values = np.full(flat.shape, np.inf)
        least = _LEAST_RELATIVE_PRESSURE * self.effective_modulus
        usual, tiny = flat > least, (flat > 0.0) & ~(flat > least)
        if self.hardness is not None:
            is_flat = flat >= self.hardness * _BELOW_HARDNESS
            values[is_flat] = 0.0
            usual &= ~is_flat
        index = np.flatnonzero(usual)
        for part in _parts(index):
            values[part] = at(flat[part])
        if np.any(tiny):
            at_least, at_higher = at(np.array([least, np.e * least]))
            values[tiny] = at_least + (at_least - at_higher) * np.log(least / flat[tiny])
        return _scalar(values.reshape(p.shape))

    def _check_method(self, method: str) -> None:
        if method not in flow.METHODS:
            raise ConductivityError(f"method = {method!r}: must be one of {flow.METHODS}")
        if method in flow.WITHOUT_DIRECTION and self.peklenik != 1.0:
            why = "a single junction" if method == "critical-junction" else "the closed law of the threshold"
            raise ConductivityError(
                f"method = {method!r} with peklenik = {self.peklenik}: {why} has no direction; use 'bruggeman'"
            )

    def _effective_separation(self, p: FloatArray, roughness: Roughness, refinement: float) -> FloatArray:
        loss, aspect = self._channels(p, roughness, refinement)
        n = medium.dimension_number(self.percolation_threshold)
        return medium.effective_gap(loss, self.spectrum.rms_height, n, aspect, refinement=refinement)

    def _channels(
        self, p: FloatArray, roughness: Roughness, refinement: float
    ) -> tuple[LostArea, float | FloatArray]:
        """Area lost and aspect of the inclusions of the effective medium, at acting pressures."""
        if self.peklenik == 1.0:
            return self._lost_area(p, roughness, refinement), 1.0
        area = relative_contact_area(p, moment_of_all(roughness, p.size), self.effective_modulus)
        share = area / self.percolation_threshold
        factor = self._touching_pressure(share)
        aspect = medium.inclusion_aspect(self.peklenik, share)
        return self._lost_area(p * factor, roughness, refinement), aspect

    def _touching_pressure(self, share: FloatArray) -> FloatArray:
        of_theory = (
            medium.touching_pressure if self.theory == "paper" else medium.touching_pressure_at_equal_gap
        )
        return of_theory(self.peklenik, share)

    def _near_threshold(self, p: FloatArray, roughness: Roughness, refinement: float) -> FloatArray:
        loss = self._lost_area(p, roughness, refinement)
        n = medium.dimension_number(self.percolation_threshold)
        u = medium.effective_gap(loss, self.spectrum.rms_height, n, refinement=refinement)
        mean = self._mean(p, roughness).mean[:, 0]
        return medium.near_threshold(u, mean, self._corrected_area(p, roughness), self.percolation_threshold)

    def _corrected_area(self, p: FloatArray, roughness: Roughness) -> FloatArray:
        """Corrected A/A0 of the roughness that is seen, at acting pressures, shape (P,)."""
        moment = moment_of_all(roughness, p.size)
        return medium.corrected_area(area_argument(p / self.effective_modulus, moment))

    def _critical_separation(self, p: FloatArray, roughness: Roughness) -> FloatArray:
        relative = p / self.effective_modulus
        return medium.critical_gap(self.spectrum, roughness, relative, self.gamma, self.percolation_threshold)


class _OfEqualGap(RoughContact):
    """Stands in for a surface of the corrected theory, whose gaps where little touches are right without the medium."""

    def _touching_pressure(self, share: FloatArray) -> FloatArray:
        return medium.touching_pressure_at_equal_gap(self.peklenik, share)


def _parts(index: IntArray) -> list[IntArray]:
    """About `_CHUNK` at a time."""
    return np.array_split(index, max(round(index.size / _CHUNK), 1)) if index.size else []


@lru_cache(maxsize=64)
def _equal_gap(shape: PowerSpectrum, gamma: float) -> MonotoneCurve:
    """ln(p/E*) at which the paper's theory has the mean gap of the gap law at ln(p/E*), for elastic asperities."""
    law, paper = gap_law(shape), RoughContact(shape, effective_modulus=1.0, gamma=gamma).interface_law()
    log_p = paper.log_pressure(law.gap_nodes)
    return MonotoneCurve(law.log_pressure_nodes, log_p, law.decay_nodes / paper.decay_length(log_p))


@lru_cache(maxsize=256)
def _sealing_by_equal_gap(surface: RoughContact, elastic: float) -> float:
    """Pressure at which the gaps are those of an elastic surface of the paper's theory at its own sealing [Pa].

    Made once per surface: of all that a load is asked for it would take the longest.
    """
    if surface.hardness is None:
        curve, unit = surface._equal_gap
        return math.exp(float(curve.inverse(np.array(math.log(elastic) - unit))) + unit)
    return surface._reaches(elastic, 0.0, min(_MOST_SEALING * elastic, surface.hardness))


# Surfaces that differ in hardness alone have one elastic surface in common.
@lru_cache(maxsize=64)
def _bearing_and_sealing(elastic: RoughContact) -> tuple[float, float]:
    gap = BEARING_GAP * elastic.spectrum.rms_height
    if elastic.theory == "corrected":
        bearing = elastic.effective_modulus * float(gap_law(elastic.spectrum).pressure(gap))
        return bearing, elastic.sealing_pressure
    # ubar is convex in ln p: from the second on Newton's steps stay on one side
    log_p = np.log(_USUAL_BEARING * elastic.effective_modulus * elastic.spectrum.rms_slope)
    for _ in range(MOST_STEPS):
        p = np.exp(np.array([log_p]))
        separation = elastic._mean(p, elastic._roughness_at(p))
        step = float((separation.mean[0, 0] - gap) / separation.decay[0, 0])
        log_p += step
        if abs(step) < _CLOSE:
            break
    return float(np.exp(log_p)), elastic.sealing_pressure


# Bearing pressures are 0.4 to 7 % of E* h'; after a step in ln p this small Newton's method is at rounding.
_USUAL_BEARING, _CLOSE = 0.02, 1e-6

# The gap law has the gap at which the paper's theory seals within a factor of this.
_MOST_SEALING = 4.0
# How far below the largest one ln(s/(1 - s)) of a sealing pressure is looked for, and what few exceed.
_SEALING_RANGE, _USUAL_ODDS = 40.0, 0.0

# The table's last point below the sealing pressure, as a fraction of it; u_eff is below any molecule's size there.
_CLOSEST_TO_SEALING, _CLOSEST_TO_POWER = 0.02, 1e-3
# Distances below p_min, in ln p, of the points that carry the table on: a few decades, then ever wider.
_LOG_STEPS_BELOW = 0.5 * 1.5 ** np.arange(13.0, -1.0, -1.0)


def _density(relative: FloatArray) -> FloatArray:
    """Pressures per step of the abscissa that make the error of a table even, at fractions of the sealing pressure.

    Few where the law at low pressure holds, most around half the sealing pressure, where channels close, and half as
    many beyond 0.95, where the abscissa is long and next to nothing flows.
    """
    channels_close = 0.6 + 0.8 * np.exp(-(((relative - 0.45) / 0.3) ** 2))
    nearly_sealed = 1.0 / (1.0 + (0.05 / (1.0 - relative)) ** 3)
    return (0.25 + 0.75 * channels_close / (1.0 + 0.007 / relative)) * (0.5 + 0.5 * nearly_sealed)


# Where the pressures follow from the error: the first ones, in `_BELOW` and in the range, and how well the cubic
# through four of them must predict the one in the middle; the spline through all is a hundred times better.
_FIRST_BELOW, _FIRST_INSIDE = slice(0, None, 3), 9
_TABLE_ERROR = 1e-4
_MOST_INTERVALS = 96


@dataclass(frozen=True)
class _Range:
    """Pressures of a table, from far below its range to its end or to the last one that is not yet sealed.

    Parameters
    ----------
    sealing_pressure : float
        [Pa]
    fine : ndarray
        Many ln p between both ends of the range.
    below : ndarray
        ln p below them.
    method : str
        Of the flow conductivity.
    end : float
        Of the range that is asked for, the sealing pressure at most [Pa].
    """

    sealing_pressure: float
    fine: FloatArray
    log_pressure_below: FloatArray
    method: str
    end: float

    @classmethod
    def of(cls, surface: RoughContact, p_min: float, p_max: float, method: str) -> _Range:
        sealing_pressure = surface.sealing_pressure_by(method)
        # toward the closed law's power of 1 - p/p_seal steps of its logarithm are even
        margin = _CLOSEST_TO_POWER if method == "threshold-law" else _CLOSEST_TO_SEALING
        top = min(p_max, (1.0 - margin) * sealing_pressure)
        fine = np.linspace(np.log(min(p_min, 1e-3 * top)), np.log(top), 3200)
        log_p_below = fine[0] - _LOG_STEPS_BELOW
        log_p_below = log_p_below[log_p_below > np.log(1e-60 * surface.effective_modulus)]
        return cls(sealing_pressure, fine, log_p_below, method, min(p_max, sealing_pressure))

    @cached_property
    def _abscissa(self) -> FloatArray:
        return flow.table_abscissa(self.fine, np.log(self.sealing_pressure), self.method)

    @property
    def ends(self) -> FloatArray:
        """Both ends of the range [Pa]."""
        return np.exp(self.fine[[0, -1]])

    def spread_pressures(self, num: int) -> FloatArray:
        """`num` pressures as dense as `_density` says, after every second one below [ln(p/Pa)]."""
        density = _density(np.exp(self.fine) / self.sealing_pressure)
        steps = 0.5 * (density[1:] + density[:-1]) * np.diff(self._abscissa)
        sums = np.concatenate([[0.0], np.cumsum(steps)])
        in_range = np.interp(np.linspace(0.0, sums[-1], num), sums, self.fine)
        return np.concatenate([self.log_pressure_below[::-2][::-1], in_range])

    def adapt_pressures(
        self, values: Callable[[FloatArray], FloatArray], length: float
    ) -> tuple[FloatArray, FloatArray]:
        """Pressures that follow from the error of u_eff, and the values there.

        Parameters
        ----------
        values : callable
            What is tabulated, at pressures of shape (n,) [Pa]: u_eff and others, shape (n, 1 + m).
        length : float
            Below it u_eff is interpolated as its logarithm [m].
        """
        x = np.concatenate([self.log_pressure_below, self.fine])
        abscissa = flow.table_abscissa(x, np.log(self.sealing_pressure), self.method)
        start = np.concatenate(
            [
                abscissa[: self.log_pressure_below.size][_FIRST_BELOW],
                np.linspace(self._abscissa[0], self._abscissa[-1], _FIRST_INSIDE),
            ]
        )

        def smooth(places: FloatArray) -> FloatArray:
            rows = values(np.exp(np.interp(places, abscissa, x)))
            return np.column_stack([flow.logarithmic(rows[:, 0] / length), rows[:, 1:]])

        least_step = (self._abscissa[-1] - self._abscissa[0]) / _MOST_INTERVALS
        rows, table = sample_curve(smooth, start, _allowed_error, closest=least_step)
        table[:, 0] = length * np.logaddexp(0.0, table[:, 0])
        return np.exp(np.interp(rows, abscissa, x)), table


def _allowed_error(values: FloatArray) -> FloatArray:
    """Error of `logarithmic`, the first column, that is the same share of u_eff everywhere; any of the others."""
    error = np.full(values.shape, np.inf)
    error[:, 0] = _TABLE_ERROR * np.maximum(1.0, values[:, 0])
    return error


def _checked_range(p_min: float, p_max: float, num: int | None) -> tuple[float, float, int | None]:
    low = positive(ConductivityError, "p_min", p_min, "Pa")
    high = positive(ConductivityError, "p_max", p_max, "Pa")
    if not low < high:
        raise ConductivityError(f"p_min = {p_min} and p_max = {p_max}: p_min must be below p_max [Pa]")
    if num is not None and (int(num) != num or num < 8):
        raise ConductivityError(f"num = {num}: must be a whole number, at least 8")
    return low, high, None if num is None else int(num)


@lru_cache(maxsize=64)
def _conductivity_table(
    surface: RoughContact, p_min: float, p_max: float, num: int | None, method: str, of_gas: bool = False
) -> AnyTable:
    span, equivalent = _Range.of(surface, p_min, p_max, method), surface.equivalent_elastic_surface
    if equivalent is not None and (surface.theory == "corrected" or num is not None):
        # rounded out where neighbouring contacts may share a table
        ends = _elastic_ends(surface, span) if num is None else _acting_ends(surface, span)
        return asked_by(surface, _conductivity_table(equivalent, *ends, num, method, of_gas))
    # ln R with u_eff, or afterwards where u_eff is positive
    with_rarefaction = of_gas and (method == "bruggeman" if equivalent is None else num is None)
    values = _values_of(surface, span, method, with_rarefaction)
    if num is None:
        pressure, rows = span.adapt_pressures(values, 0.5 * surface.spectrum.rms_height)
    else:
        pressure = np.exp(span.spread_pressures(num))
        rows = values(pressure)
    pressure, rows = pressure[rows[:, 0] > 0.0], rows[rows[:, 0] > 0.0]
    table = ConductivityTable(pressure, rows[:, 0], span.sealing_pressure, p_max, method)
    liquid = table.of_surface(surface)
    if not of_gas:
        return liquid
    log_R = rows[:, 1:] if with_rarefaction else _log_rarefaction(surface, pressure, method)
    if not np.all(np.isfinite(log_R)):
        raise ConductivityError(
            f"p_max = {p_max}: too close to the sealing pressure {liquid.sealing_pressure} [Pa]"
        )
    return GasConductivityTable(liquid, log_R, _LOG_D)


def _values_of(
    surface: RoughContact, span: _Range, method: str, of_gas: bool
) -> Callable[[FloatArray], FloatArray]:
    """u_eff and, of a gas, ln R over pressure, as a table is to be made of them, shape (n, 1 + m)."""
    if surface.equivalent_elastic_surface is None:
        if of_gas:
            return lambda p: np.column_stack(surface.rarefied_separation(p, _LOG_D))
        return lambda p: np.asarray(surface.effective_separation(p, method))[:, None]
    elastic = _conductivity_table(
        surface.equivalent_elastic_surface, *_elastic_ends(surface, span), None, method, of_gas
    )

    def values(p: FloatArray) -> FloatArray:
        log_p = np.log(surface.equivalent_pressure(p))
        u = elastic.at_log_pressure(log_p)[:, None]
        if not isinstance(elastic, GasConductivityTable):
            return u
        return np.column_stack([u, elastic.log_rarefaction_at(log_p[:, None])(_LOG_D)])

    return values


def asked_by(surface: RoughContact, table: AnyTable) -> AnyTable:
    """Table of the surface that stands in for another one, asked at the nominal pressures of that one.

    Parameters
    ----------
    surface : RoughContact
        The other one.
    table : ConductivityTable or GasConductivityTable
    """
    return table.with_liquid(table.liquid.of_surface(surface, surface.log_equivalent_pressure))


def _elastic_ends(surface: RoughContact, span: _Range) -> tuple[float, float]:
    """Whole decades around what acts at the ends of a table [Pa]."""
    low, high = np.log10(_acting_ends(surface, span))
    return float(10.0 ** np.floor(low)), float(10.0 ** np.ceil(high))


def _acting_ends(surface: RoughContact, span: _Range) -> tuple[float, float]:
    """What acts at the ends of a table [Pa]."""
    # a table up to the sealing pressure goes on where a short contact is still open
    low, high = surface.equivalent_pressure(np.array([span.ends[0], span.end])).tolist()
    return low, high


# The low-pressure law holds to 1e-9 50 below p_c (in ln p); above it ubar is tabulated at this spacing, and where it is
# all but straight at wider ones: the curve between is off by less than 1e-6 of ubar, 2e-6 for plastic asperities.
_LAW_SPACING = 0.05
_LAW_STEPS = ((-50.0, -20.0, 1.0), (-20.0, -8.0, 0.25), (-8.0, 8.0, _LAW_SPACING))
# Exact slopes carry the curve further.
_ELASTIC_LAW_STEPS = (
    *((-50.0, -20.0, 1.0), (-20.0, -8.0, 0.4), (-8.0, -5.0, 0.2), (-5.0, -1.0, 0.1)),
    (-1.0, 8.0, _LAW_SPACING),
)
# The table ends where the gap is this fraction of u0: full contact for any purpose.
_LAW_END = 1e-6


@lru_cache(maxsize=32)
def _interface_law(surface: RoughContact) -> RoughSurfaceLaw:
    """Mean separation over ln p, with its exact slope for elastic asperities and a spline's for plastic ones."""
    if surface.theory == "corrected":
        return _corrected_law(surface)
    steps = _ELASTIC_LAW_STEPS if surface.hardness is None else _LAW_STEPS
    log_p = _toward_hardness(
        surface, np.log(surface.p_c) + np.concatenate([np.arange(*step) for step in steps])
    )
    p = np.exp(log_p)
    gap, decay = np.zeros(p.shape), np.zeros(p.shape)
    for start in range(0, p.size, 64):
        part = slice(start, start + 64)
        equivalent = surface.equivalent_pressure(p[part])
        separation = surface._mean(equivalent, surface._roughness_at(equivalent))
        gap[part], decay[part] = separation.mean[:, 0], separation.decay[:, 0]
        if separation.mean[-1, 0] <= _LAW_END * decay[0]:
            break
    is_used = gap > _LAW_END * decay[0]
    log_p, gap, decay = log_p[is_used], gap[is_used], decay[is_used]
    if surface.hardness is not None:
        decay = -spline_slopes(log_p, np.log(gap)) * gap
    return RoughSurfaceLaw(log_p, gap, decay)


def _corrected_law(surface: RoughContact) -> RoughSurfaceLaw:
    """The gap law of the elastic surface, or at the pressures at which it has the gaps of one that yields."""
    law, log_modulus = gap_law(surface.spectrum), math.log(surface.effective_modulus)
    log_p = law.log_pressure_nodes + log_modulus
    if surface.hardness is None:
        return RoughSurfaceLaw(log_p, law.gap_nodes, law.decay_nodes)
    log_p = _toward_hardness(surface, log_p)
    gap = law.gap(surface._log_elastic(log_p) - log_modulus)
    is_used = gap > _LAW_END * surface.spectrum.rms_height
    log_p, gap = log_p[is_used], gap[is_used]
    return RoughSurfaceLaw(log_p, gap, -spline_slopes(log_p, np.log(gap)) * gap)


def _toward_hardness(surface: RoughContact, log_pressure: FloatArray) -> FloatArray:
    """ln p up to the hardness, toward which the gap closes ever faster: equal ratios of what is missing."""
    if surface.hardness is None:
        return log_pressure
    near_hardness = np.log(surface.hardness) + np.log1p(-np.exp(np.arange(-0.5, -7.0, -_LAW_SPACING)))
    return np.concatenate([log_pressure[log_pressure < near_hardness[0] - 0.5 * _LAW_SPACING], near_hardness])


def _checked_pressure(pressure: ArrayLike) -> FloatArray:
    p = np.asarray(pressure, dtype=float)
    is_bad = ~(np.isfinite(p) & (p >= 0.0))
    if np.any(is_bad):
        raise SurfaceError(f"pressure = {p[is_bad].flat[0]}: must be finite and not negative [Pa]")
    return p


def _scalar(values: ArrayLike) -> FloatArray | float:
    array = np.asarray(values)
    return float(array) if array.ndim == 0 else array


# Inverse Knudsen numbers D of u_eff in the table, 1e-5 to 1e4, closest around 0.1: beyond both ends the widest and the
# narrowest gaps that matter are in their limits too.
_LOG_D = -2.6 + 4.5 * np.sinh(np.linspace(-1.436, 1.693, 44))


def gas_conductivity_table(
    surface: RoughContact, p_min: float, p_max: float, num: int | None = None, method: str = "bruggeman"
) -> GasConductivityTable:
    """Table for all gases, made once per surface and range.

    Parameters
    ----------
    surface : RoughContact
    p_min, p_max : float
        Range of contact pressures [Pa].
    num : int, optional
        Number of pressures in the range, at least 8; by default as many, and where, as the errors need to be small, see
        `RoughContact.conductivity_table`.
    method : {"bruggeman", "critical-junction", "threshold-law"}
        See `RoughContact.effective_separation`.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> table = leak.gas_conductivity_table(surface, 1e6, 1e8, num=8)
    >>> len(table.liquid.pressure) >= 8
    True
    """
    table = _conductivity_table(surface, *_checked_range(p_min, p_max, num), method, of_gas=True)
    assert isinstance(table, GasConductivityTable)
    return table


def _log_rarefaction(surface: RoughContact, pressure: FloatArray, method: str) -> FloatArray:
    """ln R at pressures, by any method, and at `_LOG_D`."""
    if method == "critical-junction":
        # One junction has one gap: nothing to average over.
        return np.zeros((pressure.size, _LOG_D.size))
    _, log_R = surface.rarefied_separation(pressure, _LOG_D)
    if method == "threshold-law":
        # The closed law has one gap, as a junction has; the medium's many gaps fade with the medium.
        log_R *= 1.0 - medium.closed_share(surface.corrected_contact_area(pressure))[:, None]
    return log_R
