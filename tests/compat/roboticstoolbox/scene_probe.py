"""Questions about scenes, distances, closed forms, text and URDF files, asked of the toolbox and of its face alike."""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

Q = np.random.default_rng(2).uniform(-1.0, 1.0, (4, 3))

URDF = """<robot name="crane">
<link name="base"/>
<link name="turn"><inertial><origin xyz="0.1 0.02 0.2" rpy="0.1 0.2 0.3"/><mass value="2"/>
 <inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial></link>
<link name="boom"><inertial><origin xyz="0.3 0 0"/><mass value="1.5"/>
 <inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="trolley"><inertial><mass value="0.5"/>
 <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="hook"/>
<joint name="a" type="revolute"><parent link="base"/><child link="turn"/><origin xyz="0 0 0.5" rpy="0 0 0.2"/>
 <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="5" velocity="1.5"/></joint>
<joint name="b" type="revolute"><parent link="turn"/><child link="boom"/><origin xyz="0.1 0 0.3" rpy="0.1 0 0"/>
 <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="1"/></joint>
<joint name="c" type="prismatic"><parent link="boom"/><child link="trolley"/><origin xyz="0.2 0 0"/>
 <axis xyz="1 0 0"/><limit lower="0" upper="1" effort="5" velocity="0.5"/></joint>
<joint name="d" type="fixed"><parent link="trolley"/><child link="hook"/><origin xyz="0 0 -0.4" rpy="0 0.3 0"/></joint>
</robot>
"""


def _arm(rtb: Any, sm: Any) -> Any:
    """Two turns and a slide with shapes to draw and to check."""
    sg: Any = import_module("spatialgeometry")
    ET, Link = rtb.ET, rtb.Link
    ball = sg.Sphere(0.1, pose=sm.SE3(0.05, 0, 0.1))
    box = sg.Cuboid([0.5, 0.1, 0.2], pose=sm.SE3(0.3, 0, 0) * sm.SE3.Rx(0.3))
    a = Link(ET.tz(0.2) * ET.Rz(jindex=0), name="a", collision=[ball], geometry=[sg.Sphere(0.2)])
    b = Link(
        ET.tx(0.3) * ET.Ry(jindex=1),
        name="b",
        parent=a,
        collision=[box],
        geometry=[sg.Cuboid([0.5, 0.1, 0.2])],
    )
    c = Link(ET.tx(0.6) * ET.tx(jindex=2, qlim=[0, 1]), name="c", parent=b, collision=[sg.Sphere(0.08)])
    return rtb.Robot([a, b, c], name="arm")


def distances(rtb: Any, sm: Any) -> dict[str, Any]:
    """Distances of a robot and of its links from shapes, and the bounds that are made of them."""
    sg: Any = import_module("spatialgeometry")
    robot = _arm(rtb, sm)
    out: dict[str, Any] = {}
    for i, q in enumerate(Q):
        shapes = (
            sg.Sphere(0.1, pose=sm.SE3(0.9, 0.3, 0.5)),
            sg.Cuboid([0.2, 0.3, 0.4], pose=sm.SE3(0.4, -0.5, 0.6) * sm.SE3.Rz(0.4)),
        )
        robot.q = q
        for k, shape in enumerate(shapes):
            key = f"{i} {k}"
            d, p, w = robot.closest_point(q, shape, 5.0)
            out[f"{key} distance"], out[f"{key} touches"] = d, bool(robot.iscollided(q, shape))
            if d > 0.0 and k == 0:  # where the nearest points are single ones
                out[f"{key} points"] = np.array([p, w])
            for link in robot.links:
                out[f"{key} link {link.name}"] = link.closest_point(shape, 5.0)[0]
                out[f"{key} link {link.name} touches"] = bool(link.iscollided(shape))
            shape.v = [0.2, -0.1, 0.3, 0.0, 0.0, 0.0]
            _, b = robot.link_collision_damper(shape, q, di=5.0, ds=0.05, xi=2.0)
            if d > 0.0 and k == 0:  # A is not compared: theirs mixes the axes of link and world
                out[f"{key} damper"] = np.ravel(b)
            out[f"{key} far"] = [str(x) for x in robot.closest_point(q, shape, 1e-3)] if d > 0.01 else []
        A, b = robot.joint_velocity_damper(np.array([3.1, 0.2, 0.06]))
        out[f"{i} joints"] = np.column_stack([A, b])
        seen = sg.Sphere(0.02, pose=sm.SE3(0.9, 0.5, 0.2))
        seen.v = [0.1, 0.2, 0.3, 0, 0, 0]
        A, b = robot.vision_collision_damper(seen, camera=sm.SE3(0.2, 0.9, 1.2), q=q, di=5.0)
        rows = np.column_stack([A, np.ravel(b)])
        out[f"{i} sight"] = rows[[0, 2]]  # those of balls, whose nearest points are single ones
        out[f"{i} geometry"] = np.array([T.A for T in robot.fkine_geometry(q, 1.0, 1.0)])
    return out


