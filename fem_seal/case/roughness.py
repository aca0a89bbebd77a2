"""The table [roughness] of the case file: power spectra of both surfaces, given, tabulated, measured or of a finish.

A new kind of spectrum comes in as one more model in `Spectrum`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache, reduce
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    field_validator,
    model_validator,
)

from fem_seal.case.fields import FORMS, Entry, Number, OneOrRange, Quantity, Table, show
from fem_seal.case.messages import missing_key, problems
from fem_seal.errors import InputError, TextTableError
from fem_seal.files import (
    MOST_BYTES_OF_SCAN,
    UnreadableFileError,
    check_file,
    own_tables,
    problem,
    read_text_table,
)
from leak import files
from leak.numerics.roots import root_between

if TYPE_CHECKING:
    from fem_seal.arrays import FloatArray
    from leak import (
        Cusps,
        Finish,
        FinishedSurface,
        MeasuredSurface,
        PowerSpectrum,
        ScanSettings,
        StretchedRoughness,
        TurnedScan,
        TurnedTexture,
    )
    from leak.surfaces.finish import Spread
    from leak.surfaces.self_affine_fit import TrueHeight


Wavenumber = Annotated[float, Quantity("wavenumber", "1 1/m", "1e12 1/m")]
Height = Annotated[float | tuple[float, float], OneOrRange("length", "1 nm", "200 um")]
Cutoff = Annotated[float, Quantity("length", "0.1 um", "100 mm")]

# A value this far outside of the usual range of its process is remarked on.
_UNUSUAL = 1.5
HEIGHTS = ("Ra", "Rq", "Rz")
if TYPE_CHECKING:
    ProcessName = str
else:
    ProcessName = Literal[tuple(files.own_tables("leak.surfaces", "processes.toml")["processes"])]
# Keys of a finish that a turned face does not have, and that it alone has.
_OF_GAUSSIAN = ("lay", "lay_aspect", "peklenik", "q_low")
_OF_TURNED = ("nose_radius", "spiral")
_LONGEST = 100
_FINISH_TEXT = re.compile(
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
    match = _FINISH_TEXT.match(text) if len(text) <= _LONGEST else None
    if match is None or (match["before"] and match["after"]) or not match["unit"]:
        raise ValueError(problem("no_finish"))
    process = (match["before"] or match["after"] or "").strip()
    return {
        "kind": "finish",
        match["height"]: " ".join(filter(None, match.group("number", "range", "unit"))),
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
    nose_radius: Annotated[float, Quantity("length", "5 um", "50 mm")] | None = None
    spiral: bool | None = None

    @property
    def height(self) -> str | None:
        """Which of Ra, Rq and Rz is given."""
        return next((key for key in HEIGHTS if getattr(self, key) is not None), None)

    def _check_finish(self) -> None:
        """ValueError if the keys do not make a finish."""
        heights = [key for key in HEIGHTS if getattr(self, key) is not None]
        if len(heights) > 1:
            raise ValueError(f"has {' and '.join(heights)}; a finish has one of them")
        other = _OF_GAUSSIAN if self.process == "turned" else _OF_TURNED
        for key in other:
            if key in self.model_fields_set and getattr(self, key) is not None:
                name = "not_of_turned" if self.process == "turned" else "of_turned"
                raise ValueError(problem(name, key=key, process=self.process or "unspecified"))
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
        usual_filter = implied_filter(height, value)
        band = ProfileFilter(
            usual_filter.lambda_c if self.lambda_c is None else self.lambda_c,
            usual_filter.lambda_s if self.lambda_s is None else self.lambda_s,
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
            self.nose_radius,
        )

    @property
    def remark(self) -> str:
        """That the value is unusual for the process; empty if it is not."""
        finish = self.finish
        low, high = finish.process.Ra
        Ra = _surface(finish, (), ()).expected.Ra
        if low / _UNUSUAL <= Ra <= high * _UNUSUAL:
            return ""
        values = {"Ra": 1e6 * Ra, "low": 1e6 * low, "high": 1e6 * high}
        return str(problem("unusual_finish", process=finish.process.name, **values))


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
        return _surface(self.finish, *(tuple(sorted((pairs or {}).items())) for pairs in (shares, factors)))


_Places = tuple[tuple[str, float], ...]


# Asked for several times by every part of a run.
@lru_cache(maxsize=256)
def _surface(finish: Finish, shares: _Places, factors: _Places) -> FinishedSurface:
    return finish.surface(dict(shares), dict(factors))


_MOST_FILES = 200
# Root mean square of ln C_along/C_across after stretching, above which isolines are no similar ellipses.
_LARGEST_MISFIT = 0.5


class Texts(Entry):
    """A list of texts, a tuple after reading."""

    def __init__(self, *, limit: int, example: str) -> None:
        self.limit, self.example = limit, example

    def read(self, value: object) -> tuple[str, ...]:
        """The texts; ValueError if it is no list of texts."""
        if not isinstance(value, (list, tuple)) or not all(isinstance(text, str) for text in value):
            raise ValueError(f"must be a list of texts, such as {self.example}")
        if not 0 < len(value) <= self.limit:
            raise ValueError(f"has {len(value)} entries; allowed are 1 to {self.limit}")
        return tuple(value)

    @property
    def _schema(self) -> dict[str, Any]:
        return {"type": "array", "items": {"type": "string"}, "minItems": 1, "maxItems": self.limit}


class LengthUnits(Texts):
    """One unit of length, or two, those of x and height."""

    def read(self, value: object) -> tuple[str, ...]:
        """Two units; ValueError if they are none."""
        from leak.surfaces.scan_files import two_units

        units = super().read([value, value] if isinstance(value, str) else value)
        two_units(units)
        return units

    @property
    def _schema(self) -> dict[str, Any]:
        several = super()._schema
        return {"anyOf": [{"type": "string"}, {**several, "minItems": 2}]}


def read_spectrum(file: str | Path) -> tuple[FloatArray, FloatArray]:
    """Wavenumber and density of a tabulated two-dimensional isotropic spectrum.

    Parameters
    ----------
    file : path
        Text with two columns, q [1/m] and C [m^4]; see `read_text_table`.

    Returns
    -------
    q, C : ndarray, shape (n,)
        Wavenumber [1/m], increasing, and density [m^4], positive.

    Raises
    ------
    TextTableError
        If the file is not such a table.
    """
    table = read_text_table(file)
    if table.values.shape[1] != 2 or table.values.shape[0] < 2:
        raise TextTableError("must hold two columns, q [1/m] and C [m^4], and at least two rows")
    q, C = table.values.T
    positive = (q > 0) & (C > 0)
    if not positive.all():
        raise TextTableError(f"q and C must be positive; line {table.lines[int(np.argmin(positive))]} is not")
    is_increasing = np.diff(q) > 0
    if not is_increasing.all():
        line = table.lines[int(np.argmin(is_increasing)) + 1]
        raise TextTableError(f"q must increase from row to row; line {line} does not")
    return q, C


class SelfAffine(Table):
    """kind = "self-affine": isotropic, constant up to q_rolloff, then falling as q^(-2 (1 + hurst))."""

    kind: Literal["self-affine"]
    rms_height: Annotated[float, Quantity("length", "0.01 nm", "1 mm")]
    hurst: Annotated[float, Number(0, 1, exclusive_low=True)]
    q_low: Wavenumber
    q_rolloff: Wavenumber
    q_high: Wavenumber

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it."""
        from leak import PowerSpectrum

        return PowerSpectrum.self_affine(**self.model_dump(exclude={"kind"}))


