"""The same dynamics as matrices, for analysis and tests: D, C, K = dG/dq, and the energy.

Letters and conventions as in :mod:`robot.kernels.dynamics`; compiled as ``fuzzy.kernels.jit`` says.
"""

from __future__ import annotations

import numpy as np

from fuzzy.kernels.jit import inlined_kernel, kernel
from robot.kernels.dynamics import Array, Parameters, Workspace


@inlined_kernel
def joint_angles(n: int, matrix: Array) -> None:
    """Turn a (2N, 2N) matrix over (s, phi) in place into one over (s, theta).

    phi_k is the sum of theta_0 .. theta_(k-1): column theta_j collects the columns phi_k with k > j, and so do rows.
    """
    size = 2 * n
    for row in range(size):
        total = 0.0
        for j in range(n - 1, -1, -1):
            column = matrix[row, n + j]
            matrix[row, n + j] = total
            total += column
    for column in range(size):
        total = 0.0
        for j in range(n - 1, -1, -1):
            row_value = matrix[n + j, column]
            matrix[n + j, column] = total
            total += row_value


@inlined_kernel
def mass_matrix(arm: Parameters, q: Array, work: Workspace, D: Array) -> None:
    """Write the mass matrix D (2N, 2N), symmetric and positive definite. Needs ``directions(q, work)``.

    Composite bodies: links i and k both carry the masses from max(i, k) on.
    """
    n = arm.mass.size
    carried = 0.0
    for k in range(n - 1, -1, -1):
        carried += arm.mass[k]
        for i in range(k + 1):
            cosine = work.cosine[k] * work.cosine[i] + work.sine[k] * work.sine[i]
            sine = work.sine[k] * work.cosine[i] - work.cosine[k] * work.sine[i]
            D[k, i] = carried * cosine
            D[i, k] = D[k, i]
            D[k, n + i] = carried * q[i] * sine
            D[n + i, k] = D[k, n + i]
            D[i, n + k] = -carried * q[k] * sine
            D[n + k, i] = D[i, n + k]
            D[n + k, n + i] = carried * q[k] * q[i] * cosine
            D[n + i, n + k] = D[n + k, n + i]
    joint_angles(n, D)
    rods = 0.0
    for j in range(n - 1, -1, -1):
        rods += arm.inertia[j]
        for i in range(j):
            D[n + i, n + j] += rods
            D[n + j, n + i] += rods
        D[n + j, n + j] += rods


@kernel
def coriolis_matrix(arm: Parameters, q: Array, dq: Array, work: Workspace, C: Array) -> None:
    """Write C (2N, 2N) = sum of m_i J_iᵀ dJ_i/dt, which is Christoffel's. Needs ``directions(q, work)``.

    The masses move in a plane without curvature, so that d²p/dq_j dq_k · dp/dq_i are the Christoffel symbols of the
    first kind; hence dD/dt - 2 C is skew.
    """
    n = arm.mass.size
    carried = np.empty(n)
    w = np.empty(n)
    total = 0.0
    for k in range(n - 1, -1, -1):
        total += arm.mass[k]
        carried[k] = total
    rate = 0.0
    for k in range(n):
        w[k] = rate
        rate += dq[n + k]
    for k in range(n):
        for i in range(n):
            both = carried[max(i, k)]
            cosine = work.cosine[k] * work.cosine[i] + work.sine[k] * work.sine[i]
            sine = work.sine[k] * work.cosine[i] - work.cosine[k] * work.sine[i]
            C[k, i] = both * w[i] * sine
            C[k, n + i] = both * (dq[i] * sine - q[i] * w[i] * cosine)
            C[n + k, i] = both * q[k] * w[i] * cosine
            C[n + k, n + i] = both * q[k] * (dq[i] * cosine + q[i] * w[i] * sine)
    joint_angles(n, C)


@inlined_kernel
def stiffness_matrix(arm: Parameters, q: Array, work: Workspace, K: Array) -> None:
    """Write K (2N, 2N) = dG/dq, the Hessian of the potential energy. Needs ``directions(q, work)``."""
    n = arm.mass.size
    K[:, :] = 0.0
    weight = 0.0
    for k in range(n - 1, -1, -1):
        weight += arm.mass[k] * arm.gravity
        K[k, n + k] = weight * work.sine[k]
        K[n + k, k] = K[k, n + k]
        K[n + k, n + k] = weight * q[k] * work.cosine[k]
    joint_angles(n, K)
    for k in range(n):
        lever = arm.half_rod[k]
        both = arm.stiffness[0, k] + arm.stiffness[1, k]
        difference = arm.stiffness[0, k] - arm.stiffness[1, k]
        K[k, k] += both
        K[k, n + k] += lever * difference
        K[n + k, k] += lever * difference
        K[n + k, n + k] += lever * lever * both


@inlined_kernel
def energy(arm: Parameters, q: Array, dq: Array, work: Workspace) -> tuple[float, float]:
    """Return the kinetic and the potential energy, J (4, 5 corrected). Needs ``directions(q, work)``."""
    n = arm.mass.size
    kinetic = 0.0
    potential = 0.0
    v1 = 0.0
    v3 = 0.0
    depth = 0.0
    w = 0.0
    for k in range(n):
        sine = work.sine[k]
        cosine = work.cosine[k]
        v1 += dq[k] * sine + q[k] * w * cosine
        v3 += dq[k] * cosine - q[k] * w * sine
        depth += q[k] * cosine
        w += dq[n + k]
        kinetic += 0.5 * (arm.mass[k] * (v1 * v1 + v3 * v3) + arm.inertia[k] * w * w)
        stretch = q[k] - arm.rest_length[k]
        first = stretch + arm.half_rod[k] * q[n + k]
        second = stretch - arm.half_rod[k] * q[n + k]
        potential += 0.5 * (arm.stiffness[0, k] * first * first + arm.stiffness[1, k] * second * second)
        potential -= arm.mass[k] * arm.gravity * depth
    return kinetic, potential
