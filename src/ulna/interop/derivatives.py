"""Directional derivatives of traced functions in both directions, with respect to some of the inputs only.

They are functions again, so derivatives of any order follow; each is made once.
Reference: Griewank and Walther 2008, chapters 3.1 and 3.2.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.compiler import Function, Port, trace
from ulna.system import forks

Choice = tuple[bool, ...]
"""Which inputs are meant."""

_families: weakref.WeakKeyDictionary[Function, Derivatives] = weakref.WeakKeyDictionary()
_lock = forks.lock(forks.RECIPES)


@final
class Derivatives:
    """The directional derivatives of one function, made when first asked for.

    Args:
        function: The function.
    """

    def __init__(self, function: Function) -> None:
        self._function = weakref.ref(function)
        self._made: dict[Any, Function] = {}

    def forward(self, moving: Choice) -> Function:
        """The derivative of the outputs along tangents of some inputs.

        Args:
            moving: For each input, whether it has a tangent.

        Returns:
            A function of all inputs and then of the tangents; its outputs are those of the function.
        """
        return self._cached(("forward", moving), lambda f: _forward(f, moving))

    def reverse(self, wanted: Choice, without: int = 0) -> Function:
        """The derivatives with respect to some inputs of the sum of the outputs, weighted by cotangents.

        Args:
            wanted: For each input, whether it is differentiated by.
            without: How many of the last inputs are left out. The function must be linear in them, so that no
                derivative by them depends on them, and `wanted` may contain no other input.

        Returns:
            A function of the inputs and then of the cotangents of all outputs; its outputs are as the wanted inputs.
        """
        return self._cached(("reverse", wanted, without), lambda f: _reverse(f, wanted, without))

    def _cached(self, key: Any, make: Any) -> Function:
        with _lock:
            made = self._made.get(key)
            if made is None:
                function = self._function()
                assert function is not None  # who asks for a derivative holds the function
                made = self._made[key] = make(function)
            return made


def derivatives_of(function: Function) -> Derivatives:
    """The directional derivatives of a function; the same object at each call."""
    with _lock:
        family = _families.get(function)
        if family is None:
            family = _families[function] = Derivatives(function)
        return family


def _forward(f: Function, moving: Choice) -> Function:
    derivative, count = f.jvp(), len(f.inputs)

    def along(*arrays: Any) -> Any:
        tangents = iter(arrays[count:])
        filled = [next(tangents) if m else np.zeros(p.shape) for m, p in zip(moving, f.inputs, strict=True)]
        return derivative(*arrays[:count], *filled)

    ports = [*f.inputs, *(p for p, m in zip(derivative.inputs[count:], moving, strict=True) if m)]
    return _traced(along, derivative, ports)


def _reverse(f: Function, wanted: Choice, without: int) -> Function:
    derivative, count = f.vjp(), len(f.inputs) - without

    def back(*arrays: Any) -> Any:
        absent = [np.zeros(p.shape) for p in f.inputs[count:]]
        bars = derivative(*arrays[:count], *absent, *arrays[count:])
        bars = (bars,) if derivative.single else bars
        return tuple(bar for bar, w in zip(bars, wanted, strict=True) if w)

    return _traced(back, derivative, [*f.inputs[:count], *derivative.inputs[len(f.inputs) :]])


def _traced(run: Any, derivative: Function, ports: Sequence[Port]) -> Function:
    """The part of a derivative that is needed, as a function of these ports (whose names may repeat)."""
    rules = "relaxed" if derivative.graph.relaxed else "exact"
    shapes: dict[str, Any] = {f"x{k}": port.shape for k, port in enumerate(ports)}
    return trace(run, name=derivative.name, rules=rules, **shapes)
