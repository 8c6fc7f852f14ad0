"""How the arm's kernels are compiled: as ``fuzzy.kernels.jit`` compiles, but without numba's memory runtime."""

from __future__ import annotations

from fuzzy.kernels.jit import Kernel, _compile


def borrowing_kernel(function: Kernel) -> Kernel:
    """Compile a kernel that only works on the arrays it is given: one that allocates does not compile.

    Numba counts references to every array that a function receives, and a named tuple of arrays is many. For kernels
    that neither allocate nor keep an array this is wasted, and here three quarters of the running time; without the
    memory runtime nothing is counted. Such kernels may call only their like, and none may call ``numba.carray``.
    """
    return _compile(function, nogil=True, _nrt=False)
