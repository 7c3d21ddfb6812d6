"""What every call that draws puts into the scene, what handles read back, and what is refused, as text."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import ulna
from support.transcripts import compare, transcript
from ulna.geometry import Box, Sphere
from ulna.robots.catalogue import build_bundled
from ulna.viewer.graph.camera import Camera, camera_for
from ulna.viewer.graph.content import Copies, Lines, Points, Text, transforms

CALLS = """
v.box((1, 2, 3))
v.box((1, 2, 3), name="crate", pose=(1, 2, 3), color="red", opacity=0.5)
v.box((1, 2, 3), name="crate/lid", pose=turned, color=(0.1, 0.2, 0.3))
v.box((1, 2))
v.box((1, 2, -3))
v.box((1, 2, 3), colour="red")
v.box((1, 2, 3), opacity=1.5)
v.box((1, 2, 3), name="a//b")
v.sphere(0.5)
v.sphere(0.25)
v.ellipsoid((1, 2, 3))
v.cylinder(0.5, 2.0)
v.capsule(0.5, 2.0)
v.cone(0.5, 2.0)
v.add(Box((1, 1, 1)), name="from shape")
v.add(3)
v.group("g", pose=(0, 0, 1))
v.axes()
v.axes(0.5, name="g/axes", pose=turned, opacity=0.5)
v.arrow((0, 0, 2))
v.arrow((3, 4, 0), (1, 1, 1), name="g/force", color="blue", radius=0.01, size=0.1)
v["g/force"].vector
v["g/force"].size
setattr(v["g/force"], "vector", (0, 1, 0))
setattr(v["g/force"], "vector", (0, 0, 0))
setattr(v["g/force"], "size", 0.5)
setattr(v["g/force"], "size", 0.0)
v.line([(0, 0, 0), (1, 0, 0), (1, 1, 0)])
v.line([(0, 0, 0), (1, 0, 0)], name="wire", color="green", thickness=0.01, opacity=0.25)
v["wire"].points
setattr(v["wire"], "points", [(0, 0, 0), (0, 0, 5)])
v.curve([(0, 0, 0), (1, 0, 0), (1, 1, 0)], steps=3)
v.curve([(0, 0, 0), (1, 0, 0)], steps=3)
v.curve([(0, 0, 0), (1, 0, 0), (1, 1, 0)], steps=0)
v.points([(0, 0, 0), (1, 0, 0)])
v.points([(0, 0, 0), (1, 0, 0)], name="cloud", colors=[(1, 0, 0), (0, 1, 0)], size=0.05)
v["cloud"].points
v["cloud"].colors
setattr(v["cloud"], "points", [(2, 0, 0), (3, 0, 0)])
setattr(v["cloud"], "points", [(2, 0, 0)])
setattr(v["cloud"], "colors", (0, 0, 1))
v["cloud"].set([(2, 0, 0)], [(1, 1, 1)])
v.points([(0, 0, 0), (1, 0, 0)], colors=[(1, 0, 0)])
v.text("words")
v.text("more", name="sign", height=0.2, pose=(1, 2, 3), color="red")
v["sign"].text
setattr(v["sign"], "text", "other")
v.grid()
v.grid(2.0, 0.5, name="lattice", color="red")
v.copies(Sphere(0.1), [(0, 0, 0), (1, 0, 0)])
v.copies(Sphere(0.1), transforms([(0, 0, 0), (1, 0, 0)]), scales=2.0)
v.copies(Box((0.1, 0.1, 0.1)), transforms([(0, 0, 0), (1, 0, 0)]), name="many", colors=[(1, 0, 0), (0, 1, 0)])
v["many"].positions
v["many"].colors
v["many"].poses
setattr(v["many"], "positions", [(5, 0, 0), (6, 0, 0)])
setattr(v["many"], "positions", [(5, 0, 0)])
setattr(v["many"], "colors", None)
setattr(v["many"], "poses", np.stack([turned, turned]))
v["crate"].pose
v["crate"].position
v["crate/lid"].world_pose
v["crate"].color
v["crate"].opacity
v["crate"].scale
v["crate"].visible
setattr(v["crate"], "pose", turned)
setattr(v["crate"], "position", (4, 5, 6))
setattr(v["crate"], "color", "white")
setattr(v["crate"], "color", None)
setattr(v["crate"], "opacity", 0.125)
setattr(v["crate"], "scale", 2.0)
setattr(v["crate"], "scale", (1, 2, 3))
setattr(v["box"], "scale", (1, 2, 3))
setattr(v["box"], "scale", (0, 2, 3))
setattr(v["crate"], "visible", False)
setattr(v["crate"], "visible", 3)
v["nothing"]
"crate" in v
"crate/nothing" in v
repr(v["crate"])
repr(v["wire"])
v.scene.names
v.scene.floor()
len(v.scene.points())
len(v.scene.points(100))
camera_for(v.scene).position
camera_for(v.scene, 1.5).target
v.remove("crate")
v.remove("crate")
v.remove(v["wire"])
v.add(arm, name="arm")
setattr(v["arm"], "q", q)
setattr(v["arm"], "q", "qz")
setattr(v["arm"], "q", [1, 2])
v["arm"].tool
v["arm"].show
setattr(v["arm"], "show", "skeleton")
setattr(v["arm"], "show", "collision")
setattr(v["arm"], "show", "nothing")
v["arm"].frames(["tool0"], 0.1)
v["arm"].frames("nothing")
v["arm"].center_of_mass(0.05)
v["arm"].inertias()
v["arm"].manipulability()
v["arm"].manipulability("tool0", 0.1, "force")
v["arm"].manipulability(of="nothing")
v["arm"].trace()
v["arm"].force((0, 0, 10))
v["arm"].velocity()
v["arm"].ghosts([q, 0 * q])
setattr(v["arm"], "q", 0.5 * q)
v["arm"].moves
v.fleet(arm, [q, 0 * q], name="fleet")
v.remove("arm")
v.clear()
v.scene.names
repr(v)
v.nothing
Points([(0, 0, 0), (1, 2, 3)], (1, 0, 0), 0.1).surfaces[0].vertices
len(Points(np.zeros((50, 3)), np.linspace(0, 1, 150).reshape(50, 3)).surfaces)
len(Points(np.arange(90000.0).reshape(30000, 3) / 1e5, (1, 0, 0)).surfaces[0].triangles)
Points([(0, 0, 0), (1, 2, 3)], (1, 0, 0), 0.1).as_balls.poses[1]
Points([(0, 0, 0)], [(1, 0, 0), (0, 1, 0)])
Lines.through([(0, 0, 0), (1, 0, 0), (1, 2, 0)], "red", 0.1).segments
Lines.through([(0, 0, 0), (0, 0, 2)], "red", 0.2).surfaces[0].vertices
Lines.through([(0, 0, 0), (2, 0, 0)], "red", 0.2).surfaces[0].normals
Lines.through([(0, 0, 0), (2, 0, 0)], "red", 0.2).surfaces[0].triangles
Text("a", 0.0)
Text(3)
copies.bounding_points
[s.vertices[-1] for s in copies.surfaces]
[s.rgba for s in copies.surfaces]
Copies((), transforms([(0, 0, 0)])).bounding_points
transforms([(1, 2, 3)], [(0, 0, 1, 1)])
transforms([(1, 2, 3)], [(0, 0, 1, 1), (0, 0, 0, 1)])
Camera((1, 2, 3), (0, 0, 0)).axes()
Camera((1, 2, 3), (1, 2, 3))
Camera((1, 2, 3), (0, 0, 0), fov=4.0)
""".strip().splitlines()


def test_what_every_call_draws_reads_and_refuses() -> None:
    viewer = ulna.Viewer(page=False)
    arm = ulna.Robot(build_bundled("ur5", visuals="simple"))
    turned = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    octahedron = Points([(0, 0, 0)], (1, 0, 0), 2.0).surfaces
    copies = Copies(octahedron, transforms([(1, 0, 0), (0, 2, 0)]), None, (1.0, 2.0, 3.0), 0.5)
    names = {"v": viewer, "turned": turned, "arm": arm, "q": np.linspace(0.1, 0.6, 6), "copies": copies}
    names |= {"Box": Box, "Sphere": Sphere, "Points": Points, "Lines": Lines, "Text": Text, "Copies": Copies}
    names |= {"Camera": Camera, "camera_for": camera_for, "transforms": transforms}
    text = transcript(CALLS, names, viewer.scene)
    compare(Path(__file__).parent / "scene_transcript.txt", text)
