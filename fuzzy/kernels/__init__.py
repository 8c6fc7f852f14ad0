"""Numba kernels of fuzzy inference: arrays in, arrays out, no exceptions."""
