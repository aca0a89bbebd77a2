"""How a process of the command line comes sooner to its work: libraries spared what none of its commands uses.

For `fem_seal.__main__` alone. Where fem_seal is a library, the other libraries are what they always are.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import LazyLoader
from types import ModuleType

# Loaded by scipy and matplotlib for nothing that happens here, with a hundred and fifty others.
POSTPONED = frozenset(
    {
        "PIL.ExifTags",
        "fontTools.agl",
        "mpl_toolkits.mplot3d.art3d",
        "numpy.f2py",
        "numpy.testing",
    }
)


def spare() -> None:
    """Spare modules that are loaded from now on what nobody asks for; to be called before anything is imported."""
    sys.meta_path.insert(0, _Sparing)


class _Sparing:
    """Finds a few modules, as Python does, and changes how they are loaded."""

    @staticmethod
    def find_spec(
        fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Where the module is; None for all others, which Python finds by itself."""
        if fullname not in POSTPONED and fullname not in _CHANGED:
            return None
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, SourceFileLoader):
            file = spec.loader
            changed = _CHANGED.get(fullname)
            spec.loader = changed(file.name, file.path) if changed else LazyLoader(file)
        return spec


class _WithoutProperties(SourceFileLoader):
    """Loads matplotlib's artists without a list of all properties of each in a dozen of docstrings.

    Looking for them takes longer than all else that matplotlib does at its import, and there is no switch. Whoever asks
    `matplotlib.artist.ArtistInspector` for them later gets them.
    """

    def exec_module(self, module: ModuleType) -> None:
        """Load the module, and with it the artists."""
        from matplotlib.artist import ArtistInspector

        found = {"get_aliases": dict, "get_setters": list}
        kept = {name: getattr(ArtistInspector, name) for name in found if hasattr(ArtistInspector, name)}
        try:
            for name in kept:
                setattr(ArtistInspector, name, lambda _, nothing=found[name]: nothing())
            super().exec_module(module)
        finally:
            for name, method in kept.items():
                setattr(ArtistInspector, name, method)


class _WithoutTables(SourceFileLoader):
    """Loads scipy without a table of array libraries in docstrings, each of which it reads and writes anew for it."""

    def exec_module(self, module: ModuleType) -> None:
        """Load the module that has the decorator."""
        super().exec_module(module)
        if "xp_capabilities" in vars(module):
            vars(module)["xp_capabilities"] = lambda **_: lambda function: function


_CHANGED = {"matplotlib.figure": _WithoutProperties, "scipy._lib._array_api": _WithoutTables}
