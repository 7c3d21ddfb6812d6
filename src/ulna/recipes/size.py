"""How large a kernel will be before it is traced: an estimate from the model's tree, its announcement, and its limit.

| symbol | meaning |
|---|---|
| n | number of columns of S, of all joints or of those that carry the frames asked for |
| n_k | number of columns on the way from the world to column k, itself included (Featherstone 2008, section 6.5) |
| nodes | a n + b sum n_k + c sum n_k^2 |

The coefficients are those of chains with inclined axes, which are the largest: robots have half as many nodes or more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import ceil
from typing import Any

from ulna.algorithms.multibody.tree import steps
from ulna.compiler.language.graph import most_operations, refuse_size
from ulna.compiler.runtime.jit import announced
from ulna.model import Model

SECONDS, BYTES = 8e-5, 1.6e3
"""For each node, to trace and compile it."""
_TRACING = 0.3
"""The part of the time that tracing takes."""
_SILENT_SECONDS = 3.0
"""Tracing that takes longer is announced [s]; it is made anew in every process, also where the code is kept on disk."""

COEFFICIENTS: dict[str, tuple[float, float, float]] = {
    "fk": (58, 0, 0),
    "link_poses": (58, 0, 0),
    "jacobian": (70, 0, 0),
    "jacobian_dot": (116, 0, 0),
    "hessian": (36, 19, 0),
    "frame_velocity": (97, 0, 0),
    "frame_acceleration": (144, 0, 0),
    "analytical_jacobian": (84, 0, 0),
    "manipulability": (141, 0, 0),
    "manipulability_gradient": (234, 0, 0),
    "joint_torque_regressor": (0, 95, 0.5),
    "gravity_regressor": (0, 31, 1),
    "frame_velocity_derivatives": (108, 0, 0),
    "frame_acceleration_derivatives": (254, 0, 0),
    "centroidal_derivatives": (850, 0, 0),
    "com_velocity_derivatives": (550, 0, 0),
    "centroidal_matrix": (165, 0, 0),
    "centroidal_matrix_dot": (428, 0, 0),
    "inverse_dynamics": (165, 0, 0),
    "gravity_forces": (35, 0, 0),
    "static_torque": (35, 0, 0),
    "bias_forces": (160, 0, 0),
    "forward_dynamics": (400, 0, 0),
    "inverse_dynamics_derivatives": (280, 129, 0),
    "forward_dynamics_derivatives": (330, 138, 18),
    "mass_matrix": (28, 28, 0),
    "inverse_mass_matrix": (31, 25, 3.5),
    "coriolis_matrix": (155, 77, 0),
    "forward_dynamics_with_jacobian": (148, 40, 1),
    "constrained_dynamics": (148, 40, 1),
    "impulse_dynamics": (100, 40, 1),
    "delassus_matrix": (60, 40, 1),
    "operational_inertia": (230, 39, 1.4),
    "operational_coriolis": (520, 119, 1.4),
    "operational_gravity": (190, 52, 1.4),
    "operational_acceleration": (530, 0, 0),
}
_OF_FRAMES = frozenset(
    {
        "fk", "jacobian", "jacobian_dot", "hessian", "frame_velocity", "frame_acceleration", "analytical_jacobian",
        "manipulability", "manipulability_gradient", "frame_velocity_derivatives", "frame_acceleration_derivatives",
    }
)  # fmt: skip
"""Kernels that depend on the joints alone that carry their frames."""
_OTHERS = (120.0, 0.0, 0.0)


def estimated_nodes(model: Model, name: str, options: Mapping[str, Any]) -> int:
    """About how many nodes the graph of a kernel has."""
    n, pairs, squares = _sizes(model, _joints(model, name, options))
    a, b, c = COEFFICIENTS.get(name, _OTHERS)
    return round(a * n + b * pairs + c * squares)


@contextmanager
def sized(model: Model, name: str, options: Mapping[str, Any]) -> Iterator[None]:
    """Refuses a kernel that would be too large, and announces one that takes long to trace.

    Raises:
        TooLargeError: The estimate is above `most_operations()`.
    """
    nodes = estimated_nodes(model, name, options)
    what = f"{name} of {model.name!r}"
    if nodes > most_operations():
        refuse_size(f"{what} would take about {_rounded(nodes)} operations", nodes * SECONDS, nodes * BYTES)
    seconds = nodes * SECONDS
    if _TRACING * seconds < _SILENT_SECONDS:
        yield
        return
    text = (
        f"tracing {what} (about {_rounded(nodes)} operations), about {ceil(_TRACING * seconds)} s; to compile it then "
        f"takes about {ceil((1.0 - _TRACING) * seconds)} s and {nodes * BYTES / 1e9:.1f} GB"
    )
    with announced(text, f"Tracing {name}", _TRACING * seconds):
        yield


def _joints(model: Model, name: str, options: Mapping[str, Any]) -> Iterable[int]:
    frame = options.get("frame")
    if name not in _OF_FRAMES or frame == "all":
        return range(len(model.joints))
    frames = frame if isinstance(frame, tuple) else (model.tool if frame is None else frame,)
    if not all(isinstance(one, str) for one in frames):
        return ()  # refused, with a better message, by the recipe
    return sorted({joint for one in frames for joint in model.support(model.frame(one).joint)})


def _sizes(model: Model, joints: Iterable[int]) -> tuple[int, int, int]:
    """n, sum n_k and sum n_k^2."""
    before: list[int] = []
    n = pairs = squares = 0
    for step in steps(model, joints):
        depth = before[step.parent] if step.parent >= 0 else 0
        for _ in range(step.kind.nv):
            depth += 1
            n, pairs, squares = n + 1, pairs + depth, squares + depth**2
        before.append(depth)
    return n, pairs, squares


def _rounded(x: float) -> str:
    """Two digits of a large number."""
    return f"{float(f'{x:.1e}'):,.0f}"
