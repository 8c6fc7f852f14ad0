"""Tables and workspace by address: one integer instead of fifty arrays.

Numba examines every array among a call's arguments, which for a whole ``Tables`` costs 4 µs, ten times the inference.
So the arrays stay where they are, a directory lists their addresses and shapes, and kernels receive the address of
the directory. Whoever holds the address must keep the ``Directory`` alive; ``fuzzy.inference.Controller`` does.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.core.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array
from numpy.typing import NDArray

from fuzzy.kernels.jit import JIT, PROTOTYPE, inlined_kernel
from fuzzy.kernels.tables import (
    InputTables,
    Integers,
    OutputTables,
    RuleTables,
    Tables,
    Workspace,
    new_workspace,
)

_INPUTS = 1
_RULES = _INPUTS + len(InputTables._fields)
_OUTPUTS = _RULES + len(RuleTables._fields)
_WORKSPACE = _OUTPUTS + len(OutputTables._fields)
_END = _WORKSPACE + len(Workspace._fields)


_TYPES = (np.dtype(np.int64), np.dtype(np.float64))

_PLAIN_ARRAYS: dict[int, tuple[NDArray[Any], ...]] = {}
"""The arrays of all directories by address, for kernels that run as plain Python. They stay: an address does not tell
whether it is still in use."""


class Directory(NamedTuple):
    """Addresses and shapes of all arrays of a compiled system and of a workspace, and the arrays themselves."""

    entries: Integers  # (n_arrays, 3) address, rows, columns: of ``defuzzifiers``, the tables, the workspace
    defuzzifiers: Integers  # (n_out,) addresses of the kernels that defuzzify
    tables: Tables
    workspace: Workspace

    @property
    def address(self) -> int:
        """Address to hand to kernels."""
        return self.entries.ctypes.data


def directory(tables: Tables, defuzzifiers: Sequence[int]) -> Directory:
    """List all arrays that an inference needs, a new workspace among them.

    Args:
        tables: A compiled system.
        defuzzifiers: Address of the kernel that defuzzifies, for each output.
    """
    addresses = np.array(defuzzifiers, dtype=np.int64)
    workspace, listed_workspace = new_workspace(tables)
    listed = Directory(
        np.concatenate([entries([addresses]), tables.entries, listed_workspace]), addresses, tables, workspace
    )
    if not JIT:
        _PLAIN_ARRAYS[listed.address] = (addresses, *tables.inputs, *tables.rules, *tables.outputs, *workspace)
    return listed


def entries(arrays: Sequence[NDArray[Any]]) -> Integers:
    """Return (n_arrays, 3) address, rows and columns of arrays, which must be contiguous."""
    listed = []
    for array in arrays:
        if not array.flags.c_contiguous or array.dtype not in _TYPES:
            raise ValueError(f"found {array.dtype} of shape {array.shape}; valid: contiguous int64 or float64")
        listed.append((array.ctypes.data, *array.shape, 1)[:3])
    return np.array(listed, dtype=np.int64)


def _array_at(dtype: Any, dimensions: int) -> Any:
    """Return a function (address of a directory, entry) -> array, callable inside kernels."""
    if not JIT:
        return lambda address, entry: _PLAIN_ARRAYS[address][entry]
    kind = types.Array(types.int64 if dtype is np.int64 else types.float64, dimensions, "C")

    @intrinsic
    def array_at(typingctx: Any, address: Any, entry: Any) -> Any:  # noqa: ARG001
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
            word = ir.IntType(64)
            directory = builder.inttoptr(arguments[0], word.as_pointer())
            first = builder.mul(arguments[1], word(3))
            where, *shape = (builder.load(builder.gep(directory, [builder.add(first, word(i))])) for i in range(3))
            array = make_array(kind)(context, builder)
            strides = [builder.mul(word(8), shape[1]), word(8)] if dimensions == 2 else [word(8)]
            populate_array(
                array,
                data=builder.inttoptr(where, array.data.type),
                shape=shape[:dimensions],
                strides=strides,
                itemsize=word(8),
                meminfo=None,
            )
            return array._getvalue()

        return kind(types.int64, types.int64), generate

    return array_at


_integers = _array_at(np.int64, 1)
_integers_2d = _array_at(np.int64, 2)
_numbers = _array_at(np.float64, 1)
_numbers_2d = _array_at(np.float64, 2)


def _at() -> Any:
    """Return a function that marks an index as not negative, callable inside kernels."""
    if not JIT:
        return lambda index: index

    @intrinsic
    def at(typingctx: Any, index: Any) -> Any:  # noqa: ARG001
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
            return arguments[0]

        return types.uint64(types.int64), generate

    return at


at = _at()
"""``array[at(n)]`` is ``array[n]`` for n >= 0: without it numba adds the array's length to a negative index, and must
keep every length at hand for that, which costs a quarter of an inference."""


def _call_at() -> Any:
    """Return a function that calls an ``AddressedKernel``, callable inside kernels."""
    if not JIT:
        return lambda kernel, address, number: PROTOTYPE(int(kernel))(address, number)

    @intrinsic
    def call_at(typingctx: Any, kernel: Any, address: Any, number: Any) -> Any:  # noqa: ARG001
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
            kind = ir.FunctionType(ir.DoubleType(), [ir.IntType(64), ir.IntType(64)])
            return builder.call(builder.inttoptr(arguments[0], kind.as_pointer()), arguments[1:])

        return types.float64(types.int64, types.int64, types.int64), generate

    return call_at


call_at = _call_at()


@inlined_kernel
def defuzzifier_at(address, output):
    """Return the address of an output's defuzzifier."""
    return _integers(address, 0)[output]


