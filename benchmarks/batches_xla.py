"""Batches of MuJoCo XLA (MJX) on the CPU beside ours: one of so many samples, float64 and float32.

    python benchmarks/batches_xla.py [--samples 1000] [robot ...]

Robots: those of speed.py. Needs `mujoco-mjx`, and what derivatives.py needs; without it, it says so and measures nothing.
MJX is compiled by `jax.jit(jax.vmap(...))`, and each of its functions computes all that the quantity needs of a new
configuration, as in speed.py; its mass matrix is the dense one. XLA uses all cores, ours one and two threads. Medians in
turns; one batch and its compilation.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from typing import Any

os.environ["ULNA_QUIET"] = "1"

import numpy as np
from _speed_robots import LABELS, mujoco_model
from _timing import medians, shown, table
from derivatives import ROBOTS

from ulna.loading import load_model
from ulna.model import FreeFlyer, with_root_joint
from ulna.robot import Robot
from ulna.robots import example_robot_data as data

try:
    import jax
    from mujoco import mjx
except ImportError as missing:
    sys.exit(f"MuJoCo XLA is not measured: {missing}. Install mujoco-mjx.")

OURS = ("fk", "mass_matrix", "inverse_dynamics", "forward_dynamics")
HEAD = ("robot", "quantity", "Ulna", "two threads", "float32", "MJX", "MJX, float32", "ratio", "ratio, float32",
        "Ulna compiled", "MJX compiled")  # fmt: skip


def by_mjx(model: Any) -> dict[str, Callable[..., Any]]:
    """What MJX has for the quantities, of one sample."""
    state = mjx.make_data(model)

    def placed(q: Any) -> Any:
        return mjx.com_pos(model, mjx.kinematics(model, state.replace(qpos=q)))

    def mass_matrix(q: Any) -> Any:
        return mjx.full_m(model, mjx.crb(model, placed(q)))

    def inverse_dynamics(q: Any, v: Any, a: Any) -> Any:
        moving = mjx.com_vel(model, placed(q).replace(qvel=v, qacc=a))
        return mjx.rne(model, moving, True).qfrc_bias

    def forward_dynamics(q: Any, v: Any, tau: Any) -> Any:
        return mjx.forward(model, state.replace(qpos=q, qvel=v, qfrc_applied=tau)).qacc

    return {
        "fk": lambda q: mjx.kinematics(model, state.replace(qpos=q)).xpos[-1],
        "mass_matrix": mass_matrix,
        "inverse_dynamics": inverse_dynamics,
        "forward_dynamics": forward_dynamics,
    }


def compiled(f: Callable[..., Any], arrays: list[Any], is_double: bool) -> tuple[Callable[[], Any], float]:
    """A call of a batch, and how long the first one takes."""
    kind = np.float64 if is_double else np.float32
    with jax.enable_x64(is_double):
        given = [jax.numpy.asarray(x, dtype=kind) for x in arrays]
        batch = jax.jit(jax.vmap(f))
        start = time.perf_counter()
        jax.block_until_ready(batch(*given))
        took = time.perf_counter() - start

    def call() -> None:
        with jax.enable_x64(is_double):
            jax.block_until_ready(batch(*given))

    return call, took


def rows_of(label: str, samples: int) -> list[list[str]]:
    """All quantities of a robot."""
    name = ROBOTS[label]
    path, _ = data.files(name)
    floating = data.DESCRIPTIONS[name].floating
    model, peer = load_model(path), mujoco_model(path, floating)
    if floating and not any(isinstance(joint.kind, FreeFlyer) for joint in model.joints):
        model = with_root_joint(model, FreeFlyer())
    if peer is None:
        return []
    robot, rng = Robot(model), np.random.default_rng(0)
    rows = []
    for quantity in OURS:
        count = 1 if quantity in ("fk", "mass_matrix") else 3
        arrays = [
            robot.random_configuration((samples,), seed=1),
            *rng.standard_normal((2, samples, robot.nv)),
        ][:count]
        theirs = [rng.standard_normal((samples, peer.nq)), *rng.standard_normal((2, samples, peer.nv))][
            :count
        ]
        rows.append(row(label, robot, peer, quantity, arrays, theirs))
        print(*rows[-1], sep=", ", file=sys.stderr, flush=True)
    return rows


def row(
    label: str, robot: Robot, peer: Any, quantity: str, arrays: list[Any], theirs: list[Any]
) -> list[str]:
    """One robot and one quantity."""
    calls: dict[str, Callable[[], Any]] = {}
    start = time.perf_counter()
    kernel = robot.kernel(quantity)
    out = kernel(*arrays)
    first = time.perf_counter() - start
    small, few = robot.kernel(quantity, dtype=np.float32), [x.astype(np.float32) for x in arrays]
    out32 = small(*few)
    calls["Ulna"] = lambda: kernel(*arrays, out=out)
    calls["two threads"] = lambda: kernel(*arrays, out=out, threads=2)
    calls["float32"] = lambda: small(*few, out=out32)
    with jax.enable_x64(True):
        wide = by_mjx(mjx.put_model(peer))[quantity]
    calls["MJX"], took = compiled(wide, theirs, True)
    narrow = by_mjx(mjx.put_model(peer))[quantity]
    calls["MJX, float32"], _ = compiled(narrow, theirs, False)
    times = dict(zip(calls, medians([*calls.values()], 3, 0.02), strict=True))
    samples = len(arrays[0])
    each = {key: value / samples for key, value in times.items()}
    ratios = f"{times['MJX'] / times['Ulna']:.0f}", f"{times['MJX, float32'] / times['float32']:.0f}"
    return [label, quantity, *(shown(each[key]) for key in calls), *ratios, shown(first), shown(took)]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--samples", type=int, default=1000)
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(LABELS[:5])}; default all")
    given = parser.parse_args()
    rows = [row for label in given.robots or LABELS[:5] for row in rows_of(label, given.samples)]
    title = f"Batches of {given.samples:,} samples on the CPU, a sample"
    print(table(title, HEAD, rows))


if __name__ == "__main__":
    main()
