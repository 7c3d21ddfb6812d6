"""The functions that derivatives of a function are."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ulna.compiler.language import differentiation
from ulna.compiler.language.ports import Port, prefixed
from ulna.errors import InputError, ShapeError, UnknownName

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ulna.compiler.language.graph import Graph


class Differentiable:
    """What a function knows of its derivatives; each is a function again."""

    name: str
    graph: Graph
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    single: bool

    def jvp(self) -> Any:
        """Forward derivative: inputs and their tangents `d_<name>` in, tangents of the outputs out."""
        made = differentiation.jvp(self.graph, self.results)
        ports = (*self.inputs, *prefixed("d_", self.inputs, self.inputs))
        return self._derived("jvp", made, self.outputs, self.single, ports)

    def vjp(self) -> Any:
        """Reverse derivative: inputs and cotangents `bar_<name>` of the outputs in, cotangents of the inputs out."""
        made = differentiation.vjp(self.graph, self.results)
        ports = (*self.inputs, *prefixed("bar_", self.outputs, self.inputs))
        outputs = prefixed("bar_", self.inputs)
        return self._derived("vjp", made, outputs, len(outputs) == 1, ports)

    def jacobian(self, wrt: str | int = 0) -> Any:
        """Derivative of every output by one input: shape output + input.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
        """
        port, numbers = self._chosen(wrt)
        made = differentiation.jacobian(self.graph, self.results, numbers)
        outputs = tuple(Port(f"d{p.name}_d{port.name}", p.shape + port.shape) for p in self.outputs)
        return self._derived("jacobian", made, outputs, self.single)

    def value_and_gradient(self, wrt: str | int = 0) -> Any:
        """The number that the function returns, and its gradient by one input, of that input's shape.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
            ShapeError: If the function does not return a number.
            InputError: If it has several outputs.
        """
        port, numbers = self._chosen(wrt)
        self._check_number("A gradient")
        made = differentiation.value_and_gradient(self.graph, self.results, numbers)
        outputs = (self.outputs[0], Port(f"d{self.outputs[0].name}_d{port.name}", port.shape))
        return self._derived("value_and_gradient", made, outputs, False)

    def hessian(self, wrt: str | int = 0) -> Any:
        """Second derivative of every output by one input: shape output + input + input; symmetric bit for bit.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
        """
        port, numbers = self._chosen(wrt)
        made = differentiation.hessian(self.graph, self.results, numbers)
        outputs = tuple(Port(f"d2{p.name}_d{port.name}2", p.shape + 2 * port.shape) for p in self.outputs)
        return self._derived("hessian", made, outputs, self.single)

    def hvp(self, wrt: str | int = 0) -> Any:
        """Product of the Hessian by one input with a vector: inputs and `d_<name>` in, the product out.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
            ShapeError: If the function does not return a number.
            InputError: If it has several outputs.
        """
        port, numbers = self._chosen(wrt)
        self._check_number("A product with the Hessian")
        made = differentiation.hvp(self.graph, self.results, numbers)
        ports = (*self.inputs, *prefixed("d_", [port], self.inputs))
        return self._derived("hvp", made, (Port("out", port.shape),), True, ports)

    def _derived(
        self,
        suffix: str,
        made: tuple[Graph, Sequence[int]],
        outputs: tuple[Port, ...],
        single: bool,
        inputs: tuple[Port, ...] = (),
    ) -> Any:
        graph, results = made
        return replace(
            self,  # type: ignore[type-var]
            name=f"{self.name}_{suffix}",
            graph=graph,
            inputs=inputs or self.inputs,
            outputs=outputs,
            results=tuple(results),
            single=single,
            doc="",
        )

    def _chosen(self, wrt: str | int) -> tuple[Port, range]:
        """An input by name or number, and the numbers of its entries."""
        names = [p.name for p in self.inputs]
        number = names.index(wrt) if wrt in names else wrt
        if not isinstance(number, int) or not 0 <= number < len(names):
            raise UnknownName("input", wrt, names)
        first = sum(p.size for p in self.inputs[:number])
        return self.inputs[number], range(first, first + self.inputs[number].size)

    def _check_number(self, what: str) -> None:
        """Refuses a function that returns anything but one number."""
        advice = f"{what} is that of a single number; for others take jacobian or hessian."
        if len(self.outputs) != 1:
            raise InputError(f"{self.name} returns {len(self.outputs)} outputs; expected one. {advice}")
        if self.outputs[0].shape != ():
            raise ShapeError(f"output of {self.name}", self.outputs[0].shape, "()", advice)
