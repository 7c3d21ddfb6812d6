"""The readers under test: for each a seed, a way to damage it, and what is done with what was read."""

from __future__ import annotations

import io
import os
import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import ulna
from fuzz.mutants import NUMBERS, binary_mutant, text_mutant
from ulna import trajectory
from ulna.formats.dh import DHRow, model_from_dh
from ulna.formats.ets import ETS
from ulna.robot import Robot
from ulna.viewer.mesh.mesh_files import load_mesh

URDF = """<?xml version="1.0"?>
<robot name="small">
  <material name="blue"><color rgba="0 0 0.8 1"/></material>
  <link name="base"><visual><geometry><box size="0.6 0.1 0.2"/></geometry><material name="blue"/></visual></link>
  <link name="arm"><inertial><origin xyz="0 0 0.1" rpy="0 0.2 0"/><mass value="1.5"/>
      <inertia ixx="0.1" ixy="0" ixz="0.01" iyy="0.2" iyz="0" izz="0.15"/></inertial>
    <visual><geometry><mesh filename="arm.stl" scale="1 1 1"/></geometry></visual>
    <collision><origin xyz="0 0 1" rpy="1 0 0"/><geometry><cylinder radius="0.1" length="1"/></geometry></collision></link>
  <link name="hand"/><link name="left"/><link name="free"/>
  <joint name="shoulder" type="revolute"><origin xyz="0 0 0.5" rpy="0 1.5 0"/><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" velocity="2" effort="10"/><dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/><axis xyz="0.6 0 0.8"/></joint>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" velocity="1" effort="5"/><mimic joint="wrist" multiplier="2" offset="0.1"/></joint>
  <joint name="flight" type="floating"><parent link="base"/><child link="free"/></joint>
</robot>"""
XACRO = URDF.replace('name="small">', 'name="small" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
    '<xacro:property name="size" value="0.3"/><xacro:arg name="side" default="left"/>'
    '<xacro:macro name="tip" params="on *place"><link name="${on}_tip"/><joint name="${on}_t" type="fixed">'
    '<parent link="${on}"/><child link="${on}_tip"/><xacro:insert_block name="place"/></joint></xacro:macro>'
    '<xacro:tip on="hand"><origin xyz="0 0 ${size * 2}"/></xacro:tip>'
    '<xacro:if value="${size > 0.1}"><link name="$(arg side)_x"/><joint name="x" type="fixed"><parent link="hand"/>'
    '<child link="$(arg side)_x"/></joint></xacro:if>', 1)  # fmt: skip
SRDF = """<robot name="small"><group name="g"><joint name="shoulder"/><link name="arm"/>
<chain base_link="base" tip_link="hand"/><group name="h"/></group><group name="h"><joint name="wrist"/></group>
<group_state name="rest" group="g"><joint name="shoulder" value="0.5"/><joint name="flight" value="0 0 1 0 0 0 1"/></group_state>
<end_effector name="e" parent_link="hand" group="h"/><virtual_joint name="v" type="floating" parent_frame="w" child_link="base"/>
<disable_collisions link1="base" link2="arm" reason="Adjacent"/><passive_joint name="wrist"/>
<rotor_params><joint name="shoulder" mass="0.1" gear_ratio="50"/></rotor_params></robot>"""
MJCF = """<mujoco model="m"><compiler angle="radian"/><option gravity="0 0 -9.81"><flag contact="enable"/></option>
<default><joint damping="0.1" armature="0.01"/><default class="c"><geom rgba="1 0 0 1"/></default></default>
<asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><material name="k" rgba="0 1 0 1"/></asset>
<worldbody><geom type="plane" size="1 1 .1"/><body name="a" pos="0 0 1" euler="0.1 0 0"><freejoint name="f"/>
<geom name="g" type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02" material="k"/><site name="s" pos="0 0 -0.5"/>
<body name="b" pos="0 0 -0.5"><joint name="j1" axis="0 1 0" range="-1 1" ref="0.1"/><joint name="j2" type="slide" axis="1 0 0"/>
<geom class="c" type="mesh" mesh="t"/><inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
<body name="c"><joint name="j3" type="ball"/><geom size="0.1"/></body></body></body>
<replicate count="2" offset="1 0 0"><body name="r"><joint axis="0 0 1"/><geom size="0.1"/></body></replicate></worldbody>
<equality><joint joint1="j1" joint2="j2" polycoef="0 1 0 0 0"/><connect body1="b" body2="r0" anchor="0 0 0"/></equality>
<contact><exclude body1="a" body2="b"/></contact><actuator><motor joint="j1" forcerange="-1 1" forcelimited="true"/></actuator>
<keyframe><key name="k" qpos="0 0 1 1 0 0 0 0 0 1 0 0 0 0 0"/></keyframe></mujoco>"""