class TabulatedSpectrum(Table):
    """kind = "table": a two-dimensional isotropic spectrum from a file."""

    kind: Literal["table"]
    file: str

    @field_validator("file")
    @classmethod
    def _readable(cls, file: str) -> str:
        read_spectrum(file)
        return str(Path(file).absolute())

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it."""
        from leak import PowerSpectrum

        return PowerSpectrum.from_table(*read_spectrum(self.file))


class MeasuredSpectrum(Table):
    """kind = "profile": the spectrum of measured line scans or maps; see guide/surfaces in the manual."""

    kind: Literal["profile"]
    file: str | None = None
    files: (
        Annotated[tuple[str, ...], Texts(limit=_MOST_FILES, example='["scan1.csv", "scan2.csv"]')] | None
    ) = None
    unit: Annotated[tuple[str, ...], LengthUnits(limit=2, example='["mm", "um"]')] | None = None
    detrend: Literal["tilt", "mean", "curvature"] = "tilt"
    window: Literal["hann", "none"] = "hann"
    tip_radius: Annotated[float, Quantity("length", "1 nm", "10 mm")] | None = None
    shortest_wavelength: Annotated[float, Quantity("length", "0.1 nm", "10 mm")] | None = None
    extrapolation: Literal["cut", "self-affine"] = "cut"
    hurst: Annotated[float, Number(0, 1, exclusive_low=True)] | None = None
    q_low: Wavenumber | None = None
    q_high: Wavenumber | None = None

    outliers: Literal["keep", "remove"] = "keep"
    turned: bool = True
    spiral: bool = True

    @model_validator(mode="after")
    def _consistent(self) -> MeasuredSpectrum:
        if (self.file is None) == (self.files is None):
            raise ValueError('needs file = "seat.csv", or files = ["scan1.csv", "scan2.csv"], one of both')
        for key in ("hurst", "q_low", "q_high"):
            if self.extrapolation == "cut" and getattr(self, key) is not None:
                raise ValueError(f'{key} is only for extrapolation = "self-affine"; remove it, or set that')
        if self.extrapolation == "self-affine" and self.hurst is None:
            raise ValueError('extrapolation = "self-affine" needs hurst, such as hurst = 0.8')
        self.read_scans()
        if "spiral" in self.model_fields_set and self.turned_scan is None:
            raise ValueError(problem("no_feed_seen"))
        return self

    @property
    def paths(self) -> tuple[str, ...]:
        """The files, absolute."""
        names = self.files if self.files is not None else (self.file or "",)
        return tuple(str(Path(name).absolute()) for name in names)

    @property
    def settings(self) -> ScanSettings:
        """How the scans become a spectrum, as `leak` takes it."""
        from leak import ScanSettings, SelfAffineContinuation

        continuation = self.hurst and SelfAffineContinuation(self.hurst, self.q_low, self.q_high)
        return ScanSettings(
            self.detrend,
            self.window,
            self.tip_radius,
            self.shortest_wavelength,
            continuation or "cut",
            self.outliers,
        )

    def read_scans(self) -> MeasuredSurface:
        """What the scans say about the surface."""
        return _measure_scans(tuple((path, _stamp(path)) for path in self.paths), self.unit, self.settings)

    @property
    def turned_scan(self) -> TurnedScan | None:
        """The turned face that most of the scans show; None where they do not, and with turned = false."""
        return self._recognise(self.paths)

    def _recognise(self, paths: Sequence[str]) -> TurnedScan | None:
        files = tuple((path, _stamp(path)) for path in paths)
        return _recognise_texture(files, self.unit, self.settings) if self.turned else None

    def texture(self) -> TurnedTexture:
        """The face as `leak` takes it, where it is turned."""
        turned = self.turned_scan
        assert turned is not None  # of the only callers, those of `Roughness.turned_faces`
        return turned.texture

    def build(self) -> PowerSpectrum:
        """The spectrum as `leak` takes it; of a turned face that of the fine roughness."""
        return self.read_scans().spectrum if self.turned_scan is None else self.turned_scan.fine

    def remarks(self) -> Iterator[str]:
        """What the scans say against their use; of a turned face what is left without its cusps."""
        turned = self.turned_scan
        yield from (self.read_scans() if turned is None else turned.rest).warnings
        if turned is not None and (others := len(self.paths) - len(turned.rest.scans)):
            yield str(problem("scans_without_feed", count=others, scans=len(self.paths), feed=turned.feed))

    def each_scan(self) -> tuple[PowerSpectrum | TurnedTexture, ...]:
        """What each scan alone shows: a spectrum or, of a turned face, cusps unless it shows none."""
        if self.turned_scan is not None:
            alone = [self._recognise([path]) for path in self.paths]
            return tuple(turned.texture for turned in alone if turned is not None)
        scans = [((path, _stamp(path)),) for path in self.paths]
        return tuple(_measure_scans(scan, self.unit, self.settings).spectrum for scan in scans)


def _stamp(path: str) -> tuple[int, int]:
    """Tells whether a file has changed."""
    try:
        status = Path(path).stat()
    except (OSError, ValueError):
        return 0, 0
    return status.st_mtime_ns, status.st_size


# A case asks for its spectrum several times, and reading a spreadsheet takes more than a second.
@cache
def _measure_scans(
    files: tuple[tuple[str, tuple[int, int]], ...], unit: tuple[str, ...] | None, settings: ScanSettings
) -> MeasuredSurface:
    from leak import ScanError, measure, read_topographies

    for path, _ in files:
        try:
            check_file(path, MOST_BYTES_OF_SCAN)
        except UnreadableFileError as error:
            raise ScanError(f"{path}: {error}") from None
    return measure(read_topographies([path for path, _ in files], unit=unit), settings)


@cache
def _recognise_texture(
    files: tuple[tuple[str, tuple[int, int]], ...], unit: tuple[str, ...] | None, settings: ScanSettings
) -> TurnedScan | None:
    from leak import ScanError, recognise_texture

    try:
        return recognise_texture(_measure_scans(files, unit, settings).scans, settings)
    except ScanError:
        # nothing is left on the cusps that could be a roughness
        return None


class FineRoughness(Table):
    """Roughness on the crests of a turned face: isotropic and self-affine, waves up to two feeds long."""

    rms_height: Annotated[float, Quantity("length", "0.1 nm", "100 um")]
    hurst: Annotated[float, Number(0, 1, exclusive_low=True)]
    q_rolloff: Wavenumber
    q_high: Wavenumber | None = None


Fine = Annotated[
    Annotated[FineRoughness, Tag(FORMS[0])] | Annotated[FinishTable, Tag("finish")],
    Discriminator(lambda value: "finish" if isinstance(value, FinishTable) or is_finish(value) else FORMS[0]),
]

# Keys of other tables that say in [roughness] how a random surface looks.
_OF_RANDOM = ("hurst", "q_low", "q_rolloff", "q_high", "lay", "lay_aspect", "peklenik", *HEIGHTS)


def _with_fine(entries: Mapping[str, Any]) -> Mapping[str, Any]:
    """A turned face whose fine roughness is a table: a finish in words becomes one."""
    fine = entries.get("fine")
    if isinstance(fine, str):
        try:
            return {**entries, "fine": read_finish(fine)}
        except ValueError as error:
            raise ValueError(f"fine, {show(fine)}, {error}") from None
    if isinstance(fine, Mapping) and is_finish(fine):
        return {**entries, "fine": {**fine, "kind": "finish"}}
    return entries


class TurnedFace(Table):
    """process = "turned" with feed: grooves of the tool side by side, and fine roughness on the crests between them."""

    kind: Literal["turned"]
    process: Literal["turned"]
    feed: Annotated[float, Quantity("length", "1 um", "5 mm")]
    nose_radius: Annotated[float, Quantity("length", "5 um", "50 mm")]
    fine: Fine
    spiral: bool = True

    @model_validator(mode="before")
    @classmethod
    def _fine_alone(cls, entries: object) -> object:
        if not isinstance(entries, Mapping):
            return entries
        if of_random := [key for key in _OF_RANDOM if key in entries]:
            raise ValueError(problem("random_and_feed", key=of_random[0]))
        return _with_fine(entries)

    @model_validator(mode="after")
    def _sensible(self) -> TurnedFace:
        self.check_texture()
        return self

    def check_texture(self) -> None:
        """ValueError if the keys do not make a turned face."""
        if isinstance(self.fine, FinishTable) and self.fine.process == "turned":
            raise ValueError(problem("fine_turned"))
        self.texture()

    def build(self) -> PowerSpectrum:
        """The spectrum of the fine roughness as `leak` takes it."""
        from leak import PowerSpectrum
        from leak.surfaces.finish import SHORTEST_WAVE

        if isinstance(self.fine, FinishTable):
            return self.fine.build()
        q_low = math.pi / self.feed
        return PowerSpectrum.self_affine(
            rms_height=self.fine.rms_height,
            hurst=self.fine.hurst,
            q_low=min(q_low, self.fine.q_rolloff),
            q_rolloff=self.fine.q_rolloff,
            q_high=self.fine.q_high or 2.0 * math.pi / SHORTEST_WAVE.usual,
        )

    def texture(self) -> TurnedTexture:
        """The face as `leak` takes it; SurfaceError, a ValueError, if it is none."""
        from leak import TurnedTexture

        return TurnedTexture(self.feed, self.nose_radius, self.build())


AnySpectrum = SelfAffine | TabulatedSpectrum | MeasuredSpectrum | FinishTable | TurnedFace
Spectrum = Annotated[AnySpectrum, Field(discriminator="kind")]
# Keys of [roughness] that hold a spectrum.
PARTS = ("spectrum", "seat", "closure", "gasket", "along", "across")


class JoinedFaces(NamedTuple):
    """What both faces make together: a spectrum with its Tripp number, and the cusps of each turned face.

    Of turned faces the spectrum is that of the fine roughness on the crests of both.
    """

    spectrum: PowerSpectrum
    peklenik: float
    crests: tuple[Cusps, ...] = ()
    phase: float = 0.5

    @property
    def of_crests(self) -> dict[str, Any]:
        """Keywords of a `TurnedContact` beside its fine roughness; empty without a turned face."""
        if not self.crests:
            return {}
        first, other = self.crests[0], self.crests[1] if len(self.crests) > 1 else None
        return {**first._asdict(), "other": other, "phase": self.phase}


class Roughness(FinishKeys):
    """[roughness]: of both surfaces together, or of each; their spectra add.

    Ra, Rq or Rz with a process in the table itself is the finish of each of both faces, as a drawing means it, and a
    feed that of both tools.
    """

    kind: Literal["finish", "turned"] | None = None
    feed: Annotated[float, Quantity("length", "1 um", "5 mm")] | None = None
    fine: Fine | None = None
    spectrum: Spectrum | None = None
    seat: Spectrum | None = None
    closure: Spectrum | None = None
    gasket: Spectrum | None = None

    along: Spectrum | None = None
    across: Spectrum | None = None
    peklenik: Annotated[float, Number(0.001, 1000)] = 1.0

    @model_validator(mode="before")
    @classmethod
    def _finishes(cls, entries: object) -> object:
        return read_roughness(entries)

    @model_validator(mode="after")
    def _one_way(self) -> Roughness:
        spectra = [key for key in PARTS if getattr(self, key) is not None]
        if self.feed is not None:
            if spectra:
                raise ValueError(problem("finish_and_spectrum", height="feed", others=" and ".join(spectra)))
            self._check_faces()
            return self
        if self.height is not None:
            if spectra:
                raise ValueError(
                    problem("finish_and_spectrum", height=self.height, others=" and ".join(spectra))
                )
            self._check_finish()
            return self
        keys = [key for key in FinishKeys.model_fields if getattr(self, key) is not None]
        if keys or self.kind is not None:
            raise ValueError(
                problem("finish_without_height", what=f"has {keys[0]}" if keys else "is a finish")
            )
        if "along" in spectra or "across" in spectra:
            self._two_directions(spectra)
        elif ("spectrum" in spectra) == any(key in spectra for key in ("seat", "closure", "gasket")):
            raise ValueError(problem("spectrum_twice" if spectra else "spectrum_missing"))
        if self.is_turned and "peklenik" in self.model_fields_set:
            by_scans = not any(isinstance(part, TurnedFace | FinishTable) for part in self._turned_parts)
            raise ValueError(problem("peklenik_of_turned" if by_scans else "not_of_turned", key="peklenik"))
        return self

    def _check_faces(self) -> None:
        """ValueError if the keys do not make two turned faces."""
        for key in _OF_RANDOM:
            if key in self.model_fields_set and getattr(self, key) is not None:
                raise ValueError(problem("random_and_feed", key=key))
        if self.process != "turned":
            raise ValueError(problem("of_turned", key="feed", process=self.process or "unspecified"))
        for key in ("nose_radius", "fine"):
            if getattr(self, key) is None:
                raise ValueError(f"{key} {missing_key(TurnedFace, key).message}")
        face = self.parts["seat"]
        assert isinstance(face, TurnedFace)
        face.check_texture()

    def _two_directions(self, spectra: Collection[str]) -> None:
        if not {"along", "across"} <= {*spectra}:
            raise ValueError("needs along and across, both or neither")
        if len(spectra) > 2:
            raise ValueError(problem("directions_and_spectrum"))
        if self.peklenik != 1.0:
            raise ValueError("has peklenik, which along and across determine already; remove it")
        if isinstance(self.along, FinishTable | TurnedFace) or isinstance(
            self.across, FinishTable | TurnedFace
        ):
            raise ValueError(problem("finish_in_directions"))

    @property
    def parts(self) -> dict[str, AnySpectrum]:
        """The spectra that are given, by their key; a finish of each of both faces stands at seat and at closure."""
        if self.height is not None:
            entries = {key: getattr(self, key) for key in FinishKeys.model_fields}
            both = FinishTable.model_construct(kind="finish", **entries)
            return {"seat": both, "closure": both}
        if self.feed is not None:
            turned = TurnedFace.model_construct(
                kind="turned",
                process="turned",
                feed=self.feed,
                nose_radius=self.nose_radius,  # type: ignore[arg-type]
                fine=self.fine,  # type: ignore[arg-type]
                spiral=self.spiral is not False,
            )
            return {"seat": turned, "closure": turned}
        return {key: spectrum for key in PARTS if (spectrum := getattr(self, key)) is not None}

    @property
    def finishes(self) -> dict[str, FinishTable]:
        """Those of `parts` that are finishes."""
        return {key: spectrum for key, spectrum in self.parts.items() if isinstance(spectrum, FinishTable)}

    @property
    def turned_faces(self) -> dict[str, TurnedFace | MeasuredSpectrum]:
        """Those of `parts` that are turned with a feed that is given or seen in scans."""
        return {
            key: part
            for key, part in self.parts.items()
            if isinstance(part, TurnedFace) or (isinstance(part, MeasuredSpectrum) and part.turned_scan)
        }

    @property
    def is_turned(self) -> bool:
        """Whether a face is turned, with a feed or with a drawing's finish."""
        return bool(self._turned_parts)

    @property
    def _turned_parts(self) -> list[TurnedFace | MeasuredSpectrum | FinishTable]:
        by_drawing = [face for face in self.finishes.values() if face.process == "turned"]
        return [*self.turned_faces.values(), *by_drawing]

    @property
    def has_two_combs(self) -> bool:
        """Whether crests of one face lie on those of the other."""
        return len(self._turned_parts) > 1

    @property
    def has_thread(self) -> bool:
        """Whether a groove of a turned face leads through the contact: unless it is a ring."""
        return any(face.spiral is not False for face in self._turned_parts)

    @property
    def leaves_open(self) -> bool:
        """Whether it says less than the leak rate needs: of a finish its shape, of two turned faces how they lie."""
        return bool(self.finishes) or self.has_two_combs

    @property
    def is_measured(self) -> bool:
        """Whether a spectrum comes from scans."""
        return any(isinstance(spectrum, MeasuredSpectrum) for spectrum in self.parts.values())

    def build(self) -> PowerSpectrum:
        """Spectrum of the gap between the undeformed surfaces."""
        return self.combine()[0]

    def combine(
        self,
        swaps: Mapping[str, PowerSpectrum | TurnedTexture] | None = None,
        shares: Mapping[str, float] | None = None,
        factors: Mapping[str, float] | None = None,
    ) -> JoinedFaces:
        """Spectrum of the gap between the undeformed surfaces, its Tripp number, and the crests of turned faces.

        The sum of the spectra given, or the angular average of those along and across. Of faces with a lay the number
        is the ratio of rms slopes, across the flow over along it, of the sum.

        Parameters
        ----------
        swaps : mapping, optional
            Spectra and turned faces that stand instead of the table's own, by their key.
        shares, factors : mapping, optional
            Places in the ranges of what the finishes leave open, and factors, see `leak.Finish.surface`; the same in
            both faces.
        """
        from leak import TurnedTexture

        swaps = swaps or {}
        faces = {
            key: face.surface(shares, factors) for key, face in self.finishes.items() if key not in swaps
        }
        spectra = {
            key: fine_of(swaps[key])
            if key in swaps
            else faces[key].spectrum
            if key in faces
            else part.build()
            for key, part in self.parts.items()
        }
        if "along" in spectra:
            stretch = _stretch(spectra["along"], spectra["across"])
            return JoinedFaces(stretch.spectrum, stretch.peklenik)
        total = reduce(lambda total, spectrum: total + spectrum, spectra.values())
        textures = [
            swap if isinstance(swap := swaps.get(key), TurnedTexture) else face.texture()
            for key, face in self.turned_faces.items()
        ]
        textures += [face.texture for face in faces.values() if face.texture is not None]
        crests = tuple(texture.own for texture in textures)
        if "peklenik" in self.model_fields_set or crests or not faces:
            # the other half of a feed is the same, mirrored
            return JoinedFaces(total, self.peklenik, crests, 0.5 * float((shares or {}).get(PHASE, 0.5)))
        number = _tripp_number(
            [(spectra[key].rms_slope, faces[key].peklenik if key in faces else 1.0) for key in spectra]
        )
        return JoinedFaces(total, number)

    @property
    def cutoff(self) -> float | None:
        """Wave beyond which the finishes say nothing, and the user neither [m]; None without a finish."""
        faces = [finish for finish in self.finishes.values() if finish.q_low is None]
        return max((finish.finish.band.lambda_c for finish in faces), default=None)

    def remarks(self) -> Iterator[str]:
        """What the scans themselves say against their use, and values that a process does not usually reach."""
        for text in dict.fromkeys(finish.remark for finish in self.finishes.values()):
            if text:
                yield f"roughness: {text}"
        for key, part in self.parts.items():
            if isinstance(part, MeasuredSpectrum):
                for warning in part.remarks():
                    yield f"roughness.{key}: {warning}"
        if self.along is not None and self.across is not None:
            stretch = _stretch(self.along.build(), self.across.build())
            if stretch.misfit > _LARGEST_MISFIT:
                yield str(problem("no_stretch", best=stretch.peklenik, off=math.exp(stretch.misfit)))


