"""Kernels as C functions, by the source of the very kernels that the controller runs.

Parameters that are the same all over an exported controller, such as the code of an implication, are bound: what
depends on them alone is decided here.
"""

from __future__ import annotations

import ast
import inspect
import itertools
import re
from collections.abc import Callable, Iterable
from typing import Any

from fuzzy.export.c_functions import constant
from fuzzy.export.kernel_source import Bound, Fixed, bound, is_kernel, meaning, parsed, plain

_INTEGERS = frozenset({"question", "code", "count", "which"})
"""Parameters that are integers; all others are numbers, or arrays of them."""

_ARRAYS = frozenset({"account", "values", "places", "lines"})

_OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "/",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.And: "&&",
    ast.Or: "||",
}
_LIBRARY = {"sqrt": "M(sqrt)", "abs": "M(fabs)", "min": "smaller", "max": "larger"}

_HELPERS = {
    "smaller": "\nstatic REAL smaller(REAL a, REAL b)\n{\n    return b < a ? b : a;\n}\n",
    "larger": "\nstatic REAL larger(REAL a, REAL b)\n{\n    return b > a ? b : a;\n}\n",
}
"""Functions that translated kernels call."""


def translated(wanted: Iterable[tuple[Callable[..., Any], Fixed]]) -> str:
    """Return C functions of kernels, each with some parameters fixed, and of what they call, before its callers."""
    definitions: dict[str, str] = {}

    def add(function: Callable[..., Any], fixed: Fixed) -> None:
        entry = bound(function, fixed)
        if entry.name in definitions:
            return
        writer = _Writer(entry, fixed)
        text = writer.definition()
        for called in writer.called:
            add(called.function, fixed)
        definitions[entry.name] = text

    for function, fixed in wanted:
        add(function, fixed)
    text = "".join(definitions.values())
    return "".join(helper for name, helper in _HELPERS.items() if f"{name}(" in text) + text


