"""Makes calls with whatever `roboticstoolbox` this Python finds: `python run_calls.py CALLS RESULTS`.

A result is what the call returned, as plain data, what it printed, its warnings, and the classes of its exception.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import pickle
import signal
import sys
import traceback
import warnings
from typing import Any

import numpy as np
from subjects import SETUP

SECONDS = 20  # a call that takes longer is given up
CLASSES = ("ET", "ETS", "Link", "Robot", "Gripper", "DH", "PoE", "IK_", "URDF")


def plain(value: Any, depth: int = 0) -> Any:
    """The value as plain data: numbers, text, names of types."""
    name = type(value).__name__
    if depth > 4:
        return ("deep", name)
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, (np.bool_,)):
        return bool(value)
    if isinstance(value, (int, float, np.integer, np.floating)):
        return ("number", float(value))
    if name == "IKSolution":
        return ("IKSolution", bool(np.all(value.success)), np.shape(value.q) if value.q is not None else None)
    if hasattr(value, "A") and hasattr(value, "data") and name[:2] in ("SE", "SO", "Tw"):
        return (name, len(value), np.array([np.asarray(x, dtype=complex).real for x in value.data]))
    if isinstance(value, np.ndarray) and value.dtype != object:
        return ("array", value.dtype.kind in "b", np.asarray(value, dtype=float))
    if isinstance(value, np.ndarray) and all(isinstance(x, (int, float)) for x in value.flat):
        return ("array", False, value.astype(float))  # an array of objects that are numbers
    if isinstance(value, np.ndarray) or name in ("Add", "Mul", "Symbol", "Float"):
        return ("symbols", str(value))
    if isinstance(value, dict):
        return ("dict", {str(key): plain(x, depth + 1) for key, x in value.items()})
    if isinstance(value, (list, tuple)):
        return (name if isinstance(value, tuple) else "list", [plain(x, depth + 1) for x in value])
    if isinstance(value, (set, frozenset)):
        return ("set", sorted(map(str, value)))
    if name == "Trajectory":
        arrays = {
            key: plain(getattr(value, key, None))
            for key in ("t", "s", "sd", "sdd", "istime", "tblend", "arrive")
        }
        return ("Trajectory", str(value), arrays)
    if name.startswith("IK_"):
        return (
            name,
            value.name,
            plain(value.We),
            value.ilimit,
            value.slimit,
            value.tol,
            bool(value.joint_limits),
        )
    if any(name.startswith(kind) for kind in CLASSES) or hasattr(value, "links"):
        return ("object", name, str(value))
    return ("thing", name)


def made(call: dict[str, Any], objects: dict[str, Any], base: dict[str, Any]) -> dict[str, Any]:
    """The result of a call."""
    out: dict[str, Any] = {"value": None, "error": None, "text": "", "warnings": []}
    printed = io.StringIO()
    with warnings.catch_warnings(record=True) as caught, contextlib.redirect_stdout(printed):
        warnings.simplefilter("always")
        try:
            names = named(call, objects, base)
        except Exception as error:
            return out | {"error": ["no subject", type(error).__name__, str(error)[:300]]}
        caught.clear()
        signal.setitimer(signal.ITIMER_REAL, SECONDS, 1)  # again: a library may swallow the first
        try:
            if "\n" in call["code"] or " = " in call["code"].partition("(")[0]:
                exec(call["code"], names)
                out["value"] = plain(names["value"])
            else:
                out["value"] = plain(eval(call["code"], names))
        except Exception as error:
            out["error"] = [*(kind.__name__ for kind in type(error).__mro__), str(error)[:300]]
            out["checked"] = is_check(error)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    out["text"] = printed.getvalue()
    kinds = {w.category.__name__ for w in caught}
    out["warnings"] = sorted(kinds & {"DeprecationWarning", "FutureWarning"})
    return out


def is_check(error: BaseException) -> bool:
    """Whether the toolbox raised on purpose: by a `raise`, or in a check of arguments of spatialmath."""
    frames = traceback.extract_tb(error.__traceback__)
    last = frames[-1] if frames else None
    if last is None or not (last.line or "").startswith("raise"):
        return False
    return "roboticstoolbox" in last.filename or last.filename.endswith("argcheck.py")


def named(call: dict[str, Any], objects: dict[str, Any], base: dict[str, Any]) -> dict[str, Any]:
    """The names that a call may use."""
    names, n = dict(base), call["joints"]
    if call["keep"]:
        if call["subject"] not in objects:
            objects[call["subject"]] = eval(call["subject"], dict(base))
        robot = objects[call["subject"]]
    else:
        robot = eval(call["subject"], names)
    draw = np.random.default_rng(5)
    q = np.array([0.2, -0.4, 0.3, -1.8, 0.4, 1.7, 0.5][:n]) if n <= 7 else draw.uniform(-1, 1, n)
    names |= {
        "q": q,
        "qd": draw.uniform(-1, 1, n),
        "qdd": draw.uniform(-1, 1, n),
        "J": draw.uniform(-1, 1, (6, n)),
    }
    names.setdefault("robot", robot)
    return names


def _too_long(*_: Any) -> None:
    raise TimeoutError("the call took too long")


def in_children(calls: list[dict[str, Any]], base: dict[str, Any]) -> dict[str, Any]:
    """The results of calls, which are made in forked processes: one that crashes is noted, and the next goes on."""
    results: dict[str, Any] = {}
    while len(results) < len(calls):
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            with os.fdopen(writing, "wb") as stream:
                objects: dict[str, Any] = {}
                for call in calls[len(results) :]:
                    pickle.dump((call["key"], made(call, objects, base)), stream)
                    stream.flush()
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading, "rb") as stream, contextlib.suppress(EOFError):
            while True:
                key, result = pickle.load(stream)
                results[key] = result
        if os.waitpid(child, 0)[1] and len(results) < len(calls):
            results[calls[len(results)]["key"]] = {
                "value": None,
                "error": ["crash"],
                "text": "",
                "warnings": [],
            }
    return results


if __name__ == "__main__":
    signal.signal(signal.SIGALRM, _too_long)
    import roboticstoolbox
    import spatialmath

    base: dict[str, Any] = {"rtb": roboticstoolbox, "np": np, "sm": spatialmath}
    exec(SETUP, base)
    with open(sys.argv[1]) as file:
        calls = json.load(file)
    results = in_children(calls, base)
    with open(sys.argv[2], "wb") as stream:
        pickle.dump((roboticstoolbox.__file__, results), stream)
