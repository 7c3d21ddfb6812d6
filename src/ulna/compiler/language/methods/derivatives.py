"""Derivatives of a traced function, each again a traced function."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ulna.compiler.language.differentiation import copy_of, forward, reverse
from ulna.compiler.language.loop_derivatives import SHORT_TAPE
from ulna.compiler.language.ports import Port
from ulna.errors import InputError, ShapeError, UnknownName

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ulna.compiler.language.graph import Graph


class Differentiable:
    """Mixin of `Function`: methods that return its derivatives as functions."""

    name: str
    graph: Graph
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    results: tuple[int, ...]
    single: bool

    def jvp(self) -> Any:
        """Forward derivative: inputs and their tangents `d_<name>` in, tangents of the outputs out."""
        g, inputs, results = copy_of(self.graph, self.results)
        nodes = forward(g, {x: g.input() for x in inputs}, results)
        ports = (*self.inputs, *_prefixed("d_", self.inputs, self.inputs))
        return self._derived("jvp", (g, nodes), self.outputs, self.single, ports)

    def vjp(self) -> Any:
        """Reverse derivative: inputs and cotangents `bar_<name>` of the outputs in, cotangents of the inputs out."""
        g, inputs, results = copy_of(self.graph, self.results)
        nodes = reverse(g, [(y, g.input()) for y in results], inputs)
        ports = (*self.inputs, *_prefixed("bar_", self.outputs, self.inputs))
        outputs = _prefixed("bar_", self.inputs)
        return self._derived("vjp", (g, nodes), outputs, len(outputs) == 1, ports)

    def jacobian(self, wrt: str | int = 0) -> Any:
        """Derivative of every output by one input: shape output + input.

        Takes as many forward sweeps as the input has numbers, or as many reverse sweeps as there are results,
        whichever is fewer; equal parts of the sweeps are shared by the graph.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
        """
        port, entries = self._input_and_entries(wrt)
        g, inputs, results = copy_of(self.graph, self.results)
        chosen = [inputs[k] for k in entries]
        if len(chosen) > len(results):
            nodes = [bar for y in results for bar in reverse(g, [(y, g.constant(1.0))], chosen)]
        else:
            columns = [forward(g, {x: g.constant(1.0)}, results) for x in chosen]
            nodes = [column[row] for row in range(len(results)) for column in columns]
        outputs = tuple(Port(f"d{p.name}_d{port.name}", p.shape + port.shape) for p in self.outputs)
        return self._derived("jacobian", (g, nodes), outputs, self.single)

    def value_and_gradient(self, wrt: str | int = 0) -> Any:
        """The number that the function returns, and its gradient by one input, of that input's shape.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
            ShapeError: If the function does not return a number.
            InputError: If it has several outputs.
        """
        port, entries = self._input_and_entries(wrt)
        self._require_scalar_output("A gradient")
        g, inputs, (value,) = copy_of(self.graph, self.results)
        gradient = reverse(g, [(value, g.constant(1.0))], [inputs[k] for k in entries])
        outputs = (self.outputs[0], Port(f"d{self.outputs[0].name}_d{port.name}", port.shape))
        return self._derived("value_and_gradient", (g, [value, *gradient]), outputs, False)

    def hessian(self, wrt: str | int = 0) -> Any:
        """Second derivative of every output by one input: shape output + input + input; symmetric bit for bit.

        Forward over reverse. Only entries on and above the diagonal are computed.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
        """
        port, entries = self._input_and_entries(wrt)
        g, inputs, results = copy_of(self.graph, self.results, SHORT_TAPE)
        chosen = [inputs[k] for k in entries]
        nodes: list[int] = []
        for y in results:
            gradient = reverse(g, [(y, g.constant(1.0))], chosen)
            upper = [forward(g, {x: g.constant(1.0)}, gradient[: k + 1]) for k, x in enumerate(chosen)]
            nodes += [upper[max(i, k)][min(i, k)] for i in range(len(chosen)) for k in range(len(chosen))]
        outputs = tuple(Port(f"d2{p.name}_d{port.name}2", p.shape + 2 * port.shape) for p in self.outputs)
        return self._derived("hessian", (g, nodes), outputs, self.single)

    def hvp(self, wrt: str | int = 0) -> Any:
        """Product of the Hessian by one input with a vector: inputs and `d_<name>` in, the product out.

        Args:
            wrt: The input's name or number.

        Raises:
            UnknownName: If there is no such input.
            ShapeError: If the function does not return a number.
            InputError: If it has several outputs.
        """
        port, entries = self._input_and_entries(wrt)
        self._require_scalar_output("A product with the Hessian")
        g, inputs, (value,) = copy_of(self.graph, self.results)
        vector = {inputs[k]: g.input() for k in entries}
        nodes = forward(g, vector, reverse(g, [(value, g.constant(1.0))], list(vector)))
        ports = (*self.inputs, *_prefixed("d_", [port], self.inputs))
        return self._derived("hvp", (g, nodes), (Port("out", port.shape),), True, ports)

    def sweeps(self, what: str, wrt: str | int = 0) -> int:
        """How many sweeps over the graph a derivative takes, each about as long as the others.

        Args:
            what: The method of this class that differentiates: "jacobian", "hessian", ...
            wrt: The name or number of the input, for methods that take one.

        Returns:
            The number of sweeps.

        Raises:
            UnknownName: If there is no such input.
        """
        if what == "jacobian":
            return min(len(self.results), len(self._input_and_entries(wrt)[1]))
        if what == "hessian":
            return len(self.results) * (1 + len(self._input_and_entries(wrt)[1]))
        return 2 if what == "hvp" else 1

    def _derived(
        self,
        suffix: str,
        derivative: tuple[Graph, Sequence[int]],
        outputs: tuple[Port, ...],
        single: bool,
        inputs: tuple[Port, ...] = (),
    ) -> Any:
        graph, results = derivative
        return replace(
            self,  # type: ignore[type-var]
            name=f"{self.name}_{suffix}",
            graph=graph,
            inputs=inputs or self.inputs,
            outputs=outputs,
            results=tuple(results),
            single=single,
            doc="",
            columns=None,  # the form of columns is that of the function itself
        )

    def _input_and_entries(self, wrt: str | int) -> tuple[Port, range]:
        """An input by name or number, and the positions of its entries among those of all inputs."""
        names = [p.name for p in self.inputs]
        number = names.index(wrt) if wrt in names else wrt
        if not isinstance(number, int) or not 0 <= number < len(names):
            raise UnknownName("input", wrt, names)
        first = sum(p.size for p in self.inputs[:number])
        return self.inputs[number], range(first, first + self.inputs[number].size)

    def _require_scalar_output(self, what: str) -> None:
        """Refuses a function that returns anything but one number."""
        advice = f"{what} is that of a single number; for others take jacobian or hessian."
        if len(self.outputs) != 1:
            raise InputError(f"{self.name} returns {len(self.outputs)} outputs; expected one. {advice}")
        if self.outputs[0].shape != ():
            raise ShapeError(f"output of {self.name}", self.outputs[0].shape, "()", advice)


def _prefixed(prefix: str, ports: Sequence[Port], beside: Sequence[Port] = ()) -> tuple[Port, ...]:
    """The ports with `prefix` before their names, repeated where a port of `beside` has that name."""
    taken, renamed = {p.name for p in beside}, []
    for port in ports:
        name = prefix + port.name
        while name in taken:
            name = prefix + name
        taken.add(name)
        renamed.append(Port(name, port.shape))
    return tuple(renamed)
