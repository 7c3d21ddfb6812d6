"""A model at one moment, whose quantities are evaluated on numbers instead of being compiled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from pinocchio._containers.arguments import check_layout
from pinocchio._data.states import FieldStates
from pinocchio._model.building import KinematicTree
from pinocchio._model.compiled_model import CompiledModel, fixed_frames
from pinocchio._model.core_model import core_model
from pinocchio._model.kernel_parameters import PARAMETERS, with_parameters
from pinocchio._tables.evaluation import TableEvaluator
from pinocchio._tables.joint_table import JointTable
from ulna import kernels
from ulna.errors import InputError
from ulna.model import Frame
from ulna.model import Model as CoreModel
from ulna.system.cached import cached_property
from ulna.typing import Floats

NUMBER_CALLS = 2
"""How many calls are evaluated on numbers before the first model is compiled; one takes some 0.1 s for a humanoid."""


@final
class EvaluatedModel:
    """Stands in place of a `CompiledModel` for what is computed when it is read.

    Args:
        source: The model, whose present parameters are copied.
    """

    def __init__(self, source: KinematicTree) -> None:
        self._source, self._layout = source, source._layout
        self._parameters = [[x.copy() for x in source._parameter_blocks(name)] for name in PARAMETERS]

    @cached_property
    def model(self) -> CoreModel:
        """Ulna's model of these parameters.

        Raises:
            InputError: Joints were added since.
        """
        source = self._source
        if source._layout is not self._layout:
            raise InputError(
                "Joints were added to the model since this result was computed. Make a new Data: model.createData()."
            )
        core = core_model(source)
        if self.is_present():
            return core
        values = {name: np.concatenate(x) for name, x in zip(PARAMETERS, self._parameters, strict=True)}
        return with_parameters(core, values)

    def evaluator(self, data: FieldStates) -> TableEvaluator:
        """The evaluator of a Data, with these parameters.

        Raises:
            UnknownKind: A joint is of a kind that tables do not have.
        """
        evaluator = evaluator_of(self._source, data)
        evaluator.load_parameters(*map(np.concatenate, self._parameters))
        return evaluator

    def is_present(self) -> bool:
        """Whether the model still has these parameters."""
        return all(
            np.array_equal(before, now)
            for name, blocks in zip(PARAMETERS, self._parameters, strict=True)
            for before, now in zip(blocks, self._source._parameter_blocks(name), strict=True)
        )

    @property
    def frames(self) -> tuple[Frame, ...]:
        """The frames of the model, as they are now."""
        return fixed_frames(self._source)

    @property
    def gravity(self) -> Floats:
        """The acceleration of free fall (3,)."""
        return self._parameters[PARAMETERS.index("gravity")][0]

    def snapshot(self) -> EvaluatedModel:
        """Itself: nothing of it changes."""
        return self

    def compile(self, key: Any, build: Any, echoed: Any = (), /, **shapes: Any) -> Callable[..., Any]:
        """The function `build(model)` of arrays, evaluated on numbers.

        Args:
            key: Not used: nothing is kept.
            build: Makes the function of a model of Ulna.
            echoed: Not used: there are no parameters to return.
            **shapes: Shapes of the arguments, which nothing depends on.

        Returns:
            The function.
        """
        return _quiet(build(self.model))

    def compile_at_frames(
        self, key: Any, build: Any, echoed: Any = (), /, **shapes: Any
    ) -> Callable[..., Any]:
        """The function `build(model, frames)` of arrays, evaluated on numbers; see `compile`.

        Args:
            key: Not used: nothing is kept.
            build: Makes the function of a model of Ulna and its frames.
            echoed: Not used: there are no parameters to return.
            **shapes: Shapes of the arguments, which nothing depends on.

        Returns:
            The function.
        """
        return _quiet(build(self.model, self.frames))

    def kernel(self, name: str, **options: Any) -> Callable[..., Any]:
        """A quantity of Ulna, evaluated on numbers.

        Args:
            name: Its name.
            **options: Its options.

        Returns:
            The function of arrays.
        """
        quantity = kernels.QUANTITIES[name]
        return _quiet(quantity.build(self.model, **{**quantity.options, **options}))


def kernels_for(model: KinematicTree, data: FieldStates, function: object) -> CompiledModel | EvaluatedModel:
    """The kernels of a model's present parameters; evaluated on numbers at the first calls of a function.

    Args:
        data: Its data, whose model it becomes.
        function: The function, for counting its calls.

    Returns:
        The kernels.

    Raises:
        InputError: The Data does not fit the model.
    """
    check_layout(model, data)
    if data._model is model and model.first_calls.includes(function, NUMBER_CALLS):
        return EvaluatedModel(model)
    return data._attach(model)


def loaded_with(compiled: CompiledModel | EvaluatedModel, data: FieldStates) -> TableEvaluator:
    """The evaluator of a Data, with the parameters of kernels.

    Args:
        compiled: The kernels.

    Returns:
        The evaluator.

    Raises:
        UnknownKind: A joint is of a kind that tables do not have.
    """
    if isinstance(compiled, EvaluatedModel):
        return compiled.evaluator(data)
    evaluator = evaluator_of(data._model, data)
    evaluator.load_parameters(*numbers_of(compiled))
    return evaluator


class Numbers(NamedTuple):
    """The numbers of a model, as `TableEvaluator.load_parameters` takes them.

    Attributes:
        placements: Placements of joints, the universe included (njoints, 4, 4) [m].
        inertias: Mass, lever and moments (njoints, 13) [kg, m, kg m^2].
        gravity: The acceleration of free fall (3,) [m/s^2].
        armature: The armature (nv,) [kg m^2].
    """

    placements: Floats
    inertias: Floats
    gravity: Floats
    armature: Floats


def numbers_of(compiled: CompiledModel | EvaluatedModel) -> Numbers:
    """The numbers that kernels belong to.

    Args:
        compiled: The kernels.

    Returns:
        The numbers.
    """
    if isinstance(compiled, EvaluatedModel):
        return Numbers(*map(np.concatenate, compiled._parameters))
    core = compiled.model
    bodies = (core.base_inertia, *core.inertias)
    armature = np.zeros(core.nv)
    for joint in core.joints:
        armature[joint.idx_v : joint.idx_v + joint.nv] = joint.armature[: joint.nv]
    return Numbers(
        np.stack([np.eye(4), *(joint.placement.matrix() for joint in core.joints)]),
        np.stack([np.concatenate([[Y.mass], Y.com, np.reshape(Y.inertia, 9)]) for Y in bodies]),
        np.asarray(core.gravity),
        armature,
    )


def step_on_numbers(
    function: Callable[..., Any], targets: Sequence[Any], returned: Sequence[int]
) -> Callable[..., Any]:
    """What stands in place of a bound kernel at first calls: it evaluates a function and compiles nothing.

    Args:
        function: The function of arrays; its outputs are written into the targets.
        targets: Arrays (...), one for each output.
        returned: The indices of the outputs that a call returns copies of, in a tuple where there are several.

    Returns:
        The step.
    """

    def step(*arrays: Any) -> Any:
        results = _quiet(function)(*arrays)
        for target, value in zip(targets, results, strict=True):
            target[...] = value
        copies = tuple(np.array(targets[k]) for k in returned)
        return copies[0] if len(copies) == 1 else copies or None

    return step


def _quiet(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function without warnings of NumPy about values that it does not take in the end."""

    def run(*arrays: Any) -> Any:
        with np.errstate(all="ignore"):
            return function(*arrays)

    return run


def evaluator_of(model: KinematicTree, data: FieldStates) -> TableEvaluator:
    """The evaluator of a Data, for the joints of a model.

    Returns:
        The evaluator; its parameters are not loaded.

    Raises:
        UnknownKind: A joint is of a kind that tables do not have.
    """
    if data._evaluator is None:
        if model._joint_table is None:
            model._joint_table = JointTable(model)
        data._evaluator = TableEvaluator(model._joint_table, model.nq, model.nv)
    return data._evaluator
