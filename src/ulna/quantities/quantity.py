"""What a quantity of a robot is: one declaration, from which its kernel, its method and their documentation follow.

    @quantity(algorithms.mass_matrix, "(nv, nv) [kg, kg m, kg m^2]")
    def mass_matrix(self, q: ArrayLike) -> Floats:
        \"\"\"The joint-space mass matrix; armature counts [Featherstone 2008, section 6.2].\"\"\"
        ...

Arguments that are listed in `ARRAYS` are arrays, whose sizes are known by their names; all others are options, with
their default values. The kernel is `algorithm(model, *arrays, **options)`, traced for one model and one choice of
options. The method finds that kernel and calls it with the arrays, and with `out` and `threads` where it has such
arguments. Its signature is the one written; its docstring is completed by what is known of the arguments.

Once its kernel is there, a method is called by machine code (`direct_calls`), at some 10 ns beyond the kernel. What the
decorator makes is for the first call, for methods that are bound before they are called (`f = robot.fk`, 30 to 60 ns
beyond the kernel), and for interpreters without fast calls. It is made from a template, since one general function of
`*args` and `**options` takes 125 ns, and 300 ns with an option. Keyword-only arguments would add 20 ns to it, since
Python calls functions that have such ones in a slower way.
"""

from __future__ import annotations

import functools
import types
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, final

from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Frame, Model
from ulna.quantities.documentation import ARRAYS, OF_CALLS, Size, documented
from ulna.quantities.mass import with_mass

if TYPE_CHECKING:
    from ulna.compiler.forms.columns import Columns
    from ulna.compiler.language.ports import SecondForm

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
        columns_from: From how many velocities of a robot on that form is used; below, straight-line code is faster.
        stages: Makes its form of stages for a model and options, for single calls; returns None for models without.
        stages_from: From how many velocities of a robot on that form is used; below, straight-line code is faster.
        chains_from: The same of chains of revolute joints that suit scans; None for as many.
        scans: Whether these stages are scans of a chain, whose code is as short for thousands of joints.
        batches_from: From how many on batches may be computed in stages, too, which takes longer than straight-line
            code does, and spares what that takes to compile.
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
    columns_from: int = 12
    stages: Callable[..., SecondForm | None] | None = None
    stages_from: int = 24
    chains_from: int | None = None
    scans: bool = False
    batches_from: int = 24

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
        """The form of columns of the same function; see `ulna.compiler.forms.columns`.

        Args:
            model: The robot.
            **options: All options.

        Returns:
            `columns(model, *arrays, **options)` as a function of the arrays.

        Raises:
            ModelError: If it needs the inverse of the mass matrix, and the model has none.
        """
        assert self.columns is not None, self.name
        form = self.columns

        def on(model: Model, **options: Any) -> Callable[..., Columns]:
            return lambda *arrays: form(model, *arrays, **options)

        return with_mass(on)(model, **options) if self.inverts_mass else on(model, **options)

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
    columns_from: int = 12,
    stages: Callable[..., SecondForm | None] | None = None,
    stages_from: int = 24,
    chains_from: int | None = None,
    scans: bool = False,
    batches_from: int = 24,
    direct: bool = False,
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
        direct: Whether a body that stays is for other than default values: with these the kernel is called directly.
        more: As for `Quantity`.
        nodes: As for `Quantity`; one number is the first.
        inverts_mass: As for `Quantity`.
        columns: As for `Quantity`.
        columns_from: As for `Quantity`.
        stages: As for `Quantity`.
        stages_from: As for `Quantity`.
        chains_from: As for `Quantity`.
        scans: As for `Quantity`.
        batches_from: As for `Quantity`.
        returns: What the result is, for the documentation, where the first sentence does not say it.
        **about: What to write of arguments, where it is not what `ulna.quantities.documentation` has for their names.

    Returns:
        The decorator; the method has the record as its attribute `quantity`.
    """
    rest: Any = {"more": more, "result": result, "inverts_mass": inverts_mass, "batches_from": batches_from}
    rest["nodes"] = nodes if isinstance(nodes, tuple) else (nodes, 0.0, 0.0)
    rest |= {"columns": columns, "columns_from": columns_from, "stages": stages, "stages_from": stages_from}
    rest |= {"chains_from": chains_from, "scans": scans, "name": name or algorithm.__name__.lstrip("_")}

    def declare(method: F) -> F:
        parameters, record = _parameters_of(method)[0], _record(method, algorithm, arrays, options, rest)
        made = method if options is not None and not direct else _generated(method, record, options is None)
        made.__doc__ = documented(method.__doc__, parameters, result, returns, inverts_mass, about)
        made.quantity = record  # type: ignore[attr-defined]
        return made

    return declare


def _record(
    method: Callable[..., Any],
    algorithm: Callable[..., Any],
    arrays: tuple[str, ...] | None,
    options: Mapping[str, Any] | None,
    rest: Mapping[str, Any],
) -> Quantity:
    """The quantity that a method declares; arrays and options are those of the method where they are None."""
    parameters, defaults = _parameters_of(method)
    own_options = {key: value for key, value in defaults.items() if key not in OF_CALLS}
    return Quantity(
        algorithm=algorithm,
        arrays=tuple(n for n in parameters if n in ARRAYS) if arrays is None else arrays,
        options=own_options if options is None else options,
        summary=(method.__doc__ or "").split("\n\n", 1)[0],
        **rest,
    )


def _parameters_of(method: Callable[..., Any]) -> tuple[tuple[str, ...], dict[str, Any]]:
    """The names of a method's parameters after `self`, and the default values of those that have one."""
    code, values = method.__code__, method.__defaults__ or ()
    parameters = code.co_varnames[1 : code.co_argcount + code.co_kwonlyargcount]
    return parameters, dict(zip(parameters[-len(values) :], values, strict=False))


