"""What a Data knows of its fields: the states they belong to, and what is computed only when it is read.

Every field has a mark: 0 where it is filled, the number of the algorithm that deferred it until it is read (or that
invalidated it), -1 where it waits in `Data._waiting`. Bound algorithms write the marks of all fields they touch.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from itertools import compress
from typing import Any, ClassVar, NamedTuple, final

import numpy as np

from pinocchio._containers.arguments import check_layout
from pinocchio._containers.arrays import not_applicable
from pinocchio._data.algorithm import ALGORITHMS, STATES, STATES_READ, Algorithm, Deferred
from pinocchio._data.storage import FILLED_BY, PER_JOINT, READ_INSTEAD, FieldArrays
from pinocchio._model.building import KinematicTree
from pinocchio._model.compiled_model import CompiledModel
from pinocchio._model.kernel_cache import parameters_of
from ulna.compiler.runtime.repeated_calls import forget
from ulna.errors import InputError
from ulna.typing import Floats

_WAITING = -1.0


@final
class BoundAlgorithms:
    """The algorithms bound to one Data, for one model and its parameters; `not_applicable` where none is bound yet."""

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return not_applicable


class Waiting(NamedTuple):
    """Fields that are computed with the kernels of an earlier moment, or under forces."""

    deferred: Deferred
    compiled: CompiledModel | None
    state: tuple[Floats, ...]


class FieldStates:
    """The part of a Data that manages its fields."""

    _called_by_users: ClassVar[bool] = False
    """Whether arguments of its methods are checked; see `check_methods`."""

    _slots: ClassVar[dict[str, int]]
    """Where the mark of a field is."""

    nframes: int
    mass: Any
    tau: Any
    _lists: dict[str, Any]
    _arrays: FieldArrays
    _marks: Any
    _mark_array: Floats
    _waiting: dict[str, Waiting]
    _layout: Any
    _model: KinematicTree
    _compiled: CompiledModel | None
    _evaluator: Any
    """Of first calls."""
    _bound: BoundAlgorithms
    _bound_at: dict[Any, Any]
    """Kernels of frames, by index and reference frame."""
    _bound_reads: dict[tuple[float, str], Any]
    """For the number of an algorithm and a field that it deferred, what computes the field; see `Deferred.bind`."""
    _parameters_of: dict[int, CompiledModel]
    _constraint_sets: list[Any]
    _constraint_solution: Any
    _motion_solution: Any = None
    """What constraintDynamics left last."""
    _motion_derivatives: Any = None
    """The derivatives of it that were computed last."""
    _impact_derivatives: Any = None
    """Those of an impact."""
    _delassus: Any
    _damped: Any
    """Dynamics with a Jacobian that ran last, and their damping."""
    _factored_for: Any = None
    """Those whose factors of the mass matrix are in the arrays."""
    _known_states: set[str]
    _q: Any
    _qv: Any
    _qva: Any
    _q_of_joints: Any
    _qv_of_joints: Any
    _q_of_jacobians: Any
    _qv_of_jacobians: Any
    _state_of_derivatives: Any
    _state_of_forward_dynamics: Any
    _q_of_articulated: Any
    _q_of_centers: Any
    _qv_of_centers: Any

    def _target(self, name: str) -> Floats:
        """Where an algorithm writes: the array of that name, of the joints but the universe, of the whole robot."""
        if name in PER_JOINT:
            return self._arrays[name][1:]
        return self._arrays[name[:-3]][0] if name.endswith("[0]") else self._arrays[name]

    def _mark_of(self, field: str) -> Floats:
        """Where the mark of a field is written."""
        k = self._slots[field]
        return self._mark_array[k : k + 1].reshape(())

    def _attach(self, model: KinematicTree) -> CompiledModel:
        """The kernels of the model's present parameters; algorithms bound to others are released.

        Raises:
            InputError: See `compiled_for`.
        """
        compiled, before = compiled_for(model, self), self._compiled
        if compiled is not before or model is not self._model:
            same_kernels = before is not None and compiled.cache is before.cache
            self._keep_deferred(self._parameters_of if same_kernels else ())
            if not same_kernels:
                self._bound, self._bound_at, self._bound_reads = BoundAlgorithms(), {}, {}
                self._parameters_of = {}
            forget(self)
            self._compiled, self._model, self._constraint_sets = compiled, model, []
        return compiled

    def _keep_deferred(self, but: Container[int]) -> None:
        """Stores, for each deferred field, its kernels and its state; not for those of algorithms in `but`."""
        for field, slot in self._slots.items():
            number = int(self._marks[slot])
            if number > 0 and number not in but and field in ALGORITHMS[number - 1].deferred:
                deferred, compiled, state = self._as_waiting(field)
                self._defer(deferred, self._deferred_with(number, deferred), compiled, *state)

    def _as_waiting(self, field: str) -> Waiting:
        """A deferred field with its kernels and its state, which later calls do not change."""
        number = int(self._marks[self._slots[field]])
        if number == _WAITING:
            return self._waiting[field]
        deferred, compiled = ALGORITHMS[number - 1].deferred[field], self._compiled_of(number)
        state = tuple(x.copy() for x in self._state_of(number, deferred))
        return Waiting(deferred, compiled and compiled.snapshot(), state)

    def _parameters_stored_by(
        self, compiled: CompiledModel, algorithm: Algorithm
    ) -> tuple[tuple[str, ...], list[Floats]]:
        """The names of the parameters that an algorithm stores at every call, and the arrays for them.

        Deferred fields are computed with these, though the parameters may have changed since.

        Args:
            algorithm: The algorithm.

        Returns:
            The names, and arrays (...) for them.
        """
        stored = tuple(parameters_of(algorithm.depends_on)) if algorithm.deferred else ()
        if compiled.parameter_names and algorithm.number not in self._parameters_of:
            self._parameters_of[algorithm.number] = compiled.snapshot()
        return stored, self._parameters_of.get(algorithm.number, compiled).parameters_of(stored)

    def _compiled_of(self, number: int) -> CompiledModel | None:
        """The kernels, and the parameters, of the fields that an algorithm deferred."""
        return self._parameters_of.get(number, self._compiled)

    def _deferred_with(self, number: float, deferred: Deferred) -> tuple[str, ...]:
        """The fields that an algorithm deferred and that are computed together."""
        fields = (name for name, other in ALGORITHMS[int(number) - 1].deferred.items() if other is deferred)
        return tuple(name for name in fields if self._marks[self._slots[name]] == number)

    def _state_of(self, number: float, deferred: Deferred) -> tuple[Floats, ...]:
        return tuple(self._target(f"{ALGORITHMS[int(number) - 1].name} {x}") for x in deferred.inputs)

    def _defer(self, deferred: Deferred, fields: tuple[str, ...], compiled: Any, *state: Floats) -> None:
        """Has fields computed when they are read.

        Args:
            deferred: How they are computed.
            fields: Their names.
            *state: The arrays (...) that they are computed from; they are kept, not copied.
        """
        waiting = Waiting(deferred, compiled, state)
        for field in fields:
            self._waiting[field] = waiting
            self._marks[self._slots[field]] = _WAITING

    def _store_states(self, algorithm: Algorithm) -> None:
        """Notes which states an algorithm stores."""
        self._known_states |= algorithm.known_states()

    def _mark_filled(self, *fields: str) -> None:
        """Marks fields that were filled just now."""
        for field in fields:
            self._marks[self._slots[field]] = 0.0

    def _invalidate(self, algorithm: Algorithm) -> None:
        """Marks the fields that an algorithm invalidates, where it is not a bound one, which marks them itself."""
        for field in algorithm.invalidates:
            self._marks[self._slots[field]] = float(algorithm.number)

    def _read(self, field: str) -> None:
        """Computes a field that was deferred until it is read.

        Raises:
            InputError: The last algorithm leaves an intermediate result there in Pinocchio, and nothing here.
        """
        number = self._marks[self._slots[field]]
        if number == 0.0:
            return
        bound = self._bound_reads.get((number, field))
        if bound is not None and bound() is not NotImplemented:
            return
        if number == _WAITING:
            waiting = self._waiting[field]
            deferred, compiled, state = waiting
            fields = tuple(f for f, other in self._waiting.items() if other is waiting)
            fields = tuple(f for f in fields if self._marks[self._slots[f]] == _WAITING)
        else:
            algorithm = ALGORITHMS[int(number) - 1]
            deferred = algorithm.deferred.get(field)
            if deferred is None:
                fix = f"Call {FILLED_BY[field]} first." if field in FILLED_BY else READ_INSTEAD[field]
                raise InputError(
                    f"`data.{field}` was invalidated by {algorithm.title}, which leaves an intermediate result there "
                    f"in Pinocchio, and nothing here. {fix}"
                )
            compiled, fields = self._compiled_of(int(number)), self._deferred_with(number, deferred)
            state = self._state_of(number, deferred)
            self._bind_read(int(number), deferred, compiled, fields, state)
        deferred.fill(self, compiled, fields, *state)
        for name in fields:
            self._marks[self._slots[name]] = 0.0
            self._waiting.pop(name, None)
        given = dict(zip(deferred.inputs, state, strict=False))  # forces may follow
        for known in (name for name, field in STATES_READ if field in fields):
            self._known_states.add(known)
            for letter in STATES[known]:
                self._arrays[f"{known} {letter}"][...] = given.get(letter, np.nan)

    def _bind_read(
        self, number: int, deferred: Deferred, compiled: Any, fields: tuple[str, ...], state: Any
    ) -> None:
        """Has fields that an algorithm left together computed by one native call from now on."""
        of_algorithm = [name for name, other in ALGORITHMS[number - 1].deferred.items() if other is deferred]
        if deferred.bind is not None and list(fields) == of_algorithm:
            bound = deferred.bind(self, number, compiled, fields, *state)
            if bound is None:
                return
            self._bound_reads.update({(float(number), field): bound for field in fields})

    def _bound_after_reads(
        self,
        fields: Sequence[str],
        bind: Callable[[Callable[..., Any]], Any],
        otherwise: Callable[..., Any] = not_applicable,
    ) -> Any:
        """A bound kernel that needs deferred fields, and computes them where they are not there yet.

        Args:
            fields: Their names.
            bind: Binds the kernel, given what it calls where it does not apply; it watches the marks of these fields.
            otherwise: A kernel bound to the same arrays, which is called where this one does not apply although the
                fields are there.

        Returns:
            The bound kernel.
        """
        marks, reads = self._marks, self._bound_reads

        def call_other(*args: Any) -> Any:
            return otherwise(*args)

        call_other.examines_arrays = True  # pyright: ignore[reportFunctionMemberAccess]
        again = bind(not_applicable if otherwise is not_applicable else call_other)
        slots = [(self._slots[field], field) for field in fields]

        def read_first(*args: Any) -> Any:
            for slot, field in slots:
                number = marks[slot]
                if number:
                    read = reads.get((number, field))
                    if read is None or read() is NotImplemented:
                        return NotImplemented
            return again(*args)

        read_first.examines_arrays = True  # pyright: ignore[reportFunctionMemberAccess]
        return bind(read_first)

    def _compute_deferred(self, but: Container[str] = ()) -> None:
        """Computes all deferred fields but some; those that are invalidated stay so."""
        for field in compress(self._slots, self._marks.tolist()):
            number = self._marks[self._slots[field]]  # 0 where it was computed with another one
            if (
                number
                and field not in but
                and (number == _WAITING or field in ALGORITHMS[int(number) - 1].deferred)
            ):
                self._read(field)

    def _require(self, state: Any, call: str) -> Any:
        """Checks that an earlier algorithm stored a state.

        Args:
            state: The state, or None.
            call: The call that stores it, for the message.

        Returns:
            The state.

        Raises:
            InputError: It is None; the message names the call that stores it.
        """
        if state is None:
            raise InputError(f"This Data holds no results of that kind yet. Call {call} first.")
        return state


_DEFERRED_FIELD = {"velocities": "v", "accelerations": "a"}


def _stored_state(name: str) -> property:
    """The state of a name in `STATES`: an array, or several in a tuple; None until an algorithm has stored it."""
    keys = [f"{name} {x}" for x in STATES[name]]

    def get(self: FieldStates) -> Any:
        if name in _DEFERRED_FIELD:
            self._read(_DEFERRED_FIELD[name])
        if name not in self._known_states:
            return None
        return self._arrays[keys[0]] if len(keys) == 1 else tuple(self._arrays[key] for key in keys)

    def put(self: FieldStates, value: Any) -> None:
        self._known_states.add(name)
        for key, values in zip(keys, (value,) if len(keys) == 1 else value, strict=True):
            self._arrays[key][...] = values

    return property(get, put)


for _attribute, _state in {
    "_q": "placements",
    "_qv": "velocities",
    "_qva": "accelerations",
    "_q_of_joints": "joints",
    "_qv_of_joints": "joint_velocities",
    "_q_of_jacobians": "jacobians",
    "_qv_of_jacobians": "jacobian_rates",
    "_state_of_derivatives": "derivatives",
    "_state_of_forward_dynamics": "forward_dynamics",
    "_q_of_articulated": "articulated",
    "_q_of_centers": "centers",
    "_qv_of_centers": "center_velocities",
}.items():
    setattr(FieldStates, _attribute, _stored_state(_state))


def compiled_for(model: KinematicTree, data: FieldStates) -> CompiledModel:
    """The kernels of the model's present parameters, when the Data fits the model.

    Returns:
        The kernels.

    Raises:
        InputError: Joints were added since the Data was made, or it was made for another robot.
    """
    check_layout(model, data)
    return model._compiled()


def check_frames(model: KinematicTree, data: FieldStates) -> None:
    """Checks that no frame was added since the Data was made.

    Raises:
        InputError: A frame was added.
    """
    if data.nframes != len(model.frames):
        raise InputError(
            f"This Data was made when the model had {data.nframes} frames; now it has {model.nframes}. "
            "Make a new one: data = model.createData() (robot.rebuildData() for a RobotWrapper)."
        )
