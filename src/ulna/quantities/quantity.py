"""What a quantity of a robot is: one declaration, from which its kernel, its method and their documentation follow.

    @quantity(algorithms.mass_matrix, "(nv, nv) [kg, kg m, kg m^2]")
    def mass_matrix(self, q: ArrayLike) -> Floats:
        \"\"\"The joint-space mass matrix; armature counts [Featherstone 2008, section 6.2].\"\"\"
        ...

Arguments that are listed in `ARRAYS` are arrays, whose sizes are known by their names; all others are options, with
their default values. The kernel is `algorithm(model, *arrays, **options)`, traced for one model and one choice of
options. The method finds that kernel and calls it with the arrays. Its signature is the one written; its docstring is
completed by what is known of the arguments.
"""

from __future__ import annotations

import functools
import types
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar, final

from ulna.compiler.language.columns import Columns
from ulna.errors import InputError
from ulna.model import Frame, Model
from ulna.quantities.documentation import ARRAYS, Size, documented
from ulna.quantities.mass import with_mass
from ulna.quantities.part import frozen

F = TypeVar("F", bound=Callable[..., Any])
Arguments = tuple[tuple[str, Size], ...]


def no_more(options: Mapping[str, Any]) -> Arguments:
    """No arguments, whatever the options."""
    return ()


@final
@dataclass(frozen=True, eq=False)
class Quantity:
    """What is declared of a quantity.

    Attributes:
        name: The name of its kernel.
        algorithm: Computes it: `algorithm(model, *arrays, **options)`.
        arrays: The names of its arrays.
        options: The names of its options with their default values.
        more: Arguments that the chosen options add after the arrays: names and sizes.
        result: Shapes and units of the results: "(nv, nv) [kg m^2]".
        summary: What it is, in a sentence or two.
        nodes: Coefficients of the size of its graph; see `ulna.quantities.size`.
        inverts_mass: Whether it needs the inverse of the mass matrix, which some models do not have.
        columns: Returns the same as a function of columns, for single calls; None for quantities without.
    """

    name: str
    algorithm: Callable[..., Any]
    arrays: tuple[str, ...]
    options: Mapping[str, Any]
    more: Callable[[Mapping[str, Any]], Arguments]
    result: str
    summary: str
    nodes: tuple[float, float, float]
    inverts_mass: bool
    columns: Callable[..., Columns] | None = None

    def arguments(self, options: Mapping[str, Any]) -> Arguments:
        """Names and sizes of the kernel's arguments under these options."""
        return (*((name, ARRAYS[name].size) for name in self.arrays), *self.more(options))

    def build(self, model: Model, **options: Any) -> Callable[..., Any]:
        """The function of the arrays, for one model and one choice of options.

        Args:
            model: The robot.
            **options: All options.

        Returns:
            `algorithm(model, *arrays, **options)` as a function of the arrays.

        Raises:
            ModelError: If it needs the inverse of the mass matrix, and the model has none.
        """
        return with_mass(self._on)(model, **options) if self.inverts_mass else self._on(model, **options)

    def build_columns(self, model: Model, **options: Any) -> Callable[..., Columns]:
        """The form of columns of the same function; see `ulna.compiler.language.columns`.

        Args:
            model: The robot.
            **options: All options.

        Returns:
            `columns(model, *arrays, **options)` as a function of the arrays.
        """
        assert self.columns is not None, self.name
        form = self.columns
        return lambda *arrays: form(model, *arrays, **options)

    def _on(self, model: Model, **options: Any) -> Callable[..., Any]:
        return lambda *arrays: self.algorithm(model, *arrays, **options)


