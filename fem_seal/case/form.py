"""The table [form] of the case file: deviations of closure and seat from roundness."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from fem_seal.bolts import BoltCircle
from fem_seal.case.fields import Quantity, Table, WholeNumber, show
from fem_seal.errors import Problem, TextTableError
from fem_seal.files import problem
from fem_seal.form import (
    Direction,
    FormError,
    PlacedGroove,
    Trace,
    Wave,
    WaveTolerance,
    along_normal,
    combine_waves,
    rigid_wave,
)

MOST_WAVES = 500
DEVIATION = Quantity("length", "0 m", "1 mm")
SECTION = Quantity("length", "1 nm", "10 mm")
TURN = Quantity("angle", "-360 deg", "360 deg")
# What a trace is read for unless it says more: the filter that drawings of small seats call for.
_USUAL_WAVES = 15
# Share of a deviation along the normal that is none: cos of 90 degrees in floating point, and far more.
_LEAST_SHARE = 1e-9


class Harmonic(Table):
    """A wave around the axis, deviation = amplitude cos(waves phi - phase)."""

    waves: Annotated[int, WholeNumber(1, MOST_WAVES)]
    amplitude: Annotated[float, DEVIATION]
    phase: Annotated[float, TURN] = 0.0


class MeasuredTrace(Table):
    """A measured roundness, flatness or waviness trace; also just the name of its file."""

    file: str
    unit: str | None = None
    waves: Annotated[int, WholeNumber(2, MOST_WAVES)] = _USUAL_WAVES

    _trace: Trace | None = None

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, entry: Any) -> Any:
        return {"file": entry} if isinstance(entry, str) else entry

    @model_validator(mode="after")
    def _read(self) -> MeasuredTrace:
        from fem_seal.case.traces import read_trace

        try:
            trace = read_trace(self.file, self.unit)
        except TextTableError as error:
            raise ValueError(f"file = {show(self.file)} {error}") from None
        if trace.most_waves < 2:
            raise ValueError(
                problem("sparse_trace", file=show(self.file), gap=math.degrees(trace.widest_gap))
            )
        object.__setattr__(self, "_trace", trace)
        return self

    @property
    def trace(self) -> Trace:
        """What was measured."""
        assert self._trace is not None  # read when the table was checked
        return self._trace

    @property
    def usable_waves(self) -> int:
        """Most waves per turn that are taken: what is asked for, and what the points can tell."""
        return min(self.waves, self.trace.most_waves)

    def remarks(self, body: str) -> list[Problem]:
        """What is to be said about the trace.

        Parameters
        ----------
        body : str
            "closure" or "seat".
        """
        lines = []
        if self.usable_waves < self.waves:
            gap = math.degrees(self.trace.widest_gap)
            lines.append(problem("few_waves", body=body, gap=gap, told=self.usable_waves, waves=self.waves))
        waves = self.trace.waves(self.usable_waves)
        rest, height = self.trace.residual(waves), math.sqrt(sum(w.amplitude**2 for w in waves[1:]) / 2)
        if rest > height:
            heights = {"rest": 1e6 * rest, "height": 1e6 * height}
            lines.append(problem("short_waves", body=body, told=self.usable_waves, **heights))
        return lines


class Scratch(Table):
    """[[form.scratches]]: a scratch across the face, of elliptic section."""

    depth: Annotated[float, SECTION]
    width: Annotated[float, SECTION]
    angle: Annotated[float, TURN] = 0.0
    direction: Annotated[float, Quantity("angle", "-85 deg", "85 deg")] = 0.0

    @property
    def groove(self) -> PlacedGroove:
        """The scratch at its angle."""
        from leak import Scratch as Groove

        return PlacedGroove(Groove(self.depth, self.width, abs(self.direction)), self.angle)


class Lay(Table):
    """[form.lay]: the groove of a turned seat that winds through the contact, not part of [roughness]."""

    pitch: Annotated[float, SECTION]
    depth: Annotated[float, SECTION]
    profile: str | None = None
    section: Literal["sinusoidal", "elliptic"] = "sinusoidal"
    width: Annotated[float, SECTION] | None = None

    @model_validator(mode="before")
    @classmethod
    def _read_profile(cls, table: Any) -> Any:
        if not isinstance(table, dict) or not isinstance(table.get("profile"), str):
            return table
        from fem_seal.case.traces import read_lay

        try:
            pitch, depth = read_lay(table["profile"])
        except TextTableError as error:
            raise ValueError(f"profile = {show(table['profile'])} {error}") from None
        return {"pitch": f"{pitch!r} m", "depth": f"{depth!r} m", **table}

    @model_validator(mode="after")
    def _fits(self) -> Lay:
        if self.width is not None and self.section != "elliptic":
            raise ValueError('width is only for section = "elliptic"; remove it')
        if self.width is not None and self.width > self.pitch:
            raise ValueError("width must not exceed the pitch")
        return self

    @property
    def groove(self) -> PlacedGroove:
        """The groove all around."""
        from leak import EllipticGroove, SinusoidalGroove, SpiralLay

        section = (
            SinusoidalGroove(self.depth, self.pitch)
            if self.section == "sinusoidal"
            else EllipticGroove(self.depth, self.width or self.pitch)
        )
        return PlacedGroove(SpiralLay(self.pitch, section))


class BodyForm(Table):
    """[form.seat] or [form.closure]: deviations of one body, as waves, as a measured trace, or as a tolerance."""

    direction: Direction = "radial"
    harmonics: tuple[Harmonic, ...] = Field((), strict=False)
    trace: MeasuredTrace | None = None
    tolerance: Annotated[float, DEVIATION] | None = None
    tolerance_waves: tuple[Annotated[int, WholeNumber(2, 100)], Annotated[int, WholeNumber(2, 100)]] = Field(
        (2, _USUAL_WAVES), strict=False
    )

    @model_validator(mode="after")
    def _one_source(self) -> BodyForm:
        sources = [key for key in ("harmonics", "trace", "tolerance") if getattr(self, key) not in (None, ())]
        if len(sources) > 1:
            raise ValueError(f"{' and '.join(sources)} both say what the deviations are; keep one of them")
        if self.tolerance is None and "tolerance_waves" in self.model_fields_set:
            raise ValueError("tolerance_waves is only for a tolerance; give tolerance as well, or remove it")
        if self.tolerance_waves[0] > self.tolerance_waves[1]:
            raise ValueError(problem("tolerance_waves", waves=list(self.tolerance_waves)))
        return self

    @property
    def deviations(self) -> tuple[Wave, ...]:
        """Waves of the body's own deviation."""
        if self.trace is not None:
            # from two on: the least-squares circle only says how the part stood
            return self.trace.trace.waves(self.trace.usable_waves)[1:]
        return tuple(Wave(harmonic.waves, harmonic.amplitude, harmonic.phase) for harmonic in self.harmonics)


