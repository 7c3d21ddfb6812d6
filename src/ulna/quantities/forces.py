"""External forces on the frames of a robot: how methods take them, and how algorithms get them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ulna.algorithms import Friction
from ulna.checks.masked import check_not_masked
from ulna.errors import ShapeError
from ulna.lazy import is_dask
from ulna.model import Model
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.quantity import Arguments
from ulna.typing import Array, ArrayLike

Forces = Mapping[str, ArrayLike] | None
"""What the surroundings exert on the robot: frame name -> wrench (..., 6) [N, N m], force first, moment second."""
FORCES = {"forces": (), "reference": "local_world_aligned"}


def wrenches(options: Mapping[str, Any]) -> Arguments:
    """Named frames add one argument, their wrenches (k, 6)."""
    return (("f_ext", (len(options["forces"]), 6)),) if options["forces"] else ()


def under_forces(algorithm: Callable[..., Any]) -> Callable[..., Any]:
    """An algorithm that takes forces on bodies last, as one that takes names of frames and their wrenches."""

    @functools.wraps(algorithm)
    def run(model: Model, q: Array, *arrays: Array, forces: Any, reference: Any = "local") -> Any:
        if not forces:
            return algorithm(model, q, *arrays, None)
        frames = [model.frame(name) for name in forces]
        external = algorithms.at_joints(model, q, arrays[-1], frames, reference)
        return algorithm(model, q, *arrays[:-1], external)

    return run


def friction_of(model: Model, friction: bool | Friction) -> Friction | None:
    """The law of friction that an option stands for.

    Args:
        model: The robot.
        friction: A law, or whether that of the model counts.

    Returns:
        The law, None for none.
    """
    if isinstance(friction, Friction):
        return friction
    return Friction.of(model) if friction else None


def stacked(forces: Mapping[str, ArrayLike]) -> Array:
    """The wrenches side by side, (..., k, 6)."""
    for name, wrench in forces.items():
        check_not_masked(f"forces[{name!r}]", wrench)
    arrays: list[Any] = [wrench if is_dask(wrench) else np.asarray(wrench) for wrench in forces.values()]
    for name, wrench in zip(forces, arrays, strict=True):
        if wrench.shape[-1:] != (6,):
            raise ShapeError(
                f"forces[{name!r}]", wrench.shape, "(..., 6)", "Force first [N], then moment [N m]."
            )
    if any(is_dask(wrench) for wrench in arrays):
        import dask.array as da  # pyright: ignore[reportMissingImports]

        return da.stack(da.broadcast_arrays(*map(da.asarray, arrays)), axis=-2)
    return np.stack(np.broadcast_arrays(*arrays), axis=-2)
