"""Operators between all pairs of objects, arrays and numbers: each pair, both ways round, in place, and operators of one operand.

Each is the text of an expression, as in `generated_calls.py`.
"""

from __future__ import annotations

from collections.abc import Iterator

OBJECTS = (
    *("M", "mo", "fo", "I", "Y", "Q", "AA", "F", "pseudo", "cholesky", "forces", "m", "d", "g", "go", "G", "rigid", "composite"),
    *("pin.LOCAL", "pin.CollisionPair(0, 1)", "pin.BaumgarteCorrectorParameters(2.0, 3.0)", "pin.CoulombFrictionCone(0.4)"),
    *("m.joints[2]", "m.joints[2].createData()", "m.referenceConfigurations"),
)  # fmt: skip
OTHERS = (
    *("2", "0", "0.5", "True", "1j", "None", "'a'", "[1.0, 2.0, 3.0]", "(1.0, 2.0, 3.0)", "np.float64(2.0)", "np.int64(2)"),
    *("np.float32(2.0)", "np.array(2.0)", "three", "q", "np.arange(4.0)", "np.arange(10.0)", "np.zeros(0)", "R", "T", "np.eye(6)"),
    *("np.eye(3, 5)", "np.ones((4, 5))", "np.eye(6, 2)", "np.ones((3, 1))", "np.ones((1, 3))", "np.ones((6, 1))", "np.eye(3).T[:, ::-1]"),
    *("np.arange(3)", "np.arange(6)", "np.array([1j, 0, 2])", "np.full(3, None)", "np.array(['a', 'b', 'c'])", "np.ones(3, np.float32)"),
    *("np.ones((2, 3, 3))", "np.matrix(R)", "object()"),
)  # fmt: skip
BETWEEN = ("+", "-", "*", "/", "//", "%", "**", "@", "^", "|", "&", "<<", "==", "!=", "<", "<=")
IN_PLACE = ("iadd", "isub", "imul", "itruediv", "imatmul", "ixor", "ior", "ipow")
OF_ONE = ("-", "+", "~", "abs", "len", "bool", "int", "float", "hash", "iter", "complex", "round", "reversed")


def operators() -> Iterator[tuple[str, str]]:
    """Pairs of a path, which is the operator, and an expression."""
    for this in OBJECTS:
        for other in (*OBJECTS, *OTHERS):
            for sign in BETWEEN:
                yield sign, f"({this}) {sign} ({other})"
                if other in OTHERS:
                    yield sign, f"({other}) {sign} ({this})"
            for name in IN_PLACE:
                yield name, f"did({this}, lambda x: operator.{name}(x, {other}))"
                if other in OTHERS:
                    yield name, f"did({other}, lambda x: operator.{name}(x, {this}))"
        for name in OF_ONE:
            yield name, f"{name}({this})" if name != "hash" else f"hash({this}) != 0"


DOCUMENTED = (
    (
        r".*",
        r".*m\.referenceConfigurations.*",
        "a dictionary, which NumPy takes there for a sequence without entries",
    ),
    (
        r"accepted",
        r"did\(Y, lambda x: operator\.i(add|sub)\(x, .*|len\(Q\)",
        "a matrix may be added in place, too; four coefficients",
    ),
    (r"text", r".*", "rounding, printed"),
    (
        r"accepted|error class",
        r".*\b(M|AA|Y|Q)\b.*(@|matmul|\[1\.0, 2\.0, 3\.0\]|\(1\.0, 2\.0, 3\.0\)).*",
        "@ is the product, too, and lists are vectors",
    ),
    (
        r"accepted|type|value",
        r".*\b(mo|fo|Y)\b.*(True|[02]|np\.(int64|float32|array)\(2(\.0)?\)).*",
        "numbers of NumPy are taken",
    ),
    (
        r"shape|value",
        r".*\bI\b.*",
        "the momentum of a velocity; there all entries of its matrix times the vector",
    ),
    (r".*", r".*\bforces\b.*", "they have all functions of Python's lists"),
    (r"value", r"did\(m\.joints.*", "joints and their data have separate classes"),
)
"""What differs on purpose: the kind of difference, the expressions, and why."""