def scene(rtb: Any, sm: Any) -> dict[str, Any]:
    """Shapes on links, robots on links, and where that puts them."""
    sg: Any = import_module("spatialgeometry")
    out: dict[str, Any] = {}
    arm, other = _arm(rtb, sm), rtb.models.DH.Puma560()
    arm.base = sm.SE3(0.1, 0.2, 0.3) * sm.SE3.Rz(0.3)
    ball = sg.Sphere(0.05, pose=sm.SE3(0, 0, 0.1))
    ball.attach_to(arm.links[1])
    flag = sg.Cuboid([0.1, 0.1, 0.1], pose=sm.SE3(0.3, 0, 0))
    arm.links[2].attach(flag)
    arm.attach(mast := sg.SceneNode(pose=np.asarray(sm.SE3(0, 0, 1).A)))
    other.attach_to(arm.links[2])
    for i, q in enumerate(Q):
        arm.q = q
        if hasattr(arm, "_update_link_tf"):
            arm._update_link_tf(q)  # which env.step does there
        arm.update()
        for name, node in (("ball", ball), ("flag", flag), ("mast", mast), ("other", other), ("arm", arm)):
            out[f"{name} {i}"], out[f"{name} T {i}"] = np.array(node._wT), np.array(node.T)
        out[f"links {i}"] = np.array([np.asarray(link._wT) for link in arm.links])
        out[f"local {i}"] = np.array([np.asarray(link.T) for link in arm.links])
    out["parents"] = [str(x.scene_parent is y) for x, y in ((ball, arm.links[1]), (other, arm.links[2]))]
    out["chain"] = [
        str(link.scene_parent is before) for link, before in zip(arm.links, [arm, *arm.links], strict=False)
    ]
    out["holds"] = [str(ball in arm.links[1].scene_children), str(mast in arm.scene_children)]
    arm.T = sm.SE3(2, 0, 0)
    out["moved"] = np.asarray(arm.base.A)
    out["tree"] = [str("sphere" in arm.tree().lower()), str("cuboid" in arm.links[1].tree_children().lower())]
    return out


def shapes(rtb: Any, sm: Any) -> dict[str, Any]:
    """What shapes tell of themselves."""
    sg: Any = import_module("spatialgeometry")
    T = sm.SE3(0.1, 0.2, 0.3) * sm.SE3.Rx(0.4)
    out: dict[str, Any] = {}
    solids = (
        sg.Cuboid([0.1, 0.2, 0.3], pose=T, color="red"),
        sg.Box([0.1, 0.2, 0.3], pose=T, color=[10, 20, 30]),
        sg.Sphere(0.2, pose=T, color=[0.1, 0.2, 0.3, 0.4]),
        sg.Cylinder(0.1, 0.5, pose=T, color="#204060"),
    )
    others = (sg.Ellipsoid([0.1, 0.2, 0.3], pose=T), sg.Axes(0.3, pose=T), sg.Arrow(0.4, pose=T))
    for k, shape in enumerate((*solids, *others)):
        kind = f"{k} {type(shape).__name__}"
        out[f"{kind} words"] = [
            shape.stype,
            str(shape.collision),
            str(shape.scene_parent),
            str(shape.scene_children),
        ]
        out[f"{kind} look"] = np.array([*shape.color, shape.opacity]) if k != 5 else np.zeros(0)
        out[f"{kind} place"] = np.array(
            [*shape.fk_dict()["t"], *shape.fk_dict()["q"], *np.ravel(shape.T), *shape.v]
        )
        out[f"{kind} described"] = [shape.to_dict()["stype"]]
        if k < len(solids):
            for world in (False, True):
                out[f"{kind} {world}"] = shape.extents(world=world)
                out[f"{kind} bounds {world}"] = shape.bounds(world=world)
                out[f"{kind} corners {world}"] = np.sort(shape.corners(world=world), axis=1)
            twin, same = shape.copy(), shape.copy()  # theirs cannot be copied after the first collision
            twin.set_alpha(0.25)
            twin.T = sm.SE3(1.0, 0.5, 0.2)
            out[f"{kind} twin"] = np.array([twin.opacity, shape.opacity, *np.ravel(twin.T)])
            out[f"{kind} away"] = shape.closest_point(twin, 10.0)[0]
            out[f"{kind} touches"] = [str(shape.iscollided(twin)), str(shape.iscollided(same))]
    group = sg.CollisionShapeGroup([solids[0], solids[2]])
    group.T = sm.SE3(0, 0, 1)
    group.update()
    out["group"] = np.array([len(group), *np.ravel(solids[0]._wT)])
    out["apart"] = group.closest_point(sg.Sphere(0.1, pose=sm.SE3(2, 0, 1)), 10.0)[0]
    scene = sg.SceneGroup([sg.SceneNode(pose=T.A)])
    out["node"] = np.array(scene[0].T)
    line = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 2.0]])
    out["line"] = np.array([sg.Path(line).points, sg.Polyline(line).points])
    return out


