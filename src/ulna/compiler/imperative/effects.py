"""What a procedure may write to."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ulna.compiler.imperative import tree as t


def written(instance: t.Instance) -> frozenset[str]:
    """The parameters whose arrays, or whose fields' arrays, a procedure may write to.

    Args:
        instance: The procedure.

    Returns:
        Their names. What is passed to a kernel, and to parameters that another procedure writes to, counts.
    """
    return frozenset(_written_in_block(instance.body)) & {name for name, _ in instance.parameters}


def _written_in_block(body: Iterable[t.Statement]) -> Iterator[str]:
    """The variables that statements may write to."""
    for statement in body:
        yield from _written_in_statement(statement)


def _written_in_statement(s: t.Statement) -> Iterator[str]:
    match s:
        case t.Store(place=place, value=value):
            yield _variable_of(place)
            yield from _written_in_calls((value, place))
        case t.KernelCall(arrays=arrays):
            yield from map(_variable_of, arrays)
            yield from _written_in_calls(arrays)
        case t.CallStatement(instance=instance, arguments=arguments):
            yield from _written_in_call(instance, arguments)
        case t.If(condition=condition, body=body, otherwise=otherwise):
            yield from _written_in_calls((condition,))
            yield from _written_in_block((*body, *otherwise))
        case t.While(condition=condition, body=body):
            yield from _written_in_calls((condition,))
            yield from _written_in_block(body)
        case t.For(start=start, stop=stop, body=body):
            yield from _written_in_calls((start, stop))
            yield from _written_in_block(body)
        case t.Assign(value=value):
            yield from _written_in_calls((value,))
        case t.Return(values=values):
            yield from _written_in_calls(values)
        case _:
            pass


def _written_in_call(instance: t.Instance, arguments: Iterable[t.Expression]) -> Iterator[str]:
    targets = written(instance)
    for (name, _), argument in zip(instance.parameters, arguments, strict=True):
        if name in targets:
            yield _variable_of(argument)
    yield from _written_in_calls(arguments)


def _written_in_calls(expressions: Iterable[t.Expression]) -> Iterator[str]:
    """The variables that calls within expressions may write to."""
    for e in expressions:
        if isinstance(e, t.Call):
            yield from _written_in_call(e.instance, e.arguments)
        else:
            yield from _written_in_calls(parts(e))


def parts(e: t.Expression) -> tuple[t.Expression, ...]:
    """The expressions that an expression is made of."""
    match e:
        case t.Operation(arguments=arguments) | t.Call(arguments=arguments):
            return arguments
        case t.Convert(value=value) | t.Broadcast(value=value):
            return (value,)
        case t.Choice(condition=condition, if_true=a, if_false=b):
            return (condition, a, b)
        case t.Field(record=record):
            return (record,)
        case t.Extent(array=array):
            return (array,)
        case t.View(array=array, indices=indices) | t.Element(array=array, indices=indices):
            return (array, *indices)
        case t.Slice(array=array, indices=indices):
            return (array, *indices)
        case t.LaneItem(value=value, index=index):
            return (value, index)
        case _:
            return ()


def _variable_of(e: t.Expression) -> str:
    """The variable that an array, or the record it is a field of, belongs to."""
    while not isinstance(e, t.Local):
        e = parts(e)[0]
    return e.name
