"""Robots and links joined, former names with their warnings, modules of robots, and options that are not known."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {}


def _add(title: str, *codes: str) -> None:
    for i, code in enumerate(codes):
        SNIPPETS[f"{title} {i}"] = code


_add(
    "joined",
    "r = DHRobot([RevoluteDH(a=1), models.DH.Puma560()]); (r.n, r.fkine(np.full(7, 0.1)), [x.name for x in r.links])",
    "r = DHRobot([models.DH.Puma560(), RevoluteDH()]); (r.n, r.fkine(np.full(7, 0.1)), [x.name for x in r.links])",
    "r = DHRobot([models.DH.TwoLink(), models.DH.Puma560()]); (r.fkine(np.full(8, 0.1)), r.base, r.tool, r.name)",
    "r = models.DH.TwoLink() + models.DH.Puma560(); q = np.full(8, 0.1); (r.jacob0(q), r.inertia(q), r.fkine_all(q))",
    "r = RevoluteDH(a=1) + models.DH.Puma560(); (type(r).__name__, r.fkine(np.full(7, 0.1)), r.name, r.qlim)",
    "r = RevoluteDH(a=1) + RevoluteDH(a=2); (type(r).__name__, r.n, r.fkine([0.1, 0.2]))",
    "[x.name for x in DHRobot([RevoluteDH(name='link2'), RevoluteDH(), RevoluteDH()]).links]",
    "[x.name for x in DHRobot([RevoluteDH(name='a'), RevoluteDH(name='a'), RevoluteDH(name='link1')]).links]",
)
_add(
    "former names",
    "sg.Sphere(0.1).collided(sg.Sphere(0.1))",
    "models.Panda().collided(np.zeros(7), sg.Sphere(0.1, pose=SE3(3, 3, 3)))",
    "models.Panda().links[3].iscollided(sg.Sphere(0.1, pose=SE3(3, 3, 3)))",
    "type(sg.Box([1, 1, 1])).__name__",
    "sg.Cuboid([1, 1, 1], base=SE3(1, 2, 3)).T",
    "s = sg.Cuboid([1, 1, 1], color=[1, 0, 0]); s.set_alpha(0.5); s.opacity",
    "str(ELink(ET.Rx()))",
    "str(ELink2(ET2.R()))",
    "p = models.DH.Puma560(); p.ikine_6s(p.fkine(p.qn), 'run', lambda r, T, c: np.zeros(3)).q",
    "Robot.URDF('nofile.urdf')",
)
_add(
    "modules of robots",
    "from roboticstoolbox.models.DH.Puma560 import Puma560; Puma560().n",
    "from roboticstoolbox.models.URDF.Panda import Panda; Panda().n",
    "from roboticstoolbox.models.ETS.Planar2 import Planar2; Planar2().n",
    "import roboticstoolbox.models.DH.UR5; rtb.models.DH.UR5().n",
    "from roboticstoolbox.models.catalog import catalog; callable(catalog)",
)
_add(
    "none",
    "ET.Rz().A(None)",
    "models.Panda().joint_velocity_damper(0.05, 0.9, 7)",
    "models.DH.UR5().accel(np.zeros(6), np.zeros(6), np.ones(6))",
)
