"""The order in which a graph is written: sines together, results stored early, in parts that LLVM compiles quickly.

A value that is computed early and used late occupies memory, so a good order has few of them. LLVM's own scheduling
of thousands of instructions is slow and poor; so a large graph becomes several functions, one after the other, which
pass values through a scratch buffer.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Container, Iterable, Iterator, Sequence
from itertools import accumulate, pairwise
from typing import NamedTuple

from ulna.compiler.language.function import Function
from ulna.compiler.language.graph import Graph
from ulna.compiler.language.ops import Op

_SIZES = {False: 400, True: 450}
"""About how many instructions a part has, without and with SIMD lanes."""
_LOOP_SIZES = {False: 800, True: 600}
"""The same of parts of a loop's body, whose state passes through memory in every iteration as it is."""
_MAX_WHOLE_BODY = {False: 4_000, True: 15_000}
"""The same of a loop's body that stays in one function.

In lanes the scratch of parts is eight times as large: inverse kinematics of humanoids took a tenth to two fifths longer
in parts."""
_SINES = frozenset({int(Op.SIN), int(Op.COS)})
_LOOP = int(Op.LOOP)
_MAX_SINGLE_PART = 1_500
"""How many instructions in SIMD lanes stay in one part: passing values between parts is costly."""


class Sines(NamedTuple):
    """Sine and cosine of some nodes, computed together."""

    arguments: tuple[int, ...]


class Store(NamedTuple):
    """Neighbouring values of an output, written together."""

    port: int
    start: int
    values: tuple[int, ...]


Step = int | Sines | Store
"""A node is computed, or one of the above."""


def made(graph: Graph, step: Step) -> Sequence[int]:
    """The nodes that a step computes; a loop comes with all that is read of its last state.

    Args:
        graph: The graph that is evaluated.
        step: A node, several sines and cosines, or a store of results.

    Returns:
        The nodes; none for a store.
    """
    if type(step) is int:  # most are; so it is found in less time
        return (step,) if graph.op[step] != _LOOP else range(step, step + 1 + graph.data[step].size)
    assert not isinstance(step, int)
    if isinstance(step, Store):
        return ()
    partners = (graph.find(op, argument) for argument in step.arguments for op in (Op.SIN, Op.COS))
    return [index for index in partners if index is not None]


def used(graph: Graph, step: Step) -> Sequence[int]:
    """The nodes that a step needs.

    Args:
        graph: The graph that is evaluated.
        step: A node, several sines and cosines, or a store of results.

    Returns:
        The nodes whose values it reads.
    """
    if type(step) is int:
        return graph.args[step]
    assert not isinstance(step, int)
    return step.values if isinstance(step, Store) else step.arguments


def parts(f: Function, lanes: int, pack: int) -> list[list[Step]]:
    """The steps that evaluate `f`, in parts that compile in acceptable time.

    The inputs are the first steps of the first part. With several parts in SIMD lanes, the last one has all the stores
    and nothing else, so that they can become a loop.

    Args:
        f: The function; with a loop whose iterations are recorded it stays one part.
        lanes: How many samples are evaluated at once.
        pack: For one sample, how many sines are taken at once; 1 for SIMD lanes, where a node holds as many as
            fit.

    Returns:
        The steps of each part, in the order in which they are written.
    """
    order = list(_order(f, 1 if f.lanes > 1 else lanes, pack))
    if f.tape_size or f.lanes > 1:  # a loop and what reads its tape are in one function
        return _cut(f, order, 1)
    size = sum(map(_instructions, order))
    if lanes == 1:
        return _cut(f, order, round(size / _SIZES[False]))
    size += len(f.results) * (2 + lanes.bit_length())  # transposing and writing
    if size < _MAX_SINGLE_PART:
        return _cut(f, order, 1)
    last: list[Step] = [step for step in order if isinstance(step, Store)]
    rest = [step for step in order if not isinstance(step, Store)]
    return [*_cut(f, rest, round(size / _SIZES[True])), last]


def loop_parts(
    graph: Graph, results: Sequence[int], kept: Sequence[int], given: Container[int], lanes: int, pack: int
) -> list[list[Step]]:
    """The steps of the body of a large loop, in parts that compile in acceptable time.

    Args:
        graph: The body.
        results: The nodes that are wanted.
        kept: The nodes that are stored, each as soon as it is known.
        given: The nodes that are computed already.
        lanes: How many samples are evaluated at once.
        pack: As for `parts`.

    Returns:
        The steps of each part; none of a body that stays whole, since it is small or has loops itself.
    """
    live = graph.live([*results, *kept])
    if any(graph.op[index] == Op.LOOP for index in live):
        return []
    waiting: dict[int, list[Step]] = {}
    for k, node in enumerate(kept):
        waiting.setdefault(node, []).append(Store(0, k, (node,)))
    done, order = {index for index in live if index in given}, list[Step]()
    for index in done:
        order += waiting.pop(index, ())
    for step in ordered(graph, [*results, *kept], pack):
        new = [index for index in made(graph, step) if index not in done]
        if new:
            order.append(step)
            done.update(new)
            for index in new:
                order += waiting.pop(index, ())
    size = sum(map(_instructions, order))
    return [] if size < _MAX_WHOLE_BODY[lanes > 1] else _pieces(order, round(size / _LOOP_SIZES[lanes > 1]))