@dataclass(frozen=True)
class Reader:
    """A reader under test.

    Attributes:
        mutant: A damaged document, as the bytes of a file.
        use: Reads the file and computes with what was read; raises AssertionError where that is no good.
        ending: How the file's name ends.
    """

    mutant: Callable[[random.Random], bytes]
    use: Callable[[Path], None]
    ending: str


def use_robot(path: Path) -> None:
    """Load a robot, compile its forward kinematics, and call it."""
    compute(ulna.load(path))


def compute(robot: Robot) -> None:
    """Forward kinematics at the neutral and at a random configuration are finite."""
    model = robot.model
    assert np.isfinite(np.asarray(robot.fk(model.neutral))).all(), "fk at neutral is not finite"
    q = robot.random_configuration(seed=0)
    assert np.isfinite(np.asarray(robot.fk(q))).all(), f"fk is not finite at {q}"


def use_srdf(path: Path) -> None:
    """Load a robot with an SRDF beside it."""
    robot = ulna.load(
        URDF.replace('<mesh filename="arm.stl" scale="1 1 1"/>', '<sphere radius="1"/>'), srdf=path
    )
    for name in robot.configurations:
        assert np.isfinite(np.asarray(robot.fk(robot.configurations[name]))).all(), name


def use_mesh(path: Path) -> None:
    """Read the surfaces of a mesh."""
    for surface in load_mesh(str(path), (1.0, 1.0, 1.0), "full"):
        assert np.isfinite(surface.vertices).all(), "vertices are not finite"
        assert surface.triangles.min() >= 0 and surface.triangles.max() < len(surface.vertices), "indices"


def use_trajectory(path: Path) -> None:
    """Load a trajectory and evaluate it."""
    found = trajectory.load(path)
    for t in (0.0, 0.5 * found.duration, found.duration):
        assert np.asarray(found(t)).shape == found.space.shape


def use_dh(path: Path) -> None:
    """A Denavit-Hartenberg table with rows of text, which become numbers."""
    rows: list[Any] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        values = [_number(word) for word in line.split()]
        rows.append(values if len(values) != 5 else DHRow(*values[:4], limits=(values[4], 2.0)))  # type: ignore[arg-type]
    compute(Robot(model_from_dh(rows)))


def _number(word: str) -> Any:
    try:
        return float(word)
    except ValueError:
        return None if word == "None" else word


def use_ets(path: Path) -> None:
    """A chain of elementary transforms, written down."""
    compute(Robot(ETS.parse(path.read_text(encoding="utf-8")).model()))


def dh_mutant(rng: random.Random) -> bytes:
    """A table with some numbers exchanged."""
    rows = [
        [f"{rng.uniform(-2, 2):.3g}" for _ in range(rng.choice((4, 4, 4, 5, 3, 0)))]
        for _ in range(rng.randrange(5))
    ]
    for row in rows:
        if row and rng.random() < 0.3:
            row[rng.randrange(len(row))] = rng.choice([*NUMBERS, "None", "a"]) or "x"
    return "\n".join(" ".join(row) for row in rows).encode()


