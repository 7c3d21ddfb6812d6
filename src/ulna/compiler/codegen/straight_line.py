"""Writes the steps of straight-line code into functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from ulna.compiler.codegen.node_writer import Module, Writer
from ulna.compiler.codegen.row_table import at
from ulna.compiler.codegen.rows import store
from ulna.compiler.language.ops import TABLE, Op
from ulna.compiler.language.scheduling import Sines, Step, Store, made, used


def define(
    module: Module, name: str, arguments: Sequence[str], attributes: str, lines: Sequence[str]
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


def write_steps(
    to: Writer,
    steps: Iterable[Step],
    slots: Mapping[int, int],
    fetch: Callable[[Writer, int], bool] = lambda to, index: False,
    put: Callable[[Writer, Store], None] = lambda to, step: store(
        to, f"o{step.port}", step.start, [to.names[v] for v in step.values]
    ),
) -> None:
    """Writes the steps of one part; what they need is fetched from the scratch, what is needed later is put there.

    Args:
        to: Where the instructions are written.
        steps: The steps.
        slots: The places of nodes in the scratch.
        fetch: Loads an input that is not loaded at the beginning where it is first used; returns whether it has.
        put: Writes values of an output.
    """
    g, layout = to.graph, to.layout

    def kind(index: int) -> str:
        return layout.truth if TABLE[g.op[index]].is_condition else layout.real

    for step in steps:
        for index in used(g, step):
            if index in to.names:
                continue
            if g.op[index] in (Op.CONST, Op.BOOL):
                to.node(index)
            elif not fetch(to, index):
                to.assign(index, f"load {kind(index)}, {at(to, slots[index])}")
        if isinstance(step, Sines):
            to.sincos(step.arguments)
        elif isinstance(step, Store):
            put(to, step)
        elif step not in to.names:
            to.node(step)
        for index in made(g, step):
            if index in slots:
                to.write(f"store {kind(index)} {to.names[index]}, {at(to, slots[index])}")
