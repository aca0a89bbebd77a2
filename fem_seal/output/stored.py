"""result.bin: a solution without what only solving reads, from which its report can be drawn again.

It is a pickle, which could call anything when it is read: only values of this program and what they are made of pass,
and arrays are numbers alone, as a pickle of numpy could hold addresses.
"""

from __future__ import annotations

import copyreg
import pickle
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from io import BytesIO
from pathlib import Path, PurePath
from typing import Any, Literal

import numpy as np

from fem_seal.answers.solution import SealSolution
from fem_seal.case.fields import Table
from fem_seal.errors import InputError
from fem_seal.files import problem, write_bytes
from fem_seal.seal.sources import Source
from fem_seal.version import __version__

FILE = "result.bin"
_HEAD = b"fem-seal result "

# What only solving reads, by the names of classes. Contacts of elastic bodies keep their fields where they are drawn.
_OF_SOLVING: Mapping[str, frozenset[str]] = {
    "CondensedBody": frozenset({"compliance", "find_loads", "loads", "recovery", "solve"}),
    "ContactModel": frozenset({"compliance", "harmonics"}),
    "YieldingBody": frozenset({"_dissected_body", "solid"}),
    "ElastoplasticContact": frozenset({"linear", "states", "unloading_model"}),
    # of a map what is calculated again at once
    "ContactSurface": frozenset({"edges", "lengths", "normals", "areas", "slopes", "loops"}),
    "MapFace": frozenset({"across", "rows"}),
}
_FIELDS = frozenset({"fields", "displacements"})

_OWN = ("fem_seal", "leak", "meshes", "pathlib")
# What classes of these are, beside dataclasses: to make one of them does nothing else.
_VALUES = (Enum, PurePath, Source, Table, tuple)
# Of other packages, and functions: values made of numbers.
_KNOWN = {
    ("builtins", "slice"),
    ("scipy._lib.array_api_compat.numpy._aliases", "asarray"),
    ("scipy.interpolate._bsplines", "BSpline"),
    ("scipy.interpolate._fitpack2", "RectBivariateSpline"),
    ("scipy.sparse._csr", "csr_matrix"),
    ("skfem.element.element_tri.element_tri_p1", "ElementTriP1"),
    ("skfem.mapping.mapping_affine", "MappingAffine"),
    ("fem_seal.answers.chain", "_no_table"),
    (__name__, "_array"),
    (__name__, "_scalar"),
    ("fem_seal.seal.leak_model", "FlowModel.table_around"),
}
# Classes whose methods are stored, for which pickle asks `getattr`: they calculate, and write nothing.
_CALCULATING = {"Source", "RoughContact"}


class _Slim(pickle.Pickler):
    """Leaves out what only solving reads."""

    def __init__(self, file: BytesIO, result: SealSolution) -> None:
        super().__init__(file, protocol=5)
        loads = (
            ()
            if result.of_profile
            else (result.highest, max(result.loads, key=lambda load: load.max_von_mises))
        )
        self.drawn = {id(contact) for load in loads for contact in load.contacts}

    def reducer_override(self, value: Any) -> Any:
        """Pickle calls it with every object."""
        if isinstance(value, np.ndarray):
            order: Literal["C", "F"] = "F" if value.flags.fnc else "C"
            buffer = bytearray if value.flags.writeable else bytes
            return _array, (value.dtype.str, value.shape, order, buffer(value.tobytes(order)))
        if isinstance(value, np.generic):
            return _scalar, (value.dtype.str, value.tobytes())
        left_out = _OF_SOLVING.get(type(value).__name__)
        if type(value).__name__ == "ContactSolution" and id(value) not in self.drawn:
            left_out = _FIELDS
        if isinstance(value, SealSolution):
            left_out = frozenset(vars(value)) - {field.name for field in fields(value)}
        if left_out is None:
            return NotImplemented
        state = {name: kept for name, kept in vars(value).items() if name not in left_out}
        names = {field.name for field in fields(value)}
        return copyreg.__newobj__, (type(value),), state | dict.fromkeys(left_out & names)  # type: ignore[attr-defined]


def _array(kind: str, shape: tuple[int, ...], order: Literal["C", "F"], content: bytes | bytearray) -> Any:
    return np.frombuffer(content, kind).reshape(shape, order=order)


def _scalar(kind: str, content: bytes) -> Any:
    return np.frombuffer(content, kind)[0]


class _Known(pickle.Unpickler):
    """Makes nothing but values of this program."""

    def find_class(self, module: str, name: str) -> Any:
        """Class or function of a name that stands in the file."""
        if (module, name) == ("builtins", "getattr"):
            return _method
        if (module, name) in _KNOWN:
            return super().find_class(module, name)
        if module.split(".")[0] in _OWN:
            value = super().find_class(module, name)
            # a name can also lead to what the module imports
            is_class = isinstance(value, type) and (value.__module__, value.__qualname__) == (module, name)
            if is_class and (is_dataclass(value) or issubclass(value, _VALUES)):
                return value
        raise pickle.UnpicklingError(f"{module}.{name}")


def _method(owner: object, name: str) -> object:
    of_program = type(owner).__module__.split(".")[0] in _OWN
    if of_program and type(owner).__name__ in _CALCULATING and not name.startswith("_"):
        return getattr(owner, name)
    raise pickle.UnpicklingError(f"{type(owner).__name__}.{name}")


def store_result(result: SealSolution, path: Path) -> None:
    """Write a solution into a file that `read_result` reads.

    Parameters
    ----------
    result : SealSolution
    path : pathlib.Path
    """
    content = BytesIO()
    content.write(_HEAD + __version__.encode() + b"\n")
    _Slim(content, result).dump(result)
    write_bytes(path, content.getvalue())


def read_result(folder: Path) -> SealSolution:
    """The solution whose files stand in a folder, without what only solving reads.

    Parameters
    ----------
    folder : pathlib.Path

    Raises
    ------
    InputError
        If there is none, if another version has written it, or if it is damaged.
    """
    again = "run the case again"
    try:
        with (folder / FILE).open("rb") as file:
            head = file.readline(100)
            if not head.startswith(_HEAD):
                raise InputError.at(f"{folder / FILE}", f"is no result of fem-seal; {again}")
            version = head.removeprefix(_HEAD).decode(errors="replace").strip()
            if version != __version__:
                versions = {"version": version, "present": __version__, "again": again}
                raise InputError(problem("stored_version", file=folder / FILE, **versions))
            result = _Known(file).load()
            if not isinstance(result, SealSolution):
                raise pickle.UnpicklingError(type(result).__name__)
            return result
    except FileNotFoundError:
        way = (
            "study report DIR` draws that"
            if (folder / "study.sqlite").exists()
            else "run CASE.toml` writes one"
        )
        raise InputError.at(str(folder), f"holds no {FILE}; `fem-seal {way}") from None
    except InputError:
        raise
    except Exception as error:  # a damaged pickle can raise any
        raise InputError.at(f"{folder / FILE}", f"cannot be read ({error}); {again}") from error