def fine_of(face: PowerSpectrum | TurnedTexture) -> PowerSpectrum:
    """Spectrum of a face; of a turned one that of its fine roughness."""
    from leak import TurnedTexture

    return face.fine if isinstance(face, TurnedTexture) else face


def _tripp_number(faces: Sequence[tuple[float, float]]) -> float:
    """Tripp number of the sum of independent roughnesses from the rms slope and the number of each.

    The mean square slopes along the flow, s^2/(1 + g^2), and across it, s^2 g^2/(1 + g^2), add.
    """
    slopes_along = sum(slope**2 / (1.0 + number**2) for slope, number in faces)
    slopes_across = sum(slope**2 * number**2 / (1.0 + number**2) for slope, number in faces)
    return math.sqrt(slopes_across / slopes_along)


def read_roughness(entries: object) -> object:
    """The table as it is checked: finishes in words become tables, and where Ra, Rq or Rz stands the kind is said.

    Parameters
    ----------
    entries : object
        What stands in the case file; anything that is no table stays as it is.

    Raises
    ------
    ValueError
        If a text is no finish.
    """
    if isinstance(entries, str):
        return read_finish(entries)
    if not isinstance(entries, Mapping):
        return entries
    tables = dict(entries)
    if "feed" in tables:
        tables = {**_with_fine(tables), "kind": "turned"}
    for key in PARTS:
        part = tables.get(key)
        if isinstance(part, str):
            try:
                tables[key] = read_finish(part)
            except ValueError as error:
                raise ValueError(f"{key}, {show(part)}, {error}") from None
        elif isinstance(part, Mapping) and "feed" in part:
            tables[key] = {**part, "kind": "turned"}
        elif isinstance(part, Mapping) and key in ("along", "across") and part.get("kind") == "profile":
            # of one direction each, and no face of its own
            tables[key] = {"turned": False, **part}
        elif isinstance(part, Mapping) and is_finish(part):
            tables[key] = {**part, "kind": "finish"}
    return tables


