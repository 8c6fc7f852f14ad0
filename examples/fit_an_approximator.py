"""Fit fuzzy approximators to a function of two inputs: given sets, least squares and minimax, and own Gaussians.

Run it from the project's folder: python examples/fit_an_approximator.py
"""

import numpy as np
from numpy.typing import NDArray

import fuzzy
from fuzzy import edits
from fuzzy.approximation import Approximation, fit, fit_gaussians


def friction(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a torque that rises with the error and sticks around rate 0."""
    return 40.0 * x[:, 0] + 25.0 * np.tanh(2.0 * x[:, 1])


def show(name: str, found: Approximation) -> None:
    """Print a line for one of them."""
    print(f"{name:34}{len(found.system.rules.list):4} rules, rms error {found.rms:7.3f}, largest {found.largest:7.3f}")


def main() -> None:
    """Fit four approximators."""
    given = fuzzy.load("rulebases/diagonal.yaml")
    show("its own sets, least squares", fit(given, friction))
    show("its own sets, least largest error", fit(given, friction, criterion="minimax", samples=1000))
    denser = edits.space_terms(edits.space_terms(given, "e", 11), "de", 11)
    show("eleven terms each", fit(denser, friction))
    show("Gaussians of their own", fit_gaussians(given, friction, rules=8, samples=400))


if __name__ == "__main__":
    main()