def closed(rtb: Any, sm: Any) -> dict[str, Any]:
    """Closed forms of the Puma 560 by the words for its branches, and axes as functions."""
    out: dict[str, Any] = {}
    draw, puma = np.random.default_rng(0), rtb.models.DH.Puma560()
    puma.base, puma.tool = sm.SE3(1, 2, 3) * sm.SE3.Rx(0.3), sm.SE3(0, 0, 0.1) * sm.SE3.Ry(0.2)
    for k in range(4):
        T = puma.fkine(draw.uniform(-3.0, 3.0, 6))
        for config in ("", "l", "r", "ru", "rd", "lun", "luf", "ldn", "ldf", "run", "ruf", "rdn", "rdf"):
            found = puma.ikine_a(T, config)
            out[f"{k} {config}"] = _angles(found.q)
            out[f"{k} {config} reached"] = [str(bool(found.success))]
    puma.base = puma.tool = sm.SE3()
    far = puma.ikine_a(sm.SE3(5, 0, 0))
    out["far"], out["far words"] = far.q, [str(far.success), far.reason]
    both = puma.ikine_a(sm.SE3([puma.fkine(puma.qn), sm.SE3(5, 0, 0)]))
    out["two"], out["two words"] = both.q, [str(both.success)]
    out["validated"] = [puma.config_validate(c, ("lr", "ud", "nf")) for c in ("", "r", "fd")]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for config in ("lun", "luf", "rdf"):
            found = puma.ikine_6s(puma.fkine([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]), config, _first)
            out[f"6s {config}"] = _angles(found.q)
    for i, et in enumerate((rtb.ET.Rx(), rtb.ET.tz(0.3), rtb.ET2.R(), rtb.ET2.tx(2))):
        out[f"axis {i}"] = et.axis_func(0.3)
    out["no axis"] = [str(rtb.ET.SE3(sm.SE3(1, 2, 3)).axis_func)]
    puma.delete_rne()
    out["again"] = puma.gravload(puma.qn)
    return out


def _first(robot: Any, T: Any, config: str) -> Any:
    return robot.ikine_a(T, config).q[:3]


def _angles(q: Any) -> Any:
    """Angles without their whole turns."""
    return np.array([np.cos(q), np.sin(q)])


def text(rtb: Any, sm: Any) -> dict[str, Any]:
    """Chains as text, data files and settings."""
    out: dict[str, Any] = {}
    for name, f, chain, q, options in (
        (
            "3",
            rtb.trchain,
            "Rx(q1)Tz(2*a+1) Ry(-q2/2) Tx(sin(pi/3)) Rz(30*pi/180)",
            [0.3, 0.4],
            {"variables": {"a": 2.0}},
        ),
        ("degrees", rtb.trchain, "Rz(q1) Tx(q2) Rx(10)", [30, 0.4], {"unit": "deg"}),
        ("2", rtb.trchain2, "R(q1) Tx(1) R(q2**2) Ty(2) Rz(0.1)", [0.3, 0.4], {}),
        ("other", rtb.trchain, "Rz(th1)Tx(f(2))", [1.0], {"qvar": "th", "variables": {"f": lambda x: x * x}}),
    ):
        out[name] = f(chain, q, **options)
        _, tokens = f(chain, q, return_tokens=True, **options)
        out[f"{name} tokens"] = [f"{t.op} {t.arg} {t.index}" for t in tokens]
        out[f"{name} again"] = f(tokens, q, **options)
    for bad in ("Rx(q3)", "Rx(", "Rx(import)", "Rw(1)", "Rx(nothing)"):
        refused = False
        try:
            rtb.trchain(bad, [1.0])
        except Exception:
            refused = True
        out[f"bad {bad}"] = [str(refused)]
    rtb.rtb_set_param("own", 3)
    out["settings"] = [str(rtb.rtb_get_param("own")), str(rtb.rtb_get_param("unicode"))]
    if find_spec("rtbdata") is not None:
        out["mat"] = [name for name in sorted(rtb.rtb_load_matfile("data/house.mat")) if name[0] != "_"]
        out["json"] = sorted(rtb.rtb_load_jsonfile("data/queensland.json"))
        out["data"] = [str(len(rtb.rtb_load_data("data/house.mat", lambda path: path.read_bytes())))]
        out["path"] = [rtb.rtb_path_to_datafile("data/house.mat").name]
    return out


