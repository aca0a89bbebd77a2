"""Asperities that yield, the theory compared with direct simulation: the pressure capped at the hardness, or von Mises.

Run: python docs/research/direct_yielding.py, to fit the constants of `leak.theory.plasticity` anew, each on one part of
its surfaces and judged on the others. Box length 1, E* = 1 and rms slope 1; pressures are in units of E* h'.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import direct_von_mises_campaign
import direct_yielding_campaign
import numpy as np
from direct_numerical import periodic_spectrum, worst_factor
from numpy.typing import NDArray

import leak
from leak.theory.plasticity import BEARING_GAP, CAPPED, VON_MISES, YieldingConstants, equivalent_pressure

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

AVERAGES = "plastic_direct.csv"
# Elastic surfaces seal at this pressure: mean over the 12 of direct_threshold.csv, standard error 0.002.
SEALING = 0.215
# Surfaces of the von Mises campaign from this seed on judge what the others are fitted to.
_HELD_OUT = 200
# Spectra of the averages: roll-off, cutoff, Hurst exponent.
_AVERAGED = {"P5": (8.0, 64.0, 0.8), "R5": (8.0, 64.0, 0.5)}


@dataclass(frozen=True)
class YieldingSet:
    """Direct results of one surface, or averages over surfaces of one spectrum; arrays over its states.

    Parameters
    ----------
    name : str
    seed : int
        Of the random phases; -1 for averages.
    spectrum : leak.PowerSpectrum
        Box length 1, rms slope 1.
    hardness : ndarray
        H/(E* h'), infinite where nothing yields.
    pressure, largest : ndarray
        p/(E* h') now, and the largest before; the same on first loading.
    area, yielded : ndarray
        Fractions of A0.
    gap : ndarray
        Mean gap over rms height.
    conductivity : ndarray
        12 eta sigma_eff over rms height cubed; nan where the flow was left out.
    theory : {"paper", "corrected"}
        What its results are put beside.
    """

    name: str
    seed: int
    spectrum: leak.PowerSpectrum
    hardness: FloatArray
    pressure: FloatArray
    largest: FloatArray
    area: FloatArray
    yielded: FloatArray
    gap: FloatArray
    conductivity: FloatArray
    theory: str = "paper"

    @property
    def yields(self) -> BoolArray:
        """States with a hardness."""
        return np.isfinite(self.hardness)

    @property
    def unloading(self) -> BoolArray:
        """States after a larger pressure."""
        return self.pressure < self.largest

    @cached_property
    def elastic(self) -> leak.RoughContact:
        """The theory of its spectrum."""
        return leak.RoughContact(self.spectrum, effective_modulus=1.0, theory=self.theory)

    @cached_property
    def bearing_pressure(self) -> float:
        """Pressure at which the theory's elastic mean gap is that of the surface cut off over a quarter."""
        return float(self.elastic.pressure(BEARING_GAP * self.spectrum.rms_height))

    @cached_property
    def equivalent(self) -> tuple[FloatArray, FloatArray]:
        """Elastic pressures with the same mean gap and with the same conductivity on the same surface.

        Cubic splines in ln p through the elastic states; nan beyond them, and where no flow was calculated.
        """
        from scipy.interpolate import make_interp_spline

        elastic = ~self.yields
        log_p = np.log(self.pressure[elastic])
        fine = np.linspace(log_p[0], log_p[-1], 4000)

        def inverse(values: FloatArray, wanted: FloatArray) -> FloatArray:
            if np.isnan(values).any():
                return np.full(wanted.shape, np.nan)
            curve = make_interp_spline(log_p, values, k=3)(fine)
            found = np.interp(wanted, curve[::-1], fine[::-1], left=np.nan, right=np.nan)
            return np.exp(np.where(np.isnan(wanted), np.nan, found))

        u = np.cbrt(self.conductivity)
        return inverse(self.gap[elastic], self.gap), inverse(u[elastic], u)

    def predicted(self, constants: YieldingConstants, sealing: float) -> FloatArray:
        """Equivalent pressure of every state that yields, nan for the others."""
        out = np.full(self.pressure.shape, np.nan)
        for hardness in np.unique(self.hardness[self.yields]):
            at = self.hardness == hardness
            out[at] = equivalent_pressure(
                self.pressure[at],
                hardness=float(hardness),
                effective_modulus=1.0,
                rms_slope=1.0,
                bearing_pressure=self.bearing_pressure,
                sealing_pressure=sealing,
                largest=self.largest[at],
                constants=constants,
            )
        return out


def read_campaign() -> list[YieldingSet]:
    """One set per surface of the campaign, see `docs/research/direct_yielding_campaign.py`."""
    rows = _rows(direct_yielding_campaign.FILE)
    keys = [
        "grid_points_per_side",
        "rolloff_wavelengths_per_box",
        "cutoff_wavelengths_per_box",
        "hurst",
        "seed",
    ]
    surfaces: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for row in rows:
        surfaces.setdefault(tuple(row[key] for key in keys), []).append(row)
    return [
        _set(f"{rolloff}/{cutoff}, {hurst}", int(seed), (float(rolloff), float(cutoff), float(hurst)), found)
        for (_, rolloff, cutoff, hurst, seed), found in surfaces.items()
    ]


def read_averages(folder: Path) -> list[YieldingSet]:
    """The independent reference: averages over two or three surfaces of 512 x 512 points."""
    rows = _rows(folder / AVERAGES)
    return [
        _set(name, -1, spectrum, [row for row in rows if row["set"] == name])
        for name, spectrum in _AVERAGED.items()
    ]


def read_von_mises(metal: tuple[str, str] = ("0.3", "0")) -> list[YieldingSet]:
    """One set per surface of `docs/research/direct_von_mises_campaign.py`, load steps extrapolated.

    Gap and conductivity err by the first order of the load steps; what half of them change is added once more, after
    unloading as much as at the largest pressure.

    Parameters
    ----------
    metal : tuple of str
        Poisson's ratio and hardening as the file writes them.
    """
    keys = ("rolloff_wavelengths_per_box", "cutoff_wavelengths_per_box", "hurst", "seed")
    surfaces: dict[tuple[str, ...], dict[tuple[str, str, str, str], dict[str, dict[str, str]]]] = {}
    for row in _rows(direct_von_mises_campaign.FILE):
        if row["model"] == "elastic" or (row["poissons_ratio"], row["hardening"]) == metal:
            state = (row["hardness_over_Eh"], row["branch"], row["p_over_Eh"], row["p_max_over_Eh"])
            surface = surfaces.setdefault(tuple(row[key] for key in keys), {})
            surface.setdefault(state, {})[row["model"]] = row
    return [_flowing(key, states) for key, states in surfaces.items()]


def _flowing(
    key: tuple[str, ...], states: dict[tuple[str, str, str, str], dict[str, dict[str, str]]]
) -> YieldingSet:
    rolloff, cutoff, hurst, seed = map(float, key)
    rows = []
    for (hardness, branch, _, p_max), models in states.items():
        row = models.get("elastic") or models.get("von-mises-whole-steps")
        # the half steps of the largest pressure tell what is left of the steps
        first = models if branch == "load" else states.get((hardness, "load", p_max, p_max), {})
        fine, coarse = (first.get(f"von-mises-{steps}-steps") for steps in ("half", "whole"))
        if row is None or (row["model"] != "elastic" and fine is None):
            continue
        rows.append({**row, "yielded_area": ""})
        for name in ("mean_gap_over_hrms", "conductivity"):
            value = float(row[name])
            if fine is not None and coarse is not None:
                value *= float(fine[name]) / float(coarse[name]) if float(coarse[name]) > 0.0 else 0.0
            rows[-1][name] = repr(value if value > 0.0 else math.nan)
        rows[-1]["hardness_over_Eh"] = "" if hardness == "nan" else hardness
    found = _set(f"{rolloff:g}/{cutoff:g}, {hurst:g}", int(seed), (rolloff, cutoff, hurst), rows)
    return replace(found, theory="corrected")


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def _set(
    name: str, seed: int, spectrum: tuple[float, float, float], rows: Sequence[dict[str, str]]
) -> YieldingSet:
    def column(key: str, empty: float = math.nan) -> FloatArray:
        return np.array([float(row[key]) if row[key] else empty for row in rows])

    return YieldingSet(
        name,
        seed,
        periodic_spectrum(*spectrum),
        column("hardness_over_Eh", math.inf),
        column("p_over_Eh"),
        column("p_max_over_Eh"),
        column("contact_area"),
        column("yielded_area"),
        column("mean_gap_over_hrms"),
        column("conductivity"),
    )


# -------------------------------------------------------------------- the equivalent pressure alone


def misfit(sets: Sequence[YieldingSet], constants: YieldingConstants, *, unloading: bool) -> FloatArray:
    """ln of the model's equivalent pressure over the direct one, by gap and by conductivity.

    The direct ones stand on the same surface's elastic results, so that nothing of the theory's own error enters, but
    for the bearing pressure. On unloading the model begins at the direct equivalent of the largest pressure.
    """
    parts = []
    for one in sets:
        chosen = one.yields & (one.unloading == unloading)
        model = one.predicted(constants, SEALING)
        for direct in one.equivalent:
            ratio = np.log(model / direct)
            if unloading:
                ratio = ratio - at_largest(one, ratio)
            parts.append(ratio[chosen & np.isfinite(ratio)])
    return np.concatenate(parts)


def at_largest(one: YieldingSet, values: FloatArray) -> FloatArray:
    """Of each state, the value at the first loading to its largest pressure."""
    first = {
        (h, round(p, 9)): value
        for h, p, value, back in zip(one.hardness, one.pressure, values, one.unloading, strict=True)
        if not back
    }
    return np.array(
        [first.get((h, round(p, 9)), math.nan) for h, p in zip(one.hardness, one.largest, strict=True)]
    )


def fit(sets: Sequence[YieldingSet], constants: YieldingConstants = CAPPED) -> YieldingConstants:
    """Constants by least squares of ln p_eq: those of first loading, then those of unloading."""
    from scipy.optimize import least_squares

    def found(constants: YieldingConstants, names: Sequence[str], unloading: bool) -> YieldingConstants:
        def changed(x: FloatArray) -> YieldingConstants:
            return constants._replace(**dict(zip(names, map(float, x), strict=True)))

        def off(x: FloatArray) -> FloatArray:
            return misfit(sets, changed(x), unloading=unloading)

        return changed(least_squares(off, [getattr(constants, name) for name in names]).x)

    return found(found(constants, ("total", "bearing", "growth"), False), ("spring", "bend"), True)


def halves(sets: Sequence[YieldingSet]) -> tuple[list[YieldingSet], list[YieldingSet]]:
    """Surfaces of even seed, to fit, and of odd seed, to judge."""
    return [one for one in sets if one.seed % 2 == 0], [one for one in sets if one.seed % 2 == 1]


def held_out(sets: Sequence[YieldingSet]) -> tuple[list[YieldingSet], list[YieldingSet]]:
    """Surfaces of the von Mises campaign to fit, and to judge."""
    return [one for one in sets if one.seed < _HELD_OUT], [one for one in sets if one.seed >= _HELD_OUT]


# -------------------------------------------------------------------- the readings of the theory


def capped(one: YieldingSet) -> tuple[FloatArray, FloatArray]:
    """Mean gap and conductivity of the capped reading, in the units of the results."""
    acting = one.pressure.copy()
    acting[one.yields] = one.predicted(CAPPED, one.elastic.sealing_pressure)[one.yields]
    return _theory(one, one.elastic, acting)


def conserved(one: YieldingSet) -> tuple[FloatArray, FloatArray]:
    """The same of C_pl, with the spring-back of the capped reading."""
    gap, flow = elastic(one)
    for hardness in np.unique(one.hardness[one.yields]):
        surface = leak.RoughContact(one.spectrum, effective_modulus=1.0, hardness=float(hardness))
        at = one.hardness == hardness
        first = surface.equivalent_first_loading_pressure(one.pressure[at], one.largest[at])
        gap[at], flow[at] = _theory(one, surface, first)
    return gap, flow


def elastic(one: YieldingSet) -> tuple[FloatArray, FloatArray]:
    """The same as if nothing yielded."""
    return _theory(one, one.elastic, one.pressure)


def _theory(
    one: YieldingSet, surface: leak.RoughContact, pressure: FloatArray
) -> tuple[FloatArray, FloatArray]:
    h = one.spectrum.rms_height
    gap, u = np.asarray(surface.mean_separation(pressure)), np.asarray(surface.effective_separation(pressure))
    return gap / h, (u / h) ** 3


READINGS: dict[str, Callable[[YieldingSet], tuple[FloatArray, FloatArray]]] = {
    "changed only where it touches (capped)": capped,
    "volume conserved (C_pl)": conserved,
    "no yielding (elastic)": elastic,
}


def areas(one: YieldingSet) -> FloatArray:
    """Theory over direct contact area on first loading, nan elsewhere."""
    out = np.full(one.pressure.shape, np.nan)
    for hardness in np.unique(one.hardness[one.yields]):
        at = (one.hardness == hardness) & ~one.unloading
        surface = leak.RoughContact(one.spectrum, effective_modulus=1.0, hardness=float(hardness))
        out[at] = np.asarray(surface.contact_area(one.pressure[at])) / one.area[at]
    return out


def picture(sets: Sequence[YieldingSet], path: Path) -> Path:
    """Conductivity over pressure: direct results as marks, both readings as lines, loading and unloading."""
    import matplotlib
    from matplotlib.figure import Figure

    one = sets[0]
    colours = dict(zip(np.unique(one.hardness[one.yields]), ("#7a1f5a", "#c8641a", "#1f7a4d"), strict=False))
    style = {"font.size": 9, "svg.hashsalt": "yielding", "axes.spines.top": False, "axes.spines.right": False}
    with matplotlib.rc_context(style):
        figure = Figure(figsize=(9.6, 3.9), layout="constrained")
        loading, unloading = figure.subplots(1, 2, sharey=True)
        p = np.geomspace(1e-3, 0.05, 24)
        rest = _states(one, math.inf, p, p)
        loading.plot(p, capped(rest)[1], color="#444", linewidth=1.2, label="elastic")
        at = ~one.yields
        loading.plot(one.pressure[at], one.conductivity[at], "o", color="#444", ms=4)
        for hardness, colour in colours.items():
            p = np.geomspace(1e-3, min(0.5 * hardness, 0.05), 24)
            states = _states(one, float(hardness), p, p)
            loading.plot(p, capped(states)[1], color=colour, linewidth=1.2, label=f"{hardness:g}")
            loading.plot(p, conserved(states)[1], "--", color=colour, linewidth=1.0)
            at = (one.hardness == hardness) & ~one.unloading
            loading.plot(one.pressure[at], one.conductivity[at], "o", color=colour, ms=4)
            unloading.plot(p, capped(states)[1], color=colour, linewidth=0.8, alpha=0.5)
            back = (one.hardness == hardness) & one.unloading
            unloading.plot(one.pressure[back], one.conductivity[back], "o", color=colour, ms=4)
            for largest in np.unique(one.largest[back]):
                p = np.geomspace(5e-4, largest, 12)
                states = _states(one, float(hardness), p, np.full(p.shape, largest))
                unloading.plot(p, capped(states)[1], color=colour, linewidth=1.2)
                unloading.plot(p, conserved(states)[1], "--", color=colour, linewidth=1.0)
        loading.set(
            xlabel="p / (E* h')",
            ylabel="12 η σ_eff / (rms height)³",
            title="First loading",
            xscale="log",
            yscale="log",
            ylim=(1e-4, 30),
        )
        loading.legend(frameon=False, loc="lower left", title="hardness / (E* h')", fontsize=8)
        unloading.set(xlabel="p / (E* h')", title="Unloading from two largest pressures", xscale="log")
        path.parent.mkdir(exist_ok=True)
        figure.savefig(path, metadata={"Date": None, "Creator": None})
    return path


def _states(one: YieldingSet, hardness: float, pressure: FloatArray, largest: FloatArray) -> YieldingSet:
    """The same surface at other states, without direct results."""
    none = np.full(pressure.shape, np.nan)
    return replace(
        one,
        hardness=np.full(pressure.shape, hardness),
        pressure=pressure,
        largest=largest,
        area=none,
        yielded=none,
        gap=none,
        conductivity=none,
    )


def main(folder: Path) -> None:
    """Fit, judge, and say how far off the constants in use are."""
    campaigns = {
        "capped": (halves(read_campaign()), CAPPED),
        "von Mises": (held_out(read_von_mises()), VON_MISES),
    }
    for what, ((seen, unseen), in_use) in campaigns.items():
        for name, constants in (("fitted now", fit(seen, in_use)), ("in use", in_use)):
            print(what, name, *(f"{key} {value:.3f}" for key, value in constants._asdict().items()))
            for half, sets in (("fitted", seen), ("judged", unseen)):
                for branch, unloading in (("loading", False), ("unloading", True)):
                    off = misfit(sets, constants, unloading=unloading)
                    if off.size:
                        worst, rms = worst_factor(np.exp(off)), math.exp(math.sqrt(float(np.mean(off**2))))
                        print(
                            f"  {half}, {branch}: worst factor {worst:.2f}, rms {rms:.3f}, {off.size} values"
                        )


if __name__ == "__main__":
    default = Path(__file__).resolve().parents[2] / "tests" / "reference"
    main(Path(os.environ.get("FEM_SEAL_REFERENCE", default)))
