"""What can go wrong in `leak`, one sentence per class, and the checks of numbers and arrays that raise it.

All are `ValueError`, so existing handlers keep working.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from leak.arrays import BoolArray, FloatArray


class LeakError(ValueError):
    """Any wrong input to the `leak` package; the message names the key, the value and what is allowed.

    Examples
    --------
    >>> import leak
    >>> issubclass(leak.SpectrumError, leak.LeakError), issubclass(leak.LeakError, ValueError)
    (True, True)
    """


class SpectrumError(LeakError):
    """A power spectrum cannot be made from the numbers given.

    Examples
    --------
    >>> import leak
    >>> leak.PowerSpectrum.self_affine(rms_height=-1.0, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    Traceback (most recent call last):
        ...
    leak.errors.SpectrumError: rms_height = -1.0: must be a positive finite number [m]
    """


class TableError(LeakError):
    """A text holds no table of numbers, or not the expected one.

    Examples
    --------
    >>> from leak.text_tables import read_tables
    >>> read_tables("no numbers")
    Traceback (most recent call last):
        ...
    leak.errors.TableError: has a header but no rows of numbers
    """


class ScanError(LeakError):
    """A measured line scan or height map cannot be read, or holds too little to make a spectrum of.

    Examples
    --------
    >>> import leak
    >>> leak.line_scan([0.0], [0.0])
    Traceback (most recent call last):
        ...
    leak.errors.ScanError: a scan of 1 point: needs at least 16
    """


class SurfaceError(LeakError):
    """A rough contact was given a material value or a pressure outside its meaning.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> leak.RoughContact(spectrum, effective_modulus=0.0)
    Traceback (most recent call last):
        ...
    leak.errors.SurfaceError: effective_modulus = 0.0: must be a positive finite number [Pa]
    """


class LawError(LeakError):
    """An interface law cannot be made from the numbers given.

    Examples
    --------
    >>> import leak
    >>> leak.TabulatedLaw([0.0, 1e-6], [1e6, 2e6])
    Traceback (most recent call last):
        ...
    leak.errors.LawError: pressure[1]: pressure must strictly decrease along the table [Pa]
    """


class ProfileError(LeakError):
    """A pressure profile, or what goes with it into the leak integral, cannot be used.

    Examples
    --------
    >>> import leak
    >>> leak.leak_rate([0.0, 1e-3], [1e6, 1e6, 1e6], 1e-15, 1e5, 0.014)
    Traceback (most recent call last):
        ...
    leak.errors.ProfileError: x has shape (2,), p has shape (3,): both must be (n,)
    """


class ConductivityError(LeakError):
    """A flow conductivity was asked for outside the pressures it was tabulated for, or with an unknown method.

    Examples
    --------
    >>> import leak
    >>> spectrum = leak.PowerSpectrum.self_affine(rms_height=1e-6, hurst=0.8, q_low=1e4, q_rolloff=5e4, q_high=1e6)
    >>> surface = leak.RoughContact(spectrum, effective_modulus=115e9)
    >>> surface.conductivity_table(1e6, 1e8, method="guess")
    Traceback (most recent call last):
        ...
    leak.errors.ConductivityError: method = 'guess': must be one of ('bruggeman', 'critical-junction', 'threshold-law')
    """


class DirectError(LeakError):
    """A direct simulation was given a map or pressure it cannot use, or its contact did not converge.

    Examples
    --------
    >>> import leak
    >>> leak.direct.simulate([[0.0, 0.0]], 1e-3, [1e6], effective_modulus=100e9)
    Traceback (most recent call last):
        ...
    leak.errors.DirectError: heights has shape (1, 2): must be (n, n), n at least 2
    """


class FluidError(LeakError):
    """A fluid is not in the library, or has an impossible property.

    Examples
    --------
    >>> import leak
    >>> try:
    ...     leak.liquid("soup")
    ... except leak.FluidError as error:
    ...     print(str(error)[:18])
    fluid = 'soup': mu
    """


def um(length: float, digits: int = 4) -> str:
    """A length [m] for a message, in the unit of roughness.

    Parameters
    ----------
    length : float
    digits : int, optional
        Significant ones.

    Examples
    --------
    >>> um(2.5e-5)
    '25 um'
    """
    return f"{1e6 * float(length):.{digits}g} um"


def positive(error: type[ValueError], name: str, value: float, unit: str) -> float:
    """Return `value` as a float, or raise `error` when it is not a positive finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if not 0.0 < number < float("inf"):
        raise error(f"{name} = {value!r}: must be a positive finite number [{unit}]")
    return number


def as_arrays(error: type[ValueError], must: str, *values: ArrayLike) -> list[FloatArray]:
    """Arrays of numbers, or `error` with what the values must be and why one of them is not."""
    # a command that answers before any calculation loads this file, too
    import numpy as np

    try:
        return [np.asarray(value, dtype=float) for value in values]
    except (TypeError, ValueError) as reason:
        raise error(f"{must}: {reason}") from None


def check_each(error: type[ValueError], name: str, values: FloatArray, good: BoolArray, must: str) -> None:
    """Raise `error` with the first of several values that is not right, "p[3] = -1.0: must not be negative [Pa]"."""
    places = (~good).nonzero()[0]
    if places.size:
        raise error(f"{name}[{places[0]}] = {values[places[0]]}: {must}")


def check_order(
    error: type[ValueError], name: str, values: FloatArray, must: str, *, equal: bool = False
) -> None:
    """Raise `error` with the first of several values that is below the one before, or as large unless it may be."""
    lower, upper = values[:-1], values[1:]
    places = (upper < lower if equal else upper <= lower).nonzero()[0]
    if places.size:
        i = int(places[0])
        raise error(f"{name}[{i + 1}] = {values[i + 1]} follows {values[i]}: {must}")
