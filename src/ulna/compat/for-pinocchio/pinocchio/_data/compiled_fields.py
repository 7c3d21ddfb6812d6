"""Fields of a Data that one kernel computes when they are read, out of the state of the algorithm that left them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import not_applicable
from pinocchio._data.algorithm import STATES, STATES_READ, Deferred
from pinocchio._data.evaluated_model import EvaluatedModel
from pinocchio._data.states import FieldStates
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.joint_table import UnknownKind
from ulna import spatial
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

_MOTIONS = ("v", "ov", "a_gf", "oa_gf")
"""Fields whose first row, the motion of the universe, is set with the others."""


def split_forces(F: Array) -> list[spatial.Force | None]:
    """Rows of an array as forces on joints."""
    return [spatial.Force(F[k, :3], F[k, 3:]) for k in range(F.shape[0])]


@final
class CompiledFields:
    """Fields that `functions(model, *inputs, forces)` computes: a function without arguments for each field.

    `by_table` computes them for a model that is evaluated. The row of the universe is set here where the field is a
    motion, and where `totals` names the field: that row is computed under the name `field[0]` then. All others keep it,
    for algorithms fill it.
    """

    def __init__(
        self,
        inputs: str,
        functions: Callable[..., dict[str, Any]],
        by_table: Callable[..., dict[str, Floats]] | None = None,
        totals: tuple[str, ...] = (),
        is_of_subtrees: bool = False,
    ) -> None:
        self._is_of_subtrees = 1.0 if is_of_subtrees else np.nan
        self._inputs, self._functions, self._by_table = inputs, functions, by_table
        self._totals = totals

    def deferred(self) -> Deferred:
        """How they are computed when they are read."""
        return Deferred(self._inputs, self.fill, self.bind)

    def fill(
        self,
        data: FieldStates,
        compiled: CompiledModel | EvaluatedModel,
        fields: tuple[str, ...],
        *state: Floats,
    ) -> None:
        """Computes fields.

        Args:
            data: Its data, which is filled.
            compiled: The kernels of the model.
            fields: Their names.
            *state: The arrays (...) that they are computed from.
        """
        evaluator = table_of(data, compiled) if self._by_table else None
        names = [*fields, *(f"{field}[0]" for field in self._with_universe(fields))]
        if self._by_table and evaluator:
            computed = self._by_table(evaluator, *state)
            results = tuple(
                computed[name] if name in computed else _of_universe(compiled, name) for name in names
            )
        else:
            results = self._kernel(compiled, fields, state)(*state)
        for name, values in zip(names, results, strict=False):  # what follows is for `bind`
            data._target(name)[...] = values
        for name, value in self._flags(fields):
            data._arrays[name][...] = value

    def bind(
        self, data: FieldStates, number: int, compiled: CompiledModel, fields: tuple[str, ...], *state: Floats
    ) -> Any:
        """Makes a kernel of no arguments that computes fields, see `Deferred.bind`.

        Args:
            data: Its data, which is filled.
            number: That of the algorithm that left the fields.
            compiled: The kernels of the model.
            fields: Their names.
            *state: The arrays (...) that they are computed from, which are read at every call.

        Returns:
            The bound kernel.
        """
        marks = [data._mark_of(field) for field in fields]
        return self._kernel(compiled, fields, state).into(
            *(data._target(field) for field in fields),
            *(data._target(f"{field}[0]") for field in self._with_universe(fields)),
            *marks,
            *(data._arrays[name] for name in _states_of(fields)),
            *(data._arrays[name] for name, _ in self._flags(fields)),
            watch=[(mark, np.array(float(number))) for mark in marks],
            otherwise=not_applicable,
            trailing_inputs=state,
        )

    def _kernel(
        self, compiled: CompiledModel | EvaluatedModel, fields: tuple[str, ...], state: Sequence[Floats]
    ) -> Any:
        """Of a state: the fields, rows of the universe, zeros for marks, and the state that `v` or `a` is of."""
        state_size = len(self._inputs.rstrip("f"))
        with_universe = [f"{field}[0]" for field in self._with_universe(fields)]
        states = _states_of(fields)

        def build(core: CoreModel) -> Any:
            def run(*args: Array) -> tuple[Any, ...]:
                forces = split_forces(args[-1]) if len(args) > state_size else None
                functions = self._functions(core, *args[:state_size], forces)
                computed = [functions[field]() for field in fields]
                universe = [
                    functions[name]() if name in functions else _of_universe(core, name)
                    for name in with_universe
                ]
                given = dict(zip(self._inputs, args, strict=False))
                known = [given.get(name[-1], np.full(core.nv, np.nan)) for name in states]
                flags = (value for _, value in self._flags(fields))
                return *computed, *universe, *([0.0] * len(fields)), *known, *flags

            return run

        shapes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(state)}
        key = self._functions, self._totals, fields, len(state)
        return compiled.compile(key, build, **shapes)

    def _flags(self, fields: tuple[str, ...]) -> list[tuple[str, float]]:
        """Arrays that say whether momenta are of all that joints move: 1, or nan where they are of bodies."""
        return [("subtree momenta", self._is_of_subtrees)] if {"oh", "of"} & {*fields} else []

    def _with_universe(self, fields: tuple[str, ...]) -> list[str]:
        """The fields whose row of the universe is set here."""
        return [field for field in fields if field in (*_MOTIONS, *self._totals)]


def _of_universe(model: Any, name: str) -> Array:
    """That row of a motion, (6,): what does not move accelerates upwards relative to free fall."""
    lift = -np.asarray(model.gravity) if name in ("a_gf[0]", "oa_gf[0]") else np.zeros(3)
    return np.concatenate([lift, np.zeros(3)])


def _states_of(fields: tuple[str, ...]) -> list[str]:
    """The arrays of the states that are known once these fields are filled; their last letters are those of inputs."""
    names = [name for name, field in STATES_READ if field in fields]
    return [f"{name} {letter}" for name in names for letter in STATES[name]]


def table_of(data: FieldStates, compiled: Any) -> TableEvaluator | None:
    """The evaluator for a model that is evaluated; None for others, and where a table does not have its joints.

    Args:
        data: Its data.
        compiled: The kernels of the model.

    Returns:
        The evaluator, or None.
    """
    try:
        return compiled.evaluator(data) if isinstance(compiled, EvaluatedModel) else None
    except UnknownKind:
        return None
