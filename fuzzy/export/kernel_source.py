"""The kernels' own source, so that an exported controller computes by the very same formulas.

A kernel is plain Python over numbers and arrays of numbers; :mod:`fuzzy.export.c_kernels` makes C of it.
"""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, NamedTuple, cast

Fixed = Mapping[str, Mapping[str, int]]
"""Values of parameters by name, by the name of the kernel that has them; under an empty name for all kernels."""


class Bound(NamedTuple):
    """A kernel with parameters that are fixed.

    Attributes:
        function: The kernel.
        values: The fixed parameters.
    """

    function: Callable[..., Any]
    values: tuple[tuple[str, int], ...]

    @property
    def name(self) -> str:
        """Name in the other language: module, function, and the values of fixed parameters."""
        original = plain(self.function)
        words = [
            original.__module__.rpartition(".")[2],
            original.__name__.strip("_"),
            *(str(value) for _, value in self.values),
        ]
        return "_".join(words)


def bound(function: Callable[..., Any], fixed: Fixed) -> Bound:
    """Return a kernel with those of its parameters fixed that ``fixed`` has."""
    original = plain(function)
    known = {**fixed.get("", {}), **fixed.get(original.__name__.strip("_"), {})}
    names = inspect.signature(original).parameters
    return Bound(function, tuple((name, known[name]) for name in names if name in known))


def python_source(kernels: list[Callable[..., Any]]) -> str:
    """Return kernels, and whatever they call, as plain Python functions that are called ``module_name``."""
    definitions: dict[str, str] = {}

    def add(entry: Bound) -> None:
        if entry.name in definitions:
            return
        definitions[entry.name] = ""
        tree = parsed(entry.function)
        tree.decorator_list = []
        tree.name = entry.name
        called: list[Bound] = []
        namespace = plain(entry.function).__globals__

        class Names(ast.NodeTransformer):
            def visit_Name(self, node: ast.Name) -> ast.AST:
                return self._resolved(node)

            def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
                return self._resolved(node)

            def _resolved(self, node: ast.expr) -> ast.AST:
                value = meaning(node, namespace)
                if isinstance(value, int) or (isinstance(value, float) and math.isfinite(value)):
                    return ast.Constant(value)
                if is_kernel(value):
                    called.append(Bound(cast("Callable[..., Any]", value), ()))
                    return ast.Name(called[-1].name)
                return node

        text = ast.unparse(ast.fix_missing_locations(Names().visit(tree)))
        for other in called:
            add(other)
        definitions[entry.name] = text

    for function in kernels:
        add(Bound(function, ()))
    return "\n\n\n".join(definitions.values())


def plain(function: Callable[..., Any]) -> Any:
    """Return the Python function that a kernel is compiled from."""
    return getattr(function, "py_func", function)


def parsed(function: Callable[..., Any]) -> ast.FunctionDef:
    """Return the definition of a kernel."""
    tree = ast.parse(inspect.getsource(plain(function))).body[0]
    assert isinstance(tree, ast.FunctionDef)
    return tree


def is_kernel(value: object) -> bool:
    """Return whether a value is a kernel."""
    return callable(value) and getattr(plain(value), "__module__", "").startswith("fuzzy.kernels")


def meaning(node: ast.expr, namespace: Mapping[str, Any]) -> Any:
    """Return what a global name means; None for any other expression."""
    match node:
        case ast.Name(id=name):
            return namespace.get(name)
        case ast.Attribute(value=ast.Name(id=module), attr=name) if isinstance(namespace.get(module), ModuleType):
            return getattr(namespace[module], name)
    return None
