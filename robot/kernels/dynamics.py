"""Dynamics of the planar chain of N modules, by recursions over its links.

Link k (counted from 0 here, from 1 in the literature) is the line from mass k-1 to mass k; its direction makes the
angle phi_k with n3. Rod k sits on mass k and is turned by psi_k = phi_(k+1), so that every absolute angle belongs to
one rod. Joint angles theta_k = psi_k - psi_(k-1) are used outside, absolute angles inside: there the masses couple
only through the links' directions, and each recursion of Featherstone's book shrinks to scalars. Vectors have the
components (n1, n3); n3 points along gravity.

Letters:
    q, dq, ddq   (2N,) [s_0 .. s_(N-1), theta_0 .. theta_(N-1)] in m and rad, and derivatives
    Q            (2N,) generalized forces, N on every s and N m on every theta
    D, C, G, K   mass matrix, Coriolis matrix, gravity and spring forces, dG/dq
    d_k, n_k     (sin phi, cos phi) and (cos phi, -sin phi): unit vectors along and across link k
    w_k          d(phi_k)/dt; the speed of link k's end against its start is ds d + s w n

The equations are Lagrange's, derived from the kinetic and potential energies (1)-(6) as corrected in docs/errata.md.

References:
    R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008: recursive Newton-Euler (ch. 5), composite bodies
    (ch. 6), articulated bodies (ch. 7).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzy.kernels.jit import inlined_kernel, kernel

Array = NDArray[np.float64]

SLIP_SPEED = 0.02
"""m/s; Coulomb friction reaches 71 % of its force at this speed: sign(v) is taken as v / √(v² + SLIP_SPEED²)."""

STOP_LENGTH = 0.01
"""m; actuators that get shorter than this meet their stops."""


class Parameters(NamedTuple):
    """An arm as kernels read it: read-only arrays, row 0 of a pair is actuator 1."""

    mass: Array
    """(N,) kg, on the rods."""
    inertia: Array
    """(N,) kg m², of the rods."""
    half_rod: Array
    """(N,) m, lever of the actuators, l/2."""
    rest_length: Array
    """(N,) m, of the springs."""
    stiffness: Array
    """(2, N) N/m."""
    damping: Array
    """(2, N) N s/m."""
    gravity: float
    """m/s²."""
    friction: Array
    """(2, N) N, Coulomb friction."""
    has_friction: int
    """1 if any friction is not 0."""
    payload: float
    """kg, carried by the last rod."""
    payload_offset: float
    """m, from the last rod's centre along the rod's normal."""
    stop_stiffness: float
    """N/m, of the stops of the actuators' lengths; 0 for none."""


class Workspace(NamedTuple):
    """Intermediate results of the recursions, one entry a link, all (N,)."""

    sine: Array
    """sin phi, written by ``directions``."""
    cosine: Array
    """cos phi, written by ``directions``."""
    along: Array
    """1 / (d·A d) of the tail's articulated inertia A; in ``rigid_body_force``, acceleration of the mass along n1."""
    across: Array
    """(d·A n) / (d·A d); in ``rigid_body_force``, acceleration of the mass along n3."""
    effective: Array
    """Inertia that the link's end shows across the link while it is free to slide."""
    turning: Array
    """1 / inertia of the link about its start, with the rod it starts from."""
    remaining: Array
    """Force across the link that is left when the link slides freely."""
    bias: Array
    """Force along the link at zero acceleration."""


@kernel
def new_workspace(n: int) -> Workspace:
    """Return a workspace for ``n`` modules; allocate it once a run."""
    return Workspace(
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
        np.empty(n),
    )


@inlined_kernel
def directions(q: Array, work: Workspace) -> None:
    """Write sin and cos of every link's absolute angle; the first link always hangs along n3."""
    n = q.size // 2
    angle = 0.0
    work.sine[0] = 0.0
    work.cosine[0] = 1.0
    for k in range(1, n):
        angle += q[n + k - 1]
        work.sine[k] = math.sin(angle)
        work.cosine[k] = math.cos(angle)


@inlined_kernel
def _tip_direction(q: Array, work: Workspace) -> tuple[float, float]:
    """Return sin and cos of the last rod's absolute angle. Needs ``directions(q, work)``."""
    n = q.size // 2
    sine = math.sin(q[2 * n - 1])
    cosine = math.cos(q[2 * n - 1])
    return (
        work.sine[n - 1] * cosine + work.cosine[n - 1] * sine,
        work.cosine[n - 1] * cosine - work.sine[n - 1] * sine,
    )


