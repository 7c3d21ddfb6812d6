"""What the package and the Robotics Toolbox are both asked of members: chains, links, robots, trajectories, symbols.

`python asked_members.py out.json`: a line that starts with `!` is a statement; every other one holds expressions
whose values are kept; an exception is an answer, too.
"""

import copy
import json
import sys
import warnings

import numpy as np
import roboticstoolbox as rtb
import sympy
from spatialmath import SE2, SE3

CHAINS = """
! E, E2 = rtb.ET, rtb.ET2; a, b, c = sympy.symbols("a b c"); q = np.array([0.1, -0.2, 0.3])
! x = E.Rz() * E.tx(1.0) * E.Ry(flip=True) * E.tz() * E.tx(0.5); x[3].qlim = [-1, 2]
str(x); x.n; x.m; len(x); x.structure; x.jindices; x.joint_idx(); x.jindex_set(); x.fkine(q).A; x.eval(q); x.jacob0(q); x.jacobe(q); x.qlim; x.inv().fkine(q).A; str(x.inv()); str(x.compile()); x.compile().fkine(q).A; str(x[1:3]); str(x[0]); x[0].isrotation; x[1].istranslation; x[2].isflip; x[0].axis; x[1].param; x[0].isjoint; x[1].isjoint; x[0].iselementary; x == x; x == x[1:]; copy.deepcopy(x) == x; x[0] == x[0]; x[0] == x[1]; x.fkine([1, 2]); x.fkine(q, base=SE3(1, 2, 3)).A; x.fkine(q, tool=SE3(1, 2, 3)).A; x.hessian0(q); x.hessiane(q); x.manipulability(q); x.jacobm(q); x.jacob0_analytical(q, "rpy/xyz"); x.jacob0_analytical(q, "nothing")
(E.tx(1.0) + E.ty(2.0)).eval([]); (x + x).n; (x * E.tx(1.0)).m; str(E.tx(1.0) * x); [str(part) for part in x.split()]; [str(part) for part in x.split(method="first")]; [str(part) for part in x.split("nothing")]
! y = copy.deepcopy(x); y.insert(1, E.Rx(0.3))
str(y); str(y.pop(0)); str(y); y.n; str(y.pop()); y[99]
! z = copy.deepcopy(x); z.data[1] = E.ty(3.0)
str(z); z.eval(q); str(E.tx(0.5).inv()); str(E.Rz(flip=True)); str(E.Rz(0.3, "deg")); str(E.Rz(30, "deg")); E.Rz(30, "deg").A(); E.tx().A(0.3); E.Rx().A(0.3); E.Ry(flip=True).A(0.3); E.SE3(SE3(1, 2, 3)).A(); str(E.SE3(SE3(1, 2, 3))); E.SE3(SE3.Rx(0.3)).iselementary; repr(E.tx(0.5)); repr(E.Rz()); repr(E.Rz(jindex=2, flip=True, qlim=[-1, 1])); str(E.Rz(a)); str(E.tx(a)); E.Rz(a).A(); E.tx(a).A(); E.Rz().A(a); E.tx(0.3).eta; E.Rz(jindex=3).jindex; E.tx(qlim=[0, 1]).qlim; E.Rz(qlim=[1]); E.Rz(unit="nothing"); E.Rz().isjoint; x[0].qlim
! p = E2.R() * E2.tx(1.0) * E2.R() * E2.ty(0.5); u = np.array([0.3, 0.4])
str(p); p.n; p.structure; p.fkine(u).A; p.jacob0(u); p.jacobe(u); str(p.inv()); p.inv().fkine(u).A; E2.R(0.3).A(); E2.tx(0.2).A(); E2.SE2(SE2(1, 2, 0.3)).A(); str(E2.SE2(SE2(1, 2, 0.3))); p == p; p.qlim; str(p.compile()); str(E2.R(30, "deg")); (p * E2.tx(1.0)).m; p.fkine([1, 2, 3]); E2.R().A(a); p[1].param; p[0].axis; p.joint_idx(); len(p.split())
! w = rtb.ETS(E.Rz(a) * E.tx(b)); s = rtb.ETS(E.Rz() * E.tx(b) * E.Rz() * E.tx(c))
str(w); w.eval([]); s.eval([a, 0.3]); s.fkine([0, 0]).A; str(s); s.n
rtb.ETS().n; str(rtb.ETS()); rtb.ETS([E.tx(1), 3]); rtb.ETS(3); rtb.ETS2([E.tx(1)]); x * 3; E.tx(1.0) * 3; x.random_q().shape; x.random_q(4).shape; x.joints()[1].isflip; rtb.ETS([E.Rz(jindex=0), E.Rz()]); rtb.ETS([E.Rz(), E.tx(1.0), E.Rz(jindex=1)]).jindices; str(x.__str__("theta{0}")); str(x.__str__("q{1}"))
"""

