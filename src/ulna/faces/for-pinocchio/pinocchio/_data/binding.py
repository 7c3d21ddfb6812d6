"""Algorithms bound to the arrays of a Data: one native call compares numbers of the model, checks, computes, writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, final

import numpy as np

from pinocchio._containers.arrays import exact
from pinocchio._model.kernel_parameters import unread
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data.data import Data
    from pinocchio._data.deferred_fields import Late
    from pinocchio._model.kernels import Engine
    from pinocchio._model.model import Model

ALGORITHMS: list[Algorithm] = []
"""All of them; a field of a Data is marked with the number of the one that left it, the first being 1."""
_ARGUMENTS = {"q": "q", "v": "v", "a": "a", "t": "tau"}


def refuse(*_: Any) -> Any:
    """What stands where nothing is bound yet, and what a bound algorithm calls when it does not apply."""
    return NotImplemented


@final
@dataclass(frozen=True, eq=False)
class Algorithm:
    """An algorithm whose results lie in a Data.

    Attributes:
        name: Its name, an attribute of `Runs`.
        inputs: A letter for each input: q, v, a, t (torques), and at the end f (a force for every joint).
        targets: The arrays of a Data that its outputs go into; see `Data.target`.
        build: Makes of the tower's model (and its frames, where `on` says so) a function of the inputs.
        returns: Numbers of outputs that are returned, as copies.
        on: What its results depend on: placements of joints, all numbers of the model, or placements and frames.
        late: Fields that are computed when they are read, of its inputs (or of what it writes to `<name> a`).
        spoils: Fields that hold an intermediate step after it in Pinocchio, and here nothing.
        title: Its name for people.
        number: What marks the fields that it left.
    """

    name: str
    inputs: str
    targets: tuple[str, ...]
    build: Callable[..., Any]
    returns: tuple[int, ...] = ()
    on: Literal["places", "numbers", "frames"] = "numbers"
    late: Mapping[str, Late] = field(default_factory=dict)
    spoils: tuple[str, ...] = ()
    title: str = ""
    number: int = field(init=False)

    def __post_init__(self) -> None:
        ALGORITHMS.append(self)
        object.__setattr__(self, "number", len(ALGORITHMS))


@final
class Runs:
    """The algorithms bound to one Data, for one model and the numbers it had; `refuse` where none is bound yet."""

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return refuse


def run(model: Model, data: Data, algorithm: Algorithm, *args: Any) -> Any:
    """Runs an algorithm where the bound one did not apply: converts the arguments, and binds it to the present numbers.

    Raises:
        InputError: the Data does not fit the model.
        ShapeError: an argument has another size.
    """
    given = _converted(model, algorithm, args)
    found = getattr(data._run, algorithm.name)(*given) if data._model is model else NotImplemented
    if found is not NotImplemented:
        return found
    watch = model.watched(algorithm.on)  # before the engine: another thread may change a number meanwhile
    engine = data.attach(model)
    bound = _bind(model, data, engine, algorithm, watch, algorithm.build)
    found = bound(*given)
    setattr(data._run, algorithm.name, bound)
    data.knows(algorithm)
    return found


def _converted(model: Model, algorithm: Algorithm, args: tuple[Any, ...]) -> list[Floats]:
    return [exact(x, size, name) for (name, size), x in zip(_sizes(model, algorithm), args, strict=True)]


def _sizes(model: Model, algorithm: Algorithm) -> list[tuple[str, int]]:
    """Names and sizes of the arguments; forces are one for each joint, the universe included."""
    letters = algorithm.inputs.rstrip("f")
    forces = range(model.njoints if letters != algorithm.inputs else 0)
    states = [(_ARGUMENTS[letter], model.nq if letter == "q" else model.nv) for letter in letters]
    return [*states, *((f"fext[{k}]", 6) for k in forces)]


def run_at(
    model: Model,
    data: Data,
    algorithm: Algorithm,
    place: tuple[Any, ...],
    frame: int | None,
    build: Any,
    q: Any,
) -> Any:
    """Runs and binds what `build(model, frames)` makes, whose first output is returned and lies in no field of a Data.

    It is bound at `place` in `data._run_at`, with the reference that is second there. `frame` is what it is of,
    None where that is no frame of the model.
    """
    given = _converted(model, algorithm, (q,))
    found = data._run_at.get(place, (refuse,))[0](*given) if data._model is model else NotImplemented
    if found is not NotImplemented:
        return found
    watch = model.watched(algorithm.on) + ([] if frame is None else model.watched("frame", frame))
    engine = data.attach(model)
    bound = _bind(model, data, engine, algorithm, watch, build, place)
    found = bound(*given)
    data._run_at[place] = bound, place[1]
    data.knows(algorithm)
    return found


def traces(data: Data, algorithm: Algorithm) -> tuple[list[Floats], list[int], list[float]]:
    """What an algorithm writes besides its results: where, then the inputs that go there, and the marks after them.

    The inputs are those that late fields, and the data of joints, are of; the marks say what is filled, late, spoilt.
    """
    kept = kept_by(algorithm)
    marks = {name: 0.0 for name in algorithm.targets if name in data.slots}
    marks |= {name: float(algorithm.number) for name in (*algorithm.late, *algorithm.spoils)}
    where = [*(data.target(name) for name in kept), *(data.mark_of(name) for name in marks)]
    return where, [algorithm.inputs.index(letter) for letter in kept.values()], list(marks.values())


def kept_by(algorithm: Algorithm) -> dict[str, str]:
    """Where an algorithm keeps which of its inputs."""
    needed = {letter for late in algorithm.late.values() for letter in late.inputs}
    kept = {f"{algorithm.name} {letter}": letter for letter in algorithm.inputs if letter in needed}
    if "liMi" in algorithm.late:
        kept["own q"] = "q"
        if "v" in algorithm.inputs and {"v", "ov"} & {*algorithm.late, *algorithm.targets}:
            kept |= {"moving q": "q", "moving v": "v"}
    return kept


def _bind(
    model: Model,
    data: Data,
    engine: Engine,
    algorithm: Algorithm,
    watch: Any,
    build: Any,
    place: tuple[Any, ...] = (),
) -> Any:
    shapes: dict[str, Any] = {name: (size,) for name, size in _sizes(model, algorithm)}
    where, kept, marks = traces(data, algorithm)

    def built(*models: Any) -> Any:
        results = build(*models)

        def whole(*given: Any) -> tuple[Any, ...]:
            if "f" in algorithm.inputs:
                states = len(algorithm.inputs) - 1
                given = (*given[:states], np.stack(given[states:])[1:])
            found = results(*given)
            return (*(found if isinstance(found, tuple) else (found,)), *(given[k] for k in kept), *marks)

        whole.__name__ = algorithm.title or algorithm.name
        return whole

    built.__name__ = algorithm.title or algorithm.name
    make = engine.of_frame if place or algorithm.on == "frames" else engine.made
    numbers, told = data.keeps(engine, algorithm)
    kernel = engine.living(make(("run", algorithm.name, *place), built, numbers, **shapes))
    own = [np.zeros(kernel.function.outputs[0].shape)] if place else []
    targets = [*own, *(data.target(name) for name in algorithm.targets), *where, *told]
    return kernel.into(*targets, returns=algorithm.returns, watch=unread(kernel, watch), otherwise=refuse)


@final
class Scratch:
    """A kernel of whose first output every call returns a copy, and which refuses what is not exactly its argument.

    It reads its last inputs from `given`, arrays that stay, and writes its other outputs into `others`.
    """

    def __init__(
        self, kernel: Any, watch: Any = (), others: Sequence[Floats] = (), given: Sequence[Floats] = ()
    ) -> None:
        self.result: Floats = np.zeros(kernel.function.outputs[0].shape)
        targets = self.result, *others
        self.call = kernel.into(*targets, returns=(0,), watch=watch, otherwise=refuse, given=given)