@inlined_kernel
def rigid_body_force(
    arm: Parameters, q: Array, dq: Array, ddq: Array, gravity: float, work: Workspace, Q: Array
) -> None:
    """Write Q = D ddq + C dq + gravity: what the masses and rods take, without springs and dampers.

    Recursive Newton-Euler: accelerations from the base to the tip, forces back. Needs ``directions(q, work)``.

    Args:
        arm: Parameters.
        q: (2N,) position.
        dq: (2N,) velocity.
        ddq: (2N,) acceleration.
        gravity: m/s²; 0 leaves gravity out.
        work: ``sine`` and ``cosine`` in, others overwritten.
        Q: (2N,) out.
    """
    n = arm.mass.size
    a1 = 0.0
    a3 = 0.0
    w = 0.0
    dw = 0.0
    for k in range(n):
        sine = work.sine[k]
        cosine = work.cosine[k]
        radial = ddq[k] - q[k] * w * w
        lateral = q[k] * dw + 2.0 * dq[k] * w
        a1 += radial * sine + lateral * cosine
        a3 += radial * cosine - lateral * sine
        work.along[k] = a1
        work.across[k] = a3
        w += dq[n + k]
        dw += ddq[n + k]
        Q[n + k] = arm.inertia[k] * dw
    f1 = 0.0
    f3 = 0.0
    if arm.payload > 0.0:
        sine, cosine = _tip_direction(q, work)
        offset = arm.payload_offset
        f1 = arm.payload * (a1 + offset * (dw * cosine - w * w * sine))
        f3 = arm.payload * (a3 - offset * (dw * sine + w * w * cosine) - gravity)
        Q[2 * n - 1] += offset * (f1 * cosine - f3 * sine)
    for k in range(n - 1, -1, -1):
        sine = work.sine[k]
        cosine = work.cosine[k]
        f1 += arm.mass[k] * work.along[k]
        f3 += arm.mass[k] * (work.across[k] - gravity)
        Q[k] = f1 * sine + f3 * cosine
        if k > 0:
            # The moment of link k about its start acts on the rod it starts from, and on every joint before it.
            Q[n + k - 1] += q[k] * (f1 * cosine - f3 * sine) + Q[n + k]


@inlined_kernel
def add_passive_force(arm: Parameters, q: Array, dq: Array, sign: float, Q: Array) -> None:
    """Add ``sign`` times what springs and dampers oppose at (q, dq) to Q (2N,), actuator by actuator; (5), (6)."""
    n = arm.mass.size
    for k in range(n):
        lever = arm.half_rod[k]
        stretch = q[k] - arm.rest_length[k]
        first = arm.stiffness[0, k] * (stretch + lever * q[n + k]) + arm.damping[0, k] * (dq[k] + lever * dq[n + k])
        second = arm.stiffness[1, k] * (stretch - lever * q[n + k]) + arm.damping[1, k] * (dq[k] - lever * dq[n + k])
        Q[k] += sign * (first + second)
        Q[n + k] += sign * lever * (first - second)
    if arm.has_friction:
        add_friction(arm, dq, sign, Q)
    if arm.stop_stiffness > 0.0:
        add_stops(arm, q, sign, Q)


@inlined_kernel
def add_friction(arm: Parameters, dq: Array, sign: float, Q: Array) -> None:
    """Add ``sign`` times the actuators' Coulomb friction, with a smooth sign of their speeds, to Q (2N,); F of (36)."""
    n = arm.mass.size
    for k in range(n):
        lever = arm.half_rod[k]
        speed = dq[k] + lever * dq[n + k]
        first = arm.friction[0, k] * speed / math.sqrt(speed * speed + SLIP_SPEED * SLIP_SPEED)
        speed = dq[k] - lever * dq[n + k]
        second = arm.friction[1, k] * speed / math.sqrt(speed * speed + SLIP_SPEED * SLIP_SPEED)
        Q[k] += sign * (first + second)
        Q[n + k] += sign * lever * (first - second)


@inlined_kernel
def add_stops(arm: Parameters, q: Array, sign: float, Q: Array) -> None:
    """Add ``sign`` times what the stops oppose to actuators shorter than ``STOP_LENGTH`` to Q (2N,)."""
    n = arm.mass.size
    for k in range(n):
        lever = arm.half_rod[k]
        first = -_stop(q[k] + lever * q[n + k], arm.stop_stiffness)
        second = -_stop(q[k] - lever * q[n + k], arm.stop_stiffness)
        Q[k] += sign * (first + second)
        Q[n + k] += sign * lever * (first - second)


@inlined_kernel
def _stop(length: float, stiffness: float) -> float:
    """Return the push of a stop: it sets in with slope 0, and below length 0 its slope is the stiffness."""
    if length >= STOP_LENGTH:
        return 0.0
    if length <= 0.0:
        return stiffness * (0.5 * STOP_LENGTH - length)
    return 0.5 * stiffness * (STOP_LENGTH - length) ** 2 / STOP_LENGTH


@inlined_kernel
def inverse_dynamics(arm: Parameters, q: Array, dq: Array, ddq: Array, work: Workspace, Q: Array) -> None:
    """Write Q = D ddq + C dq + B dq + F + G, the force that moves the arm so. Needs ``directions(q, work)``."""
    rigid_body_force(arm, q, dq, ddq, arm.gravity, work, Q)
    add_passive_force(arm, q, dq, 1.0, Q)