# Keys of [roughness] that go together; one way of giving the roughness replaces the others.
_OF_CUSPS = ("feed", "fine", "spiral")
_WAYS = (("spectrum",), ("seat", "closure", "gasket"), ("along", "across"))


def roughness_like(old_entries: object, change: object) -> tuple[object, object]:
    """The table before a change and the change, such that merging one into the other gives what is meant.

    Another way of giving the roughness replaces the one before. A finish of each of both faces stays that of the face
    that is not changed, and one of Ra, Rq and Rz replaces the others.

    Parameters
    ----------
    old_entries, change : object
        As they stand in a case file; anything that is no table stays as it is.
    """
    if not isinstance(change, Mapping):
        return old_entries, change
    old = _as_tables(old_entries)
    new = {**change, **_as_tables({key: change[key] for key in PARTS if key in change})}
    if _has_height(new) or "feed" in new:
        same = is_finish(old) if _has_height(new) else "feed" in old
        for key in HEIGHTS if same else (*PARTS, "peklenik", "kind", *_OF_CUSPS, *FinishKeys.model_fields):
            old.pop(key, None)
        return old, new
    ways = [way for way in _WAYS if any(new.get(key) is not None for key in way)]
    if len(ways) == 1:
        if is_finish(old):
            finish = {key: old.pop(key) for key in ("kind", *FinishKeys.model_fields) if key in old}
            if ways[0] == _WAYS[1]:
                faces = ("gasket" if "gasket" in new else "seat", "closure")
                old |= {key: {**finish, "kind": "finish"} for key in faces}
        if "feed" in old:
            face = {key: old.pop(key) for key in ("kind", "process", "nose_radius", *_OF_CUSPS) if key in old}
            if ways[0] == _WAYS[1]:
                old |= {
                    key: {**face, "kind": "turned"}
                    for key in ("gasket" if "gasket" in new else "seat", "closure")
                }
        for key in PARTS:
            if key not in ways[0]:
                old.pop(key, None)
    for key in PARTS:
        part, new_part = old.get(key), new.get(key)
        if not (isinstance(part, Mapping) and isinstance(new_part, Mapping)):
            continue
        if ("feed" in part) != ("feed" in new_part) and (_has_height(new_part) or "feed" in new_part):
            del old[key]
        elif _has_height(new_part):
            old[key] = {name: value for name, value in part.items() if name not in HEIGHTS}
    return old, new