class Form(Table):
    """[form]: seats that are not round, how the closure is guided, scratches; see guide/form in the manual."""

    guide: Literal["free", "guided"] = "free"
    eccentricity: Annotated[float, DEVIATION] = 0.0
    eccentricity_angle: Annotated[float, TURN] = 0.0
    tilt: Annotated[float, Quantity("angle", "0 deg", "1 deg")] = 0.0
    tilt_angle: Annotated[float, TURN] = 0.0
    tilt_height: Annotated[float, Quantity("length", "-10 m", "10 m")] = 0.0
    seat: BodyForm | None = None
    closure: BodyForm | None = None
    scratches: tuple[Scratch, ...] = Field((), strict=False)
    lay: Lay | None = None

    flow_around: bool = False

    @property
    def parts(self) -> dict[str, BodyForm]:
        """The tables of the bodies that are given, by name."""
        return {
            name: part for name, part in (("closure", self.closure), ("seat", self.seat)) if part is not None
        }

    def without_effect(self, angle: float) -> list[Problem]:
        """What is given and changes nothing, in words.

        Parameters
        ----------
        angle : float
            Of the contact normal to the axis [rad].
        """
        rigid = [key for key in ("eccentricity", "tilt") if getattr(self, key) and self.guide == "free"]
        remarks = [problem("free_closure", key=key) for key in rigid]
        for name, part in self.parts.items():
            if self.guide == "free" and any(wave.waves == 1 and wave.amplitude for wave in part.harmonics):
                remarks.append(problem("one_wave", body=name))
            if abs(along_normal(part.direction, _normal(angle))) < _LEAST_SHARE:
                way = "axial" if part.direction == "radial" else "radial"
                remarks.append(problem("across_normal", body=name, direction=part.direction, other=way))
        return remarks

    def error(
        self,
        angle: float,
        initial_contact_radius: float,
        moment: float = 0.0,
        bolts: BoltCircle | None = None,
    ) -> FormError:
        """What the table does to the gap.

        Parameters
        ----------
        angle : float
            Of the contact normal to the axis [rad].
        initial_contact_radius : float
            [m]
        moment : float
            Of the load [N m].
        bolts : BoltCircle, optional
            One by one.
        """
        normal, offset = _normal(angle), (self.eccentricity, self.eccentricity_angle)
        waves = [
            *rigid_wave(normal, initial_contact_radius, *offset, self.tilt, self.tilt_angle, self.tilt_height)
        ]
        highest, zone, wave_range, remarks = 1, 0.0, [MOST_WAVES, 2], list[str]()
        for name, part in self.parts.items():
            share = along_normal(part.direction, normal) * (1.0 if name == "closure" else -1.0)
            waves += [Wave(wave.waves, share * wave.amplitude, wave.phase) for wave in part.deviations]
            highest = max([highest, *(wave.waves for wave in part.deviations)])
            if part.tolerance is not None:
                zone += 0.5 * abs(share) * part.tolerance
                smallest, largest = part.tolerance_waves
                wave_range = [min(wave_range[0], smallest), max(wave_range[1], largest)]
                highest = max(highest, largest)
            if part.trace is not None:
                remarks += map(str, part.trace.remarks(name))
        tolerance = WaveTolerance(zone, (wave_range[0], wave_range[1])) if zone else None
        grooves = [cut.groove for cut in self.scratches] + ([] if self.lay is None else [self.lay.groove])
        guided = self.guide == "guided"
        return FormError(
            combine_waves(waves), guided, tolerance, highest, tuple(remarks), tuple(grooves), moment, bolts
        )


def _normal(angle: float) -> tuple[float, float]:
    """(n_r, n_z) of the contact normal."""
    return -math.sin(angle), math.cos(angle)
