"""Lagrange's equations of the three-module arm, derived by sympy from the corrected energies (1)-(6)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

N = 3


class Equations(NamedTuple):
    """Functions of (q, dq, mass, inertia, l, s0, k1, k2, c1, c2, g); each argument is a sequence or a number."""

    D: Callable[..., Any]
    C_dq: Callable[..., Any]
    B_dq: Callable[..., Any]
    G: Callable[..., Any]
    K: Callable[..., Any]
    energy: Callable[..., Any]
    F_paper: Callable[..., Any]
    F_internal: Callable[..., Any]


@functools.cache
def derive() -> Equations:
    q = sp.symbols(f"s1:{N + 1} theta1:{N + 1}", real=True)
    dq = sp.symbols(f"ds1:{N + 1} dtheta1:{N + 1}", real=True)
    m, inertia = sp.symbols(f"m1:{N + 1}"), sp.symbols(f"I1:{N + 1}")
    rod, rest = sp.symbols(f"l1:{N + 1}"), sp.symbols(f"s0_1:{N + 1}")
    k = [sp.symbols(f"k{a}_1:{N + 1}") for a in "12"]
    c = [sp.symbols(f"c{a}_1:{N + 1}") for a in "12"]
    g = sp.Symbol("g")
    s, theta = q[:N], q[N:]
    # (1)-(3): module i points along (sin phi_i, cos phi_i), phi_i the sum of the angles before it.
    phi = [sum(theta[:i], sp.Integer(0)) for i in range(N)]
    links = [sp.Matrix([s[i] * sp.sin(phi[i]), s[i] * sp.cos(phi[i])]) for i in range(N)]
    masses = [sum(links[1 : i + 1], links[0]) for i in range(N)]
    rods = [sum(theta[: i + 1], sp.Integer(0)) for i in range(N)]
    rate = sp.Matrix(dq)

    def speed(position: Any) -> Any:
        return sp.Matrix([position]).jacobian(q) * rate

    kinetic = sp.Integer(0)
    for i in range(N):
        kinetic += (m[i] * (speed(masses[i].T).T * speed(masses[i].T))[0] + inertia[i] * speed([rods[i]])[0] ** 2) / 2
    lengths = [[s[i] + sign * rod[i] * theta[i] / 2 for i in range(N)] for sign in (1, -1)]
    potential = -sum(m[i] * g * masses[i][1] for i in range(N)) + sum(
        k[a][i] * (lengths[a][i] - rest[i]) ** 2 / 2 for a in range(2) for i in range(N)
    )
    dissipation = sum(c[a][i] * speed([lengths[a][i]])[0] ** 2 / 2 for a in range(2) for i in range(N))
    momentum = sp.Matrix([sp.diff(kinetic, v) for v in dq])
    D = momentum.jacobian(dq)
    C_dq = momentum.jacobian(q) * rate - sp.Matrix([sp.diff(kinetic, x) for x in q])
    B_dq = sp.Matrix([sp.diff(dissipation, v) for v in dq])
    G = sp.Matrix([sp.diff(potential, x) for x in q])
    # (7)-(12): actuators push their rod along the module and turn it with the lever l/2.
    F_paper, F_internal = sp.zeros(2 * N, 2 * N), sp.zeros(2 * N, 2 * N)
    for i in range(N):
        direction = sp.Matrix([sp.sin(phi[i]), sp.cos(phi[i])])
        push = masses[i].jacobian(q).T * direction
        turn = sp.Matrix([rods[i]]).jacobian(q).T
        for a, sign in enumerate((1, -1)):
            F_paper[:, 2 * i + a] = push + sign * rod[i] / 2 * turn
            F_internal[:, 2 * i + a] = sp.Matrix([lengths[a][i]]).jacobian(q).T
    arguments = [q, dq, m, inertia, rod, rest, k[0], k[1], c[0], c[1], g]

    def compiled(expression: Any) -> Callable[..., Any]:
        function = sp.lambdify(arguments, expression, "numpy", cse=True)
        vector = getattr(expression, "shape", (0, 0))[1] == 1
        return lambda *values: np.ravel(function(*values)) if vector else np.asarray(function(*values), dtype=float)

    return Equations(
        compiled(D),
        compiled(C_dq),
        compiled(B_dq),
        compiled(G),
        compiled(G.jacobian(q)),
        compiled(sp.Matrix([kinetic, potential])),
        compiled(F_paper),
        compiled(F_internal),
    )