GENERATED: set[Any] = set()
"""The methods made from templates: wrappers of them have the same attributes, and must be called."""


def _generated(method: F, record: Quantity, has_tables: bool) -> F:
    """The method that calls the kernel; without `has_tables` its body is called for other than default values."""
    _, defaults = _parameters_of(method)
    count, nones = len(record.arrays), tuple(value is None for value in defaults.values())
    takes_out = OF_CALLS.issubset(defaults)
    code = _template(count, nones, takes_out) if has_tables else _direct_template(count, nones)
    made = _renamed(code, method, record)
    made.has_tables = has_tables  # type: ignore[attr-defined]
    GENERATED.add(made)
    return made


def _renamed(code: types.CodeType, method: F, record: Quantity) -> F:
    """The function of a template's code, with the name and the arguments of a method."""
    parameters = method.__code__.co_varnames[: method.__code__.co_argcount]
    renamed = code.replace(
        co_name=method.__name__,
        co_qualname=method.__qualname__,
        co_varnames=(*parameters, *code.co_varnames[len(parameters) :]),
        co_names=tuple(record.name if name == "NAME" else name for name in code.co_names),
        co_consts=tuple(record.name if constant == "NAME" else constant for constant in code.co_consts),
    )
    values = {f"d{k}": value for k, value in enumerate(method.__defaults__ or ())}
    made: Any = types.FunctionType(renamed, {"body": method, **values}, method.__name__, method.__defaults__)
    functools.update_wrapper(made, method)
    return made


@functools.cache
def _template(arrays: int, nones: tuple[bool, ...], takes_out: bool) -> types.CodeType:
    """The code of methods with so many arrays, and other arguments whose default values are None or d0, d1, ...

    The last two arguments are `out` and `threads` where the method takes them; all others are options. The code is
    compiled once for all methods alike. No error is raised from these.
    """
    x, o = _names("x", arrays), _names("o", len(nones))
    options = o[:-2] if takes_out else o
    chosen = "self._kernels.NAME"
    if options:
        others = "".join(f"[{option}]" for option in options)
        chosen += f" if {_are_default(options, nones)} else self._by_options['NAME']{others}"
    call = f"({', '.join(x)})"
    lines = ["try:", f"    kernel = {chosen}", "except (AttributeError, KeyError, TypeError):", "    pass"]
    if takes_out:
        out, threads = o[-2:]
        lines += ["else:", f"    if {out} is None and {threads} is None:", f"        return kernel{call}"]
        call = f"({', '.join(x)}, out={out}, threads={threads})"
    else:
        lines += ["else:", f"    return kernel{call}"]
    key = ", ".join([repr("NAME"), *options])
    return _compiled([*x, *o], [*lines, f"return self._kernel({key}){call}"])


@functools.cache
def _direct_template(arrays: int, nones: tuple[bool, ...]) -> types.CodeType:
    """As `_template`, of methods that call the kernel themselves unless all arguments have their default values."""
    x, o = _names("x", arrays), _names("o", len(nones))
    lines = [
        f"if {_are_default(o, nones)}:",
        "    try:",
        "        kernel = self._kernels.NAME",
        "    except AttributeError:",
        "        pass",
        "    else:",
        f"        return kernel({', '.join(x)})",
        f"return body(self, {', '.join([*x, *o])})",
    ]
    return _compiled([*x, *o], lines)


def _names(letter: str, count: int) -> list[str]:
    return [f"{letter}{k}" for k in range(count)]


def _are_default(names: Sequence[str], values_none: Sequence[bool]) -> str:
    """The text of a condition; equal strings that are not the same object only take the longer way."""
    pairs = enumerate(zip(names, values_none, strict=False))
    return " and ".join(f"{name} is {None if is_none else f'd{k}'}" for k, (name, is_none) in pairs)


def _compiled(parameters: Sequence[str], lines: Sequence[str]) -> types.CodeType:
    """The code of a method of these lines."""
    names: dict[str, Any] = {}
    exec("\n    ".join([f"def method(self, {', '.join(parameters)}):", *lines]), names)
    return names["method"].__code__


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