def ets_mutant(rng: random.Random) -> bytes:
    """A chain with some steps exchanged."""
    values = [
        "q",
        "q0",
        "q1",
        "-q2",
        "q9999999",
        "90 deg",
        "pi/2",
        "-3*pi/4",
        "0.5",
        "1e49",
        "q" * 50,
        "pi/0",
        *NUMBERS,
    ]
    values = values if rng.random() < 0.5 else ["q", "q", "0.5", "90 deg", "-pi/2"]
    steps = [
        f"{rng.choice(('tx', 'Ry', 'rz', 'tz', 'Rx'))}({rng.choice(values)})"
        for _ in range(rng.randrange(1, 7))
    ]
    text = rng.choice((" ", " * ", "")).join(steps).encode()
    text = text if rng.random() < 0.8 else binary_mutant(text, rng)
    return text.decode("utf-8", errors="replace").encode()


def _mesh(kind: str) -> Callable[[random.Random], bytes]:
    import trimesh

    shape = trimesh.creation.icosphere(subdivisions=1)
    exported: Any = shape.export(file_type=kind)
    seed: bytes = exported if isinstance(exported, bytes) else exported.encode()
    if kind == "dae":
        return lambda rng: text_mutant(seed.decode(), rng) if rng.random() < 0.7 else binary_mutant(seed, rng)
    return lambda rng: binary_mutant(seed, rng)


def _npz(rng: random.Random) -> bytes:
    """A saved trajectory with arrays exchanged, or with its bytes damaged."""
    file = io.BytesIO()
    made = trajectory.quintic([0.0, 1.0], [1.0, 2.0], 2.0)
    arrays: dict[str, Any] = {
        "times": made.times,
        "coefficients": made.coefficients,
        "names": np.array(made.space.names),
        "kind": np.array(["ulna trajectory 1", made.kind]),
    }
    others = [
        np.zeros(3),
        np.array("x"),
        np.array([1, np.nan]),
        np.zeros((0, 2)),
        np.zeros((1, 100, 2)),
        np.array(["a", "b", "c"]),
        np.array([0.0, -1.0]),
    ]
    if rng.random() < 0.7:
        arrays[rng.choice(list(arrays))] = rng.choice(others)
    np.savez(file, **arrays)
    return file.getvalue() if rng.random() < 0.5 else binary_mutant(file.getvalue(), rng)


def _csv(rng: random.Random) -> bytes:
    rows = [["t", "q0", "v_q0", "a_q0"], *([f"{k * 0.1:g}", "1", "0", "0"] for k in range(4))]
    for _ in range(rng.choice((0, 1, 3))):
        row = rng.choice(rows)
        row[rng.randrange(len(row))] = rng.choice(NUMBERS)
    text = "\n".join(",".join(row) for row in rows).encode()
    return text if rng.random() < 0.6 else binary_mutant(text, rng)


def reader(name: str) -> Reader:
    """The reader of that name."""
    made: dict[str, Callable[[], Reader]] = {
        "urdf": lambda: Reader(lambda rng: text_mutant(URDF, rng), use_robot, ".urdf"),
        "xacro": lambda: Reader(lambda rng: text_mutant(XACRO, rng), use_robot, ".xacro"),
        "mjcf": lambda: Reader(lambda rng: text_mutant(MJCF, rng), use_robot, ".xml"),
        "srdf": lambda: Reader(lambda rng: text_mutant(SRDF, rng), use_srdf, ".srdf"),
        "dh": lambda: Reader(dh_mutant, use_dh, ".txt"),
        "ets": lambda: Reader(ets_mutant, use_ets, ".txt"),
        "npz": lambda: Reader(_npz, use_trajectory, ".npz"),
        "csv": lambda: Reader(_csv, use_trajectory, ".csv"),
        **{
            kind: (lambda kind=kind: Reader(_mesh(kind), use_mesh, f".{kind.removesuffix('_ascii')}"))
            for kind in MESHES
        },
    }
    return made[name]()


MESHES = ("stl", "stl_ascii", "obj", "ply", "glb", "dae")
NAMES = ("urdf", "xacro", "mjcf", "srdf", "dh", "ets", "npz", "csv", *MESHES)
os.environ.setdefault("ULNA_CACHE", "0")
