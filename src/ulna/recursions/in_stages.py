"""Derivatives of inverse dynamics in stages, as a part of quantities that are otherwise loops over joints."""

from __future__ import annotations

from collections.abc import Sequence
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
_NAME = "inverse_dynamics_derivatives"


def torque_derivatives(model: Model, loops: Recursion | Composition) -> Recursion | Composition:
    """The derivatives of inverse dynamics by whatever is faster.

    Args:
        model: The robot.
        loops: The loops that compute them.

    Returns:
        Stages where model and processor suit them; else the loops.
    """
    form = algorithms.stages_of_inverse_dynamics_derivatives(model) if model.nv <= _MOST_VELOCITIES else None
    if form is None or not can_write_columns(form, jit.target(), "double"):
        return loops
    return _InStages(model, form, loops)


@final
class _InStages(Composition):
    """The derivatives by stages, compiled when they are first evaluated.

    Args:
        model: The robot.
        form: The stages.
        loops: Loops that compute the same, whose code is shown.
    """

    def __init__(self, model: Model, form: StagedForm, loops: Recursion | Composition) -> None:
        super().__init__(loops.outputs, loops)
        self._model, self._form = model, form

    @cached_property
    def _kernel(self) -> Any:
        shapes: dict[str, Any] = {port.name: port.shape for port in self._form.inputs}
        graph = partial(
            trace, partial(algorithms.inverse_dynamics_derivatives, self._model), name=_NAME, **shapes
        )
        return compile(DeferredFunction(_NAME, "", self._form, graph))

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        shapes = [port.shape for port in self._form.outputs]
        for k in range(len(outputs[0])):
            results = (x[k].reshape(shape) for x, shape in zip(outputs, shapes, strict=True))
            self._kernel(*(np.ascontiguousarray(x[k]) for x in inputs), out=tuple(results))
