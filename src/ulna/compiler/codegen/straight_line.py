"""Writes the steps of straight-line code into functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ulna.compiler.codegen.scheduling import Sines, Step, Store, made, used
from ulna.compiler.codegen.step_writer import Definitions, StepWriter
from ulna.compiler.language.ops import Op


def define(
    module: Definitions, name: str, arguments: Sequence[str], attributes: str, lines: Sequence[str]
) -> None:
    """A function of a module.

    Args:
        module: Where the definition goes.
        name: Its name.
        arguments: Its arguments, with their types.
        attributes: What is written after them.
        lines: Its instructions, without the last one, which returns.
    """
    head = f"define internal void @{name}({', '.join(arguments)}) {attributes} {{"
    module.definitions[name] = "\n".join([head, "entry:", *lines, "  ret void", "}", ""])


def at(to: StepWriter, place: int | str, scratch: str = "%scratch") -> str:
    """A pointer to a place of the scratch; a place is as wide as a value in all lanes.

    Args:
        to: Where the instruction is written.
        place: Number of the place, or the name of one.
        scratch: The name of the scratch.

    Returns:
        The pointer as an operand, with its type.
    """
    pointer = to.fresh("z")
    to.write(f"{pointer} = getelementptr {to.layout.real}, ptr {scratch}, i64 {place}")
    return f"ptr {pointer}"


def write_steps(
    to: StepWriter,
    steps: Iterable[Step],
    slots: Mapping[int, int],
    fetch: Callable[[Any, int], bool] = lambda to, index: False,
    put: Callable[[Any, Store], None] | None = None,
) -> None:
    """Writes the steps of one part; what they need is fetched from the scratch, what is needed later is put there.

    Args:
        to: Where the instructions are written.
        steps: The steps.
        slots: The places of nodes in the scratch.
        fetch: Loads an input that is not loaded at the beginning where it is first used; returns whether it has.
        put: Writes values of an output; None where no step does.
    """
    g, names = to.graph, to.names
    for step in steps:
        for index in used(g, step):
            if index in names:
                continue
            if g.op[index] in (Op.CONST, Op.BOOL):
                to.node(index)
            elif not fetch(to, index):
                to.assign(index, f"load {to.kind(index)}, {at(to, slots[index])}")
        if isinstance(step, Sines):
            to.sincos(step.arguments)
        elif isinstance(step, Store):
            assert put is not None
            put(to, step)
        else:
            to.nodes(made(g, step))
        for index in made(g, step):
            if index in slots:
                to.write(f"store {to.kind(index)} {names[index]}, {at(to, slots[index])}")
