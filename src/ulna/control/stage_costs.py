"""Costs of stages: their value, gradient and Hessian along changes of state and control."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ulna.checks.frozen_calls import warn_of_frozen_calls
from ulna.checks.parameters import function_of, names_to_pass
from ulna.compiler import Function, trace
from ulna.control.systems import System
from ulna.errors import InputError, UnknownName
from ulna.typing import Array


def extra_shapes(
    cost: Callable[..., Any], first: Sequence[str], shapes: dict[str, Any]
) -> dict[str, tuple[int, ...]]:
    """The shapes of the arguments of a cost after the first ones.

    Args:
        cost: The function.
        first: What its first arguments are called.
        shapes: Shapes of the others, by name.

    Returns:
        The shapes of the others, in their order.

    Raises:
        InputError: If the cost takes fewer arguments, or another is called as one of a stage.
        UnknownName: If a shape is missing, or there is no argument for one.
    """
    warn_of_frozen_calls(cost, stacklevel=5)
    names = names_to_pass(cost, shapes)
    call = f"cost({', '.join(first)}, ...)"
    if len(names) < len(first):
        raise InputError(f"`cost` takes {len(names)} arguments, {', '.join(names)}; expected {call}.")
    for name in shapes:
        if name not in names[len(first) :]:
            raise UnknownName(
                "further argument of the cost", name, names[len(first) :], f"It is called as {call}."
            )
    for name in names[len(first) :]:
        if name not in shapes:
            raise UnknownName("shape of argument", name, shapes, f"Give it: {name}=(3,), or () for a number.")
        if name in ("x", "u", "z_"):
            raise InputError(
                f"`cost` has an argument {name!r}; expected another name, which stages use themselves."
            )
    return {n: s if isinstance(s, tuple) else (s,) for n in names[len(first) :] for s in (shapes[n],)}


class CostParts:
    """Value, gradient and Hessian of a cost along the changes z = (dx, du) of state and control, to be traced.

    Args:
        system: The dynamics.
        cost: The cost: a number, or residuals.
        extra: Shapes of its further arguments.
        has_control: Whether it takes a control.

    Raises:
        InputError: If the cost is neither a number nor a vector of residuals.
    """

    def __init__(
        self, system: System, cost: Callable[..., Any], extra: dict[str, tuple[int, ...]], has_control: bool
    ) -> None:
        n, nu = system.ndx, system.nu if has_control else 0
        controls: dict[str, Any] = {"u": (nu,)} if has_control else {}
        of_stage = function_of(cost, names_to_pass(cost, extra))
        shapes: dict[str, Any] = {"z_": (n + nu,), "x": (system.nx,), **controls, **extra}

        def along(z: Array, x: Array, *rest: Array) -> Any:
            arguments = [*system.split(system.plus(x, z[:n]))]
            if has_control:
                arguments.append(rest[0] + z[n:])
            return of_stage(*arguments, *rest[len(controls) :])

        self._traced = trace(along, name="cost", **shapes)
        returned = [port.shape for port in self._traced.outputs]
        if len(returned) != 1 or len(returned[0]) > 1:
            shown = ", ".join(map(str, returned))
            raise InputError(
                f"`cost` returns the shape {shown}; expected a number, or one vector of residuals."
            )
        self._is_number = returned[0] == ()
        self._origin = np.zeros(n + nu)
        self._first: Function = self._traced.jacobian("z_")
        self._second: Function | None = self._traced.hessian("z_") if self._is_number else None

    def value(self, x: Array, controls: tuple[Array, ...], p: Sequence[Array]) -> Any:
        """The cost at a state.

        Args:
            x: State (nx,) [any].
            controls: The control (nu,), if there is one.
            p: The further arguments (...) each.

        Returns:
            The cost.
        """
        r = self._traced(self._origin, x, *controls, *p)
        return r if self._is_number else 0.5 * (r @ r)

    def at(self, x: Array, controls: tuple[Array, ...], p: Sequence[Array]) -> tuple[Any, Array, Array]:
        """Cost, gradient and Hessian at a state.

        Args:
            x: State (nx,) [any].
            controls: The control (nu,), if there is one.
            p: The further arguments (...) each.

        Returns:
            Cost, gradient (ndx + nu,) and Hessian (ndx + nu, ndx + nu).
        """
        arguments = (self._origin, x, *controls, *p)
        first = self._first(*arguments)
        if self._second is not None:
            return self._traced(*arguments), first, self._second(*arguments)
        r = self._traced(*arguments)
        return 0.5 * (r @ r), r @ first, first.T @ first
