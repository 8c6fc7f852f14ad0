"""Tables and workspace by address: one integer instead of forty arrays.

Numba examines every array among a call's arguments, which for a whole ``Tables`` costs 4 µs, ten times the inference.
So the arrays stay where they are, a directory lists their addresses and shapes, and kernels receive the address of
the directory. Whoever holds the address must keep the ``Directory`` alive; ``fuzzy.inference.Controller`` does.
"""

import ctypes
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba.core import config, types
from numba.core.extending import intrinsic
from numba.np.numpy_support import carray
from numpy.typing import NDArray

from fuzzy.kernels.jit import inlined_kernel
from fuzzy.kernels.tables import Tables, Workspace

_ARRAYS = len(Tables._fields) + len(Workspace._fields)


class Directory(NamedTuple):
    """Addresses and shapes of all arrays of a compiled system and of a workspace, and the arrays themselves."""

    entries: NDArray[np.int64]  # (n_arrays, 3) address, rows, columns; tables first
    tables: Tables
    workspace: Workspace

    @property
    def address(self) -> int:
        """Address to hand to kernels."""
        return self.entries.ctypes.data


def directory(tables: Tables, workspace: Workspace) -> Directory:
    """List the arrays of ``tables`` and ``workspace``, which must be contiguous."""
    entries = np.zeros((len(tables) + len(workspace), 3), dtype=np.int64)
    for row, array in zip(entries, (*tables, *workspace), strict=True):
        if not array.flags.c_contiguous or array.dtype not in (np.int64, np.float64):
            raise ValueError(f"found {array.dtype} of shape {array.shape}; valid: contiguous int64 or float64")
        row[:] = array.ctypes.data, array.shape[0], array.shape[1] if array.ndim == 2 else 1
    return Directory(entries, tables, workspace)


@intrinsic
def _compiled_pointer(typingctx: Any, address: Any) -> Any:  # noqa: ARG001
    """Turn an address into a pointer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        return builder.inttoptr(arguments[0], ir.IntType(8).as_pointer())

    return types.voidptr(types.intp), generate


def _plain_pointer(address: int) -> ctypes.c_void_p:
    """Turn an address into a pointer, where kernels run as plain Python."""
    return ctypes.c_void_p(int(address))


_settings: Any = config
_pointer: Any = _plain_pointer if _settings.DISABLE_JIT else _compiled_pointer


@inlined_kernel
def _entries(address):
    return carray(_pointer(address), (_ARRAYS, 3), np.int64)


@inlined_kernel
def _integers(entry):
    return carray(_pointer(entry[0]), (entry[1],), np.int64)


@inlined_kernel
def _integers_2d(entry):
    return carray(_pointer(entry[0]), (entry[1], entry[2]), np.int64)


@inlined_kernel
def _numbers(entry):
    return carray(_pointer(entry[0]), (entry[1],), np.float64)


@inlined_kernel
def _numbers_2d(entry):
    return carray(_pointer(entry[0]), (entry[1], entry[2]), np.float64)


@inlined_kernel
def tables_at(address):
    """Return the tables at ``address``; callable inside kernels, and what is not used of them costs nothing."""
    entry = _entries(address)
    return Tables(
        options=_integers(entry[0]),
        input_range=_numbers_2d(entry[1]),
        input_rejects=_integers(entry[2]),
        input_start=_integers(entry[3]),
        input_shape=_integers(entry[4]),
        input_parameter=_numbers_2d(entry[5]),
        grid=_integers_2d(entry[6]),
        grid_origin=_integers(entry[7]),
        program=_integers(entry[8]),
        program_start=_integers(entry[9]),
        weight=_numbers(entry[10]),
        consequent_start=_integers(entry[11]),
        consequent_term=_integers(entry[12]),
        output_range=_numbers_2d(entry[13]),
        output_start=_integers(entry[14]),
        output_shape=_integers(entry[15]),
        output_parameter=_numbers_2d(entry[16]),
        method=_integers(entry[17]),
        no_fire=_integers(entry[18]),
        no_fire_value=_numbers(entry[19]),
        neighbour=_integers(entry[20]),
        cut_start=_integers(entry[21]),
        cut=_numbers_2d(entry[22]),
        break_start=_integers(entry[23]),
        break_point=_numbers(entry[24]),
        edge_start=_integers(entry[25]),
        edge=_numbers_2d(entry[26]),
    )


@inlined_kernel
def workspace_at(address):
    """Return the workspace at ``address``; callable inside kernels."""
    entry = _entries(address)
    return Workspace(
        input=_numbers(entry[27]),
        output=_numbers(entry[28]),
        membership=_numbers(entry[29]),
        strength=_numbers(entry[30]),
        fired=_integers(entry[31]),
        height=_numbers(entry[32]),
        stack=_numbers(entry[33]),
        moments=_numbers(entry[34]),
        scratch=_numbers(entry[35]),
    )
