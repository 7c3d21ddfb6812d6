"""Algorithms whose inputs are fields of a Data as they are, bound to its arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from pinocchio._containers.arrays import not_applicable
from pinocchio._data.algorithm import ALGORITHMS, STATES, Algorithm
from pinocchio._data.data import Data
from pinocchio._data.evaluated_model import NUMBER_CALLS, EvaluatedModel
from pinocchio._data.states import compiled_for
from pinocchio._model.bound_kernels import not_read
from pinocchio._model.kernel_cache import Dependence
from pinocchio._model.model import Model
from ulna.compiler.runtime.repeated_calls import CallCache
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats

_MOST_EARLIER = 4
"""How many kernels, bound for other fields that were read, are kept: the first call after another algorithm and the
second one differ in these fields."""


@final
@dataclass(frozen=True, eq=False)
class OfFields:
    """An algorithm whose inputs are fields of a Data.

    Attributes:
        name: Its name, under which it is bound.
        reads: The fields that it reads, and of states such as "velocities v" the arrays.
        fills: The arrays of the Data that it fills, "of[1:]" for the rows of the joints, "of[0]" for that of the
            universe, "mark of vcom" for the mark of a field; "" for a result that lies in no field.
        build: Makes, of a model of Ulna whose joints count and not its numbers, the function of these fields, of those
            in `if_read` that were read before, of the inertias (n, 13), gravity (3,) and the armature (nv,). Where
            there are fields in `if_read`, the names of those are its second argument. Where `of_numbers` is set, it
            makes of the model with its numbers the function of a dictionary of inputs.
        returns: The index of what a call returns a copy of, or the indices.
        if_read: Fields that are computed when they are read; those that were read, and may have been written to, are
            inputs, too; `mass` where it was written to.
        known_of: For some of them the state that they were computed of; they are inputs where it is `state`.
        unless: For some of them an array that holds nan where they are inputs.
        same: Pairs of arrays that must be equal: of what state the fields are.
        stores: Pairs of an array and one of `reads` that is copied into it.
        leaves: The names of algorithms, and for each the fields that it defers from then on, or invalidates.
        state: The state that these fields are of then, such as "derivatives".
        depends_on: What of the model it depends on besides its inputs; see `KernelCache._watched`.
        holder: What a call returns holds the copy; see `BoundKernel`.
        answer: A field that calls return, live, in place of what `returns` says.
        of_numbers: Whether the numbers of the model are those of the kernel, as in other algorithms.
        as_they_are: With `of_numbers`, fields that are inputs and not computed for it where they wait to be read: each
            with the state that it is of when read, and an array that is an input, too, or "". See `inputs`.
        written: With `of_numbers`, what runs in place of this one where the last of its results is not above zero.
    """

    name: str
    reads: tuple[str, ...]
    fills: tuple[str, ...]
    build: Callable[..., Callable[..., tuple[Any, ...]]]
    returns: int | tuple[int, ...] = 0
    if_read: tuple[str, ...] = ()
    known_of: tuple[tuple[str, str], ...] = ()
    unless: tuple[tuple[str, str], ...] = ()
    same: tuple[tuple[str, str], ...] = ()
    stores: tuple[tuple[str, str], ...] = ()
    leaves: tuple[tuple[str, tuple[str, ...]], ...] = ()
    state: str = ""
    depends_on: Dependence = "structure"
    holder: type | None = None
    answer: str = ""
    of_numbers: bool = False
    as_they_are: tuple[tuple[str, str, str], ...] = ()
    written: OfFields | None = None

    def inputs(self) -> list[str]:
        """The names of the inputs of `build`: of fields, "mark of oh" (0 where it is filled), and of states."""
        names = [*self.reads]
        for field, state, flag in self.as_they_are:
            names += [
                field,
                f"mark of {field}",
                *(f"{state} {x}" for x in STATES[state]),
                *filter(None, [flag]),
            ]
        return list(dict.fromkeys(names))

    def step(self, model: Model, data: Data) -> Any:
        """What is bound to these.

        Args:
            model: The model.
            data: Its data.

        Returns:
            A kernel without arguments, or what answers NotImplemented.
        """
        return data._bound_at.get(self.name, not_applicable) if data._model is model else not_applicable

    def run(self, model: Model, data: Data, calls: CallCache | None = None) -> Any:
        """Fills the Data.

        Args:
            model: The model.
            data: Its data.
            calls: The cache of calls with a Model and a Data that return what this does; the kernel is added to it.

        Returns:
            Copies of the results that are returned; NotImplemented where the fields are not all of one state.

        Raises:
            InputError: The Data does not fit the model.
        """
        result = self.step(model, data)()
        if result is NotImplemented and self.written is not None:
            result = self.written.step(model, data)()
        if result is NotImplemented:
            result = self._run_after_reads(model, data)
        if result is NotImplemented and self.written is not None:
            return self.written.run(model, data)
        if calls is not None and result is not NotImplemented:
            calls.add(self.step(model, data), 0, model, data)
        return result

    def _run_after_reads(self, model: Model, data: Data) -> Any:
        """Computes the fields that it reads, where they were deferred, and then the results."""
        compiled_for(model, data)
        arrays = data._arrays
        if not all(np.array_equal(arrays[one], arrays[other]) for one, other in self.same):
            return NotImplemented
        for field in self._needed(data):
            data._read(field)
        if "mass" in self._taken(data)[0]:  # what is divided by a mass is taken with it
            for field, _ in self.known_of:
                if field != "Jcom":
                    data._read(field)
        return self._run_anew(model, data)

    def _needed(self, data: Data) -> list[str]:
        return [name for name in self.reads if name in data._slots]

    def _run_anew(self, model: Model, data: Data) -> Any:
        """Evaluates it on numbers, or compiles it and binds it to the arrays of the Data and of the model."""
        if self.of_numbers:
            return self._run_with_numbers(model, data)
        taken, watch = self._taken(data)
        bodies = model._parameter_blocks("inertias")
        parameters = [*model._parameter_blocks("gravity"), *model._parameter_blocks("armature")]
        read = [_array(data, name) for name in (*self.reads, *taken)]
        is_evaluated = "mass" in taken  # which is no array
        if is_evaluated or model.first_calls.includes(self.name, NUMBER_CALLS):
            function = self._function(taken)(EvaluatedModel(model).model)
            with np.errstate(all="ignore"):
                return self._left(model, data, function(*read, np.concatenate(bodies), *parameters))
        inputs = [*read, *bodies, *parameters]
        needed = self._needed(data)
        watch += [
            *model._watched(self.depends_on),
            *((data._arrays[x], data._arrays[y]) for x, y in self.same),
            *self._constants(model, data),
        ]
        watch += [(data._mark_of(name), np.zeros(())) for name in needed]
        bind = self._bind(model, data, taken, inputs, watch, range(len(read), len(read) + len(bodies)))
        if data._model is not model:
            return data._bound_after_reads(needed, bind)()
        before = data._bound_at.get((self.name, "bound before"), 0)
        earlier = self.step(model, data) if before < _MOST_EARLIER else not_applicable
        step = data._bound_at[self.name] = data._bound_after_reads(needed, bind, earlier)
        data._bound_at[self.name, "bound before"] = before + 1 if before < _MOST_EARLIER else 1
        return step()

    def _run_with_numbers(self, model: Model, data: Data) -> Any:
        """Evaluates it on numbers, or compiles it and binds it to the arrays of the Data; see `of_numbers`."""
        self._know_states(data)
        names = self.inputs()
        read = [_array(data, name) for name in names]
        if model.first_calls.includes(self.name, NUMBER_CALLS):
            chosen = self.written or self
            function = _of_dictionary(chosen.build(EvaluatedModel(model).model), names)
            with np.errstate(all="ignore"):
                return chosen._left(model, data, function(*read))
        step = data._bound_at[self.name] = self._bind_with_numbers(model, data, names, read)
        return step()

    def _bind_with_numbers(self, model: Model, data: Data, names: list[str], read: list[Floats]) -> Any:
        """Compiles it, and binds it to these inputs, which are arrays of the Data."""
        watch = [*model._watched(self.depends_on)]  # first: another thread may change a parameter meanwhile
        compiled = data._attach(model)
        watch += [*self._constants(model, data), *((data._arrays[x], data._arrays[y]) for x, y in self.same)]
        needed = self._needed(data)
        watch += [(data._mark_of(name), np.zeros(())) for name in needed]
        side_targets, copied, values = self._sides(model, data)

        def build(core: CoreModel) -> Any:
            function = _of_dictionary(self.build(core), names)
            return lambda *args: (*function(*args[len(copied) :]), *args[: len(copied)], *values)

        inputs = [*copied, *read]
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(inputs)}
        kernel = compiled.live(compiled.compile((self.name, len(copied), tuple(values)), build, **sizes))
        outputs = list(zip(self.fills, kernel.function.outputs, strict=False))
        condition = None if self.written is None else len(self.fills)
        last = [] if condition is None else [np.zeros(())]

        def bind(otherwise: Any) -> Any:
            return kernel.into(
                *(_filled(data, name) if name else np.zeros(port.shape) for name, port in outputs),
                *last,
                *side_targets,
                returns=self._returned(),
                watch=not_read(kernel, watch),
                otherwise=otherwise,
                trailing_inputs=inputs,
                condition=condition,
                answer=getattr(data, self.answer) if self.answer else None,
            )

        return data._bound_after_reads(needed, bind) if needed else bind(not_applicable)

    def _know_states(self, data: Data) -> None:
        """Sets to nan the states that are not known yet, and notes those that it stores."""
        for _, state, _ in self.as_they_are:
            if state not in data._known_states:
                for letter in STATES[state]:
                    data._arrays[f"{state} {letter}"][...] = np.nan
        data._known_states |= {name.split()[0] for name, _ in self.stores}

    def _bind(
        self,
        model: Model,
        data: Data,
        taken: tuple[str, ...],
        inputs: list[Floats],
        watch: list[Any],
        bodies: range,
    ) -> Callable[..., Any]:
        """Compiles it; what binds it, given what is called where it does not apply.

        `bodies` are the places of the blocks of inertias among the inputs.
        """
        blocks = tuple(len(inputs[place]) for place in bodies)
        side_targets, copied, values = self._sides(model, data)
        inputs = [*copied, *inputs]
        sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(inputs)}
        key = self.name, taken, tuple(model.parents), len(copied), tuple(values), blocks

        def build(core: CoreModel) -> Any:
            return _with_sides(self._function(taken)(core), len(copied), bodies, values)

        kernel = model._compiled_structure().compile(key, build, **sizes)
        outputs = zip(self.fills, kernel.function.outputs, strict=False)
        targets = [_filled(data, name) if name else np.zeros(port.shape) for name, port in outputs]

        def bind(otherwise: Any) -> Any:
            return kernel.into(
                *targets,
                *side_targets,
                returns=self._returned(),
                watch=watch,
                otherwise=otherwise,
                trailing_inputs=inputs,
                holder=self.holder,
                answer=getattr(data, self.answer) if self.answer else None,
            )

        return bind

    def _taken(self, data: Data) -> tuple[tuple[str, ...], list[tuple[Floats, Floats]]]:
        """The fields of `if_read` that are inputs, and pairs of arrays that are equal while they are the same ones."""
        taken, pairs, arrays = [], [], data._arrays
        states, others = dict(self.known_of), dict(self.unless)
        for name in self.if_read:
            mark = data._mark_of(name)
            pairs.append((mark, mark.copy()))
            if name == "mass":
                changes = arrays["mass changes"]
                pairs.append((changes, changes.copy()))
                mark = 0.0 if changes and not mark else 1.0
            state = states.get(name)
            if state is not None and not mark:
                known = [(arrays[f"{state} {x}"], arrays[f"{self.state} {x}"]) for x in STATES[state]]
                is_known = state in data._known_states and all(np.array_equal(x, y) for x, y in known)
                pairs += known if is_known else [(x, x.copy()) for x, _ in known]
                mark = 0.0 if is_known else 1.0
            if name in others and not mark:
                pairs.append((arrays[others[name]], arrays[others[name]].copy()))
                mark = 0.0 if np.isnan(arrays[others[name]]).all() else 1.0
            if not mark:
                taken.append(name)
        return tuple(taken), pairs

    def _function(self, taken: tuple[str, ...]) -> Callable[[CoreModel], Any]:
        """What makes the function of a model of Ulna, given which fields were read."""
        return (lambda core: self.build(core, taken)) if self.if_read else self.build

    def _returned(self) -> tuple[int, ...]:
        """The indices of the results that a call returns copies of."""
        if self.answer:
            return ()
        return self.returns if isinstance(self.returns, tuple) else (self.returns,)

    def _records(self) -> list[tuple[Algorithm, tuple[str, ...]]]:
        """The algorithms of `leaves`."""
        by_name = {one.name: one for one in ALGORITHMS}
        return [(by_name[name], fields) for name, fields in self.leaves]

    def _constants(self, model: Model, data: Data) -> list[Any]:
        """Parameters, as pairs for `watch`, that are constants of the kernels of what is deferred."""
        if not self.leaves or data._attach(model).parameter_names:  # else they are copied at each call
            return []
        return [
            pair
            for record, _ in self._records()
            if record.deferred
            for pair in model._watched(record.depends_on)
        ]

    def _sides(self, model: Model, data: Data) -> tuple[list[Floats], list[Floats], list[float]]:
        """What a kernel writes besides its results: into which arrays, what is copied there, and marks of fields."""
        arrays, marks = data._arrays, dict.fromkeys(_marked(data, self.fills), 0.0)
        copies = [(arrays[name], arrays[source]) for name, source in self.stores]
        compiled = data._attach(model) if self.leaves else None
        for record, fields in self._records():
            marks |= dict.fromkeys(fields, float(record.number))
            letters = {
                x for field in fields if field in record.deferred for x in record.deferred[field].inputs
            }
            copies += [(arrays[f"{record.name} {x}"], arrays[f"{self.state} {x}"]) for x in sorted(letters)]
            if compiled is not None:
                names, stored = data._parameters_stored_by(compiled, record)
                copies += zip(stored, compiled.live_parameters_of(names), strict=True)
        targets, sources = ([pair[k] for pair in copies] for k in range(2))
        return [*targets, *map(data._mark_of, marks)], sources, list(marks.values())

    def _left(self, model: Model, data: Data, results: Sequence[Any]) -> Any:
        """Writes results, leaves what a call writes besides, and returns copies of those that are returned."""
        arrays = data._arrays
        for name, values in zip(self.fills, results, strict=True):
            if name:
                _filled(data, name)[...] = values
        if self.leaves and data._model is not model:
            data._attach(model)
        for name, source in self.stores:
            arrays[name][...] = arrays[source]
        data._mark_filled(*_marked(data, self.fills))
        for record, fields in self._records():
            for field in fields:
                deferred = record.deferred.get(field)
                if deferred is None:
                    data._marks[data._slots[field]] = float(record.number)
                else:
                    state = (arrays[f"{self.state} {x}"].copy() for x in deferred.inputs)
                    data._defer(deferred, (field,), EvaluatedModel(model), *state)
        if self.answer:
            return getattr(data, self.answer)
        if isinstance(self.returns, tuple):
            return tuple(np.array(results[k], float) for k in self.returns)
        result = np.array(results[self.returns], float)
        return result if self.holder is None else self.holder(result)


def _of_dictionary(function: Any, names: list[str]) -> Any:
    """A function of arrays in the order of their names."""
    return lambda *args: function(dict(zip(names, args, strict=True)))


def _with_sides(function: Any, copied: int, bodies: range, values: list[float]) -> Any:
    """A function of what is copied, and of the inputs with inertias in blocks: its results, the copies and numbers."""

    def run(*args: Any) -> tuple[Any, ...]:
        own = args[copied:]
        inertias = np.concatenate([own[place] for place in bodies])
        results = function(*own[: bodies.start], inertias, *own[bodies.stop :])
        return (*results, *args[:copied], *values)

    return run


def _filled(data: Data, name: str) -> Floats:
    """Where results are written: the whole array of a field, with that of the universe, its row, or all others."""
    if name.startswith("mark of "):
        return data._mark_of(name.removeprefix("mark of "))
    if name.endswith("[1:]"):
        return data._arrays[name[:-4]][1:]
    return data._target(name) if name.endswith("[0]") else data._arrays[name]


def _marked(data: Data, names: tuple[str, ...]) -> list[str]:
    """The fields among those that are filled whose marks are set; not where marks are filled, too."""
    fields = [one.removesuffix("[1:]") for one in names]
    return [name for name in fields if name in data._slots and f"mark of {name}" not in names]


def _array(data: Data, name: str) -> Floats:
    """A field as an array, or the mark of one; "kept com" is a field that is not computed for it."""
    name = name.removeprefix("kept ")
    if name.startswith("mark of "):
        return data._mark_of(name.removeprefix("mark of "))
    return np.array([*list.__iter__(data._lists["mass"])]) if name == "mass" else data._arrays[name]


def inputs_by_name(names: tuple[str, ...], args: tuple[Array, ...]) -> dict[str, Array]:
    """The inputs of an algorithm by the names of fields; those after them are "inertias", "gravity" and "armature".

    Args:
        names: The names of the fields.
        args: The inputs, (...) each.

    Returns:
        The inputs, (...) each.
    """
    return dict(zip((*names, "inertias", "gravity", "armature"), args, strict=True))
