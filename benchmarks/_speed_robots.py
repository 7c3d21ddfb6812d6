"""Robots of speed.py in Ulna, Pinocchio and MuJoCo, and what these have for each quantity."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import constraints
import derivatives
import dynamics
import numpy as np
import pinocchio as pin

from ulna.algorithms import Proximal
from ulna.loading import load_model
from ulna.model import Model
from ulna.robots import example_robot_data as data

try:
    import mujoco
except ImportError:
    mujoco = None

CHAINS = {"chain 100": 100, "chain 1000": 1000, "chain 5000": 5000}
LABELS = (*derivatives.ROBOTS, *CHAINS)
LARGEST_FOR_PINOCCHIO = 200
"""Joints; the size of Pinocchio's Data grows with their cube."""
LARGEST_FOR_MUJOCO = 1000
"""Joints; MuJoCo refuses trees that are five times as deep, after a minute."""
FRAME = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def _fk(peer: Any, memory: Any, q: Any) -> Any:
    pin.forwardKinematics(peer, memory, q)
    return pin.updateFramePlacement(peer, memory, peer.nframes - 1)


def _jacobian(peer: Any, memory: Any, q: Any) -> Any:
    return pin.computeFrameJacobian(peer, memory, q, peer.nframes - 1, FRAME)


PEERS: dict[str, tuple[int, Callable[..., Any]]] = {
    "fk": (1, _fk),
    "jacobian": (1, _jacobian),
    **dynamics.PEERS,
    **{name: (3, function) for name, function in derivatives.PEERS.items()},
}
"""For each kernel how many of q, v, and a or tau it takes, and what Pinocchio has for it."""

CONTACTS = ("constrained_dynamics", "impulse_dynamics", "constrained_dynamics_derivatives")
"""Kernels of robots that stand on their feet, as in constraints.py."""


def on_contacts(
    label: str, name: str, peer: Any, memory: Any
) -> tuple[int, Callable[..., Any], dict[str, Any]]:
    """As a row of `PEERS`, and the options of the kernel: both without regularisation."""
    _, standing = constraints.STANDING[label]
    models, datas = constraints.peers_constraints(peer, standing)
    pin.initConstraintDynamics(peer, memory, models, datas)
    settings = pin.ProximalSettings(1e-12, 0.0, 1)
    options = {"constraints": tuple(standing), "solver": Proximal(mu=0.0)}

    def dynamics_of(peer: Any, memory: Any, q: Any, v: Any, tau: Any) -> Any:
        return pin.constraintDynamics(peer, memory, q, v, tau, models, datas, settings)

    def impulse_of(peer: Any, memory: Any, q: Any, v: Any) -> Any:
        return pin.impulseDynamics(peer, memory, q, v, models, datas, 0.0, settings)

    def derivatives_of(peer: Any, memory: Any, q: Any, v: Any, tau: Any) -> Any:
        pin.constraintDynamics(peer, memory, q, v, tau, models, datas, settings)
        return pin.computeConstraintDynamicsDerivatives(peer, memory, models, datas, settings)

    if name == "constrained_dynamics":
        return 3, dynamics_of, options
    if name == "constrained_dynamics_derivatives":
        return 3, derivatives_of, {"constraints": tuple(standing)}
    return 2, impulse_of, options


def chain_file(n: int, folder: str) -> Path:
    """A URDF of a chain of revolute joints whose axes and offsets are in general position."""
    rng = np.random.default_rng(n)
    link = (
        '<link name="l{0}"><inertial><origin xyz="{1}"/><mass value="{2:.3f}"/>'
        '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="0.002" iyz="0.003"/></inertial></link>'
    )
    joint = (
        '<joint name="j{0}" type="revolute"><parent link="l{1}"/><child link="l{0}"/><origin xyz="{2}" rpy="{3}"/>'
        '<axis xyz="{4}"/><limit lower="-3" upper="3" velocity="2" effort="100"/></joint>'
    )
    lines = ['<link name="l0"/>']
    for k in range(1, n + 1):
        numbers = [" ".join(f"{x:.3f}" for x in rng.uniform(-0.2, 0.2, 3)) for _ in range(3)]
        axis = ("1 0 0", "0 1 0", "0 0 1")[k % 3]
        lines += [
            link.format(k, numbers[0], rng.uniform(0.5, 1.5)),
            joint.format(k, k - 1, *numbers[1:], axis),
        ]
    path = Path(folder) / f"chain{n}.urdf"
    path.write_text(f'<robot name="chain{n}">{"".join(lines)}</robot>')
    return path


def models(label: str, folder: str) -> tuple[Model, Any, Any]:
    """The robot in Ulna, in Pinocchio unless it is too large, and in MuJoCo, where it reads the file; else None."""
    if label in CHAINS:
        n = CHAINS[label]
        path = chain_file(n, folder)
        peer = pin.buildModelFromUrdf(str(path)) if n <= LARGEST_FOR_PINOCCHIO else None
        other = mujoco_model(path, False) if n <= LARGEST_FOR_MUJOCO else None
        return load_model(path), peer, other
    name = derivatives.ROBOTS[label]
    path, _ = data.files(name)
    model, peer = derivatives.load(name)
    return model, peer, mujoco_model(path, data.DESCRIPTIONS[name].floating)


def mujoco_model(path: str | Path, floating: bool) -> Any:
    """The robot in MuJoCo; None where it is not installed or refuses the file."""
    if mujoco is None:
        return None
    text = Path(path).read_text()
    for tag in ("visual", "collision"):
        text = re.sub(rf"<{tag}\b.*?</{tag}>", "", text, flags=re.DOTALL)
    try:
        spec = mujoco.MjSpec.from_string(text)
        spec.compiler.fusestatic = False
        if floating:
            spec.worldbody.first_body().add_freejoint()
        return spec.compile()
    except Exception as error:
        print(f"MuJoCo does not read {path}: {str(error).splitlines()[0]}", file=sys.stderr)
        return None


def mujoco_calls(model: Any) -> dict[str, Callable[[], Any]]:
    """What MuJoCo has for the quantities, each from a configuration on."""
    state, torque = mujoco.MjData(model), np.zeros(model.nv)
    jacobians = np.zeros((2, 3, model.nv))
    state.qvel[:] = np.random.default_rng(0).standard_normal(model.nv)

    def fk() -> None:
        mujoco.mj_kinematics(model, state)

    def positions() -> None:
        mujoco.mj_kinematics(model, state)
        mujoco.mj_comPos(model, state)

    def jacobian() -> None:
        positions()
        mujoco.mj_jacBody(model, state, jacobians[0], jacobians[1], model.nbody - 1)

    def mass_matrix() -> None:
        positions()
        (mujoco.mj_makeM if hasattr(mujoco, "mj_makeM") else mujoco.mj_crb)(model, state)

    def inverse_dynamics() -> None:
        positions()
        mujoco.mj_comVel(model, state)
        mujoco.mj_rne(model, state, 1, torque)

    def forward_dynamics() -> None:
        mujoco.mj_forward(model, state)

    return {f.__name__: f for f in (fk, jacobian, mass_matrix, inverse_dynamics, forward_dynamics)}
