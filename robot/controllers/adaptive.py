"""Fuzzy blocks that learn while the arm moves; equations (39)-(43)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import msgspec
import numpy as np

from robot.arm import Arm
from robot.controllers.base import ADAPTED_GAUSSIANS, ADAPTED_SETS, Array, Law, keep_checked, law
from robot.controllers.feedback_linearization import DAMPING_RATIO, NATURAL_FREQUENCY, placed
from robot.controllers.fuzzy import Controller, check_blocks, input_scales
from robot.controllers.fuzzy_pid import input_gains
from robot.controllers.pid import INTEGRAL, PROPORTIONAL, Pid
from robot.errors import InvalidControllerError

Basis = Literal["sets", "gaussians"]
"""What ξ is made of: the edited antecedent sets (first type), or Gaussian ones in their place (second type)."""

_BLOCKS: dict[Basis, int] = {"sets": ADAPTED_SETS, "gaussians": ADAPTED_GAUSSIANS}

LEAK = 0.01
"""Default σ, 1/s."""


class AdaptiveFuzzyFlc(msgspec.Struct, frozen=True):
    """Q = D̂ (q̈d + Kv ė + Kp e + f̂) + N̂ with f̂_i = θ_iᵀ ξ and dθ_i/dt = γ ξ (p12 e_i + p22 ė_i) - σ θ_i.

    p12 = 1/(2 Kp) and p22 = 1/(Kp Kv) solve Lyapunov's equation AᵀP + PA = -diag(1, 1/Kp) of the error. With σ = 0
    and a disturbance θ*ᵀξ, V = eᵀPe + |θ* - θ|²/γ never grows. ξ: products of the inputs' degrees over their sum.

    Attributes:
        model: What the controller believes the arm to be.
        inference: The compiled fuzzy system; its inputs' sets make ξ, its rules and output play no part.
        kp: (2N,) 1/s², greater than 0.
        kv: (2N,) 1/s, greater than 0.
        gamma: (2N,) γ, 1/s⁵: how fast θ (m/s², rad/s²) is learned.
        leak: (2N,) σ, 1/s: the σ-modification, which forgets and so bounds θ.
        ge: (2N,) the first input for an error of 1 m or 1 rad.
        gc: (2N,) the second input for an error's rate of 1 m/s or 1 rad/s.
        basis: ``sets`` or ``gaussians``.

    Raises:
        InvalidControllerError: Gains that are negative, not finite, or not one a coordinate; Kp or Kv of 0; a fuzzy
            system with other than two inputs and one output.
    """

    model: Arm
    inference: Controller
    kp: Sequence[float]
    kv: Sequence[float]
    gamma: Sequence[float]
    leak: Sequence[float]
    ge: Sequence[float]
    gc: Sequence[float]
    basis: Basis = "sets"

    def __post_init__(self) -> None:
        keep_checked(self, ("kp", "kv", "gamma", "leak", "ge", "gc"), 2 * self.model.n_modules)
        _check_positive(self.kp, "kp")
        _check_positive(self.kv, "kv")
        check_blocks(self.inference)
        _check_basis(self.basis)

    @staticmethod
    def default(
        arm: Arm,
        inference: Controller,
        amplitude: Array,
        natural_frequency: float = NATURAL_FREQUENCY,
        damping_ratio: float = DAMPING_RATIO,
    ) -> AdaptiveFuzzyFlc:
        """Return γ = ωn⁵, with which θ learns as an integral of gain ωn³/2 does, σ = 0.01, GE = 4/A, GC = 48/(A ωn).

        Args:
            arm: The controller's model.
            inference: The compiled fuzzy system.
            amplitude: (2N,) A, the positive size of every coordinate's motion, m and rad.
            natural_frequency: ωn, rad/s; greater than 0.
            damping_ratio: ζ, greater than 0.
        """
        size = amplitude.size
        kp, kv = placed(natural_frequency, damping_ratio, size)
        ge, gc = input_scales(amplitude, natural_frequency)
        return AdaptiveFuzzyFlc(
            model=arm,
            inference=inference,
            kp=kp,
            kv=kv,
            gamma=(natural_frequency**5,) * size,
            leak=(LEAK,) * size,
            ge=ge,
            gc=gc,
        )

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        kp, kv, gamma = np.asarray(self.kp), np.asarray(self.kv), np.asarray(self.gamma)
        return law(
            size=kp.size,
            linearizing=True,
            Kp=self.kp,
            Kd=self.kv,
            GU=(1.0,) * kp.size,
            scale=np.stack([self.ge, self.gc], axis=1).tolist(),
            output_scale=1.0,
            blocks=_BLOCKS[self.basis],
            adaptation=[(gamma / (2 * kp)).tolist(), (gamma / (kp * kv)).tolist()],
            leak=self.leak,
        )


class AdaptiveFuzzyPid(msgspec.Struct, frozen=True):
    """Q = Kp e + Kd ė + Ki ∫e dt + θ_iᵀ ξ, dθ_i/dt = γ ξ (p12 e_i + p22 ė_i) - σ θ_i: model-free and learning.

    θ is a force here. p12 = 1/(2 Kp) as in :class:`AdaptiveFuzzyFlc`; p22 = Kd/(2 Kp²), for without a model no mass is
    known.

    Attributes:
        pid: The PID.
        inference: The compiled fuzzy system; its inputs' sets make ξ, its rules and output play no part.
        gamma: (2N,) γ.
        leak: (2N,) σ, 1/s.
        ge: (2N,) the first input for an error of 1 m or 1 rad.
        gc: (2N,) the second input for an error's rate of 1 m/s or 1 rad/s.
        basis: ``sets`` or ``gaussians``.

    Raises:
        InvalidControllerError: As for :class:`AdaptiveFuzzyFlc`.
    """

    pid: Pid
    inference: Controller
    gamma: Sequence[float]
    leak: Sequence[float]
    ge: Sequence[float]
    gc: Sequence[float]
    basis: Basis = "sets"

    def __post_init__(self) -> None:
        keep_checked(self, ("gamma", "leak", "ge", "gc"), len(self.pid.kp))
        _check_positive(self.pid.kp, "pid.kp")
        check_blocks(self.inference)
        _check_basis(self.basis)

    @staticmethod
    def default(pid: Pid, inference: Controller, amplitude: Array) -> AdaptiveFuzzyPid:
        """Return blocks that take over half of the PID's integral, for motions of size A (2N,).

        They take less where Kp is small beside Ki, for θ also follows ė, as if by a proportional gain.
        """
        ki, kp = np.asarray(pid.ki), np.asarray(pid.kp)
        learned = 0.5 * np.minimum(ki, INTEGRAL / PROPORTIONAL * kp)
        ge, gc = input_gains(pid, inference, amplitude)
        rest = msgspec.structs.replace(pid, ki=(ki - learned).tolist())
        return AdaptiveFuzzyPid(rest, inference, (2.0 * learned * kp).tolist(), (LEAK,) * kp.size, ge, gc)

    def law(self) -> Law:
        """Return the gains as the kernel reads them."""
        kp, kd, gamma = np.asarray(self.pid.kp), np.asarray(self.pid.kd), np.asarray(self.gamma)
        return law(
            size=kp.size,
            linearizing=False,
            Kp=self.pid.kp,
            Kd=self.pid.kd,
            Ki=self.pid.ki,
            GU=(1.0,) * kp.size,
            scale=np.stack([self.ge, self.gc], axis=1).tolist(),
            output_scale=1.0,
            blocks=_BLOCKS[self.basis],
            adaptation=[(gamma / (2 * kp)).tolist(), (gamma * kd / (2 * kp**2)).tolist()],
            leak=self.leak,
        )


def basis_size(inference: Controller) -> int:
    """Return the number of basis functions ξ: sets of the first input times sets of the second."""
    return math.prod(len(variable.terms) for variable in inference.system.inputs)


def _check_positive(gains: Sequence[float], name: str) -> None:
    for i, gain in enumerate(gains):
        if gain <= 0.0:
            raise InvalidControllerError(f"found {gain:g}; valid: greater than 0", f"{name}[{i}]")


def _check_basis(basis: str) -> None:
    if basis not in _BLOCKS:
        raise InvalidControllerError(f"found {basis!r}; valid: {', '.join(_BLOCKS)}", "basis")
