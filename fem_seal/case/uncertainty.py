"""The table [uncertainty] of the case file: uncertain inputs and their distributions."""

from __future__ import annotations

from typing import Annotated, Literal

from fem_seal.case.fields import Number, Table, Whole


class Spread(Table):
    """How an input spreads about its value in the case."""

    distribution: Literal["lognormal", "normal", "uniform"] = "lognormal"
    relative: Annotated[float, Number(0, 0.9, exclusive_low=True)]


class Scans(Table):
    """How the spectrum spreads: by the differences between the scans that it was measured from."""

    distribution: Literal["scans"]


_SPREAD = {"distribution": "lognormal", "relative": 0.1}


class Uncertainty(Table):
    """[uncertainty]: leak rate with an interval, from inputs not known exactly; see guide/uncertainty in the manual.

    The length of measured scans is always among them.
    """

    samples: Annotated[int, Whole(16, 100000)] = 256
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 1
    confidence: Annotated[float, Number(0.5, 0.999)] = 0.9
    viscosity: Spread | None = None
    hardness: Spread | None = None
    youngs_modulus: Spread | None = None
    rms_height: Spread | None = None
    hurst: Spread | None = None
    q_rolloff: Spread | None = None
    q_high: Spread | None = None
    form: Spread | None = None
    spectrum: Scans | None = None

    @property
    def spreads(self) -> dict[str, Spread]:
        """The uncertain inputs with their spreads, without the spectrum between scans, in the order of the table."""
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in fields.items() if isinstance(value, Spread)}
