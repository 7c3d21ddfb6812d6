"""Dynamics in steps: what a stage of optimal control needs of them.

A robot takes a semi-implicit Euler step: v' = v + h a(q, v, S u), q' = q (+) h v'. With M = da/d(q, v, tau), the
derivatives of the acceleration (Carpentier & Mansard 2018), and those of q (+) w, the step's follow by the chain rule.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ulna import algorithms
from ulna.checks.arrays import known_limits
from ulna.errors import InputError, UnknownName
from ulna.model import FreeFlyer
from ulna.quantities.mass import check_mass
from ulna.robot import Robot
from ulna.typing import Array, Floats


@dataclass(frozen=True)
class System:
    """Dynamics in steps; its functions take one sample and can be traced.

    Attributes:
        nx: How many numbers a state has.
        ndx: How many numbers a change of the state has.
        nu: How many numbers a control has.
        step: The next state of a state and a control.
        step_derivatives: Its derivatives with respect to state and control.
        plus: A state and a change to the changed state.
        minus: The change that leads from one state to another.
        split: What a cost takes of a state.
        names: What these are called.
        control_limits: Least and greatest controls, (2, nu); infinite where none are known.
    """

    nx: int
    ndx: int
    nu: int
    step: Callable[[Array, Array], Array]
    step_derivatives: Callable[[Array, Array], tuple[Array, Array]]
    plus: Callable[[Array, Array], Array]
    minus: Callable[[Array, Array], Array]
    split: Callable[[Array], tuple[Array, ...]]
    names: tuple[str, ...]
    control_limits: Floats


def robot_system(robot: Robot, dt: float, actuated: Sequence[str] | None) -> System:
    """The dynamics of a robot in steps.

    Args:
        robot: The robot.
        dt: Length of a step [s].
        actuated: Names of the driven joints; None for all but free flyers.

    Returns:
        The dynamics.

    Raises:
        ModelError: If a joint moves no inertia.
        UnknownName: If a name is that of no joint with an independent torque.
    """
    check_mass(robot.model)
    model, nq, nv = robot.model, robot.nq, robot.nv
    driven = _driven(robot, actuated)

    def parts(x: Array, u: Array) -> tuple[Array, Array, Array]:
        tau = np.zeros(nv, dtype=object)
        tau[driven] = u
        return x[:nq], x[nq:], tau

    def step(x: Array, u: Array) -> Array:
        q, v, tau = parts(x, u)
        after = v + dt * algorithms.forward_dynamics(model, q, v, tau)
        return np.concatenate([algorithms.integrate(model, q, dt * after), after])

    def step_derivatives(x: Array, u: Array) -> tuple[Array, Array]:
        q, v, tau = parts(x, u)
        after = v + dt * algorithms.forward_dynamics(model, q, v, tau)
        by_q, by_v, by_tau = algorithms.forward_dynamics_derivatives(model, q, v, tau)
        along, of_step = algorithms.integrate_derivatives(model, q, dt * after)
        rate = np.concatenate([dt * by_q, np.eye(nv) + dt * by_v], axis=1)
        place = dt * (of_step @ rate) + np.concatenate([along, np.zeros((nv, nv))], axis=1)
        push = dt * by_tau[:, driven]
        return np.concatenate([place, rate]), np.concatenate([dt * (of_step @ push), push])

    def plus(x: Array, dx: Array) -> Array:
        return np.concatenate([algorithms.integrate(model, x[:nq], dx[:nv]), x[nq:] + dx[nv:]])

    def minus(x0: Array, x1: Array) -> Array:
        return np.concatenate([algorithms.difference(model, x0[:nq], x1[:nq]), x1[nq:] - x0[nq:]])

    def split(x: Array) -> tuple[Array, ...]:
        return x[:nq], x[nq:]

    greatest = known_limits(model.effort_limit)[driven]
    limits = np.stack([-greatest, greatest])
    return System(
        nq + nv, 2 * nv, len(driven), step, step_derivatives, plus, minus, split, ("q", "v"), limits
    )


def _driven(robot: Robot, actuated: Sequence[str] | None) -> list[int]:
    """The entries of the torques that a control drives."""
    joints = [joint for joint in robot.model.joints if joint.kind.nv and joint.mimic is None]
    names = [joint.name for joint in joints]
    if isinstance(actuated, str):
        actuated = (actuated,)
    for name in actuated or ():
        if name not in names:
            raise UnknownName("joint", name, names)
    chosen = [
        joint
        for joint in joints
        if (not isinstance(joint.kind, FreeFlyer) if actuated is None else joint.name in actuated)
    ]
    entries = [k for joint in chosen for k in range(joint.idx_v, joint.idx_v + joint.kind.nv)]
    if not entries:
        raise InputError("No joint is driven; expected at least one name in `actuated`.")
    return entries
