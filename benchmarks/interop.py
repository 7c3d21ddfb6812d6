"""Forward kinematics and its gradient in batches on the CPU: Ulna in PyTorch and JAX, beside pytorch_kinematics and JAX alone.

    python benchmarks/interop.py     # needs torch, pytorch-kinematics and jax

The Panda, float32, the same chain for all. The gradient is that of the squared distance of the tool from a point.
"JAX alone" is the product of the joints' matrices in jax.numpy, compiled by XLA. PyTorch and Ulna use one core, XLA all of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytorch_kinematics
import torch
from _timing import medians, shown, table

import ulna

GOAL = np.array([0.4, 0.1, 0.5], np.float32)
COUNTS = (1, 100, 10_000)
Pair = tuple[Callable[[], Any], Callable[[], Any]]


def placements(robot: ulna.Robot) -> list[np.ndarray]:
    """Each joint in the one before, and the tool in the last, (4, 4); joints turn about their z axes."""
    joints = [
        np.eye(4),
        *(robot.fk(np.zeros(7), f"panda_link{k}") for k in range(1, 8)),
        robot.fk(np.zeros(7)),
    ]
    return [np.linalg.inv(a) @ b for a, b in itertools.pairwise(joints)]


def rpy_of(T: np.ndarray) -> np.ndarray:
    """Roll, pitch and yaw, fixed axes [rad]."""
    R = T[:3, :3]
    return np.array([np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(R[2, 0]), np.arctan2(R[1, 0], R[0, 0])])


def urdf(steps: list[np.ndarray]) -> str:
    """The chain as URDF, for pytorch_kinematics."""
    lines = ['<robot name="chain"><link name="l0"/>']
    for k, T in enumerate(steps, 1):
        xyz, rpy = (" ".join(map(repr, map(float, v))) for v in (T[:3, 3], rpy_of(T)))
        kind = "revolute" if k < len(steps) else "fixed"
        lines.append(
            f'<link name="l{k}"/><joint name="j{k}" type="{kind}"><parent link="l{k - 1}"/><child link="l{k}"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/><limit lower="-4" upper="4" effort="1" velocity="1"/></joint>'
        )
    return "".join([*lines, "</robot>"])


def in_torch(fk: Callable[[Any], Any], q: np.ndarray) -> Pair:
    """Forward kinematics of tensors, and the gradient of the squared distance."""
    plain, goal = torch.tensor(q), torch.tensor(GOAL)

    def gradient() -> Any:
        x = plain.clone().requires_grad_()
        ((fk(x)[:, :3, 3] - goal) ** 2).sum().backward()
        return x.grad

    def forward() -> Any:
        with torch.no_grad():
            return fk(plain)

    return forward, gradient


def in_jax(fk: Callable[[Any], Any], q: np.ndarray) -> Pair:
    """The same of JAX arrays, compiled by XLA."""
    x, goal = jnp.asarray(q), jnp.asarray(GOAL)
    forward = jax.jit(fk)
    gradient = jax.jit(jax.grad(lambda q: ((fk(q)[:, :3, 3] - goal) ** 2).sum()))
    return lambda: forward(x).block_until_ready(), lambda: gradient(x).block_until_ready()


def jax_alone(steps: list[np.ndarray]) -> Callable[[Any], Any]:
    """The product of the joints' matrices."""
    constant = [jnp.asarray(T, jnp.float32) for T in steps]

    def one(q: Any) -> Any:
        T = jnp.eye(4, dtype=jnp.float32)
        for X, angle in zip(constant, q, strict=False):
            c, s, o, i = jnp.cos(angle), jnp.sin(angle), jnp.zeros_like(angle), jnp.ones_like(angle)
            T = T @ X @ jnp.array([[c, -s, o, o], [s, c, o, o], [o, o, i, o], [o, o, o, i]])
        return T @ constant[-1]

    return jax.vmap(one)


def main() -> None:
    torch.set_num_threads(1)
    robot = ulna.load("panda")
    steps = placements(robot)
    kernel = robot.kernel("fk", dtype="float32")
    chain = pytorch_kinematics.build_serial_chain_from_urdf(urdf(steps), "l8")
    rows = []
    for count in COUNTS:
        q = robot.random_configuration(count, seed=1).astype(np.float32)
        made = {
            "PyTorch": in_torch(ulna.interop.to_torch(kernel), q),
            "pytorch_kinematics": in_torch(lambda x: chain.forward_kinematics(x).get_matrix(), q),
            "JAX": in_jax(ulna.interop.to_jax(kernel), q),
            "JAX alone": in_jax(jax_alone(steps), q),
        }
        for forward, gradient in made.values():
            assert np.abs(np.asarray(forward()) - robot.fk(q)).max() < 1e-5
            assert np.abs(np.asarray(gradient()) - np.asarray(made["JAX"][1]())).max() < 1e-4
        times = medians([f for pair in made.values() for f in pair], repeat=7)
        for ours, peer in ((0, 2), (4, 6)):
            names = list(made)
            for k, what in enumerate(("FK", "gradient")):
                a, b = times[ours + k], times[peer + k]
                label = f"{what}: Ulna in {names[ours // 2]} / {names[peer // 2]}"
                rows.append((str(count), label, shown(a), shown(b), f"{b / a:.1f}"))
    print(table("In PyTorch and JAX", ("configurations", "ours / peer", "ours", "peer", "ratio"), rows))


if __name__ == "__main__":
    main()
