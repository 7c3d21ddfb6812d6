"""Quantities in stages in place of loops over joints: in float64 whatever the precision of arguments and results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, final

import numpy as np

from ulna import algorithms
from ulna.compiler import compile, trace
from ulna.compiler.codegen.columns import can_write_columns
from ulna.compiler.forms.columns import DeferredFunction
from ulna.compiler.forms.stages import StagedForm
from ulna.compiler.runtime import jit
from ulna.model import Model
from ulna.recursions.composition import Composition
from ulna.recursions.recursion import Recursion
from ulna.system.cached import cached_property
from ulna.typing import Floats

_MOST_VELOCITIES = 200
"""Of larger robots the stages take too long to compile."""


def in_stages(
    model: Model, name: str, form: Callable[[Model], StagedForm | None], loops: Recursion | Composition
) -> Recursion | Composition:
    """A quantity by whatever is faster.

    Args:
        model: The robot.
        name: The quantity; `ulna.algorithms` has its definition.
        form: Makes the stages of a robot; None for robots without.
        loops: The loops that compute it.

    Returns:
        Stages where model and processor suit them; else the loops.
    """
    made = form(model) if model.nv <= _MOST_VELOCITIES else None
    if made is None or not can_write_columns(made, jit.target(), "double"):
        return loops
    return _InStages(model, name, made, loops)


@final
class _InStages(Composition):
    """A quantity by stages, compiled when they are first evaluated.

    Args:
        model: The robot.
        name: The quantity.
        form: The stages.
        loops: Loops that compute the same, whose code is shown.
    """

    def __init__(self, model: Model, name: str, form: StagedForm, loops: Recursion | Composition) -> None:
        super().__init__(loops.outputs, loops)
        self._model, self._name, self._form = model, name, form

    @cached_property
    def _kernel(self) -> Any:
        shapes: dict[str, Any] = {port.name: port.shape for port in self._form.inputs}
        graph = partial(
            trace, partial(getattr(algorithms, self._name), self._model), name=self._name, **shapes
        )
        return compile(DeferredFunction(self._name, "", self._form, graph))

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        shapes = [port.shape for port in self._form.outputs]
        for k in range(len(outputs[0])):
            results = [x[k].reshape(shape) for x, shape in zip(outputs, shapes, strict=True)]
            given = (np.ascontiguousarray(x[k]) for x in inputs)
            self._kernel(*given, out=tuple(results) if len(results) > 1 else results[0])
