"""Robots and chains whose parameters, tools or coordinates are symbols, evaluated at numbers."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {}
_LENGTHS = "sympy.symbols('a1 a2 m1 m2 c1 c2 r g', real=True)"
_BEFORE = (
    "q = sympy.symbols('q:2'); qd = sympy.symbols('v:2'); qdd = sympy.symbols('w:2'); "
    f"at = dict(zip([*q, *qd, *qdd, *{_LENGTHS}], [.1, .2, .3, .4, .5, .6, .7, .8, 1.1, 1.2, .3, .35, .05, 9.7])); "
    "N = lambda x: np.array([float(sympy.sympify(e).subs(at)) for e in np.ravel(np.asarray(getattr(x, 'A', x), object))]); "
)


def _add(title: str, before: str, *codes: str) -> None:
    for i, code in enumerate(codes):
        SNIPPETS[f"{title} {i}"] = f"{_BEFORE}{before}{code}"


for _options in ("", ", mdh=True", ", inertia=True", ", mdh=True, inertia=True"):
    _add(
        f"two links{_options}",
        f"p = models.DH.TwoLink(symbolic=True{_options}); ",
        "N(p.fkine(q))",
        "N(p.jacob0(q))",
        "N(p.jacobe(q))",
        "N(p.rne(q, qd, qdd))",
        "N(p.A(1, q))",
        "[N(T) for T in p.fkine_all(q).A]",
        "p.dynamics()",
        "str(p.ets())" if not _options else "p.n",
    )
_add(
    "symbolic tools",
    "a = sympy.Symbol('a1', real=True); ",
    "N(DHRobot([RevoluteDH(a=1), RevoluteDH(a=2)], tool=SE3.Tx(a)).fkine(q))",
    "p = DHRobot([RevoluteDH(a=1), RevoluteDH(a=2)]); p.tool = SE3.Tx(a); N(p.fkine(q))",
    "N(Robot([Link(ET.Rz()), Link(ET.tx(1) * ET.Rz())], tool=SE3.Tx(a)).fkine(q))",
    "N((ET.Rz() * ET.tx(a) * ET.Rz()).fkine(q, tool=SE3(.1, .2, .3)))",
    "N((ET.Rz() * ET.tx(a) * ET.Rz()).fkine(q, base=SE3(.1, .2, .3) * SE3.Rx(.3)))",
    "[str(x) for x in (ET.Rz() * ET.tx(a) * ET.Rz()).fkine(q).A.ravel()]",
    "[str(x) for x in ET.Rz(a).A().ravel()], [str(x) for x in ET.tx(a).A().ravel()]",
)
