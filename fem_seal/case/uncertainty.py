"""The table [uncertainty] of the case file: which inputs are not known exactly, and how well they are known."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from fem_seal.case.fields import Number, Table, Whole, optional, required


class Spread(Table):
    """How an input spreads about its value in the case."""

    distribution: Literal["lognormal", "normal", "uniform"] = Field(
        "lognormal",
        description='"lognormal": the value is the median, relative the standard deviation of the logarithm; '
        '"normal": mean and relative standard deviation, cut off at three of them; "uniform": the value times '
        "1 - relative to 1 + relative",
    )
    relative: Annotated[float, Number(0, 0.9, exclusive_low=True)] = required(
        "relative width: 0.1 is ten per cent", 0.1
    )


class Scans(Table):
    """How the spectrum spreads: by the differences between the scans that it was measured from."""

    distribution: Literal["scans"] = required(
        '"scans": the mean over the scans is redrawn with random weights (Bayesian bootstrap)', "scans"
    )


_SPREAD = {"distribution": "lognormal", "relative": 0.1}


class Uncertainty(Table):
    """[uncertainty]: leak rate with an interval, from inputs not known exactly; see guide/uncertainty in the manual.

    The length of measured scans is always among them.
    """

    samples: Annotated[int, Whole(16, 100000)] = Field(
        256, description="number of samples; best a power of two"
    )
    seed: Annotated[int, Whole(0, 2**31 - 1)] = Field(
        1, description="seed of the samples: the same seed gives the same interval"
    )
    confidence: Annotated[float, Number(0.5, 0.999)] = Field(
        0.9, description="share of the samples inside the interval; the rest lies half below, half above"
    )
    viscosity: Spread | None = optional("of the fluid", _SPREAD)
    hardness: Spread | None = optional("of the asperities", _SPREAD)
    youngs_modulus: Spread | None = optional("of both bodies, in the same proportion; so does E*", _SPREAD)
    rms_height: Spread | None = optional("all heights of the roughness in the same proportion", _SPREAD)
    hurst: Spread | None = optional(
        "with a self-affine spectrum for both surfaces together; kept between 0.01 and 1, rms height kept",
        _SPREAD,
    )
    q_rolloff: Spread | None = optional("with a self-affine spectrum; kept between q_low and q_high", _SPREAD)
    q_high: Spread | None = optional("with a self-affine spectrum; kept above q_rolloff", _SPREAD)
    form: Spread | None = optional("all deviations of [form] in the same proportion", _SPREAD)
    spectrum: Scans | None = optional(
        'with a spectrum of kind "profile" from two or more files, of both surfaces or of each',
        {"distribution": "scans"},
    )

    @property
    def spreads(self) -> dict[str, Spread]:
        """The uncertain inputs with their spreads, without the spectrum between scans, in the order of the table."""
        fields = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: value for name, value in fields.items() if isinstance(value, Spread)}
