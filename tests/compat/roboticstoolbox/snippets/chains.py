"""Elementary transforms and their sequences."""

from __future__ import annotations

SNIPPETS: dict[str, str] = {}


def _add(title: str, *codes: str) -> None:
    for i, code in enumerate(codes):
        SNIPPETS[f"{title} {i}"] = code


_JOINTS = ("q1", "-q1", "A1_", "-A1_", "theta2", "-theta3", "q(3)", "+q2", "shoulder", "-elbow", "\u2212q2")
for _name in _JOINTS:
    _add(
        f"joint {_name}",
        f"e = ET.Rz({_name!r}); (str(e), repr(e), e.jindex, e.isflip, e.isjoint, e.param, e.A(0.3))",
        f"e = ET.tx({_name!r}); (str(e), repr(e), str(e.inv()), repr(e.inv()))",
        f"e = ET2.R({_name!r}); (str(e), repr(e), e.jindex, e.A(0.3))",
    )
_add(
    "joints in a chain",
    "e = ET.Rz('q1') * ET.tx(1) * ET.Ry('-q0'); (str(e), repr(e), e.n, e.jindices, e.fkine([0.1, 0.2]))",
    "e = ET.Rz('A1_') * ET.tx(1) * ET.Ry('A2_'); (str(e), e.eval([0.1, 0.2]), e.jacob0([0.1, 0.2]))",
    "e = ET.Rz('shoulder') * ET.tx(1) * ET.Ry('elbow'); (str(e), e.jindices, str(e.inv()))",
    "ETS([ET.Rz('q0'), ET.Ry()])",
    "ETS([ET.Rz('q1'), ET.Ry()])",
    "ET.Rz('q1', jindex=2)",
    "ET.Rz('q1', flip=False)",
    "ET.Rz('A0_')",
    "ET.Rz('0.3')",
    "ET.Rz('90', 'deg')",
    "ET.Rz(90, unit='degrees')",
    "e = ET.Rz(); e.jindex = -1",
    "e = ET.Rz(); e.jindex = 'a'",
    "e = ET.Rz(); e.jindex = 2; e",
    "ET.Rz(qlim=[1, 2, 3])",
    "print(Robot(ET.Rz('q0') * ET.tx(1) * ET.Ry('-q1')))",
    "print(Link(ET.tx(1) * ET.Rz('A1_'), name='upper'))",
)
_add(
    "properties",
    "e = ET.Rz(0.3); e.param = 0.5; (e, e.A(), e.isjoint, e.param)",
    "e = ET.Rz(); e.param = 0.5; (e, e.A(), e.isjoint)",
    "e = ET.SE3(SE3(1, 2, 3)); e.param = 0.5",
    "e = ET.Rz() * ET.tx(1); e[1].param = 3; (e, e.fkine([0.2]))",
    "ET.Rz(0.3).eta",
    "e = ET.Rz(0.3); e.eta = 0.4; e.param",
    "ET.Rz(0.3).axis",
    "ET.Rz(eta=0.3)",
    "ET.Rz(0.3).kind",
    "[(e.ax, e.isrotation, e.istranslation, e.iselementary) for e in (ET.Rx(), ET.tz(1), ET.SE3(SE3()), ET2.R(), ET2.tx())]",
    "[e.s for e in (ET.Rx(), ET.Ry(), ET.Rz(), ET.tx(), ET.ty(), ET.tz(), ET2.R(), ET2.tx(), ET2.ty())]",
    "sum([ET.Rx(1), ET.ty(2)])",
    "sum([ET.Rx(1) * ET.tz(3), ET.ty(2) * ET.tx(2)])",
    "ET.Rx(1) == ET.Rx(1), ET.Rx(1) == 3, ET.Rx() == ET.Rx(jindex=1)",
    "ET.Rx(1) * 3",
    "ET.SE3(np.eye(4)), ET.SE3(SE3(1, 2, 3)), ET.SE3(SE3.Rx(0.3) * SE3(1, 0, 0))",
    "ETS('a')",
    "ETS([1, 2])",
    "ETS([ET.Rz() * ET.tx(1), ET.Ry()])",
    "str(ETS()), str(ETS2()), ETS().n",
    "ET.tx(1, 'deg')",
    "repr(ET.Rz(jindex=2, flip=True, qlim=[-1, 1]))",
    "ET.Rz().A(), ET.Rz(flip=True).A(0.3), ET.tx(flip=True).A(2)",
    "import copy; e = ET.Rz('a1'); str(copy.deepcopy(e)), str(copy.copy(e))",
)
_add(
    "symbols",
    "a = sympy.symbols('a'); e = ET.Rz(a); (str(e), e.param, e.isjoint, e.A())",
    "a = sympy.symbols('a'); e = ET.tx(a) * ET.Rz() * ET.ty(2 * a); (str(e), e.eval([0.3]))",
    "a, q = sympy.symbols('a q'); e = ET.tx(a) * ET.Rz() * ET.ty(2); (e.fkine([q]), e.jacob0([q]), e.jacobe([q]))",
    "q = sympy.symbols('q'); ET.Rz().A(q), ET.Rz(flip=True).A(q), ET.tx().A(q)",
    "q = sympy.symbols('q:2'); e = ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1); e.eval(q)",
    "q = sympy.symbols('q:2'); e = ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1); e.fkine(q)",
    "q = sympy.symbols('q:2'); e = ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1); str(e.fkine(q).A.tolist())",
    "q = sympy.symbols('q:2'); e = ET2.R() * ET2.tx(1) * ET2.R() * ET2.tx(1); e.fkine(q)",
    "a = sympy.symbols('a'); e = ET2.R(a) * ET2.tx(a) * ET2.R(); (str(e), e.fkine([0.3]))",
    "a = sympy.symbols('a'); e = ET.Rz(a) * ET.Rz(2 * a); e.merge(0); e",
    "a = sympy.symbols('a'); e = ET.Rz(a) * ET.Rz(-a) * ET.tx(1); e.merge(0); e",
    "e = ET.Rz(sympy.pi / 2) * ET.Rz(3 * sympy.pi / 2) * ET.tx(1); e.merge(0); e",
    "a = sympy.symbols('a'); e = ET.Rz() * ET.Rz(a); e.merge(0); (str(e), repr(e), e.eval([0.1]))",
    "a = sympy.symbols('a'); e = ET.Rx(sympy.pi / 2) * ET.ty(a); e.swap(0); e",
    "a = sympy.symbols('a'); [et.A() for et in (ET.Rz(a) * ET.tx(1)).compile()]",
    "a = sympy.symbols('a'); (ET.ty(a) * ET.Rx()).replaced(0, 'x')",
    "a = sympy.symbols('a'); e = ET.Rz(a); e.param = 0.3; (e, e.A())",
    "a = sympy.symbols('a'); Robot(ET.tx(a) * ET.Rz() * ET.ty(2 * a)).fkine([0.3])",
    "q = sympy.symbols('q:2'); Robot(ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1)).fkine(q)",
    "q = sympy.symbols('q:2'); Robot(ET.Rz() * ET.tx(1) * ET.Rz() * ET.tx(1)).jacob0(q)",
)
_add(
    "merge",
    "e = ET.Rx(0.3) * ET.Rx(-0.3) * ET.tz(1); e.merge(0); e",
    "e = ET.tz(1) * ET.tz(2); e.merge(0); e",
    "e = ET.tz(1) * ET.tz(-1); e.merge(0); (str(e), len(e))",
    "e = ET.Rz() * ET.Rz(0.3); e.merge(0); (str(e), repr(e), e.eval([0.1]), e.jacob0([0.1]))",
    "e = ET.Rz(0.3) * ET.Rz(flip=True) * ET.tx(1); e.merge(0); (str(e), repr(e), e.eval([0.1]), str(e.inv()))",
    "e = ET.tz(0.3) * ET.tz(qlim=[0, 1]); e.merge(0); (str(e), repr(e), e.eval([0.1]))",
    "e = ET.Rz(0.3) * ET.Rz('a1'); e.merge(0); (str(e), repr(e))",
    "e = ET.Rz() * ET.Rz(); e.merge(0)",
    "e = ET.Rz(1) * ET.Rx(1); e.merge(0)",
    "e = ET.SE3(SE3(1, 2, 3)) * ET.SE3(SE3(1, 2, 3)); e.merge(0)",
    "e = ET.Rz(1) * ET.Rz(1); e.merge(1)",
    "e = ET.Rz(1) * ET.Rz(1); e.merge(-1)",
    "e = ET.Rz(1) * ET.Rz(1); f = e.merged(0); (str(e), str(f))",
    "e = ET2.R(1) * ET2.R(-1) * ET2.tx(1); e.merge(0); e",
    "e = ET2.R() * ET2.R(0.4) * ET2.tx(1); e.merge(0); (str(e), e.eval([0.1]), e.jacob0([0.1]))",
)
_turns = ("Rx", "Ry", "Rz")
for _i, _turn in enumerate(_turns):
    for _k in (1, -1, 2, 3, -3, 4, 5):
        _add(
            f"swap {_turn} {_k}",
            *(
                f"e = ET.{_turn}({_k} * np.pi / 2) * ET.{other}; e.swap(0); e"
                for other in ("tx(1)", "ty()", "tz(jindex=0)", "Rx(0.3)", "Ry(flip=True)", "Rz('A1_')")
            ),
            *(f"e = ET.{other} * ET.{_turn}({_k} * np.pi / 2); e.swap(0); e" for other in ("ty(2)", "Rz()")),
        )