LINKS = """
! E = rtb.ET; l = rtb.Link(E.tx(1.0) * E.Rz(), name="one", m=2.0, r=[0.1, 0.2, 0.3], I=[1, 2, 3, 0.1, 0.2, 0.3], Jm=0.4, B=0.5, Tc=[0.6, -0.7], G=8, qlim=[-1, 2])
l.m; l.r; l.I; l.Jm; l.B; l.Tc; l.G; l.qlim; l.isjoint; l.isrevolute; l.isprismatic; l.jindex; l.hasdynamics; l.friction(0.3); l.friction(-0.3); l.friction(0.0); l.friction(0.3, coulomb=False); l.islimit(3.0); l.islimit(1.0); l.islimit(-1.5); l.A(0.3).A; l.Ts; str(l.ets); l.v.isjoint; l.nofriction().Tc; l.nofriction().B; l.nofriction(coulomb=False, viscous=True).Tc; l.nofriction(coulomb=False, viscous=True).B; l.isflip; l.name; l.nchildren; l.parent is None; l.copy().m; l.copy().name; str(l.dyn()); l.dyn(indent=2); l.parent_name
rtb.Link(E.Rz(), I=np.diag([1.0, 2, 3])).I; rtb.Link(E.Rz(), I=[1, 2, 3]).I; rtb.Link(E.Rz(), I=np.arange(9.0).reshape(3, 3)); rtb.Link(E.Rz(), I=[1, 2]); rtb.Link(E.Rz(), Tc=0.5).Tc; rtb.Link(E.Rz(), Tc=[0.5, 0.5, 0.5]); rtb.Link(E.Rz(), r=[1, 2]); rtb.Link(E.tx(1.0)).isjoint; rtb.Link(E.tx(1.0)).qlim; rtb.Link(E.Rz() * E.tx(1.0)); rtb.Link(E.Rz() * E.Rz()); rtb.Link(E.Rz(), parent=3); rtb.Link(E.tz(qlim=[0, 1])).isprismatic; rtb.Link(E.Rz(flip=True)).isflip; rtb.Link(E.Rz(), I=np.arange(1.0, 10)); rtb.Link(E.tx(1.0) * E.ty(2.0)).Ts; rtb.Link().Ts
! d = rtb.RevoluteDH(d=0.1, a=0.2, alpha=0.3, offset=0.4, m=1.0, qlim=[-2, 2]); p = rtb.PrismaticDH(theta=0.1, a=0.2, alpha=0.3, qlim=[0, 1]); f = rtb.RevoluteMDH(d=0.1, a=0.2, alpha=0.3); g = rtb.PrismaticMDH(theta=0.1, a=0.2, alpha=0.3, qlim=[0, 1])
[str(k) for k in (d, p, f, g)]; [k.A(0.7).A for k in (d, p, f, g)]; [k.mdh for k in (d, p, f, g)]; [k.sigma for k in (d, p, f, g)]; d.offset; d.alpha; p.theta; d.d; d.isrevolute; p.isprismatic; d.islimit(3.0); rtb.DHLink(sigma=0, d=1.0).isrevolute; rtb.DHLink(sigma=1, theta=1.0).isprismatic; (d + p).n; str((d + p).links[1]); (d + rtb.DHRobot([p, f.__class__(d=1.0)]) if 0 else d + rtb.DHRobot([p])).n; d + 3
! d.a = 5.0; d.alpha = 0.0; d.offset = 0.1
d.A(0.2).A; d.a
"""