def scratch_places(
    graph: Graph, pieces: Sequence[Sequence[Step]], results: Sequence[int] = ()
) -> dict[int, int]:
    """Where in the scratch the nodes lie that a later part needs; a place that is free again is taken again.

    Constants are written anew in each part, but those among `results` are in the scratch, too.

    Args:
        graph: The graph.
        pieces: The steps of each part.
        results: Nodes that are in the scratch even if they are constants.

    Returns:
        The place of each node that has one.
    """
    constant = (Op.CONST, Op.BOOL)
    handed = {index for index in results if graph.op[index] in constant}
    last: dict[int, int] = {}
    for number, steps in enumerate(pieces):
        for step in steps:
            for index in used(graph, step):
                last[index] = number
    slots: dict[int, int] = {}
    free: list[int] = []
    ending: list[list[int]] = [[] for _ in pieces]
    count = 0
    for number, steps in enumerate(pieces):
        for index in (index for step in steps for index in made(graph, step)):
            is_late = index not in slots and last.get(index, 0) > number
            if is_late and (graph.op[index] not in constant or index in handed):
                if not free:
                    free.append(count)
                    count += 1
                slots[index] = free.pop()
                ending[last[index]].append(slots[index])
        free += ending[number]
    return slots


def _cut(f: Function, steps: Sequence[Step], count: int) -> list[list[Step]]:
    """The inputs, then the other steps, in up to `count` parts that take equally long."""
    g = f.graph
    inputs: list[Step] = [index for index in g.live(f.results) if g.op[index] == Op.INPUT]
    order = [step for step in steps if not isinstance(step, int) or g.op[step] != Op.INPUT]
    pieces = _pieces(order, max(count, 1))
    return [[*inputs, *piece] if k == 0 else piece for k, piece in enumerate(pieces or [[]])]


def _pieces(order: Sequence[Step], count: int) -> list[list[Step]]:
    """The steps in up to `count` parts that take equally long."""
    ends = list(accumulate(map(_instructions, order), initial=0))
    cuts = [bisect_left(ends, ends[-1] * k / count) for k in range(count)]
    return [list(order[start:end]) for start, end in pairwise([*cuts, len(order)]) if start < end]


def _instructions(step: Step) -> int:
    """About how many instructions a step becomes; what stores take in lanes is not known here."""
    return 60 if type(step) is Sines else 1


def chunks(lanes: int, size: int) -> Iterator[tuple[int, int]]:
    """First column and number of columns of each chunk of a row; none reaches beyond the row.

    Args:
        lanes: The widest chunk, a power of two.
        size: Number of columns of a row.

    Yields:
        Pairs of a first column and a number of columns, which is a power of two.
    """
    start = 0
    while start < size:
        width = lanes
        while width > size - start:
            width //= 2
        yield start, width
        start += width


def stores(f: Function, lanes: int) -> list[Store]:
    """The stores of all results.

    Args:
        f: The function.
        lanes: How many neighbouring numbers of an output are written together, at most; a power of two.

    Returns:
        The stores, in the order of the outputs.
    """
    steps, start = [], 0
    for number, port in enumerate(f.outputs):
        values = f.results[start : start + port.size]
        steps += [Store(number, at, values[at : at + width]) for at, width in chunks(lanes, port.size)]
        start += port.size
    return steps


def _order(f: Function, lanes: int, pack: int) -> Iterator[Step]:
    """The order of the trace; the sines first that can be taken together, and each store as soon as it can be."""
    g = f.graph
    waiting: dict[int, list[Store]] = {}
    missing: dict[Store, int] = {}
    for store in stores(f, lanes):
        missing[store] = len(set(store.values))
        for value in set(store.values):
            waiting.setdefault(value, []).append(store)
    done: set[int] = set()
    for step in ordered(g, f.results, pack):
        if type(step) is int and g.op[step] != _LOOP and step not in waiting:  # most are such
            if step not in done:
                done.add(step)
                yield step
            continue
        new = [index for index in made(g, step) if index not in done]
        if not new:
            continue
        yield step
        for index in new:
            done.add(index)
            for store in waiting.pop(index, ()):
                missing[store] -= 1
                if not missing[store]:
                    yield store


def ordered(g: Graph, results: Sequence[int], pack: int) -> Iterator[int | Sines]:
    """The nodes in the order of the trace, some again; with `pack` > 1 sines come together, `pack` at a time.

    One vector of sines costs a single call about as much as one scalar.

    Args:
        g: The graph.
        results: The nodes that are wanted.
        pack: How many sines are taken at once.

    Yields:
        Nodes, and groups of sines; a node may come again after the group that computes it.
    """
    live = g.live(results)
    groups = _sines_by_depth(g, live) if pack > 1 else {}
    for depth in sorted(groups):
        arguments = tuple(groups[depth])
        yield from g.live(arguments)
        for k in range(0, len(arguments), pack):
            yield Sines(arguments[k : k + pack])
    for index in live:
        yield index if pack > 1 or g.op[index] not in _SINES else Sines(g.args[index])


def _sines_by_depth(g: Graph, live: Iterable[int]) -> dict[int, dict[int, None]]:
    """The arguments of sines and cosines, by how many sines they are computed from at most, one after the other."""
    level: dict[int, int] = {}
    groups: dict[int, dict[int, None]] = {}
    for index in live:
        args = g.args[index]
        depth = max([level[a] for a in args]) if args else 0
        if g.op[index] in _SINES:
            groups.setdefault(depth, {})[args[0]] = None
            depth += 1
        level[index] = depth
    return groups