def _has_height(entries: Mapping[str, Any]) -> bool:
    return any(entries.get(key) is not None for key in HEIGHTS)


def _as_tables(entries: object) -> dict[str, Any]:
    """A new table with its finishes as tables; empty if it is none, or a text that is no finish."""
    try:
        tables = read_roughness(entries)
    except ValueError:
        return {}
    return dict(tables) if isinstance(tables, Mapping) else {}


@lru_cache(maxsize=64)
def _stretch(along: PowerSpectrum, across: PowerSpectrum) -> StretchedRoughness:
    from leak import stretched_roughness

    return stretched_roughness(along, across)


def scan_case(files: Sequence[str], entries: Mapping[str, Any]) -> MeasuredSpectrum:
    """Scans with the settings of a case file, given outside of one.

    Parameters
    ----------
    files : sequence of str
    entries : mapping
        Keys of a spectrum of kind "profile" as they stand in a case file; None is left out.

    Raises
    ------
    InputError
        If an entry is wrong or a file cannot be used.
    """
    settings = {key: value for key, value in entries.items() if value is not None}
    try:
        return MeasuredSpectrum.model_validate({"kind": "profile", "files": list(files), **settings})
    except ValidationError as error:
        raise InputError(*problems(error, MeasuredSpectrum)) from None


