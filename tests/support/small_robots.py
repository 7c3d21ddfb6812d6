"""Small robots for the tests of models."""

from __future__ import annotations

import math

from ulna.geometry import Box, Geometry, Material, Mesh
from ulna.model import Fixed, Model, ModelBuilder, Prismatic, Revolute
from ulna.spatial import SE3, Inertia


def arm_builder(name: str = "arm", mesh: str = "meshes/base.stl") -> ModelBuilder:
    """Two revolute joints and a slide with a fixed hand, and two fingers of which one mimics the other."""
    b = ModelBuilder(name, source="arm.urdf")
    b.add_link("base", Inertia.from_box(2.0, (1.0, 1.0, 1.0)), [Geometry("g", Mesh(mesh))])
    paint = Material("blue", (0.0, 0.0, 1.0, 1.0))
    for i in range(3):
        shape = Geometry("", Box((0.1, 0.1, 0.4)), SE3.trans(0.0, 0.0, 0.2), paint)
        b.add_link(
            f"link{i}",
            Inertia.from_com(1.0 + i, (0.0, 0.1, 0.2), (0.1, 0, 0, 0.2, 0, 0.15)),
            [shape],
            [shape],
        )
    quarter = SE3.from_rpy((math.pi / 2, 0.0, 0.0), (0.0, 0.0, 0.3))
    b.add_joint(
        "j0", Revolute((0, 0, 1)), "base", "link0", quarter, lower=-1.0, upper=2.0, velocity=3.0, effort=20.0
    )
    b.add_joint("j1", Prismatic((1, 1, 0)), "link0", "link1", quarter, lower=-0.5, upper=0.5, damping=0.1)
    b.add_joint("j2", Revolute((0, 1, 0)), "link1", "link2", quarter, friction=0.2, armature=0.01)
    b.add_link("hand", Inertia.from_point(0.5, (0.0, 0.0, 0.1)))
    b.add_joint("wrist", Fixed(), "link2", "hand", SE3.from_rpy((0.0, 0.0, 0.5), (0.0, 0.0, 0.1)))
    b.add_link("left", Inertia.from_point(0.1)).add_link("right", Inertia.from_point(0.1))
    b.add_joint(
        "grip", Prismatic((0, 1, 0)), "hand", "left", SE3.trans(0.0, 0.02, 0.1), lower=0.0, upper=0.04
    )
    b.add_joint(
        "grip2", Prismatic((0, 1, 0)), "hand", "right", SE3.trans(0.0, -0.02, 0.1), mimic=("grip", -1.0, 0.01)
    )
    b.add_frame("tcp", "hand", SE3.from_rpy((0.0, 0.3, 0.0), (0.0, 0.0, 0.2)), kind="tool").set_tool("tcp")
    b.add_frame("camera", "link1", SE3.trans(0.1, 0.0, 0.0))
    b.add_configuration("home", {"j0": 1.0, "j2": -0.5, "grip": 0.02})
    b.add_configuration("zero", [0.0, 0.0, 0.0, 0.0])
    b.disable_pair("left", "hand").disable_pair("hand", "right")
    b.add_group("all", ["j0", "j1", "j2", "wrist"]).add_group("fingers", ["grip"])
    return b


def arm() -> Model:
    """The model of it."""
    return arm_builder().build()


def gripper() -> Model:
    """A palm with one finger."""
    b = ModelBuilder("gripper")
    b.add_link("palm", Inertia.from_point(0.3)).add_link("finger", Inertia.from_point(0.1))
    b.add_joint(
        "close", Prismatic((0, 1, 0)), "palm", "finger", SE3.trans(0.0, 0.0, 0.1), lower=0.0, upper=0.05
    )
    b.add_configuration("open", [0.05]).add_configuration("home", [0.01])
    return b.add_frame("pinch", "palm", SE3.trans(0.0, 0.0, 0.15)).set_tool("pinch").build()
