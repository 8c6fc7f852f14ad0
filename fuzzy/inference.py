"""The compiled controller: one call, many calls, and the explanation of a call."""

from __future__ import annotations

import functools
import math
import os
import threading
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy import rules
from fuzzy.compiler import compile_tables
from fuzzy.errors import InvalidInputError
from fuzzy.kernels import address, defuzzify, inference, lanes
from fuzzy.kernels.jit import Kernel
from fuzzy.kernels.tables import Tables
from fuzzy.system import FuzzySystem, Rule
from fuzzy.validation import validate

_ROWS_PER_THREAD = 4096
"""Fewest rows of a batch that are worth a thread."""

_CURVE_POINTS = 201
"""Samples of an output set in a trace, besides its break points."""


class FiredRule(NamedTuple):
    """A rule that fires.

    Attributes:
        number: Number of the rule, from 0, as in ``fuzzy.rules.all_rules``.
        rule: The rule.
        strength: Firing strength times weight, in (0, 1].
    """

    number: int
    rule: Rule
    strength: float


class OutputTrace(NamedTuple):
    """How one output came about.

    Attributes:
        value: Crisp output, in the variable's unit; NaN where it is undefined.
        fired: Whether the rules define this output; if not, ``value`` comes from its no-fire policy.
        heights: Aggregated strength of each term.
        u: (m,) places in the universe, ascending.
        degree: (m,) degree of the aggregated set at ``u``.
    """

    value: float
    fired: bool
    heights: Mapping[str, float]
    u: NDArray[np.float64]
    degree: NDArray[np.float64]


class Trace(NamedTuple):
    """One inference step by step, computed by the kernels that control.

    Attributes:
        inputs: Crisp value of each input, as given.
        clamped: Names of the inputs that lay outside their range.
        memberships: Degree of every term of every input.
        strength: (n_rules,) firing strengths of all rules.
        rules: The rules that fire, the strongest first.
        outputs: How each output came about.
    """

    inputs: Mapping[str, float]
    clamped: tuple[str, ...]
    memberships: Mapping[str, Mapping[str, float]]
    strength: NDArray[np.float64]
    rules: tuple[FiredRule, ...]
    outputs: Mapping[str, OutputTrace]


