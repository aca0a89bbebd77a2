"""What can go wrong in `leak`, one sentence per class; all are `ValueError`, so existing handlers keep working."""


class LeakError(ValueError):
    """Any wrong input to the `leak` package; the message names the key, the value and what is allowed."""


class SpectrumError(LeakError):
    """A power spectrum cannot be made from the numbers given."""


class ScanError(LeakError):
    """A measured line scan or height map cannot be read, or holds too little to make a spectrum of."""


class SurfaceError(LeakError):
    """A rough contact was given a material value or a pressure outside its meaning."""


class LawError(LeakError):
    """An interface law cannot be made from the numbers given."""


class ProfileError(LeakError):
    """A pressure profile, or what goes with it into the leak integral, cannot be used."""


class ConductivityError(LeakError):
    """A flow conductivity was asked for outside the pressures it was tabulated for, or with an unknown method."""


class FluidError(LeakError):
    """A fluid is not in the library, or has an impossible property."""


def positive(error: type[LeakError], name: str, value: float, unit: str) -> float:
    """Return `value` as a float, or raise `error` when it is not a positive finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if not 0.0 < number < float("inf"):
        raise error(f"{name} = {value!r}: must be a positive finite number [{unit}]")
    return number