# The long waves of a measured surface end at eight times its roll-off, in ln q; their ln C changes by this at most.
_TRANSITION, _MOST_CHANGED = float(np.log(8.0)), 12.0
# A scatter of ln height that no leak rate shows.
_SMALLEST = 0.01
# Keys of a self-affine spectrum that change its shape.
SHAPE = ("hurst", "q_rolloff", "q_high")
# Place of the crests of one face between those of the other: 0 crest on crest, 1 crest in the middle of a groove.
PHASE = "phase"


@dataclass(frozen=True, eq=False)
class UncertainHeight:
    """The long waves of a measured surface, of which scans of finite length hold a random number.

    Parameters
    ----------
    key : {"spectrum", "seat", "closure", "along", "across"}
        Which spectrum of the case it is.
    name : str
    height : leak.surfaces.self_affine_fit.TrueHeight
        Rms height of the surface over that of its scans.
    rolloff : float
        Waves down to this wavenumber make the difference; those shorter than an eighth of its wave none [1/m].
    share : float
        Share of the variance of ln height that the differences between the scans do not show already.
    """

    key: str
    name: str
    height: TrueHeight
    rolloff: float
    share: float = 1.0
    dimensions: ClassVar[int] = 1
    """Number of random numbers that it takes."""

    def values(self, uniform: FloatArray) -> FloatArray:
        """Factors on the rms height from numbers between 0 and 1, shape (n, 1) to (n, 1)."""
        middle = float(np.log(self.height.quantile([0.5])[0]))
        return np.exp(middle + np.sqrt(self.share) * (np.log(self.height.quantile(uniform)) - middle))

    def reported_values(self, values: FloatArray) -> FloatArray:
        """The factors, shape (n,)."""
        return values[:, 0]

    def spectrum(self, base: PowerSpectrum, factor: float) -> PowerSpectrum:
        """The measured spectrum with its long waves changed so that the rms height is `factor` times what it was."""
        from leak import PowerSpectrum

        q = np.union1d(base.wavenumber, np.geomspace(base.q_low, base.q_high, 60)[1:-1])
        C = np.asarray(base(q))
        long_waves = np.clip(1.0 - np.log(q / self.rolloff) / _TRANSITION, 0.0, 1.0)

        def scale(log_C: float) -> PowerSpectrum:
            return PowerSpectrum(q, C * np.exp(log_C * long_waves))

        def misfit(log_C: float) -> float:
            return float(np.log(scale(log_C).rms_height / base.rms_height / factor))

        end = _MOST_CHANGED * float(np.sign(np.log(factor)))
        if end == 0.0:
            return base
        # what the short waves alone have is the least
        return scale(root_between(misfit, 0.0, end, rtol=1e-9) if misfit(0.0) * misfit(end) < 0.0 else end)


