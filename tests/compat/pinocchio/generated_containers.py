"""What can be done with Pinocchio's lists: entries and slices read and written, made, copied, pickled, and changed while they are in use.

Each is the text of an expression, as in `generated_calls.py`: `did(list, lambda l: what is done)`, after which `answers.py` says what
is returned, and what the list is then.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """A kind of lists.

    Attributes:
        entry: An expression for an entry.
        other: One for another entry.
        change: What changes an entry `e` in place; empty where entries cannot be changed.
        shown: What is read of an entry `e`.
    """

    entry: str
    other: str
    change: str = ""
    shown: str = "e"


_NAMED = {"change": "setattr(e, 'name', 'x')", "shown": "e.name"}
_FILLED = "e.fill(7.0)"
KINDS = {
    "SE3": Kind("M", "pin.SE3(np.eye(3), three)", "e.setIdentity()"),
    "Motion": Kind("mo", "pin.Motion(six * 2.0)", "e.setZero()"),
    "Force": Kind("fo", "pin.Force(six * 2.0)", "e.setZero()"),
    "Inertia": Kind("I", "pin.Inertia(1.0, three, np.eye(3))", "setattr(e, 'mass', 9.0)"),
    "Symmetric3": Kind("Y", "pin.Symmetric3(np.eye(3))", "e.setZero()"),
    "Frame": Kind("F", "pin.Frame('b', 1, 0, M, pin.FrameType.BODY)", **_NAMED),
    "Double": Kind("0.5", "2.5"),
    "Index": Kind("3", "5"),
    "Bool": Kind("True", "False"),
    "StdString": Kind("'a'", "'b'"),
    "Vector3": Kind("three", "three_b", _FILLED),
    "Matrix6": Kind("np.eye(6)", "np.ones((6, 6))", _FILLED),
    "MatrixXs": Kind("np.eye(2, 3)", "np.ones((3, 3))", _FILLED),
    "Matrix6x": Kind("np.eye(6, 3)", "np.ones((6, 2))", _FILLED),
    "IndexVector": Kind("filled(pin.StdVec_Index(), [1, 2])", "filled(pin.StdVec_Index(), [3])", "e.append(4)"),
    "GeometryObject": Kind("go", "g.geometryObjects[1]", **_NAMED),
    "CollisionPair": Kind("pin.CollisionPair(0, 1)", "pin.CollisionPair(1, 2)", "setattr(e, 'first', 7)", "(e.first, e.second)"),
    "RigidConstraintModel": Kind("rigid", "pin.RigidConstraintModel(pin.ContactType.CONTACT_6D, m, 2, pin.LOCAL)", **_NAMED),
    "PointAnchorConstraintModel": Kind("point", "pin.PointAnchorConstraintModel(m, 2)", **_NAMED),
    "JointFrictionConstraintModel": Kind("friction", "pin.JointFrictionConstraintModel(m, [1])", **_NAMED),
    "RigidConstraintData": Kind("rigid.createData()", "rigid.createData()", "setattr(e, 'contact_force', fo)", "e.contact_force"),
    "Model": Kind("own_m", "pin.Model()", **_NAMED),
    "GeometryModel": Kind("g", "pin.GeometryModel()", "e.removeGeometryObject('shoulder1_object')", "e.ngeoms"),
}  # fmt: skip
"""The kinds of lists whose entries can be made in both packages."""
LIVE = {
    "SE3": ("own_m.jointPlacements", "d.oMi"),
    "Motion": ("d.v",),
    "Inertia": ("own_m.inertias",),
    "Frame": ("own_m.frames",),
    "Index": ("own_m.parents", "own_m.nqs", "own_m.idx_vs"),
    "StdString": ("own_m.names",),
    "Vector3": ("d.com",),
    "Bool": ("gd.activeCollisionPairs",),
    "GeometryObject": ("g.geometryObjects",),
    "CollisionPair": ("g.collisionPairs",),
}
"""Lists that belong to other objects."""
OTHERS = ("None", "'text'", "2", "0.5", "three", "M", "[]", "object()")
READS = (
    *(f"l[{at}]" for at in ("0", "-1", "2", "9", "-9", "'a'", "1.0", "None", "np.int64(1)", "True", "2**70")),
    *(f"list(l[{part}])" for part in ("1:3", ":", "5:9", "2:1", "-2:", ":-1", "None:2", "99:", "-99:2")),
    *(
        "l[::2]",
        "l[::-1]",
        "l[0:3:1]",
        "l['a':2]",
        "len(l)",
        "bool(l)",
        "list(l)",
        "tuple(l)",
        "l.tolist()",
        "l.tolist(True)",
    ),
    *(
        "l.tolist(deep_copy=False)",
        "l.copy()",
        "copy.copy(l)",
        "copy.deepcopy(l)",
        "pickle.loads(pickle.dumps(l))",
        "l is l",
    ),
    *(
        "type(l[1:3]) is type(l)",
        "type(l.copy()) is type(l)",
        "E in l",
        "O in l",
        "l == l",
        "l == l.copy()",
        "l != l.copy()",
    ),
    *(
        "l == list(l)",
        "l < l",
        "l + l",
        "l + [E]",
        "[E] + l",
        "l * 2",
        "2 * l",
        "l.index(E)",
        "l.count(E)",
        "list(reversed(l))",
        "hash(l) != 0",
    ),
    *(
        "list(zip(l, l))",
        "list(enumerate(l))",
        "list(map(type, l)) != []",
        "next(iter(l))",
        "max(l, key=id) is not None",
        "[*l, E]",
    ),
    *("l.id() == l.id()", "l.__len__()", "l.__contains__(E)", "np.array(l).shape"),
)
"""What is read of a list `l`, with an entry E and another one O."""
WRITES = (
    *(
        "l.append(E)",
        "l.append(O)",
        "l.append()",
        "l.append(E, E)",
        "l.extend([E, O])",
        "l.extend((E,))",
        "l.extend(l)",
        "l.extend([])",
    ),
    *(
        "l.extend(E)",
        "l.extend(x for x in [E, O])",
        "l.insert(1, E)",
        "l.pop()",
        "l.remove(E)",
        "l.reverse()",
        "l.sort()",
        "l.clear()",
    ),
    *(
        "operator.setitem(l, 0, E)",
        "operator.setitem(l, -1, E)",
        "operator.setitem(l, 9, E)",
        "operator.setitem(l, 'a', E)",
    ),
    *(
        f"operator.setitem(l, slice({part}), {new})"
        for part in ("1, 2", "0, 2", "None", "2, 1", "1, 99", "0, 3, 2")
        for new in ("[E]", "[E, O, E]", "[]", "E", "(O, O)", "l")
    ),
    *(
        "operator.delitem(l, 0)",
        "operator.delitem(l, -1)",
        "operator.delitem(l, 9)",
        "operator.delitem(l, 'a')",
    ),
    *(
        "operator.delitem(l, slice(1, None))",
        "operator.delitem(l, slice(0, 2))",
        "operator.delitem(l, slice(None))",
    ),
    *(
        "operator.delitem(l, slice(0, 3, 2))",
        "operator.iadd(l, [E])",
        "operator.iadd(l, l)",
        "operator.imul(l, 2)",
    ),
    *(
        "l.reserve(3)",
        "l.reserve(-1)",
        "l.reserve('a')",
        "[l.append(E) for e in l if len(l) < 6]",
        "[operator.delitem(l, 0) for e in l]",
    ),
    *(
        "[operator.setitem(l, 0, O) for e in l]",
        "filled(l, [E] * 9)",
        "[len(l) for i in range(3) if l.append(E) is None]",
    ),
)
MADE = ("X()", "X(l)", "X(list(l))", "X([E, O])", "X((E, O))", "X([])", "X(2, E)", "X(0, E)", "X(2)", "X(-1, E)", "X(2, None)", "X(E)", "X(E, E)",
        "X(x for x in [E])", "X([E, None])", "X([E], 2)", "X(other=l)", "X(size=2, value=E)", "X('text')", "X(2.0, E)", "X([[E]])")  # fmt: skip
SHARED = (
    "(l[0], l[0])",
    "(l, l[0])",
    "(l, l[-1])",
    "(l, l[:][0])",
    "(l, l[0:2][1])",
    "(l, X(l)[0])",
    "(l, X(list(l))[0])",
    "(l, l.copy()[0])",
    "(l, copy.copy(l)[0])",
    "(l, copy.deepcopy(l)[0])",
    "(l, list(l)[0])",
    "(l, l.tolist()[0])",
    "(l, l.tolist(True)[0])",
    "(l, list(iter(l))[1])",
    "(l, [l.append(e) or e for e in [E]][0])",
    "(l, [l.extend([e]) or e for e in [E]][0])",
    "(l, [operator.setitem(l, 0, e) or e for e in [E]][0])",
    "(l, [operator.setitem(l, slice(0, 1), [e]) or e for e in [E]][0])",
    "(l, [operator.setitem(l, 0, O) or e for e in [l[0]]][0])",
    "(l, [operator.delitem(l, 0) or e for e in [l[1]]][0])",
    "(l, [l.append(E) or e for e in [l[0]]][0])",
    "(l, [filled(l, [E] * 99) and e for e in [l[0]]][0])",
    "(l, [e for e in l][2])",
    "(X(2, E), X(2, E)[0])",
    "[(x, x[0]) for x in [X(2, E)]][0]",
    "[(x, e) for e in [E] for x in [X(2, e)]][0]",
    "[(x, e) for e in [E] for x in [X([e])]][0]",
)
"""Pairs of a list and what is changed in place: whether the list has changed with it."""


def containers() -> Iterator[tuple[str, str]]:
    """Pairs of a path and an expression."""
    for name, kind in KINDS.items():
        own = path = f"pin.StdVec_{name}"
        meaning = {"E": f"({kind.entry})", "O": f"({kind.other})", "X": own}
        for this in (
            f"filled({own}(), [{kind.entry}, {kind.other}, {kind.entry}])",
            f"{own}()",
            *LIVE.get(name, ()),
        ):
            for form in _of_list(kind):
                text = re.sub(r"\b[EOX]\b", lambda found: meaning[found[0]], form)  # noqa: B023
                yield path, f"did({this}, lambda l: {text})"


def _of_list(kind: Kind) -> Iterator[str]:
    shows = kind.shown != "e"

    def shown(what: str) -> str:
        return f"[[{kind.shown} for e in x] for x in [l, {what}] if hasattr(x, '__len__')]" if shows else what

    yield from READS
    yield from MADE
    for text in WRITES:
        yield f"({text}, [{kind.shown} for e in l])" if shows else text
    for other in OTHERS:
        for text in (
            "{} in l",
            "l.append({})",
            "l.extend({})",
            "l.extend([E, {}])",
            "operator.setitem(l, 0, {})",
        ):
            yield text.format(other)
        for text in (
            "operator.setitem(l, slice(0, 1), [{}])",
            "operator.setitem(l, slice(0, 1), {})",
            "X(2, {})",
            "X([{}])",
        ):
            yield text.format(other)
    for text in ("X(l)", "X([E, O])", "l[0:2]", "l.copy()", "l.tolist()", "l.tolist(True)"):
        if shows:
            yield shown(text)
    for text in SHARED if kind.change else ():
        yield f"[[{kind.shown} for e in x] for x, e in [{text}] if [{kind.change}]]"


def _done(text: str, lists: str = r".*") -> str:
    """The pattern of expressions that do something with some lists."""
    return rf"did\({lists}, lambda l: \(?({text}).*\)"


_OF_LISTS = r"l \+ |.* \+ l\b|l \* 2|2 \* l|l < l|l\.(insert|pop|remove|reverse|sort|clear|index|count)\(|operator\.i(add|mul)\("
_LIVE = r"(own_m|d|gd|g)\.\w+"
_SLICES = r"operator\.setitem\(l, slice\("
DOCUMENTED = (
    (r"accepted|error class|value", _done(_OF_LISTS), "they have all functions of Python's lists"),
    (
        r"accepted|error class|value",
        _done(r"l\[[^]]*:[^]]*:|operator\.(set|del)item\(l, slice\(0, 3, 2\)"),
        "slices may have steps",
    ),
    (r"accepted|error class", _done(r"l\[np\.int64\(1\)\]"), "numbers of NumPy are taken"),
    (r"accepted", _done(r"pin\.StdVec_\w+\(\(|pin\.StdVec_\w+\(x for"), "tuples and generators are taken"),
    (r"error class", _done(r"l\[2\*\*70\]"), "it is an IndexError, as for all lists"),
    (
        r"refused|error class|value",
        _done(r".*", r"own_m\.(nqs|idx_vs)"),
        "they are computed when they are read: changes of them raise, as they would have no effect",
    ),
    (r"refused|error class", _done(_SLICES, _LIVE), "those of a model or a Data keep their length"),
    (r"value", _done(rf"{_SLICES}2, 1\)"), "slices that end before they begin"),
    (
        r"refused",
        _done(r".*(None|b?'text'|three|\('a'\)|, 2)\b"),
        "a text is not a list of texts, and an array no list",
    ),
    (r"value", _done(r"\[operator\.delitem\(l, 0\) for e in l\]"), "the loop ends where the list does"),
    (
        r"value",
        _done(r"\[.*operator\.delitem\(l, 0\) or e"),
        "an entry is the same one after another was taken out; there, the one that took its place",
    ),
    (r".*", _done(r".*", r".*StdVec_Vector3\(\).*"), "there they cannot be made of entries"),
    (r"accepted", _done(r"pickle"), "all can be pickled"),
    (
        r".*",
        _done(
            r".*",
            r"(g\.collisionPairs|gd\.activeCollisionPairs|filled\(pin\.StdVec_CollisionPair\(\).*|d\.com)",
        ),
        "empty lists of geometries take anything; a pair is a sequence of two numbers; all points are copied",
    ),
    (
        r"value",
        _done(r"type\(", r"d\.com"),
        "parts of what is computed when it is read are lists of arrays",
    ),
    (r"refused", _done(r".*extend\(\(?'(a|text)'\)?\)"), "a text is no list of texts"),
    (r"value", _done(r"\[.*l\.tolist\(\)\[0\].*", r".*StdVec_Matrix6\(\).*"), "they are copies there"),
    (r"error class", _done(r".*extend\(\(pin\.CollisionPair.*"), "a pair is a sequence of two numbers"),
    (
        r".*",
        _done(r".*", r"filled\(pin\.StdVec_IndexVector\(\).*"),
        "an empty list is an entry there, and entries stay when others take their place",
    ),
    (
        r".*",
        _done(r".*(three|\[\]|'text'|E\)).*", r"(filled\()?pin\.StdVec_Matri\w+\(\).*"),
        "an array without entries is one, and rows are entries",
    ),
    (
        r"value",
        _done(r"\[.*(operator\.setitem\(l, 0, .*or e for e in \[l\[0\]\]|\* 99\) and e)"),
        "what was taken out of a list stays as it is",
    ),
    (r"accepted", _done(r"pin\.StdVec_Index\((other=)?l\)"), "whole numbers of any kind"),
    (
        r"value",
        _done(r".*(in l|__contains__)", r".*RigidConstraintData\(\).*"),
        "data are not compared by what they hold",
    ),
)
"""What differs on purpose: the kind of difference, the expressions, and why."""