class Controller:
    """A compiled fuzzy system.

    Calls from several threads are safe: a call holds a lock, and ``batch`` and ``explain`` have workspaces of their
    own. The only state is the last output of a call, which the hold policy needs. Kernels are compiled, or loaded
    from their cache, on the first call.

    Attributes:
        system: The document.
        tables: Its compiled form.
    """

    def __init__(self, system: FuzzySystem) -> None:
        self.system = validate(system)
        self.tables: Tables = compile_tables(self.system)
        self._rejects = any(variable.out_of_range == "reject" for variable in self.system.inputs)
        self._lock = threading.Lock()
        self._address = 0  # of this controller's own workspace, once the first call has prepared it
        self._entry: Kernel = _unprepared

    def __call__(self, *inputs: float) -> float | tuple[float, ...]:
        """Return the crisp output for crisp inputs, in the order of ``system.inputs``; a tuple for several outputs.

        Raises:
            InvalidInputError: When an input is not finite, lies outside a range that rejects it, or when there are
                too many or too few.
        """
        try:
            value = self._entry(self._address, inputs)
        except (TypeError, ValueError):
            value = math.nan
        if value == value:  # not NaN
            return value
        return self._call(inputs)

    def _call(self, inputs: tuple[float, ...]) -> float | tuple[float, ...]:
        """Return the outputs where they are several or may be NaN, where inputs may be refused, and the first time."""
        x = self._checked(inputs)
        entry = inference.compiled_call(len(x))
        with self._lock:
            y = self._own.workspace.output
            entry(self._own.address, x)
            result = float(y[0]) if y.size == 1 else tuple(y.tolist())
        if y.size == 1 and not self._rejects:
            self._address = self._own.address
            self._entry = entry
        return result

    @functools.cached_property
    def _own(self) -> address.Directory:
        return self.directory()

    def reset(self) -> None:
        """Forget the last output, so that the hold policy begins anew."""
        self._own.workspace.output[:] = self.tables.outputs.no_fire_value

    def directory(self) -> address.Directory:
        """Return the compiled system with a new workspace; its address is what other kernels evaluate.

        One thread at a time may use it, and whoever does must keep it.
        """
        kernels = [defuzzify.DEFUZZIFIERS[int(method)].address for method in self.tables.outputs.method]
        return address.directory(self.tables, kernels)

    def batch(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the crisp outputs of many independent inferences, computed on all processors.

        Args:
            x: (n, n_in) crisp inputs, one inference a row.

        Returns:
            (n, n_out) crisp outputs. A row does not know the row before it: the hold policy gives its start value.

        Raises:
            InvalidInputError: With the first row that holds an input that is not finite or that is refused.
        """
        try:
            rows = np.ascontiguousarray(x, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InvalidInputError(f"inputs that are no table of numbers: {error}") from error
        if rows.ndim != 2 or rows.shape[1] != len(self.system.inputs):
            raise InvalidInputError(f"inputs of shape {rows.shape}; valid: (n, {len(self.system.inputs)})")
        y = np.empty((len(rows), len(self.system.outputs)))
        n_parts = max(1, min(len(rows) // _ROWS_PER_THREAD, _processors()))
        bounds = [len(rows) * part // n_parts for part in range(n_parts + 1)]
        shape = lanes.block_shape(int(self.tables.inputs.term_start[-1]), self.tables.outputs.shape.size)
        memory = [(self.directory(), np.empty(shape)) for _ in range(n_parts)]
        refused = [-1] * n_parts

        def evaluate(part: int) -> None:
            start, end = bounds[part : part + 2]
            own, block = memory[part]
            y[start:end] = self.tables.outputs.no_fire_value
            refused[part] = lanes.evaluate_rows(own.address, rows, y, start, end, block)

        threads = [threading.Thread(target=evaluate, args=(part,)) for part in range(1, n_parts)]
        for thread in threads:
            thread.start()
        evaluate(0)
        for thread in threads:
            thread.join()
        if max(refused) >= 0:
            self._check_rows(rows)
        return y

    def explain(self, *inputs: float) -> Trace:
        """Return what happened between crisp inputs and crisp outputs.

        Args:
            *inputs: Crisp inputs, in the order of ``system.inputs``.

        Raises:
            InvalidInputError: As a call does.
        """
        x = self._checked(inputs)
        own = self.directory()
        work = own.workspace
        y = work.output
        inference.compiled_call(len(x))(own.address, x)
        numbered = rules.all_rules(self.system)
        fired = [FiredRule(int(n), numbered[n], float(work.strength[n])) for n in work.fired[: work.fired_count[0]]]
        memberships = {
            variable.name: {
                term.name: float(work.membership[k])
                for term, k in zip(variable.terms, range(first, first + len(variable.terms)), strict=True)
            }
            for variable, first in zip(self.system.inputs, self.tables.inputs.term_start, strict=False)
        }
        return Trace(
            inputs=dict(zip((v.name for v in self.system.inputs), x, strict=True)),
            clamped=tuple(
                v.name for v, value in zip(self.system.inputs, x, strict=True) if not v.low <= value <= v.high
            ),
            memberships=memberships,
            strength=work.strength,
            rules=tuple(sorted(fired, key=lambda rule: -rule.strength)),
            outputs={
                output.name: self._output_trace(n, own, float(y[n])) for n, output in enumerate(self.system.outputs)
            },
        )

    def _output_trace(self, number: int, own: address.Directory, value: float) -> OutputTrace:
        output = self.system.outputs[number]
        tables, work = self.tables.outputs, own.workspace
        knots = tables.knot[tables.knot_start[number] : tables.knot_start[number + 1]]
        u = np.union1d(np.linspace(output.low, output.high, _CURVE_POINTS), knots)
        degree = np.empty(u.size)
        defuzzify.output_set(own.address, number, u, degree)
        first = tables.term_start[number]
        heights = {term.name: float(work.height[first + k]) for k, term in enumerate(output.terms)}
        return OutputTrace(value, not work.undefined[number], heights, u, degree)

    def _checked(self, inputs: tuple[float, ...]) -> tuple[float, ...]:
        """Return the inputs as floats, or refuse them."""
        names = [variable.name for variable in self.system.inputs]
        if len(inputs) != len(names):
            raise InvalidInputError(f"{len(inputs)} inputs; valid: {len(names)} ({', '.join(names)})")
        try:
            x = tuple([float(value) for value in inputs])
        except (TypeError, ValueError, OverflowError) as error:
            raise InvalidInputError(f"found {inputs}; valid: {len(names)} finite numbers") from error
        if self._rejects or not all(map(math.isfinite, x)):
            self._check_rows(np.array([x]))
        return x

    def _check_rows(self, rows: NDArray[np.float64]) -> None:
        if not np.isfinite(rows).all():
            row, column = np.argwhere(~np.isfinite(rows))[0]
            raise InvalidInputError(
                f"{rows[row, column]} in row {row} is not a finite number", self.system.inputs[column].name
            )
        if self._rejects:
            for column, variable in enumerate(self.system.inputs):
                outside = (rows[:, column] < variable.low) | (rows[:, column] > variable.high)
                if variable.out_of_range == "reject" and outside.any():
                    row = int(np.argmax(outside))
                    raise InvalidInputError(
                        f"{rows[row, column]:g} in row {row} is refused; valid: {variable.low:g} to {variable.high:g}",
                        variable.name,
                    )


def _unprepared(address: int, inputs: tuple[float, ...]) -> float:  # noqa: ARG001
    """Stand for the kernel until it is compiled, or loaded from the cache."""
    return math.nan


def _processors() -> int:
    """Return how many processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def compile_system(system: FuzzySystem) -> Controller:
    """Validate and compile a fuzzy system.

    Raises:
        InvalidSystemError: With the place of what is wrong and what is valid.
    """
    return Controller(system)