def uncertain_heights(roughness: Roughness | None, *, between_scans: bool) -> Iterator[UncertainHeight]:
    """What the length of the scans leaves open, for each measured spectrum of the table.

    Parameters
    ----------
    roughness : Roughness or None
    between_scans : bool
        Whether the differences between the scans are an uncertain input themselves.
    """
    parts = {} if roughness is None else roughness.parts
    scans = {key: part for key, part in parts.items() if isinstance(part, MeasuredSpectrum)}
    for key, scan in scans.items():
        surface = scan.read_scans() if scan.turned_scan is None else scan.turned_scan.rest
        low, high = surface.rolloff.height.interval
        if np.log(high / low) < _SMALLEST:
            continue
        # random weights scatter the mean of n scans by (n-1)/(n+1) of its true variance
        count = len(surface.scans)
        yield UncertainHeight(
            key,
            "scan_length" if len(scans) == 1 else f"scan_length_{key}",
            surface.rolloff.height,
            surface.rolloff.wavenumber or surface.q_low,
            2.0 / (count + 1.0) if between_scans else 1.0,
        )


@dataclass(frozen=True, eq=False)
class UncertainFinish:
    """One thing that the finishes of a case leave open, at the same place of its range in both faces.

    The faces need not have it alike: together they make the interval wider than one by one.

    Parameters
    ----------
    name : str
        "Ra", "Rq" or "Rz" of a range, "hurst", "q_rolloff", "q_high", "rms_height" or "lay", of turned faces
        "nose_radius", "fine_height" or "phase".
    spreads : tuple of Spread
        Its range on each face.
    """

    name: str
    spreads: tuple[Spread, ...]
    dimensions: ClassVar[int] = 1
    """Number of random numbers that it takes."""

    def values(self, uniform: FloatArray) -> FloatArray:
        """Places in the ranges from numbers between 0 and 1, shape (n, 1) to (n, 1)."""
        return uniform

    def reported_values(self, values: FloatArray) -> FloatArray:
        """The values themselves, geometric mean over the faces, of waves their wavenumber, shape (n,)."""
        if self.name == PHASE:
            return values[:, 0]
        each = [np.log(spread.at(values[:, 0], log=self.name != "hurst")) for spread in self.spreads]
        means = np.exp(np.mean(each, axis=0))
        return np.asarray(2.0 * np.pi / means if self.name.startswith("q_") else means)