ROBOTS = """
! E = rtb.ET; root = rtb.Link(E.tz(0.3), name="root"); l1 = rtb.Link(E.Rz(), name="l1", parent=root); l2 = rtb.Link(E.tx(1.0) * E.Ry(), name="l2", parent=l1); l3 = rtb.Link(E.tx(0.5), name="l3", parent=l2); l4 = rtb.Link(E.ty(0.5) * E.Rx(), name="l4", parent=l1); r = rtb.Robot([root, l1, l2, l3, l4], name="tree")
r.n; r.nlinks; r.nbranches; r[1].name; r["l2"].name; r["nothing"]; [k.name for k in r]; r.structure; list(r.revolutejoints); list(r.prismaticjoints); r.isrevolute(1); r.isprismatic(1); [[None if k is None else k.name for k in s] for s in r.segments()]; [k.name for k in r.ee_links]; r.base_link.name; [k.name for k in r.dfs_links(l1)]; [k.name for k in r.get_path("l3")[0]]; r.get_path("l3", "l1")[1]; r.fkine([0.1, 0.2, 0.3], end="l3").A; r.fkine([0.1, 0.2, 0.3], end="l4", start="l1").A; r.fkine([0.1, 0.2, 0.3], end=l4).A; r.jacob0([0.1, 0.2, 0.3], end="l3"); r.jacobe([0.1, 0.2, 0.3], end="l4"); r.fkine([0.1], end="l3"); r.fkine([0.1, 0.2, 0.3], end="nothing"); r.hasgeometry; r.hascollision; r.name; r.ets("l3").n; str(r.ets("l3")); r.qlim; r.random_q().shape; r.q; r.control_mode; r.linkdict["l2"].name
! r.q = [0.1, 0.2, 0.3]; r.qd = [1, 2, 3]; r.addconfiguration("up", [1, 2, 3]); r.addconfiguration_attr("down", [3, 2, 1])
r.q; r.qd; r.configs["up"]; r.down; r.addconfiguration("bad", [1]); setattr(r, "q", [1]); setattr(r, "control_mode", "x"); setattr(r, "base", 3); rtb.Robot([l1, l1]); rtb.Robot([rtb.Link(E.Rz(), name="a"), rtb.Link(E.Rz(), name="a")]); rtb.Robot([rtb.Link(E.Rz(), name="a", parent="nowhere")]); rtb.Robot([3]); rtb.Robot(3)
! m = rtb.models.DH.Puma560(); q = np.array([0.1, -0.3, 0.2, 0.5, -0.4, 0.3]); v = q[::-1].copy(); t = rtb.DHRobot([rtb.RevoluteDH(a=1.0, m=1.0, r=[-0.5, 0, 0], I=[0.1, 0.2, 0.3]), rtb.PrismaticDH(alpha=0.3, a=0.2, m=2.0, qlim=[0, 1])], name="two", base=SE3(1, 2, 3), tool=SE3(0.1, 0.2, 0.3), gravity=[0, 0, 9.81])
m.rne(q, v, v); m.rne(q, v, v, gravity=[1, 2, 3]); m.gravload(q); m.inertia(q); m.coriolis(q, v); m.accel(q, v, v); m.itorque(q, v); m.friction(v); m.inertia_x(q); m.gravload_x(q); m.nofriction().friction(v); m.fkine(q).A; m.fkine_all(q)[3].A; m.jacob0(q); m.jacobe(q); m.manipulability(q); m.manipulability(q, axes="trans"); m.manipulability(q, axes="rot"); m.manipulability(q, method="asada"); m.manipulability(q, method="nothing"); m.manipulability(q, axes="nothing"); m.jacob0_dot(q, v); m.A(2, q).A; m.A([1, 3], q).A; m.d; m.a; m.alpha; m.theta; m.r; m.isspherical(); m.qlim; m.todegrees(q); m.toradians(np.rad2deg(q)); m.perturb(0.1).n; m.payload(2.0, [0.1, 0.2, 0.3]); m.rne(q, 0 * q, 0 * q); m.payload(0.0); m.jacobm(q); m.rne(np.r_[q, v, v]); m.hessian0(q)
t.fkine([0.1, 0.2]).A; t.jacob0([0.1, 0.2]); t.rne([0.1, 0.2], [0.3, 0.4], [0.5, 0.6]); t.inertia([0.1, 0.2]); t.gravload([0.1, 0.2]); t.base.A; t.tool.A; t.gravity; str(t.ets()); t.n; t.structure; t.reach; t.fkine([0.1]); t.nlinks; t.isprismatic(1); t.isrevolute(0); rtb.DHRobot([]); rtb.DHRobot([rtb.RevoluteDH(), rtb.RevoluteMDH()]); t[1].sigma; t.manufacturer; t.comment; t.symbolic; t.hasdynamics; t.mdh
! t.base = SE3(); t.tool = SE3(); t.gravity = [0, 0, 1]
t.fkine([0.1, 0.2]).A; t.gravload([0.1, 0.2]); t.gravity
"""

