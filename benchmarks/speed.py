"""One table of speed: every robot and quantity beside Pinocchio and MuJoCo, in turns, with what limits each row.

    python benchmarks/speed.py [--quick] [--only NAME,NAME] [robot ...]

Robots: those of derivatives.py (Panda, UR5, Solo12, G1, Talos), and chains of 100 and 1,000 revolute joints. Needs `pin`
and `example-robot-data`; MuJoCo where it is installed and reads the file. All libraries read the same URDF, without
meshes; robots that walk have a free flyer. Columns:

- one call from Python of Ulna's kernel, of Pinocchio's function, their ratio, and of MuJoCo's functions, each computing all
  that the quantity needs of a new configuration (MuJoCo's mass matrix is sparse);
- one of 1,000 samples in a batch, beside a loop over Pinocchio; the same in float32; how many times as fast 8,192 samples
  are with two threads;
- how long the single call and the batch take to compile with an empty cache and with a full one, tracing included;
- what limits the single call and the batch, as `kernel.report()` estimates it.

A second table has what methods of robots cost beyond their kernels. Run it on a quiet machine; the whole table takes an
hour or more, since kernels of chains and humanoids are compiled three times. What is too large for a kernel is noted
below the table. CasADi's C stands beside exported C in export_c.py.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["ULNA_QUIET"] = "1"

import derivatives
import dynamics
import numpy as np
import pinocchio as pin
from _timing import medians, shown, table

from ulna import kernels
from ulna.errors import UlnaError
from ulna.loading import load_model
from ulna.model import Model
from ulna.robot import Robot
from ulna.robots import example_robot_data as data

try:
    import mujoco
except ImportError:
    mujoco = None

CHAINS = {"chain 100": 100, "chain 1000": 1000}
BATCH, MANY = 1_000, 8_192
FRAME = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
QUICK = ("fk", "jacobian", "inverse_dynamics", "mass_matrix", "forward_dynamics")


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

METHODS = {
    "fk": ("q",), "jacobian": ("q",), "gravity_forces": ("q",), "mass_matrix": ("q",), "inverse_dynamics": ("q", "v", "a"),
    "forward_dynamics": ("q", "v", "a"), "bias_forces": ("q", "v"), "frame_velocity": ("q", "v"), "manipulability": ("q",),
}  # fmt: skip
"""Methods of robots that have the names of their kernels, and their arguments."""


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
    """The robot in Ulna, Pinocchio, and MuJoCo, where it reads the file."""
    if label in CHAINS:
        path = chain_file(CHAINS[label], folder)
        return load_model(path), pin.buildModelFromUrdf(str(path)), mujoco_model(path, False)
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


def ready(robot: Robot, name: str, few: list[Any]) -> tuple[float, Any]:
    """Seconds until a kernel has answered one call and a batch, and the kernel."""
    kernels._made.clear()
    kernels._recent.clear()
    start = time.perf_counter()
    kernel = robot.kernel(name)
    kernel(*(array[0] for array in few))
    kernel(*few)
    return time.perf_counter() - start, kernel


def row(label: str, robot: Robot, peer: Any, theirs: dict[str, Any], name: str, quick: bool) -> list[str]:
    """One robot and one quantity."""
    count, function = PEERS[name]
    rng, memory = np.random.default_rng(0), peer.createData()
    most = BATCH if robot.nv > 99 else MANY
    many = [robot.random_configuration((most,), seed=1), *rng.standard_normal((2, most, robot.nv))][:count]
    few, one = [array[:BATCH] for array in many], [array[0].copy() for array in many]
    states = [
        [pin.randomConfiguration(peer), *rng.standard_normal((2, peer.nv))][:count]
        for _ in range(20 if robot.nv > 99 else 200)
    ]
    cold, kernel = ready(robot, name, [array[:2] for array in many])
    cached, kernel = ready(robot, name, [array[:2] for array in many])
    small = robot.kernel(name, dtype=np.float32)
    few32 = [array.astype(np.float32) for array in few]

    def loop() -> None:
        for state in states:
            function(peer, memory, *state)

    seconds, repeat = (0.005, 5) if quick else (0.02, 15)
    calls = [lambda: kernel(*one), lambda: function(peer, memory, *states[0]), lambda: None]
    if name in theirs:
        calls.append(theirs[name])
    single, pinocchio, empty, *other = medians(calls, repeat, seconds)
    batch, batch32, looped = medians(
        [lambda: kernel(*few), lambda: small(*few32), loop], repeat // 2 + 1, seconds
    )
    threads = [lambda: kernel(*many), lambda: kernel(*many, threads=2)]
    alone, two = (1.0, 1.0) if robot.nv > 99 else medians(threads, repeat // 2 + 1, seconds)
    single, pinocchio = max(single - empty, 1e-9), max(pinocchio - empty, 1e-9)
    reports = [] if quick else [kernel.report(), kernel.report(batch=True)]
    return [
        label, name, shown(single), shown(pinocchio), f"{pinocchio / single:.1f}",
        shown(other[0] - empty) if other else "", shown(batch / BATCH), f"{looped / len(states) / (batch / BATCH):.1f}",
        shown(batch32 / BATCH), f"{alone / two:.2f}" if robot.nv <= 99 else "", shown(cold), shown(cached),
        *([reports[0].limit, reports[1].limit] if reports else ["", ""]),
    ]  # fmt: skip


def rows(labels: list[str], names: list[str], quick: bool, notes: list[str]) -> Iterator[list[str]]:
    """All rows; what cannot be measured becomes a note."""
    for label in labels:
        with tempfile.TemporaryDirectory() as folder:
            os.environ["ULNA_CACHE"] = folder
            model, peer, other = models(label, folder)
            robot, theirs = Robot(model), {} if other is None else mujoco_calls(other)
            for name in names:
                print(f"{label}, {name} ...", file=sys.stderr, flush=True)
                try:
                    yield row(label, robot, peer, theirs, name, quick)
                except UlnaError as error:
                    notes.append(f"{label}, {name}: {type(error).__name__}, {str(error).split('. ')[0]}.")


def beyond(label: str, robot: Robot, quick: bool) -> list[list[str]]:
    """What methods cost beyond the kernels that they call."""
    rng = np.random.default_rng(0)
    values: dict[str, Any] = {"q": robot.random_configuration(seed=0)}
    values |= dict(zip("va", rng.standard_normal((2, robot.nv)), strict=True))
    result = []
    for name, arguments in METHODS.items():
        scope = {"robot": robot, "kernel": robot.kernel(name, checked=True), **values}
        listed = ", ".join(arguments)
        method, kernel = (eval(f"lambda: {f}({listed})", scope) for f in (f"robot.{name}", "kernel"))
        over, under = medians([method, kernel], 9 if quick else 41, 0.003)
        result.append(
            [label, f"robot.{name}({listed})", shown(over), shown(under), f"{(over - under) * 1e9:.0f} ns"]
        )
    return result


def main() -> None:
    """Prints the tables."""
    known = [*derivatives.ROBOTS, *CHAINS]
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="five quantities, few repetitions, no limits")
    parser.add_argument("--only", help=f"quantities, out of {', '.join(PEERS)}")
    parser.add_argument("robots", nargs="*", help=f"out of {', '.join(known)}; default all")
    given = parser.parse_args()
    names = given.only.split(",") if given.only else [*(QUICK if given.quick else PEERS)]
    for word, valid in [*((name, PEERS) for name in names), *((label, known) for label in given.robots)]:
        if word not in valid:
            parser.error(f"{word!r} is unknown; expected one of {', '.join(valid)}")
    labels, notes = given.robots or known, []
    found = list(rows(labels, names, given.quick, notes))
    head = ["robot", "quantity", "one call", "pin", "ratio", "MuJoCo", "in a batch", "ratio", "float32", "two threads",
            "compiled", "from cache", "limit", "limit of batch"]  # fmt: skip
    print(
        f"Python {sys.version.split()[0]}, NumPy {np.__version__}, pin {pin.__version__}, {platform.machine()}\n"
    )
    print(table(f"Speed: one call, and one of {BATCH:,} samples in a batch, one core", head, found))
    print("\n".join(notes))
    label = labels[0]
    with tempfile.TemporaryDirectory() as folder:
        costs = beyond(label, Robot(models(label, folder)[0]), given.quick)
    print(
        table(
            "What methods cost beyond their kernels", ["robot", "call", "method", "kernel", "beyond"], costs
        )
    )


if __name__ == "__main__":
    main()
