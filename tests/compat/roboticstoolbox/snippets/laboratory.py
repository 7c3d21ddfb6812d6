"""What programs of students do: wrenches at the base, grippers as ends, edited chains, figures, numbers of trajectories."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {}


def _add(title: str, *codes: str) -> None:
    for i, code in enumerate(codes):
        SNIPPETS[f"{title} {i}"] = code


_ARM = (
    "b = dict(m=1.5, r=[0.1, 0.02, 0.03], I=[0.02, 0.03, 0.04, 0.001, 0.002, 0.003]); "
    "r = DHRobot([RevoluteDH(d=0.3, alpha=np.pi / 2, offset=0.1, Jm=1e-4, G=50.0, B=1e-3, Tc=[0.02, -0.03], **b), "
    "RevoluteDH(a=0.4, alpha=0.2, **b), PrismaticDH(theta=0.3, a=0.1, **b)], name='arm', "
    "base=SE3(0.1, 0.2, 0.3) * SE3.RPY(0.3, 0.2, 0.1), tool=SE3(0.1, 0, 0.2)); "
    "q, qd, qdd, w = [0.2, -0.4, 0.3], [0.5, 0.1, -0.2], [0.3, -0.7, 0.9], np.arange(6.0); "
)
_add(
    "wrench of the base",
    f"{_ARM} r.rne(q, qd, qdd, base_wrench=True)",
    f"{_ARM} r.rne(q, qd, qdd, [0, 0, -9.81], w, True)",
    f"{_ARM} r.rne_python(Q=q, QD=qd, QDD=qdd, gravity=[1, 2, 3], fext=w, base_wrench=True)",
    f"{_ARM} r.rne_python(q, qd, qdd, debug=False)",
    f"{_ARM} r.rne(np.array([q, qd]), np.array([qd, q]), np.array([qdd, q]), fext=w, base_wrench=True)",
    f"{_ARM} r.friction([0.1, 0.2])",
    f"{_ARM} r.friction(0.1)",
    f"{_ARM} [type(x).__name__ for x in r.islimit(q)]",
    "PoERobot([PoERevolute([0, 0, 1], [0, 0, 0]), PoERevolute([0, 1, 0], [0.4, 0, 0.2])], SE3()).friction(0.3)",
)
_HAND = (
    "a = Link(ET.Rz(), name='a'); b = Link(ET.tx(1) * ET.Rz(), name='b', parent=a); h = Link(ET.ty(2), name='h', parent=b); "
    "r = Robot([a, b, h, Link(ET.ty(), name='f', parent=h)], gripper_links=h); g = r.grippers[0]; q = [0.1, 0.2]; "
)
_PANDA = "r = models.Panda(); g, q = r.grippers[0], r.qr; "
_add(
    "a gripper as the end",
    f"{_HAND} (g, r.ets(), r.ets(end=g), r.ets(end=h), r.ets(end='h'))",
    f"{_HAND} (repr(g), g.tool, g.n, [x.name for x in g.links])",
    f"{_HAND} (r.fkine(q), r.fkine(q, end=g), r.fkine(q, end=h), r.jacob0(q, end=g), r.jacobe(q, end=g))",
    f"{_HAND} g.tool = SE3(0, 0, 0.3); (r.ets(end=g), r.fkine(q, end=g), r.fkine(q), r.fkine(q, end='h'), repr(g)[-60:])",
    f"{_HAND} x = r.get_path(end=g); ([y.name for y in x[0]], x[1], x[2])",
    f"{_HAND} g.tool = SE3(1, 2, 3); x = r.get_path(end=g); ([y.name for y in x[0]], x[1], x[2])",
    f"{_PANDA} (r.ets(end=g), r.fkine(q, end=g), r.jacob0(q, end=g), r.jacobe(q, end=g), r.hessian0(q, end=g))",
    f"{_PANDA} (r.fkine(q, end=g, start='panda_link3'), r.jacob0_analytical(q, end=g))",
    f"{_PANDA} x = r.get_path(end=g); ([y.name for y in x[0]], x[1], x[2])",
    f"{_PANDA} bool(r.ik_LM(r.fkine(q, end=g), end=g, q0=q)[1])",
)
_add(
    "robots of any length",
    "[(x, x.qr, x.fkine(np.full(3, 0.1)), x.reach) for x in (models.DH.Ball(3), models.DH.Coil(3))]",
    "[(x, x.qz, x.fkine(np.full(5, 0.1))) for x in (models.DH.Hyper(5), models.DH.Hyper3d(5), models.DH.Coil(N=5))]",
    "[(x, x.qz) for x in (models.DH.Hyper(4, a=0.2), models.DH.Hyper3d(4, a=0.3), models.DH.Ball(N=1))]",
    "[(x, x.configs) for x in (models.DH.Ball(), models.DH.Coil(), models.DH.Hyper())]",
)
_add(
    "edited chains",
    "e = ET2.R() * ET2.tx(1); e.insert(i=0, arg=ET2.ty(1)); e",
    "e = ET.Rz() * ET.tx(1); e.insert(index=0, value=ET.ty(1)); e",
    "e = ET.Rz() * ET.tx(1) * ET.Rz(); e[0] = ET.tx(2); (e, e.n)",
    "e = ET.Rz() * ET.tx(1) * ET.Rz(); e[1] = ET.Rx(0.3); (e, e.fkine([0.1, 0.2]))",
    "e = ET.Rz() * ET.tx(1) * ET.Rz(); e[0] = ET.Rx(); (str(e), e.fkine([0.1, 0.2]))",
    "e = ET.Rz() * ET.tx(1) * ET.Rz(); e.append(ET.Rx(0.3)); e.extend([ET.tz(1)]); del e[1]; (e, e.fkine([0.1, 0.2]))",
    "Link(ETS(ET.tz(0.3)), name='fixed').T",
    "PrismaticDH(d=1)",
    "RevoluteMDH(theta=1)",
)
_add(
    "numbers of trajectories",
    "[type(x).__name__ for x in (*quintic_func(0, 1, 2)(0.5), *trapezoidal_func(0, 1, 2)(0.3))]",
    "[type(x).__name__ for x in trapezoidal_func(0, 1, 2)(9.0)]",
    "print(trapezoidal(0, 1, 5).qd, trapezoidal(0, 1, 5, V=0.3).qd)",
    "x = mstraj(np.array([[0, 0], [1, 2], [3, 1.5]]), dt=0.2, tacc=0.4, qdmax=1.0).info; [type(y).__name__ for y in x[0]]",
    "trapezoidal(0, 1, None)",
    "quintic(0, 1, 'x')",
    "quintic(0, 1, 2.5)",
    "mtraj(quintic, [0], [1], None)",
)
_add(
    "figures",
    "import matplotlib.pyplot as p; jtraj([0, 1], [1, 2], 4).plot(); [(a.get_xlabel(), a.get_ylabel()) for a in p.gcf().axes]",
    "import matplotlib.pyplot as p; trapezoidal(0, 1, 4).plot(); [(a.get_xlabel(), a.get_ylabel()) for a in p.gcf().axes]",
    "type(models.ETS.Planar2().teach([0.1, 0.2], block=False)).__name__",
    "type(models.DH.Puma560().teach(np.zeros(6), block=False, backend='pyplot')).__name__",
    "import matplotlib.pyplot as p; f = p.figure(); e = rtb.backends.PyPlot.PyPlot(); e.launch('t', f); e.fig is f",
    "import matplotlib.pyplot as p; x = p.figure().add_subplot(projection='3d'); e = rtb.backends.PyPlot.PyPlot(); e.launch(ax=x); e.ax is x",
    "e = rtb.backends.PyPlot.PyPlot(); e.launch(); r = models.DH.Puma560(); e.add(r); e.remove(r)",
    "(rtb.backends.PyPlot.RobotPlot.__name__, rtb.backends.PyPlot.EllipsePlot.__name__, rtb.backends.PyPlot.RobotPlot2.__name__)",
    "models.DH.Puma560().vellipse(models.DH.Puma560().qn).plot()",
)
