"""The compiled controller: one call, many calls, and the explanation of a call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray

from fuzzy import rules
from fuzzy.compiler import compile_tables
from fuzzy.errors import InvalidInputError
from fuzzy.kernels import address, defuzzify, inference
from fuzzy.kernels.tables import Tables, new_workspace
from fuzzy.system import FuzzySystem, Rule
from fuzzy.validation import validate

_ROWS_PER_PART = 256
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
        fired: Whether any rule concluded on this output; if not, ``value`` comes from its no-fire policy.
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

    Calls from several threads are safe: a single call keeps the interpreter lock, and ``batch`` and ``explain`` have
    workspaces of their own. The only state is the last output of a single call, which the hold policy needs.

    Attributes:
        system: The document.
        tables: Its compiled form.
    """

    def __init__(self, system: FuzzySystem) -> None:
        self.system = validate(system)
        self.tables: Tables = compile_tables(self.system)
        self._own = self.directory()
        self._address = self._own.address
        self._is_two_to_one = len(system.inputs) == 2 and len(system.outputs) == 1
        self._rejects = any(variable.out_of_range == "reject" for variable in system.inputs)

    def __call__(self, *inputs: float) -> float | tuple[float, ...]:
        """Return the crisp output for crisp inputs, in the order of ``system.inputs``; a tuple for several outputs.

        Raises:
            InvalidInputError: When an input is not finite, lies outside a range that rejects it, or when there are
                too many or too few.
        """
        if self._is_two_to_one and len(inputs) == 2 and not self._rejects:
            value = inference.call_two(self._address, inputs[0], inputs[1])
            if value != value:  # NaN: a bad input, or an output whose policy is NaN
                self._own.workspace.output[:] = self.tables.no_fire_value
                self._checked(inputs)
            return value
        y = self._own.workspace.output
        inference.call(self._address, self._checked(inputs), y)
        return float(y[0]) if y.size == 1 else tuple(y.tolist())

    def reset(self) -> None:
        """Forget the last output, so that the hold policy begins anew."""
        self._own.workspace.output[:] = self.tables.no_fire_value

    def directory(self) -> address.Directory:
        """Return the compiled system with a new workspace; its address is what other kernels evaluate.

        One thread at a time may use it, and whoever does must keep it.
        """
        return address.directory(self.tables, new_workspace(self.tables))

    def batch(self, x: ArrayLike) -> NDArray[np.float64]:
        """Return the crisp outputs of many independent inferences.

        Args:
            x: (n, n_in) crisp inputs, one inference a row.

        Returns:
            (n, n_out) crisp outputs. A row does not know the row before it: the hold policy gives its start value.

        Raises:
            InvalidInputError: With the first row that holds an input that is not finite or that is refused.
        """
        rows = np.ascontiguousarray(x, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != len(self.system.inputs):
            raise InvalidInputError(f"inputs of shape {rows.shape}; valid: (n, {len(self.system.inputs)})")
        self._check_rows(rows)
        y = np.tile(self.tables.no_fire_value, (len(rows), 1))
        parts = max(1, min(len(rows) // _ROWS_PER_PART, 4 * numba.get_num_threads()))
        directories = [self.directory() for _ in range(parts)]
        inference.evaluate_batch(np.array([part.address for part in directories]), rows, y)
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
        y = own.workspace.output
        count = inference.call(own.address, x, y)
        work = own.workspace
        numbered = rules.all_rules(self.system)
        fired = [FiredRule(int(n), numbered[n], float(work.strength[n])) for n in work.fired[:count]]
        memberships = {
            variable.name: {
                term.name: float(work.membership[k])
                for term, k in zip(variable.terms, range(first, first + len(variable.terms)), strict=True)
            }
            for variable, first in zip(self.system.inputs, self.tables.input_start, strict=False)
        }
        return Trace(
            inputs=dict(zip((v.name for v in self.system.inputs), x.tolist(), strict=True)),
            clamped=tuple(
                v.name for v, value in zip(self.system.inputs, x, strict=True) if not v.low <= value <= v.high
            ),
            memberships=memberships,
            strength=work.strength,
            rules=tuple(sorted(fired, key=lambda rule: -rule.strength)),
            outputs={
                output.name: self._output_trace(n, own, count, float(y[n]))
                for n, output in enumerate(self.system.outputs)
            },
        )

    def _output_trace(self, number: int, own: address.Directory, count: int, value: float) -> OutputTrace:
        output = self.system.outputs[number]
        tables, work = self.tables, own.workspace
        breaks = tables.break_point[tables.break_start[number] : tables.break_start[number + 1]]
        u = np.union1d(np.linspace(output.low, output.high, _CURVE_POINTS), breaks)
        degree = np.empty(u.size)
        defuzzify.output_set(own.address, count, number, u, degree)
        first = tables.output_start[number]
        heights = {term.name: float(work.height[first + k]) for k, term in enumerate(output.terms)}
        return OutputTrace(value, any(height > 0 for height in heights.values()), heights, u, degree)

    def _checked(self, inputs: tuple[float, ...]) -> NDArray[np.float64]:
        """Return the inputs as an array, or refuse them."""
        names = [variable.name for variable in self.system.inputs]
        if len(inputs) != len(names):
            raise InvalidInputError(f"{len(inputs)} inputs; valid: {len(names)} ({', '.join(names)})")
        x = np.array(inputs, dtype=np.float64)
        self._check_rows(x[np.newaxis])
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


def compile_system(system: FuzzySystem) -> Controller:
    """Validate and compile a fuzzy system.

    Raises:
        InvalidSystemError: With the place of what is wrong and what is valid.
    """
    return Controller(system)