def quantity(
    algorithm: Callable[..., Any],
    result: str,
    *,
    name: str = "",
    arrays: tuple[str, ...] | None = None,
    options: Mapping[str, Any] | None = None,
    more: Callable[[Mapping[str, Any]], Arguments] = no_more,
    nodes: float | tuple[float, float, float] = 120.0,
    inverts_mass: bool = False,
    columns: Callable[..., Columns] | None = None,
    returns: str = "",
    **about: str,
) -> Callable[[F], F]:
    """Declares the quantity that a method of a `Part` returns; its docstring may end with a source in brackets.

    Args:
        algorithm: As for `Quantity`, like all that is not listed here.
        result: As for `Quantity`.
        name: The name of the kernel; empty for that of the algorithm, without an underscore before it.
        arrays: The arrays of the kernel, where they are not those of the method.
        options: The options of the kernel, where they are not those of the method. Then the method's body stays as
            it is written, and calls the kernel itself; otherwise it is replaced.
        more: As for `Quantity`.
        nodes: As for `Quantity`; one number is the first.
        inverts_mass: As for `Quantity`.
        columns: As for `Quantity`.
        returns: What the result is, for the documentation, where the first sentence does not say it.
        **about: What to write of arguments, where it is not what `ulna.quantities.documentation` has for their names.

    Returns:
        The decorator; the method has the record as its attribute `quantity`.
    """

    def declare(method: F) -> F:
        code = method.__code__
        parameters = code.co_varnames[1 : code.co_argcount + code.co_kwonlyargcount]
        defaults = method.__defaults__ or ()
        record = Quantity(
            name=name or algorithm.__name__.lstrip("_"),
            algorithm=algorithm,
            arrays=tuple(n for n in parameters if n in ARRAYS) if arrays is None else arrays,
            options=dict(zip(parameters[-len(defaults) :], defaults, strict=False))
            if options is None
            else options,
            more=more,
            result=result,
            summary=(method.__doc__ or "").split("\n\n", 1)[0],
            nodes=nodes if isinstance(nodes, tuple) else (nodes, 0.0, 0.0),
            inverts_mass=inverts_mass,
            columns=columns,
        )
        made = method if options is not None else _calling_kernel(method, record, parameters)
        made.__doc__ = documented(method.__doc__, parameters, result, returns, inverts_mass, about)
        made.quantity = record  # type: ignore[attr-defined]
        return made

    return declare


def _calling_kernel(method: F, record: Quantity, parameters: tuple[str, ...]) -> F:
    """The function of that name and signature that calls the kernel of its options with its arrays."""
    code = _template(len(record.arrays), len(record.options), [*record.options.values()] == [None])
    renamed = code.replace(
        co_name=method.__name__,
        co_qualname=method.__qualname__,
        co_varnames=("self", *parameters, *code.co_varnames[1 + len(parameters) :]),
        co_consts=tuple(record.name if constant == "NAME" else constant for constant in code.co_consts),
    )
    made: Any = types.FunctionType(renamed, globals(), method.__name__, method.__defaults__)
    functools.update_wrapper(made, method)
    return made


@functools.cache
def _template(arrays: int, options: int, is_plain_by_default: bool) -> types.CodeType:
    """The code of methods with so many arrays x0, x1, ... and options o0, o1, ..., compiled once for all of them."""
    x, o = [f"x{k}" for k in range(arrays)], [f"o{k}" for k in range(options)]
    body = f"return self._kernels['NAME']({', '.join(x)})"
    if options:
        key = ", ".join(("'NAME'", *o))
        body = f"""try:
        kernel = self._kernels[{f"'NAME' if o0 is None else ({key})" if is_plain_by_default else key}]
    except TypeError as error:
        kernel = self._kernels[_hashable(error, {key})]
    return kernel({", ".join(x)})"""
    names: dict[str, Any] = {}
    exec(f"def method(self, {', '.join(x + o)}):\n    {body}", names)
    return names["method"].__code__


def _hashable(error: TypeError, *key: Any) -> tuple[Any, ...]:
    """The key with tuples for lists and arrays, after the key itself has raised that error; raises it where none."""
    entries = tuple(frozen(entry) for entry in key)
    if all(entry is former for entry, former in zip(entries, key, strict=True)):
        raise error
    return entries


def frame_of(model: Model, name: str | None) -> Frame:
    """The frame of a name.

    Args:
        model: The robot.
        name: The name; None for the tool.

    Returns:
        The frame.

    Raises:
        InputError: If `name` is no name.
        UnknownName: If there is no such frame; names the nearest.
    """
    if name is not None and not isinstance(name, str):
        raise InputError(f"`frame` is {name!r}; expected the name of one frame, or None for the tool.")
    return model.frame(model.tool if name is None else name)


def of_frame(algorithm: Callable[..., Any]) -> Callable[..., Any]:
    """An algorithm that takes a frame after its arrays, as one that takes the option `frame`, a name."""

    @functools.wraps(algorithm)
    def run(model: Model, *arrays: Any, frame: str | None, **options: Any) -> Any:
        return algorithm(model, *arrays, frame_of(model, frame), **options)

    return run