@inlined_kernel
def inputs_at(address):
    """Return the inputs' tables; callable inside kernels, and what is not used of them costs nothing."""
    return InputTables(
        range=_numbers_2d(address, _INPUTS),
        term_start=_integers(address, _INPUTS + 1),
        knot_start=_integers(address, _INPUTS + 2),
        knot=_numbers(address, _INPUTS + 3),
        cell_start=_integers(address, _INPUTS + 4),
        piece_start=_integers(address, _INPUTS + 5),
        piece_term=_integers(address, _INPUTS + 6),
        piece_shape=_integers(address, _INPUTS + 7),
        piece=_numbers_2d(address, _INPUTS + 8),
        rejects=_integers(address, _INPUTS + 9),
    )


@inlined_kernel
def rules_at(address):
    """Return the rules' tables; callable inside kernels."""
    return RuleTables(
        norms=_integers(address, _RULES),
        grid=_integers_2d(address, _RULES + 1),
        grid_input=_integers(address, _RULES + 2),
        program=_integers(address, _RULES + 3),
        program_start=_integers(address, _RULES + 4),
        weight=_numbers(address, _RULES + 5),
        consequent_start=_integers(address, _RULES + 6),
        consequent_term=_integers(address, _RULES + 7),
        consequent_output=_integers(address, _RULES + 8),
        member_start=_integers(address, _RULES + 9),
    )


@inlined_kernel
def outputs_at(address):
    """Return the outputs' tables; callable inside kernels."""
    return OutputTables(
        range=_numbers_2d(address, _OUTPUTS),
        term_start=_integers(address, _OUTPUTS + 1),
        shape=_integers(address, _OUTPUTS + 2),
        parameter=_numbers_2d(address, _OUTPUTS + 3),
        value=_numbers(address, _OUTPUTS + 4),
        peak=_numbers(address, _OUTPUTS + 5),
        implication=_integers(address, _OUTPUTS + 6),
        aggregation=_integers(address, _OUTPUTS + 7),
        grouping=_integers(address, _OUTPUTS + 8),
        maximum=_integers(address, _OUTPUTS + 9),
        sample_start=_integers(address, _OUTPUTS + 10),
        sample=_numbers_2d(address, _OUTPUTS + 11),
        method=_integers(address, _OUTPUTS + 12),
        no_fire=_integers(address, _OUTPUTS + 13),
        no_fire_value=_numbers(address, _OUTPUTS + 14),
        neighbour=_integers(address, _OUTPUTS + 15),
        cut_start=_integers(address, _OUTPUTS + 16),
        cut=_numbers_2d(address, _OUTPUTS + 17),
        knot_start=_integers(address, _OUTPUTS + 18),
        knot=_numbers(address, _OUTPUTS + 19),
        side_start=_integers(address, _OUTPUTS + 20),
        side_term=_integers(address, _OUTPUTS + 21),
        side=_numbers_2d(address, _OUTPUTS + 22),
    )


@inlined_kernel
def workspace_at(address):
    """Return the workspace; callable inside kernels."""
    return Workspace(
        input=_numbers(address, _WORKSPACE),
        clamped=_numbers(address, _WORKSPACE + 1),
        output=_numbers(address, _WORKSPACE + 2),
        membership=_numbers(address, _WORKSPACE + 3),
        active=_integers(address, _WORKSPACE + 4),
        active_count=_integers(address, _WORKSPACE + 5),
        strength=_numbers(address, _WORKSPACE + 6),
        fired=_integers(address, _WORKSPACE + 7),
        fired_count=_integers(address, _WORKSPACE + 8),
        height=_numbers(address, _WORKSPACE + 9),
        member=_integers(address, _WORKSPACE + 10),
        level=_numbers(address, _WORKSPACE + 11),
        member_count=_integers(address, _WORKSPACE + 12),
        gain=_numbers(address, _WORKSPACE + 13),
        undefined=_integers(address, _WORKSPACE + 14),
        stack=_numbers(address, _WORKSPACE + 15),
        scratch=_numbers(address, _WORKSPACE + 16),
    )
