"""The exceptions of fem_seal, in one tree, and texts of the user as messages may hold them."""

from __future__ import annotations

import traceback
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from leak.extras import say_absent

_SHORT = {"\n": "\\n", "\t": "\\t", "\r": "\\r"}


def printable(text: str) -> str:
    r"""A text in one line without control characters, which stand there as they are written in TOML.

    Also without those that turn the direction of writing, and what is left of bytes that are no text.

    Parameters
    ----------
    text : str

    Examples
    --------
    >>> printable("\x1b[31mred\n")
    '\\u001b[31mred\\n'
    """
    if text.isprintable():
        return text
    return "".join(
        sign if sign.isprintable() or unicodedata.category(sign) == "Zs" else _escape(sign) for sign in text
    )


def _escape(sign: str) -> str:
    number = ord(sign)
    return _SHORT.get(sign) or (f"\\u{number:04x}" if number < 0x10000 else f"\\U{number:08x}")


# Of an error with many problems.
_MOST_LINES = 20


class Text:
    """What is said, as data: its quantities get their units where it is printed."""

    def text(self, display: Any = None) -> str:
        """In the units of a `fem_seal.units.Display`, those of the field unless given."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.text()


def write(text: object, display: Any = None) -> str:
    """A text, of data in the units of a display; see `Text.text`.

    Parameters
    ----------
    text : object
    display : Display, optional
    """
    return text.text(display) if isinstance(text, Text) else str(text)


class SealError(Text, Exception):
    """Base of all errors that fem_seal raises on purpose; `display` has the units of the case in which it was raised.

    Examples
    --------
    >>> import fem_seal
    >>> issubclass(fem_seal.InputError, fem_seal.SealError)
    True
    """

    display: Any = None

    def text(self, display: Any = None) -> str:
        """See `Text.text`."""
        return " ".join(write(part, display) for part in self.args)

    def __str__(self) -> str:
        return self.text(self.display)


@contextmanager
def errors_in(display: Any) -> Iterator[None]:
    """Errors that are raised meanwhile have their quantities in these units.

    Parameters
    ----------
    display : Display
    """
    try:
        yield
    except SealError as error:
        error.display = display
        raise


class QuantityError(SealError, ValueError):
    """A text is not a quantity of the required dimension, or its value is outside the allowed range."""


@dataclass(frozen=True)
class Problem(Text):
    """One wrong entry of an input, as data.

    Parameters
    ----------
    key : str
        Where it stands, such as ``seat.angle``; empty for the input as a whole.
    says : str or Text
        What is wrong, and what is allowed where `remedy` does not say it.
    given : str or Text, optional
        What stands there, as the user wrote it; None if nothing does.
    remedy : str or Text
        What to do.
    entry : str
        Of templates/problems.toml, which has its texts; empty of what was said elsewhere.
    kind : {"", "open", "strain", "limit", "path", "solution"}
        Why a load cannot be calculated: the fluid or the spring opens the seal; it is more than the faces can carry, or
        than a body that yields; a load before it on the path of such a body cannot be calculated; no solution was
        found. Empty of all else.
    body : str
        Which yields through, by what it is called.
    """

    key: str
    says: str | Text
    given: str | Text | None = None
    remedy: str | Text = field(default="", kw_only=True)
    entry: str = field(default="", kw_only=True)
    kind: str = field(default="", kw_only=True)
    body: str = field(default="", kw_only=True)

    def text(self, display: Any = None) -> str:
        """``key = value: message``, without the parts that do not exist; one line that may be printed."""
        entry = self.key if self.given is None else f"{self.key} = {write(self.given, display)}"
        message = self.message_in(display)
        return printable(f"{entry}: {message}" if entry else message)

    def message_in(self, display: Any = None) -> str:
        """What is wrong and what is allowed, in the units of a display."""
        return join_remedy(write(self.says, display), write(self.remedy, display))

    @property
    def message(self) -> str:
        """What is wrong and what is allowed, in units of the field."""
        return self.message_in()

    @property
    def value(self) -> str | None:
        """What stands there, as the user wrote it, in units of the field; None if nothing does."""
        return None if self.given is None else write(self.given)


def join_remedy(says: str, remedy: str) -> str:
    """What is wrong and what to do in one text.

    Parameters
    ----------
    says, remedy : str
        The second may be empty.
    """
    return f"{says}{'. ' if remedy[0].isupper() else '; '}{remedy}" if remedy else says


class InputError(SealError, ValueError):
    """The input is wrong: each problem names the key, the value and what is allowed.

    Parameters
    ----------
    *problems : Problem
        At least one.
    file : path, optional
        File in which they stand.

    Examples
    --------
    >>> import fem_seal
    >>> case = fem_seal.Case(
    ...     closure={"shape": "ball", "radius": "20 mm", "material": "steel"},
    ...     seat={"shape": "cone", "angle": "45 deg", "material": "steel"},
    ...     interface={"law": "smooth"},
    ...     load={"fluid_pressure": "20 bar"},
    ... )
    >>> try:
    ...     case.replace({"seat.angle": "100 deg"})
    ... except fem_seal.InputError as error:
    ...     print(error.key, error.value)
    seat.angle "100 deg"
    """

    def __init__(self, *problems: Problem, file: str | Path | None = None) -> None:
        self.problems = problems
        self.file: Path | None = None if file is None else Path(file)
        super().__init__(*problems)

    @classmethod
    def at(
        cls, key: str, says: str | Text, given: str | Text | None = None, *, file: str | Path | None = None
    ) -> InputError:
        """The error of one wrong entry, see `Problem`."""
        return cls(Problem(key, says, given), file=file)

    def text(self, display: Any = None) -> str:
        """One line per problem, each beginning with the file, and how many more there are."""
        prefix = "" if self.file is None else printable(f"{self.file}: ")
        lines = [f"{prefix}{problem.text(display)}" for problem in self.problems[:_MOST_LINES]]
        rest = len(self.problems) - len(lines)
        if rest:
            lines.append(f"{prefix}{rest} more entries are wrong; correct these first")
        return "\n".join(lines)

    @property
    def key(self) -> str:
        """Key of the first problem."""
        return self.problems[0].key

    @property
    def value(self) -> str | None:
        """Value that stands at the first problem's key."""
        return self.problems[0].value

    @property
    def message(self) -> str:
        """What the first problem says is wrong and allowed."""
        return self.problems[0].message

    # the name that it had before
    allowed = message

    def in_file(self, file: str | Path | None) -> InputError:
        """The same problems, found in `file`."""
        return type(self)(*self.problems, file=file)