def uncertain_finishes(roughness: Roughness | None, *, names: Collection[str]) -> Iterator[UncertainFinish]:
    """What the finishes of the table leave open.

    Parameters
    ----------
    roughness : Roughness or None
    names : collection of str
        What is told otherwise.
    """
    from leak.surfaces.finish import Spread

    faces = {} if roughness is None else roughness.finishes
    spreads_by_name: dict[str, list[Spread]] = {}
    for finish in faces.values():
        for name, spread in finish.finish.spreads.items():
            if spread.high > spread.low * (1.0 + _SMALLEST):
                spreads_by_name.setdefault(name, []).append(spread)
    if roughness is not None and "peklenik" in roughness.model_fields_set:
        spreads_by_name.pop("lay", None)
    if roughness is not None and roughness.has_two_combs:
        spreads_by_name[PHASE] = [Spread(0.0, 0.5, 1.0)]
    for name, spreads in spreads_by_name.items():
        if name not in names:
            yield UncertainFinish(name, tuple(spreads))


def scanned_faces(roughness: Roughness | None) -> dict[str, tuple[PowerSpectrum | TurnedTexture, ...]]:
    """What the single scans show, for each face of the table that is the mean of two or more."""
    parts = {} if roughness is None else roughness.parts
    each = {key: part.each_scan() for key, part in parts.items() if isinstance(part, MeasuredSpectrum)}
    return {key: scans for key, scans in each.items() if len(scans) > 1}


def self_affine_part(roughness: Roughness | None) -> str | None:
    """Key of the table's self-affine spectrum; None if there is none, or one for each surface."""
    parts = {} if roughness is None else roughness.parts
    keys = [key for key, part in parts.items() if isinstance(part, SelfAffine)]
    return keys[0] if len(keys) == 1 else None
