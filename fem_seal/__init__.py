"""Leakage of metal seals: finite-element contact, rough-surface contact theory and leak rate.

>>> import fem_seal
>>> case = fem_seal.load_case("ball_cone.toml")     # doctest: +SKIP
>>> result = fem_seal.run(case)                     # doctest: +SKIP
>>> result.write("out")                             # doctest: +SKIP
"""

from typing import Any

from lazy_loader import attach_stub

# a name is loaded with its first use, so that importing fem_seal takes no time
_present, __dir__, __all__ = attach_stub(__name__, __file__)

# Former name, present name.
_FORMER = {"axial_force_for_leak": "applied_force_for_leak"}


def __getattr__(name: str) -> Any:
    if name in _FORMER:
        from fem_seal.former_names import say_once

        say_once(f"fem_seal.{name}", f"fem_seal.{_FORMER[name]}")
        name = _FORMER[name]
    return _present(name)
