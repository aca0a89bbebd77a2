"""Leakage of metal seals: finite-element contact, rough-surface contact theory and leak rate.

>>> import fem_seal
>>> case = fem_seal.load_case("ball_cone.toml")     # doctest: +SKIP
>>> result = fem_seal.run(case)                     # doctest: +SKIP
>>> result.write("out")                             # doctest: +SKIP
"""

from lazy_loader import attach_stub

# a name is loaded with its first use, so that importing fem_seal takes no time
__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
