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
from typing import Any

from fem_seal.errors import QuantityError
from fem_seal.units import DIMENSIONS, parse_quantity


def _unless_missing(choose: Callable[..., float]) -> Callable[..., float]:
    """Smallest or largest of numbers that are all there: Python's own passes over a NaN unless it comes first."""
    return lambda *numbers: math.nan if any(map(math.isnan, numbers)) else choose(numbers)


FUNCTIONS: dict[str, Callable[..., float]] = {
    "abs": abs,
    "min": _unless_missing(min),
    "max": _unless_missing(max),
    "sqrt": math.sqrt,
    "exp": math.exp,
    "log": math.log,
    "log10": math.log10,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
}
CONSTANTS = {"pi": math.pi}
_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: lambda base, power: math.pow(base, power),
}
_UNARY: dict[type[ast.unaryop], Callable[[float], float]] = {ast.UAdd: operator.pos, ast.USub: operator.neg}
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
class _Formula:
    text: str

    @cached_property
    def _body(self) -> ast.expr:
        return _parsed(self.text)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Columns and parameters that it needs."""
        return tuple(dict.fromkeys(_names(self._body)))


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
        if isinstance(self._body, ast.Compare):
            raise ExpressionError("is a comparison; a formula gives a number")

    def __call__(self, values: Mapping[str, float]) -> float:
        """Value; NaN where it is not defined (division by zero, logarithm of a negative number) or not finite."""
        return _number(self._body, values)


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
        body = self._body
        if not isinstance(body, ast.Compare) or len(body.ops) != 1 or type(body.ops[0]) not in _COMPARE:
            raise ExpressionError('is no constraint; write one comparison such as max_von_mises_Pa < "1 GPa"')

    @property
    def sides(self) -> tuple[ast.expr, ast.expr]:
        """What is compared."""
        return self._compare.left, self._compare.comparators[0]

    def met(self, values: Mapping[str, float]) -> bool:
        """Whether it holds; it does not where a value is missing."""
        left, right = self._sides(values)
        return _COMPARE[type(self._compare.ops[0])](left, right)

    def violation(self, values: Mapping[str, float]) -> float:
        """How far it is from being met, relative to the larger side; zero or below where it is met."""
        left, right = self._sides(values)
        excess = left - right if isinstance(self._compare.ops[0], (ast.Lt, ast.LtE)) else right - left
        scale = max(abs(left), abs(right))
        if math.isnan(excess):
            return math.inf
        return excess / scale if scale > 0 else excess

    @property
    def _compare(self) -> ast.Compare:
        assert isinstance(self._body, ast.Compare)
        return self._body

    def _sides(self, values: Mapping[str, float]) -> tuple[float, float]:
        left, right = self.sides
        return _number(left, values), _number(right, values)


def unknown_name(name: str, known: list[str]) -> str:
    """What to say about a name that no column and no parameter has."""
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    hint = f"do you mean {near[0]}? " if near else ""
    return f"uses {name}, which is neither a column nor a parameter; {hint}known are {', '.join(known)}"


def _parsed(text: str) -> ast.expr:
    if len(text) > _LONGEST:
        raise ExpressionError(f"is longer than {_LONGEST} characters")
    try:
        body = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError("is no formula; write for example leak_rate_m3_per_s * 6e7") from None
    _check(body, 0)
    for node in ast.walk(body):
        calculable = isinstance(node, (ast.Constant, ast.BinOp, ast.UnaryOp, ast.Call))
        if isinstance(node, ast.expr) and calculable and not _names(node) and math.isnan(_number(node, {})):
            raise ExpressionError(f"holds {ast.unparse(node):.60}, which is no finite number")
    return body


def _check(node: ast.expr, depth: int) -> None:
    if depth > _DEEPEST:
        raise ExpressionError(f"is nested more than {_DEEPEST} deep")
    if isinstance(node, ast.Constant):
        _constant(node.value)
    elif isinstance(node, (ast.Name, ast.Attribute)):
        _dotted(node)
    elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        _check(node.left, depth + 1)
        _check(node.right, depth + 1)
    elif isinstance(node, ast.UnaryOp) and type(node.op) in _UNARY:
        _check(node.operand, depth + 1)
    elif isinstance(node, ast.Call):
        if not isinstance(node.func, ast.Name) or node.func.id not in FUNCTIONS or node.keywords:
            raise ExpressionError(f"calls an unknown function; known are {', '.join(FUNCTIONS)}")
        if (len(node.args) < 2) if node.func.id in ("min", "max") else (len(node.args) != 1):
            raise ExpressionError(f"gives {node.func.id}() the wrong number of arguments")
        for argument in node.args:
            _check(argument, depth + 1)
    elif isinstance(node, ast.Compare) and depth == 0:
        for side in (node.left, *node.comparators):
            _check(side, depth + 1)
    else:
        raise ExpressionError(
            f"holds {type(node).__name__.lower()}, which is not allowed; allowed are + - * / **, names, numbers, "
            f"quantities in quotes and {', '.join(FUNCTIONS)}"
        )


def _constant(value: Any) -> float:
    if isinstance(value, str):
        return _quantity(value)[0]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ExpressionError(f"holds {value!r}, which is no number")
    try:
        return float(value)
    except OverflowError:
        return math.inf


@lru_cache(maxsize=1024)
def _quantity(text: str) -> tuple[float, str]:
    """Value and SI unit of a quantity."""
    for dimension in DIMENSIONS.values():
        with suppress(QuantityError):
            return parse_quantity(text, dimension.name), dimension.si_unit
    raise ExpressionError(f'holds "{text}", which is no quantity, such as "1 GPa", "45 deg" or "2 ml/min"')


def unit_of(node: ast.expr, units: Mapping[str, str]) -> str | None:
    """SI unit of a single name or quantity, empty for a name that has none; None of anything else.

    Parameters
    ----------
    node : ast.expr
        Side of a `Constraint`.
    units : mapping
        SI units of the names.
    """
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return _quantity(node.value)[1]
    if isinstance(node, (ast.Name, ast.Attribute)):
        return units.get(_dotted(node))
    return None


def _dotted(node: ast.expr) -> str:
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    if not isinstance(node, ast.Name):
        raise ExpressionError("has a point behind something that is no name")
    return ".".join([node.id, *reversed(parts)])


def _names(node: ast.expr) -> list[str]:
    if isinstance(node, (ast.Name, ast.Attribute)):
        name = _dotted(node)
        return [] if name in CONSTANTS else [name]
    if isinstance(node, ast.BinOp):
        return _names(node.left) + _names(node.right)
    if isinstance(node, ast.UnaryOp):
        return _names(node.operand)
    if isinstance(node, ast.Call):
        return [name for argument in node.args for name in _names(argument)]
    if isinstance(node, ast.Compare):
        return [name for side in (node.left, *node.comparators) for name in _names(side)]
    return []


def _number(node: ast.expr, values: Mapping[str, float]) -> float:
    try:
        value = _evaluated(node, values)
    except (ZeroDivisionError, ValueError, OverflowError):
        return math.nan
    return value if math.isfinite(value) else math.nan


def _evaluated(node: ast.expr, values: Mapping[str, float]) -> float:
    if isinstance(node, ast.Constant):
        return _constant(node.value)
    if isinstance(node, (ast.Name, ast.Attribute)):
        name = _dotted(node)
        return CONSTANTS[name] if name in CONSTANTS else float(values[name])
    if isinstance(node, ast.BinOp):
        return _BINARY[type(node.op)](_evaluated(node.left, values), _evaluated(node.right, values))
    if isinstance(node, ast.UnaryOp):
        return _UNARY[type(node.op)](_evaluated(node.operand, values))
    assert isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    return float(FUNCTIONS[node.func.id](*(_evaluated(argument, values) for argument in node.args)))
