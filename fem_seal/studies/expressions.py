"""Expressions over the columns of a study: arithmetic on names and numbers, and nothing else.

The text is parsed into Python's syntax tree; every node that is not in the short list below is refused, so that
no text can call, import or reach anything.
"""

from __future__ import annotations

import ast
import difflib
import math
import operator
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache

from fem_seal.errors import QuantityError
from fem_seal.files import problem
from fem_seal.units import DIMENSIONS, parse_quantity


def _smallest(*numbers: float) -> float:
    """Smallest of numbers that are all there: Python's own passes over a NaN unless it comes first."""
    return math.nan if any(map(math.isnan, numbers)) else min(numbers)


def _largest(*numbers: float) -> float:
    return -_smallest(*(-number for number in numbers))


FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "min": _smallest,
    "max": _largest,
    **{name: getattr(math, name) for name in ("sqrt", "exp", "log", "log10", "sin", "cos", "tan")},
}
CONSTANTS = {"pi": math.pi}
_OPERATORS: dict[type[ast.operator | ast.unaryop], Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
}
_COMPARE: dict[type[ast.cmpop], Callable[[float, float], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}
_LONGEST, _DEEPEST = 500, 30


class ExpressionError(ValueError):
    """An expression cannot be understood, or uses what is not allowed."""


@dataclass(frozen=True)
class Part:
    """A number, a name, or a function of other parts.

    Parameters
    ----------
    what : float, str or callable
    parts : tuple of Part
        Arguments of a function.
    unit : str or None
        SI unit of a number that stood there as a quantity.
    """

    what: float | str | Callable[..., float]
    parts: tuple[Part, ...] = ()
    unit: str | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Columns and parameters in it."""
        name = [self.what] if isinstance(self.what, str) else []
        return tuple(dict.fromkeys([*name, *(name for part in self.parts for name in part.names)]))

    def number(self, values: Mapping[str, float]) -> float:
        """Its value; NaN where it is not defined (division by zero, logarithm of a negative number) or not finite."""
        try:
            value = self._evaluate(values)
        except (ZeroDivisionError, ValueError, OverflowError):
            return math.nan
        return value if math.isfinite(value) else math.nan

    def _evaluate(self, values: Mapping[str, float]) -> float:
        if callable(self.what):
            return float(self.what(*(part._evaluate(values) for part in self.parts)))
        return float(values[self.what]) if isinstance(self.what, str) else self.what

    def unit_of(self, units: Mapping[str, str]) -> str | None:
        """SI unit of a single name or quantity, empty for a name that has none; None of anything else.

        Parameters
        ----------
        units : mapping
            SI units of the names.
        """
        return units.get(self.what) if isinstance(self.what, str) else self.unit


@dataclass(frozen=True)
class _Formula:
    text: str

    @property
    def _tree(self) -> ast.expr:
        if len(self.text) > _LONGEST:
            raise ExpressionError(f"is longer than {_LONGEST} characters")
        try:
            return ast.parse(self.text.strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise ExpressionError(problem("study_formula")) from None

    @cached_property
    def sides(self) -> tuple[Part, ...]:
        """What is compared; of a formula itself."""
        tree = self._tree
        return tuple(map(_part, (tree.left, *tree.comparators) if isinstance(tree, ast.Compare) else (tree,)))

    @property
    def names(self) -> tuple[str, ...]:
        """Columns and parameters that it needs."""
        return tuple(dict.fromkeys(name for side in self.sides for name in side.names))


@dataclass(frozen=True)
class Expression(_Formula):
    """A formula over named numbers.

    Parameters
    ----------
    text : str
        Sums, products, powers, the functions in `FUNCTIONS`, names of columns and parameters (``seat.angle``), and
        quantities in quotes (``"1 GPa"``), which count in SI.

    Raises
    ------
    ExpressionError

    Examples
    --------
    >>> Expression('leak_rate_m3_per_s / "1 mm^3/s"')({"leak_rate_m3_per_s": 3e-9})
    3.0
    """

    def __post_init__(self) -> None:
        if len(self.sides) > 1:
            raise ExpressionError("is a comparison; a formula gives a number")

    def __call__(self, values: Mapping[str, float]) -> float:
        """Value; NaN where it is not defined (division by zero, logarithm of a negative number) or not finite."""
        return self.sides[0].number(values)


@dataclass(frozen=True)
class Constraint(_Formula):
    """A comparison of two formulas, ``max_von_mises_Pa < "1 GPa"``.

    Parameters
    ----------
    text : str

    Raises
    ------
    ExpressionError
    """

    def __post_init__(self) -> None:
        if len(self.sides) != 2 or self._holds is None:
            raise ExpressionError('is no constraint; write one comparison such as max_von_mises_Pa < "1 GPa"')

    @property
    def _holds(self) -> Callable[[float, float], bool] | None:
        return _COMPARE.get(type(self._tree.ops[0])) if isinstance(self._tree, ast.Compare) else None

    def is_met(self, values: Mapping[str, float]) -> bool:
        """Whether it holds; it does not where a value is missing."""
        assert self._holds is not None
        return self._holds(*(side.number(values) for side in self.sides))

    def violation(self, values: Mapping[str, float]) -> float:
        """How far it is from being met, relative to the larger side; zero or below where it is met."""
        first, second = (side.number(values) for side in self.sides)
        excess = first - second if self._holds in (operator.lt, operator.le) else second - first
        scale = max(abs(first), abs(second))
        if math.isnan(excess):
            return math.inf
        return excess / scale if scale > 0 else excess


def unknown_name(name: str, names: list[str], what: str = "neither a column nor a parameter") -> str:
    """What to say about a name that is none of those that are known."""
    likely = difflib.get_close_matches(name, names, n=1, cutoff=0.5)
    hint = f"do you mean {likely[0]}? " if likely else ""
    return f"uses {name}, which is {what}; {hint}known are {', '.join(names)}"


def _part(node: ast.expr, depth: int = 0) -> Part:
    """A part of a formula, with all parts below it."""
    if depth > _DEEPEST:
        raise ExpressionError(f"is nested more than {_DEEPEST} deep")
    operands: list[ast.expr] = []
    what: float | str | Callable[..., float]
    unit = None
    if isinstance(node, ast.Constant):
        what, unit = _constant(node.value)
    elif isinstance(node, (ast.Name, ast.Attribute)):
        name = _dotted_name(node)
        what = CONSTANTS.get(name, name)
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        what, operands = _OPERATORS[type(node.op)], [node.left, node.right]
    elif isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
        what, operands = _OPERATORS[type(node.op)], [node.operand]
    elif isinstance(node, ast.Call):
        if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS or node.keywords:
            raise ExpressionError(f"calls an unknown function; known are {', '.join(FUNCTIONS)}")
        if (len(node.args) < 2) if node.func.id in ("min", "max") else (len(node.args) != 1):
            raise ExpressionError(f"gives {node.func.id}() the wrong number of arguments")
        what, operands = FUNCTIONS[node.func.id], node.args
    else:
        what = type(node).__name__.lower()
        raise ExpressionError(problem("study_not_in_formulas", what=what, functions=", ".join(FUNCTIONS)))
    part = Part(what, tuple(_part(operand, depth + 1) for operand in operands), unit)
    if not part.names and math.isnan(part.number({})):
        raise ExpressionError(f"holds {ast.unparse(node):.60}, which is no finite number")
    return part


def _constant(value: object) -> tuple[float, str | None]:
    """Value of a number or quantity, and SI unit of a quantity."""
    if isinstance(value, str):
        return _quantity(value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ExpressionError(f"holds {value!r}, which is no number")
    try:
        return float(value), None
    except OverflowError:
        return math.inf, None


@lru_cache(maxsize=1024)
def _quantity(text: str) -> tuple[float, str]:
    """Value and SI unit of a quantity."""
    for dimension in DIMENSIONS.values():
        with suppress(QuantityError):
            return parse_quantity(text, dimension.name), dimension.si_unit
    raise ExpressionError(f'holds "{text}", which is no quantity, such as "1 GPa", "45 deg" or "2 ml/min"')


def _dotted_name(node: ast.expr) -> str:
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        raise ExpressionError("has a point behind something that is no name")
    return ".".join([node.id, *reversed(parts)])
