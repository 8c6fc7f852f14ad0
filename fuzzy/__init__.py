"""Fuzzy inference: documents, exact kernels, analysis. Knows nothing of robots or browsers."""

from fuzzy.check import check
from fuzzy.errors import FormatError, FuzzyError, InvalidInputError, InvalidSystemError
from fuzzy.formats import load, save
from fuzzy.inference import Controller, Trace, compile_system
from fuzzy.system import FuzzySystem

__all__ = [
    "Controller",
    "FormatError",
    "FuzzyError",
    "FuzzySystem",
    "InvalidInputError",
    "InvalidSystemError",
    "Trace",
    "check",
    "compile_system",
    "load",
    "save",
]
