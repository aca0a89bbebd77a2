"""Results of seals that are not round, solved once per test process."""

from __future__ import annotations

from functools import cache
from typing import Any

from sample_results import case

import fem_seal
from fem_seal.result import SealResult


def _oval(amplitude: str, waves: int = 2) -> dict[str, Any]:
    wave = {"waves": waves, "amplitude": amplitude}
    return {"seat": {"direction": "normal", "harmonics": [wave]}}


@cache
def oval_result() -> SealResult:
    """Three loads of a rough ball on an oval cone, with water."""
    return fem_seal.run(case(form=_oval("1 um")), full=True)


@cache
def smooth_oval_result() -> SealResult:
    """Smooth surfaces that part under the lower load where the gap is widest; no leak rate."""
    return fem_seal.run(
        case(
            roughness=None,
            fluid=None,
            interface={"law": "smooth"},
            # the contact line is as long as the highest mean load needs it
            load={"fluid_pressure": ["20 bar", "150 bar"]},
            form=_oval("2.5 um"),
            # of half a millimetre of contact width; the size that a case gets costs four times as much
            mesh={"contact_size": "20 um"},
        )
    )
