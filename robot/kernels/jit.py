"""How the arm's kernels are compiled: as ``fuzzy.kernels.jit`` compiles, but without numba's memory runtime."""

from __future__ import annotations

from fuzzy.kernels.jit import Kernel, _compile


def borrowing_kernel(function: Kernel) -> Kernel:
    """Compile a kernel that only works on the arrays it is given: one that allocates does not compile.

    Numba counts references to every array that a function receives, and a named tuple of arrays is many. For kernels
    that neither allocate nor keep an array this is wasted, and here it took three quarters of the running time;
    without the memory runtime nothing is counted. They are made part of their callers, because handing over all
    those arrays is not free either.
    """
    return _compile(function, nogil=True, forceinline=True, _nrt=False)


def counting_kernel(function: Kernel) -> Kernel:
    """Compile a kernel with the memory runtime, even where a borrowing kernel calls it.

    Without saying so it would inherit its caller's choice, and ``numba.carray``, with which fuzzy systems are read,
    needs the runtime.
    """
    return _compile(function, nogil=True, _nrt=True)
