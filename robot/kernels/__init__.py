"""Numba kernels of the arm: arrays in, arrays out, no exceptions, O(N) in the number of modules."""
