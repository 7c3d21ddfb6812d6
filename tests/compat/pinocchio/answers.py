"""Evaluates calls with the package that is imported, and says what came of each.

`python answers.py [SEED]` reads lines of JSON, [number, expression], and writes for each a line [number, answer]; before it, the
number alone, so that the reader knows which call ended the process.
"""

from __future__ import annotations

import copy
import inspect
import io
import json
import operator
import pickle
import re
import signal
import sys
import warnings
from contextlib import redirect_stdout
from typing import Any

import numpy as np
import pinocchio as pin
from generated_calls import names_with_numbers

DIGITS = 9
LONGEST = 30


def filled(vector: Any, values: list[Any]) -> Any:
    """A vector with these entries."""
    for value in values:
        vector.append(value)
    return vector


def calculated(model: Any, data: Any, constraint: Any) -> Any:
    """Data of a constraint, after `calc`."""
    made = constraint.createData()
    constraint.calc(model, data, made)
    return made


def data_of(model: Any) -> Any:
    """Data of a model, after kinematics and dynamics."""
    data = model.createData()
    q, v = np.linspace(0.1, 0.6, model.nq), np.linspace(-1.0, 1.0, model.nv)
    pin.computeAllTerms(model, data, q, v)
    pin.aba(model, data, q, v, v)
    pin.computeRNEADerivatives(model, data, q, v, v)
    pin.computeForwardKinematicsDerivatives(model, data, q, v, v)
    pin.computeJointJacobiansTimeVariation(model, data, q, v)
    pin.computeJointKinematicHessians(model, data, q)
    pin.centerOfMass(model, data, q, v, v)
    pin.framesForwardKinematics(model, data, q)
    pin.forwardKinematics(model, data, q, v, v)
    pin.crba(model, data, q)
    return data


def wrote(target: Any, name: str, value: Any) -> Any:
    """What an attribute holds after an assignment, and the names of other attributes that it changed."""
    try:
        value = value(getattr(target, name))
    except Exception as error:
        raise NoValue(repr(error)) from None
    before = contents(target)
    setattr(target, name, value)
    after = contents(target)
    others = [other for other in after if other != name and before.get(other) != after[other]]
    return [getattr(target, name), sorted(others)]


def did(target: Any, action: Any) -> list[Any]:
    """What an action returns, and what its target is then."""
    result = action(target)
    return [result, target]


class NoValue(Exception):
    """The value of an assignment cannot be made."""


def contents(target: Any) -> dict[str, Any]:
    """What the attributes of an object are, as `plain` tells it; classes of errors where they cannot be read."""
    found = {}
    for name in dir(type(target)):
        if name.startswith("_") or not isinstance(inspect.getattr_static(target, name, None), DESCRIPTORS):
            continue
        try:
            found[name] = plain(getattr(target, name))
        except Exception as error:
            found[name] = type(error).__name__
    return found


DESCRIPTORS = (property,)


def plain(value: Any, depth: int = 0) -> Any:
    """Type and content of a value, as JSON has them."""
    kind = re.sub(r"^StdVec.*", "StdVec", type(value).__name__)
    if value is None or isinstance(value, (bool, np.bool_)):
        return {
            "type": "bool" if isinstance(value, np.bool_) else kind,
            "value": None if value is None else bool(value),
        }
    if isinstance(value, str):
        return {"type": kind, "value": value}
    if isinstance(value, (int, float, np.number)):
        return {"type": "int" if isinstance(value, int) else "float", "value": rounded(value)}
    if isinstance(value, np.ndarray):
        return {"type": kind, "shape": list(value.shape), "kind": value.dtype.kind, "value": rounded(value)}
    if depth > 3:
        return {"type": kind}
    if isinstance(value, (list, tuple)) or kind == "StdVec":
        return {
            "type": kind,
            "value": [plain(x, depth + 1) for x in list(value)[:LONGEST]],
            "size": len(value),
        }
    for name in ("toDynamicParameters", "homogeneous", "vector", "coeffs", "matrix", "data"):
        content = getattr(value, name, None)
        if content is not None and kind not in ("Data", "Model", "DelassusOperatorSparse"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                content = content() if callable(content) else content
            if isinstance(content, np.ndarray):
                return {"type": kind, "value": plain(content)}
    return {"type": kind}


def rounded(value: Any) -> Any:
    """Numbers as lists of texts of some digits."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        return str(array)[:80]
    flat = array.astype(float).ravel()[:400]
    return ["nan" if np.isnan(x) else f"{0.0 if abs(x) < 1e-10 else x:.{DIGITS - 2}e}" for x in flat]


NAMES = names_with_numbers(int(sys.argv[1]) if len(sys.argv) > 1 else 0)


def answer(expression: str, prepared: list[Any]) -> dict[str, Any]:
    """What an expression comes to: type, value, printed text; or the classes of its error."""
    names: dict[str, Any] = {"pin": pin, "np": np, "prepared": prepared, "data_of": data_of, "filled": filled}
    names |= {"calculated": calculated, "wrote": wrote, "did": did}
    names |= {"operator": operator, "copy": copy, "pickle": pickle}
    try:
        for name in needed(expression):
            names[name] = eval(NAMES[name], names)
    except Exception as error:
        return {"unusable": repr(error)[:200]}
    out = io.StringIO()
    try:
        with redirect_stdout(out):
            value = eval(expression, names)
        result = plain(value)
        if type(value).__name__ in TEXTS:
            result["text"] = str(value)
    except NoValue as error:
        return {"unusable": str(error)[:200]}
    except Exception as error:
        classes = [c.__name__ for c in type(error).__mro__ if c.__module__ == "builtins"]
        return {"error": classes, "message": str(error)[:160]}
    if out.getvalue():
        result["printed"] = out.getvalue()
    this = re.match(r"\((\w+)\)\.", expression)
    if this and this[1] in ("M", "mo", "fo", "I", "Y", "Q", "AA", "pseudo", "cholesky"):
        result["self"] = plain(names[this[1]])
    return result


TEXTS = (
    "SE3",
    "Motion",
    "Force",
    "Inertia",
    "Symmetric3",
    "Quaternion",
    "AngleAxis",
    "Frame",
    "PseudoInertia",
)


def needed(expression: str) -> list[str]:
    """The names that an expression needs, those first that others need."""
    found: list[str] = []

    def add(text: str) -> None:
        for name in re.findall(r"(?<![\w.'])[A-Za-z_]\w*", text):
            if name in NAMES and name not in found:
                add(NAMES[name])
                found.append(name)

    add(expression)
    return found


def main() -> None:
    """Answers until the input ends."""
    out = sys.stdout
    prepared = [pin.buildSampleModelManipulator()]
    warnings.simplefilter("ignore")
    for line in sys.stdin:
        number, expression = json.loads(line)
        print(json.dumps([number]), file=out, flush=True)
        signal.alarm(60)
        print(json.dumps([number, answer(expression, prepared)]), file=out, flush=True)
        signal.alarm(0)


if __name__ == "__main__":
    main()