_add(
    "swap",
    "e = ET.Rx(np.pi / 2) * ET.Ry(np.pi / 2); e.swap(0)",
    "e = ET.Rx(1) * ET.Ry(np.pi / 3); e.swap(0)",
    "e = ET.tx(1) * ET.ty(2); e.swap(0); e",
    "e = ET.Rx(1) * ET.tx(2); e.swap(0); e",
    "e = ET.Rx() * ET.tx(2); e.swapped(0)",
    "e = ET.Rx(np.pi / 2) * ET.SE3(SE3(1, 2, 3)); e.swap(0)",
    "e = ET.tx(1) * ET.ty(2); e.swap(1)",
    "e = ET.tx(1) * ET.ty(2); e.swap(-1)",
    "e = ET2.R(np.pi / 2) * ET2.tx(2); e.swap(0)",
    "e = ET2.ty(1) * ET2.tx(2); e.swap(0); e",
)
for _axis in "xyz":
    _add(
        f"replace {_axis}",
        *(
            f"(ET.{e} * ET.tx(1)).replaced(0, '{_axis}')"
            for e in ("tx(1)", "ty()", "Rz(0.3)", "Rx('a2')", "SE3(SE3())")
        ),
    )
_add(
    "replace",
    "(ET.tx(1) * ET.Rx(2)).replace(2, 'x')",
    "(ET.tx(1) * ET.Rx(2)).replace(0, 'w')",
    "(ET.tx(1) * ET.Rx(2)).replaced(-1, 'y')",
)
_CHAIN = "e = ET.tz(1) * ET.Rz() * ET.tx(0.5) * ET.Ry(flip=True) * ET.tz(qlim=[0, 1]); "
_add(
    "sequences",
    *(
        _CHAIN + rest
        for rest in (
            "e.__str__(q='θ{0}')",
            "e.__str__('a{1}')",
            "e.__str__('q')",
            "e.split()",
            "e.split('first')",
            "e.split('FIRST')",
            "e.split('middle')",
            "[str(x) for x in (ET.Rz() * ET.tz(1) * ET.tx(2) * ET.Rx(0.5) * ET.Rz() * ET.tx(1)).split('dh')]",
            "[str(x) for x in (ET.tx(2) * ET.Rx(0.5) * ET.Rz() * ET.tx(1) * ET.Rz() * ET.ty(3)).split('mdh')]",
            "e.split('dh')",
            "e.fixjoint(0, 0.3)",
            "e.fixjoint(1, 30, 'deg')",
            "e.fixjoint(2, 30, 'deg')",
            "e.fixjoint(3, 1)",
            "e.fixjoint(-1, 1)",
            "e.fixjoint(True, 1)",
            "e.fixjoint(0.0, 1)",
            "e.fixjoint(0, 1, 'degrees')",
            "e.fixjoint(np.int64(0), 1)",
            "e[1:3], e[-1], len(e), e.m, e.n",
            "e.joints()",
            "e.joint_idx(), e.jindex_set(), e.jindices, e.structure",
            "e.qlim",
            "e.qlim = np.array([[0, 0, 0], [1, 2, 3]]); (e.qlim, e[1].qlim)",
            "e.qlim = [1, 2]",
            "e.inv(), e.inv().eval([0.1, 0.2, 0.3])",
            "e.compile()",
            "e.insert(1, ET.tx(3)); e",
            "e.insert(1, ET.tx(3) * ET.ty(2)); e",
            "e.append(ET.tx(3)); e",
            "e.extend([ET.tx(3), ET.ty(2)]); e",
            "del e[0]; e",
            "e.pop()",
            "e[0] = ET.tx(5); e",
            "e.reverse(); e",
            "ET.tx(1) in e, e.index(e[1]), e.count(e[0])",
            "e.eval([0.1, 0.2])",
            "e.eval([0.1, 0.2, 0.3, 0.4])",
            "e.jacob0([0.1, 0.2])",
            "e.fkine(np.zeros((2, 3)))",
            "e.eval(np.zeros((1, 3)))",
            "e.fkine([0.1, 0.2, 0.3], base=SE3(1, 0, 0), tool=SE3(0, 1, 0))",
            "e.fkine([0.1, 0.2, 0.3], base=SE3(1, 0, 0), include_base=False)",
            "e.manipulability([0.1, 0.2, 0.3], method='unknown')",
            "e.manipulability([0.1, 0.2, 0.3], axes='unknown')",
            "e.manipulability([0.1, 0.2, 0.3], axes='translation')",
            "e.jacob0_analytical([0.1, 0.2, 0.3], representation='unknown')",
            "e *= ET.tx(1); e",
            "e == e[:], e == 3",
            "hash(e)",
            "e.data = e.data[:2]; e",
        )
    ),
    "e = ET.Rz(jindex=1) * ET.tx(1) * ET.Ry(jindex=0); (e.eval([0.1, 0.2]), e.jacob0([0.1, 0.2]), e.jacobe([0.1, 0.2]))",
    "e = ET.Rz(jindex=1) * ET.tx(1) * ET.Ry(jindex=0); e.hessian0([0.1, 0.2])",
    "e = ET.Rz(jindex=3) * ET.tx(1) * ET.Ry(jindex=1); (e.eval([0.1, 0.2]), e.jacob0([0.1, 0.2]))",
    "e = ET.Rz(jindex=3) * ET.tx(1) * ET.Ry(jindex=1); e.eval([0.1, 0.2, 0.3, 0.4])",
    "e = ET.Rz(jindex=3) * ET.tx(1) * ET.Ry(jindex=1); e.eval([0.1, 0.2, 0.3])",
    "Robot(ET.Rz(jindex=1) * ET.tx(1) * ET.Ry(jindex=0)).fkine([0.1, 0.2])",
    "r = Robot([Link(ET.Rz(jindex=1), name='a'), Link(ET.tx(1) * ET.Ry(jindex=0), name='b', parent='a')]); (r.fkine([0.1, 0.2]), r.jacob0([0.1, 0.2]), r.qlim)",
    "r = Robot([Link(ET.Rz(jindex=1), name='a'), Link(ET.tx(1) * ET.Ry(jindex=0), name='b', parent='a')]); print(r)",
    "e = ET2.R() * ET2.tx(1) * ET2.ty(qlim=[0, 1]); (str(e), repr(e), e.eval([0.1, 0.2]), e.jacob0([0.1, 0.2]), e.jacobe([0.1, 0.2]), e.qlim)",
    "e = ET2.R() * ET2.tx(1) * ET2.ty(qlim=[0, 1]); e.fixjoint(0, 30, 'deg')",
    "e = ET2.R() * ET2.tx(1) * ET2.ty(qlim=[0, 1]); e.fixjoint(2, 0.3)",
    "e = ET2.R(flip=True) * ET2.tx(1) * ET2.ty(qlim=[0, 1]); (e.compile(), e.inv(), e.split())",
)
_add(
    "trchain",
    *(
        f"a, q = sympy.symbols('a q'); {code}"
        for code in (
            "rtb.trchain('Rx(q1) Tz(2 * a)', [q], variables={'a': a})",
            "rtb.trchain('Rx(q1) Tz(2 * a)', [0.2], variables={'a': a})",
            "rtb.trchain('Rx(pi/2) Tz(sin(a))', variables={'a': a})",
            "rtb.trchain2('R(q1) Tx(2 * a)', [q], variables={'a': a})",
            "rtb.trchain('Rx(q1) Tz(2)', [30], unit='deg')",
            "rtb.trchain('Rx(q1) Tz(2)', [q], return_tokens=True)",
            "rtb.trchain(rtb.trchain('Rx(q1) Tz(2)', [q], return_tokens=True)[1], [0.3])",
            "rtb.trchain('Rx(t1)', [q], qvar='t')",
            "rtb.trchain('Rx(q1)', [])",
            "rtb.trchain('Rx(q1')",
            "rtb.trchain('Rw(1)')",
            "rtb.trchain('Rx(b)')",
            "rtb.trchain('Rx(q1 + q2)', [1, 2])",
            "rtb.trchain('Rx(1)', unit='grad')",
            "rtb.trchain('Rx(1)', qvar='1q')",
            "rtb.trchain([1, 2])",
            "rtb.trchain('Rx([1])')",
            "rtb.trchain('Rx(1 +)')",
        )
    ),
)
