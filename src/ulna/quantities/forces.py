"""External forces on the frames of a robot: arguments of methods, turned into those of algorithms."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ulna.algorithms import Friction
from ulna.checks.masked import check_not_masked
from ulna.checks.values import short_repr
from ulna.errors import InputError, ShapeError
from ulna.lazy import is_dask
from ulna.model import Model
from ulna.quantities.deferred_algorithms import algorithms
from ulna.quantities.quantity import Arguments
from ulna.typing import Array, ArrayLike

Forces = Mapping[str, ArrayLike] | None
"""What the surroundings exert on the robot: frame name -> wrench (..., 6) [N, N m], force first, moment second."""
FORCE_OPTIONS = {"forces": (), "reference": "local_world_aligned"}
"""Options of kernels for external forces, with their defaults."""


def wrench_arguments(options: Mapping[str, Any]) -> Arguments:
    """The additional argument of a kernel for named frames: their wrenches (k, 6)."""
    return (("f_ext", (len(options["forces"]), 6)),) if options["forces"] else ()


def with_external_forces(algorithm: Callable[..., Any]) -> Callable[..., Any]:
    """Turns an algorithm whose last argument are forces on bodies into one with names of frames and their wrenches."""

    @functools.wraps(algorithm)
    def run(model: Model, q: Array, *arrays: Array, forces: Any, reference: Any = "local") -> Any:
        if not forces:
            return algorithm(model, q, *arrays, None)
        frames = [model.frame(name) for name in forces]
        external = algorithms.at_joints(model, q, arrays[-1], frames, reference)
        return algorithm(model, q, *arrays[:-1], external)

    return run


def friction_law(model: Model, friction: bool | Friction) -> Friction | None:
    """The friction law that the option `friction` selects.

    Args:
        model: The robot.
        friction: A law, or whether that of the model counts.

    Returns:
        The law, None for none.

    Raises:
        InputError: It is neither a law nor a truth value.
    """
    if isinstance(friction, Friction):
        return friction
    if not isinstance(friction, (bool, np.bool_)):
        raise InputError(
            f"`friction` is {short_repr(friction)}; expected True for that of the model, False, or a Friction."
        )
    return Friction.of(model) if friction else None


def checked_forces(forces: Any) -> Mapping[str, ArrayLike]:
    """Wrenches by names of frames.

    Args:
        forces: What was passed.

    Returns:
        The same; empty for None.

    Raises:
        InputError: It is something else, such as an array.
    """
    if forces is None:
        return {}
    if not isinstance(forces, Mapping):
        raise InputError(
            f"`forces` is {short_repr(forces)}; expected a dictionary from names of frames to wrenches (..., 6), such "
            "as {'tool': [0, 0, -10, 0, 0, 0]}: force first [N], then moment [N m]."
        )
    return forces


def stacked_wrenches(forces: Mapping[str, ArrayLike]) -> Array:
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
