"""A finish in the case file as it stands on a drawing: Ra, Rq or Rz with the process, as keys or as a few words."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BeforeValidator, model_validator

from fem_seal.case.fields import Number, OneOrRange, Quantity, Table
from fem_seal.case.words import sentence, wrong
from fem_seal.files import own_tables

if TYPE_CHECKING:
    from leak import Finish, FinishedSurface, PowerSpectrum

Wavenumber = Annotated[float, Quantity("wavenumber", "1 1/m", "1e12 1/m")]
Height = Annotated[float | tuple[float, float], OneOrRange("length", "1 nm", "200 um")]
Cutoff = Annotated[float, Quantity("length", "0.1 um", "100 mm")]

# A value this far outside of the usual range of its process is remarked on.
_UNUSUAL = 1.5
HEIGHTS = ("Ra", "Rq", "Rz")
ProcessName = Literal[
    "lapped",
    "polished",
    "superfinished",
    "ground",
    "honed",
    "turned",
    "milled",
    "reamed",
    "sandblasted",
    "shot blasted",
    "as cast",
    "unspecified",
]
_LONGEST = 100
_WRITTEN = re.compile(
    r"^\s*(?P<before>[A-Za-z][A-Za-z _-]*?)??[\s,]*\b(?P<height>R[aqz])\s*=?\s*(?P<number>[-+0-9.eE]+)\s*"
    r"(?P<range>(?:[^\s,]+\s+)?to\s+[-+0-9.eE]+)?\s*(?P<unit>[^\s,]+)?[\s,]*(?P<after>[A-Za-z][A-Za-z _-]*)?\s*$"
)


def process_word(word: object) -> object:
    """The library's word for a process; what is no text stays as it is."""
    if not isinstance(word, str):
        return word
    plain = " ".join(word.lower().replace("-", " ").replace("_", " ").split())
    return own_tables("processes.toml").get(plain, plain)


def read_finish(text: str) -> dict[str, Any]:
    """Keys of a finish that is written in words.

    Parameters
    ----------
    text : str
        Such as "lapped Ra 0.2 um" or "Ra 0.2 to 0.4 um".

    Raises
    ------
    ValueError
        If it is no finish.

    Examples
    --------
    >>> read_finish("lapped Ra 0.2 um")
    {'kind': 'finish', 'Ra': '0.2 um', 'process': 'lapped'}
    """
    found = _WRITTEN.match(text) if len(text) <= _LONGEST else None
    if found is None or (found["before"] and found["after"]) or not found["unit"]:
        raise wrong("no_finish")
    process = (found["before"] or found["after"] or "").strip()
    return {
        "kind": "finish",
        found["height"]: " ".join(filter(None, found.group("number", "range", "unit"))),
        **({"process": process} if process else {}),
    }


def is_finish(entries: object) -> bool:
    """Whether a table, as it stands in a file, is a finish."""
    if not isinstance(entries, Mapping):
        return False
    kind = entries.get("kind")
    return kind == "finish" or (kind is None and any(key in entries for key in HEIGHTS))


class FinishKeys(Table):
    """What a drawing says about a surface, and what may be known better than from the process."""

    Ra: Height | None = None
    Rq: Height | None = None
    Rz: Height | None = None
    process: Annotated[ProcessName, BeforeValidator(process_word)] | None = None
    lambda_c: Cutoff | None = None
    lambda_s: Cutoff | None = None
    lay: Literal["none", "circular", "radial", "straight", "crossed"] | None = None
    lay_aspect: Annotated[float, Number(1, 1000)] | None = None
    hurst: Annotated[float, Number(0, 1, exclusive_low=True)] | None = None
    q_low: Wavenumber | None = None
    q_rolloff: Wavenumber | None = None
    q_high: Wavenumber | None = None

    @property
    def height(self) -> str | None:
        """Which of Ra, Rq and Rz is given."""
        return next((key for key in HEIGHTS if getattr(self, key) is not None), None)

    def _check_finish(self) -> None:
        """ValueError if the keys do not make a finish."""
        given = [key for key in HEIGHTS if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"has {' and '.join(given)}; a finish has one of them")
        _surface(self.finish, (), ())

    @property
    def finish(self) -> Finish:
        """The finish as `leak` takes it; SpectrumError, a ValueError, if it is none."""
        from leak import Finish, ProfileFilter, implied_filter, process_named

        height = self.height
        assert height is not None
        ends = getattr(self, height)
        low, high = ends if isinstance(ends, tuple) else (ends, ends)
        value = low if low == high else math.sqrt(low * high)
        implied = implied_filter(height, value)
        band = ProfileFilter(
            implied.lambda_c if self.lambda_c is None else self.lambda_c,
            implied.lambda_s if self.lambda_s is None else self.lambda_s,
        )
        return Finish(
            height,  # type: ignore[arg-type]
            value,
            process_named(self.process or "unspecified"),
            band,
            self.hurst,
            self.q_low,
            self.q_rolloff,
            self.q_high,
            self.lay_aspect,
            self.lay,
            high / value,
        )

    @property
    def remark(self) -> str:
        """That the value is unusual for the process; empty if it is not."""
        found = self.finish
        low, high = found.process.Ra
        Ra = _surface(found, (), ()).expected.Ra
        if low / _UNUSUAL <= Ra <= high * _UNUSUAL:
            return ""
        values = {"Ra": 1e6 * Ra, "low": 1e6 * low, "high": 1e6 * high}
        return sentence("unusual_finish", process=found.process.name, **values)


class FinishTable(FinishKeys):
    """kind = "finish": Ra, Rq or Rz and the process, as they stand on a drawing; see guide/finish in the manual."""

    kind: Literal["finish"]

    @model_validator(mode="after")
    def _one_finish(self) -> FinishTable:
        if self.height is None:
            raise ValueError('needs Ra, Rq or Rz, such as Ra = "0.4 um", with process = "lapped"')
        self._check_finish()
        return self

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it, averaged over all directions."""
        return self.surface().spectrum

    def surface(
        self, shares: Mapping[str, float] | None = None, factors: Mapping[str, float] | None = None
    ) -> FinishedSurface:
        """The face, what the drawing leaves open at its usual value or at places in its range.

        Parameters
        ----------
        shares, factors : mapping, optional
            See `leak.Finish.surface`.
        """
        return _surface(self.finish, *(tuple(sorted((one or {}).items())) for one in (shares, factors)))


_Places = tuple[tuple[str, float], ...]


# Asked for several times by every part of a run.
@lru_cache(maxsize=256)
def _surface(finish: Finish, shares: _Places, factors: _Places) -> FinishedSurface:
    return finish.surface(dict(shares), dict(factors))
