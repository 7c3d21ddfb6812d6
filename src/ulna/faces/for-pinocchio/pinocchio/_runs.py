"""Algorithms bound to the arrays of a Data: one native call compares numbers of the model, checks, computes, writes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, final

import numpy as np

from pinocchio._arrays import exact
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data import Data
    from pinocchio._engine import Engine
    from pinocchio._model import Model

_NAMES: list[str] = []
_ARGUMENTS = {"q": "q", "v": "v", "a": "a", "t": "tau"}


def refuse(*_: Any) -> Any:
    """What stands where nothing is bound yet, and what a bound algorithm calls when it does not apply."""
    return NotImplemented


@final
@dataclass(frozen=True)
class Algorithm:
    """An algorithm whose results lie in a Data.

    Attributes:
        name: Its name, an attribute of `Runs`.
        inputs: A letter for each input: q, v, a, t (torques).
        targets: The arrays of a Data that its outputs go into; see `Data.target`.
        build: Makes of the tower's model (and its frames, where `on` says so) a function of the inputs.
        returns: Numbers of outputs that are returned, as copies.
        on: What its results depend on: placements of joints, all numbers of the model, or placements and frames.
    """

    name: str
    inputs: str
    targets: tuple[str, ...]
    build: Callable[..., Any]
    returns: tuple[int, ...] = ()
    on: Literal["places", "numbers", "frames"] = "numbers"

    def __post_init__(self) -> None:
        _NAMES.append(self.name)


@final
class Runs:
    """The algorithms bound to one Data, for one model and the numbers it had; `refuse` where none is bound yet."""

    def __init__(self) -> None:
        for name in _NAMES:
            setattr(self, name, refuse)

    if TYPE_CHECKING:

        def __getattr__(self, name: str) -> Callable[..., Any]: ...


def run(model: Model, data: Data, algorithm: Algorithm, *args: Any) -> Any:
    """Runs an algorithm where the bound one did not apply: converts the arguments, and binds it to the present numbers.

    Raises:
        InputError: the Data does not fit the model.
        ShapeError: an argument has another size.
    """
    engine = data.attach(model)
    given = [
        exact(x, model.nq if letter == "q" else model.nv, _ARGUMENTS[letter])
        for letter, x in zip(algorithm.inputs, args, strict=True)
    ]
    bound = _bind(model, data, engine, algorithm)
    found = bound(*given)
    setattr(data._run, algorithm.name, bound)
    data._known.update(target.split()[0] for target in algorithm.targets if " " in target)
    return found


def _bind(model: Model, data: Data, engine: Engine, algorithm: Algorithm) -> Any:
    shapes: dict[str, Any] = {_ARGUMENTS[x]: (model.nq if x == "q" else model.nv,) for x in algorithm.inputs}
    make = engine.of_frame if algorithm.on == "frames" else engine.made
    kernel = make(("run", algorithm.name), algorithm.build, **shapes)
    targets = [data.target(name) for name in algorithm.targets]
    watch = model.watched(algorithm.on)
    return kernel.into(*targets, returns=algorithm.returns, watch=watch, otherwise=refuse)


@final
class Scratch:
    """A kernel of whose first output every call returns a copy, and which refuses what is not exactly its argument."""

    def __init__(self, kernel: Any, watch: Any = (), *others: Floats) -> None:
        self.result: Floats = np.zeros(kernel.function.outputs[0].shape)
        self.call = kernel.into(self.result, *others, returns=(0,), watch=watch, otherwise=refuse)