@inlined_kernel
def forward_dynamics(arm: Parameters, q: Array, dq: Array, Q: Array, load: Array, work: Workspace, ddq: Array) -> None:
    """Write the acceleration that solves D ddq + C dq + B dq + F + G = Q + forces of the loads.

    Articulated bodies: from the tip to the base every link hands on the force that its tail opposes to an
    acceleration a of the link's start, f = (m + beta n nᵀ) a + c. Because the link slides freely along d, only the
    direction n across it carries inertia, so that a link costs two divisions and no matrix is factorised. A payload
    is a link that cannot slide: its f has the same form, with a negative beta.
    Needs ``directions(q, work)``.

    Args:
        arm: Parameters.
        q: (2N,) position.
        dq: (2N,) velocity.
        Q: (2N,) generalized forces; overwritten by the forces less springs and dampers.
        load: (N, 2) external forces on the masses along n1 and n3, N.
        work: ``sine`` and ``cosine`` in, others overwritten.
        ddq: (2N,) out.
    """
    n = arm.mass.size
    add_passive_force(arm, q, dq, -1.0, Q)
    # c: force at zero acceleration of mass k; beta: the tail's inertia across the next link.
    w = 0.0
    for k in range(n - 1):
        w += dq[n + k]
    beta = 0.0
    c1 = 0.0
    c3 = 0.0
    next_sine = 0.0
    next_cosine = 1.0
    tip_share = 0.0
    tip_sine = 0.0
    tip_cosine = 1.0
    if arm.payload > 0.0:
        tip_sine, tip_cosine = _tip_direction(q, work)
        next_sine = tip_sine
        next_cosine = tip_cosine
        lever = arm.payload * arm.payload_offset
        spin = w + dq[2 * n - 1]
        tip_share = 1.0 / (arm.inertia[n - 1] + lever * arm.payload_offset)
        beta = -lever * lever * tip_share
        lateral = beta * arm.gravity * tip_sine + lever * Q[2 * n - 1] * tip_share
        radial = -lever * spin * spin
        c1 = radial * tip_sine + lateral * tip_cosine
        c3 = radial * tip_cosine - lateral * tip_sine
    for k in range(n - 1, -1, -1):
        mass = arm.mass[k]
        if k == n - 1:
            mass += arm.payload
        sine = work.sine[k]
        cosine = work.cosine[k]
        c1 -= load[k, 0]
        c3 -= mass * arm.gravity + load[k, 1]
        d_n = sine * next_cosine - cosine * next_sine
        n_n = cosine * next_cosine + sine * next_sine
        along = 1.0 / (mass + beta * d_n * d_n)
        across = beta * d_n * n_n * along
        bias = c1 * sine + c3 * cosine
        work.along[k] = along
        work.across[k] = across
        work.bias[k] = bias
        if k == 0:
            break
        effective = mass * (mass + beta) * along
        remaining = c1 * cosine - c3 * sine + across * (Q[k] - bias)
        work.effective[k] = effective
        work.remaining[k] = remaining
        s = q[k]
        rod = arm.inertia[k - 1]
        # Absolute angles: the force on psi_(k-1) is what the joint before rod k-1 gives less what the next one takes.
        torque = Q[n + k - 1] - Q[n + k]
        share = 1.0 / (rod + effective * s * s)
        work.turning[k] = share
        beta = rod * effective * share
        lateral = beta * 2.0 * dq[k] * w + (rod * remaining + effective * s * torque) * share
        c1 = Q[k] * sine + lateral * cosine
        c3 = Q[k] * cosine - lateral * sine
        next_sine = sine
        next_cosine = cosine
        w -= dq[n + k - 1]
    ddq[0] = (Q[0] - work.bias[0]) * work.along[0]
    a1 = ddq[0] * work.sine[0]
    a3 = ddq[0] * work.cosine[0]
    w = 0.0
    previous = 0.0
    for k in range(1, n):
        sine = work.sine[k]
        cosine = work.cosine[k]
        s = q[k]
        w += dq[n + k - 1]
        lateral = a1 * cosine - a3 * sine + 2.0 * dq[k] * w
        radial = a1 * sine + a3 * cosine - s * w * w
        torque = Q[n + k - 1] - Q[n + k] - s * (work.remaining[k] + work.effective[k] * lateral)
        turn = torque * work.turning[k]
        lateral += s * turn
        slide = (Q[k] - work.bias[k]) * work.along[k] - work.across[k] * lateral
        ddq[k] = slide - radial
        ddq[n + k - 1] = turn - previous
        previous = turn
        a1 = slide * sine + lateral * cosine
        a3 = slide * cosine - lateral * sine
    if arm.payload > 0.0:
        lateral = a1 * tip_cosine + (arm.gravity - a3) * tip_sine
        torque = Q[2 * n - 1] - arm.payload * arm.payload_offset * lateral
        ddq[2 * n - 1] = torque * tip_share - previous
    else:
        ddq[2 * n - 1] = Q[2 * n - 1] / arm.inertia[n - 1] - previous
