"""Shapes in docstrings are true: functions take arrays of the shapes in `Args:` and return those in `Returns:`."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import ulna
from architecture.test_docstrings import (
    ARRAYS,
    FILES,
    SOURCE,
    entries,
    is_public,
    parsed,
    public_functions,
    sections,
)
from ulna.algorithms.dynamics.joint_friction import Friction
from ulna.algorithms.dynamics.mass_matrix_factors import Factors
from ulna.algorithms.dynamics.operational_space import Task
from ulna.algorithms.multibody.mass_moments import body_moments
from ulna.algorithms.multibody.tree import steps
from ulna.model import FrameContact
from ulna.model.constraint import frame_pairs
from ulna.spatial import SE3, Motion

FOLDERS = ("algorithms/", "spatial/", "linalg.py", "numeric.py")
BATCH = (2, 3)
MODEL = ulna.load("panda", visuals="simple").model
FRAME = MODEL.frame(MODEL.tool)
FRAME_PAIRS = frame_pairs(MODEL, [FrameContact(FRAME.name)])
LENGTHS = {
    "nq": MODEL.nq,
    "nv": MODEL.nv,
    "nbodies": len(MODEL.joints),
    "n": MODEL.nv,
    "m": 6,
    "k": 2,
    "contacts": 1,
}
OTHERS: dict[str, Any] = {
    "model": MODEL,
    "frame": FRAME,
    "frames": [FRAME, MODEL.frames[3]],
    "reference": "local_world_aligned",
    "representation": "rpy/xyz",
    "task": Task(FRAME, damping=0.1),
    "tree": steps(MODEL),
    "step": steps(MODEL)[1],
    "I": body_moments(MODEL, steps(MODEL)),
    "frame_pairs": FRAME_PAIRS,
    "placement": FRAME.placement,
    "T_world_body": SE3.identity(),
    "V": Motion(np.ones((*BATCH, 3)), np.ones((*BATCH, 3))),
    "A": Motion(np.ones((*BATCH, 3)), np.ones((*BATCH, 3))),
    "local": Motion(np.ones(3), np.ones(3)),
    "factors": Factors(np.eye(MODEL.nv)),
    "friction": Friction(0.1, 0.2),
    "measure": "yoshikawa",
    "axes": "all",
    "mu": 0.5,
    "h": 0.01,
    "order": 2,
    "axis": 1,
    "size": BATCH,
    "damping": 0.1,
    "floor": 0.0,
    "rng": np.random.default_rng(0),
}
UNUSUAL = (
    "algorithms/constraints/frame_errors.py: constraint_twists",  # takes no contacts, which have no second frame
    "algorithms/constraints/kkt_factors.py: constrained_motion",  # takes factors of another matrix than the others
    "algorithms/dynamics/center_of_mass.py: total_mass",  # one number
    "algorithms/kinematics/configuration_space.py: random",  # takes the shape of the batch, which is () here
    "algorithms/kinematics/jacobian_partials.py: jacobian_partials",  # as many axes as its order
    "spatial/solid_moments.py: solid_moments",  # takes closed surfaces
    "spatial/solid_moments.py: is_closed",
)
EULER_AXES = "zyx"
ROTATIONS = ("R", "rotation")
SHAPE = re.compile(r"\(([^()]*(?:,|\.\.\.)[^()]*|)\)")


def documented_shapes(text: str) -> list[tuple[int, ...]]:
    """The shapes in a text whose lengths are known; `...` stands for a batch of (2, 3)."""
    shapes = []
    for match in SHAPE.finditer(text):
        lengths: list[int] = []
        for part in filter(None, (part.strip() for part in match[1].split(","))):
            words = part.split()
            if part in ("...", "*size"):
                lengths += BATCH
            elif all(word.isdecimal() or word in LENGTHS or word == "+" for word in words):
                factors = [[LENGTHS.get(w) or int(w) for w in term.split()] for term in part.split("+")]
                lengths.append(sum(int(np.prod(term)) for term in factors))
            else:
                break
        else:
            shapes.append(tuple(lengths))
    return shapes


def value_of(name: str, shape: tuple[int, ...], rng: np.random.Generator) -> Any:
    """Numbers of a shape: a rotation where the name asks for one, a positive definite matrix where it is square."""
    if name in ROTATIONS:
        return np.broadcast_to(np.eye(3), shape)
    value = rng.uniform(0.1, 1.0, shape)
    if len(shape) > 1 and shape[-1] == shape[-2]:
        return value @ np.swapaxes(value, -1, -2) + np.eye(shape[-1])
    return value


def call(function: Callable[..., Any], definition: ast.FunctionDef | ast.AsyncFunctionDef) -> Any:
    """The result for arguments of the documented shapes; None where an argument cannot be made from its text."""
    texts = entries(sections(ast.get_docstring(definition) or "").get("Args", ""))
    rng, values = np.random.default_rng(1), {}
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.default is not inspect.Parameter.empty:
            continue
        shapes = documented_shapes(texts.get(name, ""))
        is_array = ARRAYS.search(str(parameter.annotation)) and "Callable" not in str(parameter.annotation)
        if is_array and "Sequence" not in str(parameter.annotation) and shapes:
            values[name] = value_of(name, shapes[0], rng)
        elif name == "axes" and "spatial" in function.__module__:
            values[name] = EULER_AXES
        elif name in OTHERS:
            values[name] = OTHERS[name]
        elif shapes:
            values[name] = value_of(name, shapes[0], rng)
        else:
            return None
    with np.errstate(all="ignore"):
        return function(**values)


def arrays(result: Any) -> Iterator[Any]:
    """The arrays and numbers among results."""
    several = isinstance(result, tuple) and not hasattr(result, "_fields")
    for one in result if several else (result,):
        if isinstance(one, np.ndarray | np.generic | float):
            yield one


def functions() -> Iterator[tuple[str, Callable[..., Any], ast.FunctionDef | ast.AsyncFunctionDef]]:
    """The public functions of two or more arguments of the folders: name, function, definition."""
    for path in FILES:
        name = path.relative_to(SOURCE).as_posix()
        if name.startswith(FOLDERS) and is_public(path):
            module = importlib.import_module("ulna." + name.removesuffix(".py").replace("/", "."))
            for function, definition, owner in public_functions(parsed(path)):
                if owner is None:
                    yield f"{name}: {function}", getattr(module, function), definition


def test_results_have_the_documented_shapes() -> None:
    compared = 0
    for name, function, definition in functions():
        if name in UNUSUAL:
            continue
        returned = {np.shape(one) for one in arrays(call(function, definition))}
        text = sections(ast.get_docstring(definition) or "").get("Returns", "")
        if returned:
            assert returned == set(documented_shapes(text)), name
            compared += 1
    assert compared >= 100
