"""Spheres of the Panda on MotionBenchMaker's problems: how many starts and goals that are free are free by spheres too.

    python benchmarks/planning_spheres.py VAMP [MESHES]

VAMP is an unpacked source of VAMP (resources/panda with panda.urdf, panda.srdf and problems.tar.bz2); MESHES is a folder
with Franka's collision meshes link0.stl to hand.stl, by default that of the package example-robot-data. Both checks take
the same meshes. A problem counts if coal finds its start and its goal free.
"""

from __future__ import annotations

import re
import sys
import tarfile
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import ulna
from ulna.collision import Checker, SphereChecker, World, fit
from ulna.geometry import Box, Cylinder
from ulna.robots.example_robot_data import files as description
from ulna.spatial import SE3


def panda(resources: Path, meshes: Path) -> ulna.Robot:
    """VAMP's Panda with collision meshes as STL; its file names OBJ, which its source does not always hold."""
    text = (resources / "panda.urdf").read_text()
    text = re.sub(r"package://meshes/\w+/(\w+)\.obj", lambda m: f"{meshes}/{m[1]}.stl", text)
    with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
        file.write(text)
        file.flush()
        return ulna.load(file.name, srdf=str(resources / "panda.srdf"))


def problems(resources: Path, joints: list[str]) -> list[tuple[str, World, np.ndarray]]:
    """The name of the set, the world, and start and goal (2, 7) of each problem."""
    contents: dict[tuple[str, ...], Any] = {}
    with tarfile.open(resources / "problems.tar.bz2") as archive:
        for member in archive:
            found = re.search(r"(\w+)/(scene|request)(\d+)\.yaml$", member.name)
            if found and member.isfile():
                stream: Any = archive.extractfile(member)
                loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
                contents[found.groups()] = yaml.load(stream, Loader=loader)
    rows = []
    for (name, kind, number), scene in sorted(contents.items()):
        if kind == "scene":
            request = contents[name, "request", number]
            state = request["start_state"]["joint_state"]
            start = dict(zip(state["name"], state["position"], strict=True))
            goal = {
                c["joint_name"]: c["position"] for c in request["goal_constraints"][0]["joint_constraints"]
            }
            ends = np.array([[ends[joint] for joint in joints] for ends in (start, goal)], float)
            rows.append((name, world(scene["world"]["collision_objects"]), ends))
    return rows


def world(objects: list[dict[str, Any]]) -> World:
    found = World()
    for k, item in enumerate(objects):
        primitive, size = item["primitives"][0], item["primitives"][0]["dimensions"]
        at = pose(item["pose"]) if "pose" in item else SE3.identity()
        at = at @ pose(item["primitive_poses"][0])
        shape = Box(tuple(size)) if primitive["type"] == "box" else Cylinder(size[1], size[0])
        found = found.add(f"{item['id']} {k}", shape, at, touches=["panda_link0"])
    return found


def pose(item: dict[str, Any]) -> SE3:
    return SE3.from_quat_xyzw(np.array(item["orientation"], float), np.array(item["position"], float))


def main() -> None:
    warnings.simplefilter("ignore")
    resources = Path(sys.argv[1]) / "resources" / "panda"
    meshes = (
        Path(sys.argv[2])
        if len(sys.argv) > 2
        else description("panda")[0].parents[1] / "meshes" / "collision"
    )
    robot = panda(resources, meshes)
    start = time.perf_counter()
    spheres = fit(robot.model)
    print(f"{spheres.count} spheres in {time.perf_counter() - start:.2f} s (from the cache if there)")
    for name, link in spheres.links.items():
        print(
            f"  {name:18} {len(link.radii):3} spheres, at most {1e3 * (link.excess or 0.0):5.1f} mm outside"
        )
    free, both = Counter[str](), Counter[str]()
    for name, place, ends in problems(resources, [joint.name for joint in robot.model.joints]):
        if not Checker(robot.model, place).collides(ends).any():
            free[name] += 1
            both[name] += not SphereChecker(robot.model, place, spheres=spheres).collides(ends).any()
    for name in sorted(free):
        print(f"{name:28} {both[name]:4} of {free[name]:4}")
    total = sum(free.values())
    print(f"{'all':28} {sum(both.values()):4} of {total:4} = {100.0 * sum(both.values()) / total:.1f} %")


if __name__ == "__main__":
    main()