TRAJECTORIES = """
! q0, q1 = np.zeros(3), np.array([1.0, 2.0, -3.0]); time = np.linspace(0, 2, 9)
[part for part in (lambda T: (T.t, T.q, T.qd, T.qdd, T.istime, T.name))(rtb.quintic(1, 3, 7))]; [part for part in (lambda T: (T.t, T.q, T.qd, T.qdd, T.istime))(rtb.quintic(1, 3, time, 0.5, -0.2))]; [part for part in (lambda T: (T.t, T.q, T.qd, T.qdd))(rtb.trapezoidal(1, 3, time, V=1.2))]; rtb.trapezoidal(1, 3, 7, V=0.0001); rtb.trapezoidal(1, 3, 7, V=100.0); rtb.trapezoidal(1, 1, 7).q; rtb.trapezoidal(3, 1, 7).qd; rtb.quintic(1, 1, 5).q; rtb.quintic(0, 1, 0); rtb.quintic(0, 1, "a")
[part for part in (lambda T: (T.t, T.q, T.qd, T.qdd))(rtb.jtraj(q0, q1, 8))]; [part for part in (lambda T: (T.t, T.q, T.qd, T.qdd))(rtb.jtraj(q0, q1, time, q1, -q1))]; rtb.jtraj(q0, q1[:2], 8); [part for part in (lambda T: (T.t, T.q, T.qd))(rtb.mtraj(rtb.quintic, q0, q1, 8))]; rtb.mtraj(rtb.trapezoidal, q0, q1, time).q; rtb.mtraj(rtb.quintic, q0, q1[:2], 8); len(rtb.jtraj(q0, q1, 8)); rtb.jtraj(q0, q1, 8).naxes if hasattr(rtb.jtraj(q0, q1, 8), "naxes") else 3
[T.A for T in rtb.ctraj(SE3(1, 2, 3), SE3.Rx(1.0), 6)]; [T.A for T in rtb.ctraj(SE3(1, 2, 3), SE3.Rx(1.0), t=time)]; [T.A for T in rtb.ctraj(SE3(1, 2, 3), SE3.Rx(1.0), s=[0.0, 0.25, 1.0])]; [T.A for T in rtb.cmstraj(SE3(), SE3(), 3)] if hasattr(rtb, "cmstraj") else 1
! via = np.array([[0, 0], [1, 2], [3, 1], [4, 4.0]])
[part for part in (lambda T: (T.t, T.q, T.arrive))(rtb.mstraj(via, dt=0.1, tacc=0.3, qdmax=[1.0, 2.0]))]; rtb.mstraj(via, dt=0.1, tacc=0.3, qdmax=1.5).q; rtb.mstraj(via, dt=0.1, tacc=0.3, tsegment=[1.0, 2.0, 3.0]).q; rtb.mstraj(via, dt=0.1, tacc=[0.2, 0.3, 0.4], tsegment=[1.0, 2.0, 3.0]).q; rtb.mstraj(via, dt=0.1, tacc=0.0, qdmax=1.0).q; rtb.mstraj(via, dt=0.1, tacc=0.3, qdmax=1.0, q0=[-1, -1]).q; rtb.mstraj(via, dt=0.1, tacc=0.3, qdmax=1.0, qd0=[0.1, 0.2], qdf=[0.3, 0.1]).q; rtb.mstraj(via, dt=0.1, tacc=0.3); rtb.mstraj(via, dt=0.1, tacc=0.3, qdmax=1.0, tsegment=[1, 1, 1])
"""
SYMBOLS = """
! a1, a2, m1, m2, g, x, y, u, v, w, z = sympy.symbols("a1 a2 m1 m2 g x y u v w z")
! t = rtb.models.DH.TwoLink(symbolic=True); T = t.fkine([x, y])
t.n; t.symbolic; str(t.links[0]); [float(k.subs({x: 0.3, y: 0.4}).subs({s: 1.5 for s in k.free_symbols - {x, y}})) for k in np.ravel(T.A) if hasattr(k, "subs")]
"""
GROUPS = {
    "chains": CHAINS,
    "links": LINKS,
    "robots": ROBOTS,
    "trajectories": TRAJECTORIES,
    "symbols": SYMBOLS,
}


def plain(value):
    """A value as lists of numbers or as text."""
    if value is None or isinstance(value, (str, sympy.Basic)):
        return str(value)
    if isinstance(value, (SE2, SE3)):
        return value.A.tolist()
    if isinstance(value, (list, tuple, set)):
        return [plain(entry) for entry in value]
    array = np.asarray(value)
    if array.dtype == object:
        return [
            str(sympy.nsimplify(sympy.sympify(entry), tolerance=1e-12).evalf(6)) for entry in array.ravel()
        ]
    return array.astype(float).tolist()


def answer(expression, names):
    try:
        value = eval(expression, globals() | names)
    except Exception:
        return "an exception"
    try:
        return plain(value)
    except (TypeError, ValueError, AttributeError):
        return "an object"


def answers(text, names):
    found = {}
    for line in text.strip().splitlines():
        if line.startswith("!"):
            exec(line[1:].strip(), globals() | names, names)
            continue
        for expression in (part.strip() for part in line.split("; ") if part.strip()):
            found[f"{len(found)} {expression}"] = answer(expression, names)
    return found


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    result = {}
    for group, text in GROUPS.items():
        result |= {f"{group} {said}": value for said, value in answers(text, {"copy": copy}).items()}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": rtb.__file__, "answers": result}))