class _Writer:
    """One kernel as C; ``called`` are the kernels that it calls."""

    def __init__(self, entry: Bound, fixed: Fixed) -> None:
        self.called: list[Bound] = []
        self._entry = entry
        self._fixed = fixed
        self._values = dict(entry.values)
        self._tree = parsed(entry.function)
        self._namespace = plain(entry.function).__globals__
        self._parameters = [argument.arg for argument in self._tree.args.args]
        self._locals: dict[str, str] = {}
        self._returns = "void"

    def definition(self) -> str:
        body = self._block(self._tree.body, 1)
        parameters: list[str] = []
        for name in self._parameters:
            if name in _ARRAYS:
                parameters.append(f"REAL *{name}")
                if f"{name}_size" in body:
                    parameters.append(f"int {name}_size")
            elif name not in self._values:
                parameters.append(f"{'int' if name in _INTEGERS else 'REAL'} {name}")
        if self._returns == "pair":
            parameters.append("REAL *pair")
        variables = "".join(f"    {kind} {name} = 0;\n" for name, kind in self._locals.items())
        unused = [name for name in (*self._parameters, *self._locals) if name not in self._values]
        unused = [name for name in unused if not re.search(rf"\b{name}\b(?! = )", body)]
        variables += "".join(f"    (void){name};\n" for name in unused)
        kind = "void" if self._returns == "pair" else self._returns
        return f"\nstatic {kind} {self._entry.name}({', '.join(parameters)})\n{{\n{variables}{body}}}\n"

    def _block(self, body: list[ast.stmt], depth: int) -> str:
        text = ""
        for statement in body:
            text += self._statement(statement, depth)
            if _ends(statement, self._truth):
                break
        return text

    def _statement(self, node: ast.stmt, depth: int) -> str:
        blank = "    " * depth
        match node:
            case ast.Expr(value=ast.Constant()):
                return ""
            case ast.Expr(value=value):
                return f"{blank}{self._text(value)};\n"
            case ast.Assign(targets=[target], value=value):
                return f"{blank}{self._target(target, value)} = {self._text(value)};\n"
            case ast.AugAssign(target=target, op=operator, value=value):
                return f"{blank}{self._text(target)} {_OPERATORS[type(operator)]}= {self._text(value)};\n"
            case ast.If(test=test, body=body, orelse=otherwise):
                return self._if(test, body, otherwise, depth)
            case ast.While(test=test, body=body):
                return f"{blank}while ({self._text(test)}) {{\n{self._block(body, depth + 1)}{blank}}}\n"
            case ast.For(target=ast.Name(id=name), iter=ast.Call(args=ends), body=body):
                self._locals[name] = "int"
                first, last = (["0"] * (2 - len(ends)) + [self._text(end) for end in ends])[:2]
                head = f"for ({name} = {first}; {name} < {last}; {name}++)"
                return f"{blank}{head} {{\n{self._block(body, depth + 1)}{blank}}}\n"
            case ast.Break():
                return f"{blank}break;\n"
            case ast.Return(value=value):
                return self._return(value, depth)
        raise AssertionError(ast.dump(node))

    def _target(self, target: ast.expr, value: ast.expr) -> str:
        if isinstance(target, ast.Name) and target.id not in self._parameters:
            kind = self._kind(value)
            if self._locals.get(target.id, kind) != kind:
                kind = "REAL"
            self._locals[target.id] = kind
        return self._text(target)

    def _if(self, test: ast.expr, body: list[ast.stmt], otherwise: list[ast.stmt], depth: int) -> str:
        known = self._truth(test)
        if known is not None:
            return self._block(body if known else otherwise, depth)
        blank = "    " * depth
        text = f"{blank}if ({self._text(test)}) {{\n{self._block(body, depth + 1)}{blank}}}"
        return f"{text} else {{\n{self._block(otherwise, depth + 1)}{blank}}}\n" if otherwise else f"{text}\n"

    def _return(self, value: ast.expr | None, depth: int) -> str:
        blank = "    " * depth
        match value:
            case None:
                return f"{blank}return;\n"
            case ast.IfExp(test=test, body=ast.Tuple() as one, orelse=ast.Tuple() as other):
                inside = f"{self._return(one, depth + 1)}{blank}}} else {{\n{self._return(other, depth + 1)}"
                return f"{blank}if ({self._text(test)}) {{\n{inside}{blank}}}\n"
            case ast.Tuple(elts=parts):
                self._returns = "pair"
                stored = "".join(f"{blank}pair[{i}] = {self._text(part)};\n" for i, part in enumerate(parts))
                return f"{stored}{blank}return;\n"
        self._returns = self._kind(value)
        return f"{blank}return {self._text(value)};\n"

    def _truth(self, test: ast.expr) -> bool | None:
        """Return whether a condition on bound parameters and constants alone holds; None for any other."""
        match test:
            case ast.Compare(left=left, ops=[operator], comparators=[right]):
                one, other = self._constant(left), self._constant(right)
                if isinstance(right, ast.Tuple):
                    other = tuple(self._constant(part) for part in right.elts)
                if one is None or other is None:
                    return None
                match operator:
                    case ast.Eq():
                        return one == other
                    case ast.In():
                        return one in other
                    case ast.LtE():
                        return one <= other
        return None

    def _constant(self, node: ast.expr) -> Any:
        if isinstance(node, ast.Name) and node.id in self._values:
            return self._values[node.id]
        value = node.value if isinstance(node, ast.Constant) else meaning(node, self._namespace)
        return value if isinstance(value, int) else None

    def _kind(self, node: ast.expr) -> str:
        match node:
            case ast.Constant(value=value):
                return "int" if isinstance(value, int) else "REAL"
            case ast.Name(id=name) if name in self._locals:
                return self._locals[name]
            case ast.Name(id=name) if name in self._parameters:
                return "int" if name in _INTEGERS else "REAL"
            case ast.BinOp(left=left, right=right):
                return "int" if self._kind(left) == self._kind(right) == "int" else "REAL"
            case ast.Attribute(attr="size"):
                return "int"
        return "int" if isinstance(meaning(node, self._namespace), int) else "REAL"

    def _text(self, node: ast.expr) -> str:  # noqa: C901
        match node:
            case ast.Constant(value=value):
                assert isinstance(value, int | float)
                return str(value) if isinstance(value, int) else constant(value)
            case ast.Name(id=name) if name in self._values:
                return str(self._values[name])
            case ast.Name(id=name) if name in self._parameters or name in self._locals:
                return name
            case ast.Name() | ast.Attribute(value=ast.Name()) if isinstance(
                value := meaning(node, self._namespace), int | float
            ):
                return "(REAL)NAN" if value != value else str(value) if isinstance(value, int) else constant(value)
            case ast.Attribute(value=ast.Name(id=name), attr="size"):
                return f"{name}_size"
            case ast.Subscript(value=array, slice=place):
                return f"{self._text(array)}[{self._text(place)}]"
            case ast.BinOp(left=left, op=operator, right=right):
                return f"({self._text(left)} {_OPERATORS[type(operator)]} {self._text(right)})"
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"(-{self._text(operand)})"
            case ast.BoolOp(op=operator, values=parts):
                return f"({f' {_OPERATORS[type(operator)]} '.join(map(self._text, parts))})"
            case ast.Compare(left=left, ops=operators, comparators=others):
                operands = [left, *others]
                pairs = zip(itertools.pairwise(operands), operators, strict=True)
                parts = [f"{self._text(a)} {_OPERATORS[type(op)]} {self._text(b)}" for (a, b), op in pairs]
                return parts[0] if len(parts) == 1 else f"({' && '.join(parts)})"
            case ast.IfExp(test=test, body=body, orelse=otherwise):
                known = self._truth(test)
                if known is not None:
                    return self._text(body if known else otherwise)
                return f"({self._text(test)} ? {self._text(body)} : {self._text(otherwise)})"
            case ast.Call(func=function, args=arguments):
                return self._call(function, arguments)
        raise AssertionError(ast.dump(node))

    def _call(self, function: ast.expr, arguments: list[ast.expr]) -> str:
        word = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
        value = meaning(function, self._namespace)
        if not is_kernel(value):
            return f"{_LIBRARY[word]}({', '.join(map(self._text, arguments))})"
        called = bound(value, self._fixed)
        self.called.append(called)
        names = list(inspect.signature(plain(value)).parameters)
        fixed = dict(called.values)
        given = [self._text(part) for name, part in zip(names, arguments, strict=True) if name not in fixed]
        return f"{called.name}({', '.join(given)})"


def _ends(node: ast.stmt, truth: Callable[[ast.expr], bool | None]) -> bool:
    """Return whether nothing behind a statement is ever reached."""
    match node:
        case ast.Return() | ast.Break():
            return True
        case ast.If(test=test, body=body, orelse=otherwise) if truth(test) is not None:
            taken = body if truth(test) else otherwise
            return any(_ends(statement, truth) for statement in taken)
    return False
