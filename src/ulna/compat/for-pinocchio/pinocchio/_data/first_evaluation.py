"""First calls of a model's algorithms: evaluated by a joint table, or on plain numbers, with nothing compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from pinocchio._containers.arguments import check_layout
from pinocchio._data.algorithm import Algorithm
from pinocchio._data.evaluated_model import NUMBER_CALLS, EvaluatedModel, evaluator_of
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.fields import FIELDS, NotByTable, TableFields
from pinocchio._tables.joint_table import UnknownKind
from ulna.typing import Floats

TABLE_CALLS = 10
"""How many calls of an algorithm are evaluated by a table before the first model is compiled."""


def evaluated(model: KinematicTree, data: FieldStates, algorithm: Algorithm, arrays: list[Floats]) -> Any:
    """The results of an algorithm without a kernel, at the first calls of a model.

    Args:
        data: Its data, which is filled.
        algorithm: The algorithm.
        arrays: Its inputs, converted: q (nq,), v (nv,) and so on.

    Returns:
        What a call returns, or NotImplemented where it is to be compiled.

    Raises:
        InputError: The Data does not fit the model, or gravity has an angular part and counts.
    """
    by_table = algorithm.has_fields_in(FIELDS)
    if not model.first_calls.includes(algorithm.name, TABLE_CALLS if by_table else NUMBER_CALLS):
        return NotImplemented
    check_layout(model, data)
    model._check_gravity(algorithm.depends_on)
    inputs = _inputs(algorithm, arrays)
    try:
        outputs = (_by_table if by_table else _on_numbers)(model, data, algorithm, inputs)
    except (NotByTable, UnknownKind):
        return NotImplemented
    if data._model is not model:
        data._attach(model)
    _store(model, data, algorithm, inputs, outputs)
    results = [np.array(outputs[k]) for k in algorithm.returns]
    return None if not results else results[0] if len(results) == 1 else tuple(results)


def loaded_evaluator(model: KinematicTree, data: FieldStates, function: object) -> TableEvaluator | None:
    """The evaluator of a Data with the parameters of a model, at the first calls of a function; else None.

    Args:
        function: The function, for counting its calls.

    Returns:
        The evaluator, or None.

    Raises:
        InputError: The Data does not fit the model.
    """
    if not model.first_calls.includes(function, TABLE_CALLS):
        return None
    check_layout(model, data)
    if data._model is not model:
        data._attach(model)
    try:
        evaluator = evaluator_of(model, data)
    except UnknownKind:
        return None
    evaluator.load(model)
    return evaluator


def store(
    model: KinematicTree, data: FieldStates, algorithm: Algorithm, arrays: list[Floats], *outputs: Any
) -> None:
    """Writes the results of an algorithm and its state into a Data, and defers the fields that are computed when read.

    Args:
        data: Its data, which is filled.
        algorithm: The algorithm.
        arrays: Its inputs, converted: q (nq,), v (nv,) and so on.
        *outputs: What it fills.
    """
    _store(model, data, algorithm, _inputs(algorithm, arrays), list(outputs))


def _inputs(algorithm: Algorithm, arrays: list[Floats]) -> dict[str, Floats]:
    letters = algorithm.inputs.rstrip("f")
    inputs = dict(zip(letters, arrays, strict=False))
    if letters != algorithm.inputs:
        inputs["f"] = np.stack(arrays[len(letters) :])[1:]
    return inputs


def _by_table(
    model: KinematicTree, data: FieldStates, algorithm: Algorithm, inputs: dict[str, Floats]
) -> list[Floats]:
    evaluator = evaluator_of(model, data)
    evaluator.load(model)
    fields = TableFields(evaluator, model, inputs)
    return [np.array(fields.field(name)) for name in algorithm.fills]


def _on_numbers(
    model: KinematicTree, data: FieldStates, algorithm: Algorithm, inputs: dict[str, Floats]
) -> list[Any]:
    moment = EvaluatedModel(model)
    models = (moment.model, moment.frames) if algorithm.depends_on == "frames" else (moment.model,)
    with np.errstate(all="ignore"):
        results = algorithm.kernel(*models)(*inputs.values())
    return list(results) if isinstance(results, tuple) else [results]


def _store(
    model: KinematicTree,
    data: FieldStates,
    algorithm: Algorithm,
    inputs: dict[str, Floats],
    outputs: list[Any],
) -> None:
    """Writes results and states into the Data, and defers the fields that are computed when they are read."""
    for name, values in zip(algorithm.fills, outputs, strict=True):
        data._target(name)[...] = values
    for name, letter in algorithm.stored_inputs().items():
        data._target(name)[...] = inputs[letter]
    data._mark_filled(*(name for name in algorithm.fills if name in data._slots))
    data._invalidate(algorithm)
    moment, copies = EvaluatedModel(model), {}
    for deferred in set(algorithm.deferred.values()):
        fields = tuple(name for name, other in algorithm.deferred.items() if other is deferred)
        for letter in deferred.inputs:
            copies.setdefault(letter, data._target(f"{algorithm.name} {letter}").copy())
        data._defer(deferred, fields, moment, *(copies[letter] for letter in deferred.inputs))
    data._store_states(algorithm)