class NoLoadLeftError(InputError):
    """No load of a case can be calculated, though its input is well-formed."""


class ConvergenceError(SealError, RuntimeError):
    """An iteration did not converge; `partial` keeps what was reached, None if nothing was.

    Parameters
    ----------
    message : str or Text
        Which load, which residual, what to try.
    partial : object, optional
        Results of the loads solved before, or the last iterate.

    Examples
    --------
    >>> import fem_seal
    >>> issubclass(fem_seal.ConvergenceError, fem_seal.SealError)
    True
    """

    def __init__(self, message: str | Text, partial: object = None) -> None:
        super().__init__(message)
        self.partial = partial


class LimitLoadError(ConvergenceError):
    """A body yields through: it bears no larger load.

    Parameters
    ----------
    message : str or Text
    body : str
        By what it is called.
    """

    def __init__(self, message: str | Text, body: str = "") -> None:
        super().__init__(message)
        self.body = body


class LongPathError(ConvergenceError):
    """The load steps of bodies that yield become so short that their path does not come to an end."""


class OpenSealError(SealError, ValueError):
    """The loads leave the seal open: there is no contact to solve.

    Parameters
    ----------
    message : str or Text
    blow_off_pressure : float, optional
        Fluid pressure at which it opens [Pa].
    """

    def __init__(self, message: str | Text, blow_off_pressure: float | None = None) -> None:
        super().__init__(message)
        self.blow_off_pressure = blow_off_pressure


class OutputError(SealError, OSError):
    """A result file cannot be written."""


class DrawingError(SealError, RuntimeError):
    """A picture in space cannot be drawn on this machine."""


class ClusterError(SealError, RuntimeError):
    """The worker processes of a study are gone or cannot calculate; finished designs are kept."""


class TextTableError(SealError, ValueError):
    """A file is not a table of numbers, or not the expected one."""


def defect_text(error: BaseException) -> str:
    """What is said of an error that nobody thought of, in one line.

    Parameters
    ----------
    error : BaseException
    """
    if isinstance(error, MemoryError):
        return "not enough memory; try a coarser mesh or fewer loads"
    line = f"unexpected {type(error).__name__}: {error}. This is a defect of fem-seal; --debug shows the traceback"
    return printable(line)


_PACKAGES = ("fem_seal", "leak", "meshes")


def error_text(error: Exception, display: Any = None) -> str:
    """What an error says; one that nobody foresaw with its kind and the place in the program it comes from.

    Parameters
    ----------
    error : Exception
    display : Display, optional
        Units of what it says.

    Examples
    --------
    >>> error_text(OutputError("leak.csv: no space left on device"))
    'leak.csv: no space left on device'
    """
    if type(error).__module__.split(".")[0] in _PACKAGES:
        return " ".join(write(error, display).split())
    if isinstance(error, MemoryError):
        return "not enough memory"
    if isinstance(error, ModuleNotFoundError) and (said := say_absent(error.name)):
        return said
    name = type(error).__name__
    places = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if any(package in Path(frame.filename).parts for package in _PACKAGES)
    ]
    place = f" in {Path(places[-1].filename).name}, line {places[-1].lineno}" if places else ""
    return f"unexpected {name}: {error}{place}, a defect of fem-seal"
