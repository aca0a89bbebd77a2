"""PageSection of the verification page: yielding asperities, every reading compared with direct simulation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from direct_numerical import FloatArray, worst_factor
from direct_yielding import (
    READINGS,
    BoolArray,
    YieldingSet,
    areas,
    at_largest,
    elastic,
    halves,
    misfit,
    picture,
    read_averages,
    read_campaign,
)
from verification_page import Figure, PageSection

from leak.theory.plasticity import CAPPED

_CAPPED, _CONSERVED, _ELASTIC = READINGS
_NOTHING = "the same surfaces without a hardness, elastic theory"
_FEW, _MORE = "first loading, A/A0 < 0.2", "0.2 to 0.42"
_BACK, _FAR_BACK = "unloading from A/A0 < 0.3", "from 0.3 to 0.42"


_BRANCHES = (_FEW, _MORE, _BACK, _FAR_BACK)


def _branches(test: YieldingSet, part: BoolArray) -> dict[str, BoolArray]:
    loading, back, largest = part & ~test.unloading, part & test.unloading, at_largest(test, test.area)
    return {
        _FEW: loading & (test.area < 0.2),
        _MORE: loading & (test.area >= 0.2) & (test.area < 0.42),
        _BACK: back & (largest < 0.3),
        _FAR_BACK: back & (largest >= 0.3),
    }


def _ratios(sets: Sequence[YieldingSet]) -> dict[tuple[str, str, str], FloatArray]:
    """Theory over direct result by quantity, reading and branch."""
    ratios_by_set: dict[tuple[str, str, str], list[FloatArray]] = {}

    def sort(campaign: YieldingSet, part: BoolArray, quantity: str, name: str, ratio: FloatArray) -> None:
        for branch, states in _branches(campaign, part).items():
            ratios_by_set.setdefault((quantity, name, branch), []).append(ratio[states & np.isfinite(ratio)])

    for campaign in sets:
        sort(campaign, campaign.yields, "contact area", "Persson, elastic and yielded", areas(campaign))
        for name, reading in READINGS.items():
            gap, flow = reading(campaign)
            sort(campaign, campaign.yields, "mean gap", name, gap / campaign.gap)
            sort(campaign, campaign.yields, "conductivity", name, flow / campaign.conductivity)
        gap, flow = elastic(campaign)
        sort(campaign, ~campaign.yields, "mean gap", _NOTHING, gap / campaign.gap)
        sort(campaign, ~campaign.yields, "conductivity", _NOTHING, flow / campaign.conductivity)
    return {key: np.concatenate(parts) for key, parts in ratios_by_set.items()}


def _span(ratio: FloatArray) -> str:
    return f"{_short(ratio.min())} to {_short(ratio.max())}" if ratio.size else "-"


def _short(ratio: float) -> str:
    return (
        "< 0.001"
        if ratio < 1e-3
        else f"{ratio:.2g}"
        if ratio < 1
        else f"{ratio:.3g}"
        if ratio < 100
        else f"{ratio:.0f}"
    )


def yielding_section(reference: Path, image: Path) -> PageSection:
    """Theory over direct results where the pressure is capped at the hardness."""
    averages, campaign = read_averages(reference), read_campaign()
    picture(averages, image)
    of_averages, of_campaign = _ratios(averages), _ratios(campaign)
    rows = [
        (
            quantity,
            reading,
            source,
            *(_span(ratios[quantity, reading, branch]) for branch in _BRANCHES),
        )
        for quantity, reading in dict.fromkeys((q, r) for q, r, _ in of_averages)
        for source, ratios in (("averages", of_averages), ("campaign", of_campaign))
    ]
    _, test_half = halves(campaign)
    up, down = (misfit(test_half, CAPPED, unloading=back) for back in (False, True))

    def worst(quantity: str, branch: str) -> float:
        return worst_factor(of_averages[quantity, _CAPPED, branch])

    flows = [worst("conductivity", branch) for branch in _BRANCHES]
    hard = of_averages["conductivity", _CONSERVED, _FEW]
    text = (
        "Theory over direct result, smallest to largest. Direct: boundary elements with the pressure capped at the "
        "hardness, the overlap taken off the surface, Reynolds flow through the gap; first loading, and unloading "
        "from a larger pressure. Averages: the independent table of two spectra (roll-off at 8, cutoff at 64 waves per "
        "box, 512 x 512 points, hardness/(E* h') of 0.05 to 0.2), which were not used for fitting. Campaign: "
        f"{len(campaign)} single surfaces of `docs/research/direct_yielding_campaign.py` (Hurst exponent 0.5 to 0.9, "
        "roll-off at 4 to 16 waves per box, hardness/(E* h') of 0.03 to 0.5, p/(E* h') of 1e-3 to 0.12). "
        "The three readings are those of [asperities that yield](../theory/yielding.md); the theory gives no area on "
        "unloading. The ratios include the error of the elastic theory on the same surfaces: at the smallest "
        "pressures, where few summits of a small box carry, it is too open by up to two.\n\n"
        "![conductivity with yielding asperities](../images/direct_yielding.svg)\n\n"
        "Marks: averages P5; lines: capped; dashed: volume conserved.\n\n"
        "The equivalent pressure of the capped reading alone, on surfaces it was not fitted to and against the same "
        f"surface's elastic results: within a factor {worst_factor(np.exp(up)):.2f} on first loading "
        f"(rms {100 * np.sqrt(np.mean(up**2)):.0f} %), {worst_factor(np.exp(down)):.2f} on unloading down to a "
        f"hundredth of the largest pressure (rms {100 * np.sqrt(np.mean(down**2)):.0f} %).\n\n"
        "Conclusions: where the pressure is capped, the capped reading is no worse than the elastic theory is for "
        f"elastic surfaces: within a factor {flows[0]:.1f} while less than a fifth of the area touches, "
        f"{flows[2]:.1f} after a larger load; metal that flows by von Mises' criterion lies near it "
        "([the theories compared with direct simulation](truth.md)). C_pl "
        "smooths valleys that no metal reaches, and its leak rate is lower: it gives "
        f"{1 / hard.max():.0f} to {1 / hard.min():.0f} times less than these simulations on the same surfaces. Volume "
        "conservation does not ask for that much ([theory](../theory/yielding.md#two-readings)); C_pl is the paper's "
        "empirical reading, the paper's measured seats agree with it, and why they do is open. With the paper's theory "
        "the leak rate is given for both. Judge a limit by the larger one. A seal that was closed harder before leaks "
        "far less than on first loading; both readings take this spring-back from the simulation, since C_pl itself "
        "has almost no memory. Where more "
        "than some 40 % of the area touches, a single junction decides, and both readings are uncertain by a factor of "
        "a few."
    )
    return PageSection(
        "Rough contact and flow with yielding asperities: the readings against direct simulation",
        text,
        ("quantity", "reading", "direct", *_BRANCHES),
        tuple(rows),
        (
            Figure(
                "equivalent pressure, first loading, surfaces not fitted",
                worst_factor(np.exp(up)) - 1,
                0.25,
            ),
            Figure(
                "equivalent pressure, unloading, surfaces not fitted", worst_factor(np.exp(down)) - 1, 0.6
            ),
            Figure("mean gap, capped, first loading", worst("mean gap", _FEW) - 1, 0.16),
            Figure("mean gap, capped, unloading", worst("mean gap", _BACK) - 1, 0.16),
            Figure("conductivity, capped, A/A0 < 0.2", flows[0] - 1, 0.5),
            Figure("conductivity, capped, up to A/A0 = 0.42", flows[1] - 1, 0.8),
            Figure("conductivity, capped, unloading from A/A0 < 0.3", flows[2] - 1, 0.5),
            Figure("conductivity, capped, unloading from up to A/A0 = 0.42", flows[3] - 1, 0.5),
        ),
    )