def calls(rtb: Any, sm: Any) -> dict[str, Any]:
    """Arguments as scripts pass them."""
    puma, panda, out = rtb.models.DH.Puma560(), rtb.models.Panda(), {}
    q = np.array([0.1, 0.5, -2.4, 0.3, 0.6, 0.2])
    for half in ("trans", "rot"):
        out[f"jacob0 {half}"], out[f"jacobe {half}"] = puma.jacob0(q, half=half), puma.jacobe(q, half)
    out["jacob0 T"] = puma.jacob0(q, puma.fkine(q))
    out["jtraj"] = puma.jtraj(puma.qz, puma.qn, 7).q
    out["jtraj rates"] = puma.jtraj(puma.qz, puma.qn, np.linspace(0, 1, 5), 0.1 * q, 0.2 * q).qd
    out["param"] = (rtb.ET.Rx(param=0.3) * rtb.ET.tz(param=0.2)).eval([])
    out["null"] = np.abs(rtb.null(panda.jacob0(panda.qr), 1e-9)) + np.abs(
        rtb.null(panda.jacob0(panda.qr), rtol=1e-9)
    )
    out["hessian_numerical"] = np.round(rtb.hessian_numerical(puma.jacob0, q), 5)
    out["jacobian_numerical"] = np.round(rtb.jacobian_numerical(lambda x: puma.fkine(x).t, q), 5)
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        rtb.jsingu(puma.jacob0(puma.qz))
    out["jsingu"] = [str("4" in text.getvalue()), str("3" in text.getvalue() or "5" in text.getvalue())]
    out["null space"] = rtb.null(np.array([[1.0, 0.0, 0.0]])).shape
    wobbly = puma.perturb(0.2)
    out["perturbed"] = [
        wobbly.name,
        *(str(abs(a.m - b.m) <= 0.2 * b.m + 1e-12) for a, b in zip(wobbly.links, puma.links, strict=True)),
    ]
    return out


def files(rtb: Any, sm: Any) -> dict[str, Any]:
    """A robot from a URDF file: chains, limits, masses, torques."""
    import tempfile
    from pathlib import Path

    made = rtb.models.URDF.URDFRobot
    made = getattr(made, "URDFRobot", made)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "crane.urdf"
        path.write_text(URDF)
        robots = {"plain": made(str(path)), "hand": made(str(path), gripper_link_name=["none", "hook"])}
    out: dict[str, Any] = {}
    for name, robot in robots.items():
        q, qd, qdd = np.array([0.3, -0.4, 0.5]), np.array([0.1, 0.2, -0.3]), np.array([0.4, 0.5, 0.6])
        out[f"{name} words"] = [robot.structure, *(link.name for link in robot.links), *robot.link_dict]
        out[f"{name} ends"] = [link.name for link in robot.ee_links]
        out[f"{name} table"] = [str(robot).split("\n", 1)[1]]
        speeds = [link.qdlim for link in robot.links if link.isjoint]
        out[f"{name} limits"] = np.vstack([robot.qlim, speeds])
        out[f"{name} fkine"], out[f"{name} jacob0"] = np.asarray(robot.fkine(q).A), robot.jacob0(q)
        out[f"{name} rne"] = robot.rne(q, qd, qdd)
        out[f"{name} inertia"] = robot.inertia(q)
        out[f"{name} masses"] = np.concatenate(
            [np.ravel([link.m, *link.r, *np.ravel(link.I)]) for link in robot.links]
        )
    return out


PARTS: dict[str, Callable[[Any, Any], dict[str, Any]]] = {
    "distances": distances,
    "scene": scene,
    "shapes": shapes,
    "closed": closed,
    "text": text,
    "calls": calls,
    "files": files,
}
