"""Algorithms bound to the arrays of a Data: one native call compares parameters, checks, computes and writes."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arrays import exact, not_applicable
from pinocchio._data.algorithm import PARAMETER_NAMES, Algorithm
from pinocchio._data.first_evaluation import evaluated
from pinocchio._data.states import FieldStates
from pinocchio._model.bound_kernels import not_read
from pinocchio._model.building import KinematicTree
from pinocchio._model.compiled_model import CompiledModel
from ulna.typing import Floats


def run(model: KinematicTree, data: FieldStates, algorithm: Algorithm, *args: Any) -> Any:
    """Runs an algorithm where the bound one did not apply: converts the arguments, and binds it anew.

    Args:
        algorithm: The algorithm.
        *args: Its inputs: q (nq,), v (nv,) and so on.

    Returns:
        Its results.

    Raises:
        InputError: The Data does not fit the model.
        ShapeError: An argument has another size.
    """
    arrays = _converted(model, algorithm, args)
    result = getattr(data._bound, algorithm.name)(*arrays) if data._model is model else NotImplemented
    if result is not NotImplemented:
        return result
    result = evaluated(model, data, algorithm, arrays)
    if result is not NotImplemented:
        return result
    watch = model._watched(algorithm.depends_on)  # first: another thread may change a parameter meanwhile
    compiled = data._attach(model)
    bound = _bind(model, data, compiled, algorithm, watch, algorithm.kernel)
    result = bound(*arrays)
    setattr(data._bound, algorithm.name, bound)
    data._store_states(algorithm)
    return result


def run_at_frame(
    model: KinematicTree,
    data: FieldStates,
    algorithm: Algorithm,
    key: tuple[Any, ...],
    frame: int | None,
    build: Any,
    q: Any,
) -> Any:
    """Runs and binds what `build(model, frames)` makes, whose first output is returned and lies in no field of a Data.

    It is bound at `key` in `data._bound_at`, with the reference frame that is second there. `frame` is the index of
    the frame that it depends on, None where that is no frame of the model.

    Args:
        algorithm: The algorithm.
        key: Key in `data._bound_at`: index, reference frame, kind.
        frame: Index of the frame, or None.
        build: Makes the function that is compiled.

    Returns:
        Its first output.
    """
    arrays = _converted(model, algorithm, (q,))
    result = NotImplemented
    if data._model is model:
        result = data._bound_at.get(key, (not_applicable,))[0](*arrays)
    if result is not NotImplemented:
        return result
    watch = model._watched(algorithm.depends_on) + ([] if frame is None else model._watched("frame", frame))
    compiled = data._attach(model)
    bound = _bind(model, data, compiled, algorithm, watch, build, key)
    result = bound(*arrays)
    data._bound_at[key] = bound, key[1]
    data._store_states(algorithm)
    return result


def _converted(model: KinematicTree, algorithm: Algorithm, args: tuple[Any, ...]) -> list[Floats]:
    return [exact(x, size, name) for (name, size), x in zip(_sizes(model, algorithm), args, strict=True)]


def _sizes(model: KinematicTree, algorithm: Algorithm) -> list[tuple[str, int]]:
    """Names and sizes of the arguments; forces are one for each joint, the universe included."""
    letters = algorithm.inputs.rstrip("f")
    forces = range(model.njoints if letters != algorithm.inputs else 0)
    states = [(PARAMETER_NAMES[letter], model.nq if letter == "q" else model.nv) for letter in letters]
    return [*states, *((f"fext[{k}]", 6) for k in forces)]


def side_outputs(data: FieldStates, algorithm: Algorithm) -> tuple[list[Floats], list[int], list[float]]:
    """What an algorithm writes besides its results: into which arrays, then the indices of inputs, and marks of fields.

    The inputs are those that deferred fields, and the data of joints, are computed from.

    Args:
        algorithm: The algorithm.

    Returns:
        Arrays (...) to write to, numbers of inputs, and values for marks of fields.
    """
    stored = algorithm.stored_inputs()
    marks = {name: 0.0 for name in algorithm.fills if name in data._slots}
    marks |= {name: float(algorithm.number) for name in (*algorithm.deferred, *algorithm.invalidates)}
    targets = [*(data._target(name) for name in stored), *(data._mark_of(name) for name in marks)]
    return targets, [algorithm.inputs.index(letter) for letter in stored.values()], list(marks.values())


def _bind(
    model: KinematicTree,
    data: FieldStates,
    compiled: CompiledModel,
    algorithm: Algorithm,
    watch: Any,
    build: Any,
    key: tuple[Any, ...] = (),
) -> Any:
    shapes: dict[str, Any] = {name: (size,) for name, size in _sizes(model, algorithm)}
    side_targets, stored, marks = side_outputs(data, algorithm)

    def with_side_outputs(*models: Any) -> Any:
        function = build(*models)

        def complete(*args: Any) -> tuple[Any, ...]:
            if "f" in algorithm.inputs:
                states = len(algorithm.inputs) - 1
                args = (*args[:states], np.stack(args[states:])[1:])
            results = function(*args)
            outputs = results if isinstance(results, tuple) else (results,)
            return (*outputs, *(args[k] for k in stored), *marks)

        complete.__name__ = algorithm.title or algorithm.name
        return complete

    with_side_outputs.__name__ = algorithm.title or algorithm.name
    compile_ = compiled.compile_at_frames if key or algorithm.depends_on == "frames" else compiled.compile
    names, parameters = data._parameters_stored_by(compiled, algorithm)
    kernel = compiled.live(compile_(("run", algorithm.name, *key), with_side_outputs, names, **shapes))
    result = [np.zeros(kernel.function.outputs[0].shape)] if key else []
    targets = [*result, *(data._target(name) for name in algorithm.fills), *side_targets, *parameters]
    return kernel.into(
        *targets, returns=algorithm.returns, watch=not_read(kernel, watch), otherwise=not_applicable
    )
