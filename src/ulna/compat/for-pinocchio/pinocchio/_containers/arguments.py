"""Checks of arguments by the annotations of functions; errors are also of the classes that Pinocchio raises."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, TypeVar, final

import numpy as np

from ulna.errors import InputError, ShapeError, excerpt

Function = TypeVar("Function", bound=Callable[..., Any])


@final
class ArgumentError(InputError, TypeError):
    """An argument has a type that the function does not take; Pinocchio raises a TypeError of that name."""


@final
class IndexOutOfRange(InputError, IndexError, OverflowError):
    """An index has no entry; Pinocchio raises an OverflowError where it is negative."""


@final
class WrongShape(ShapeError, TypeError, RuntimeError):
    """An array has the wrong shape; Pinocchio raises a ValueError, a TypeError or a RuntimeError."""


class _Omitted:
    """Stands for an argument that was left out, where None would be one that was passed."""

    def __repr__(self) -> str:
        return "..."


OMITTED: Any = _Omitted()
"""The default of parameters whose argument may be left out, but not be None."""


def given(function: str, **values: Any) -> tuple[Any, ...]:
    """Arguments of parameters that may be left out: None for those that were.

    Args:
        function: Name of the function, for messages.
        **values: What was passed, by the names of the parameters; OMITTED for nothing.

    Returns:
        The arguments, in the order of their names.

    Raises:
        ArgumentError: One of them is None.
    """
    for name, value in values.items():
        if value is None:
            raise ArgumentError(f"{function}: `{name}` is None. Leave it out, or pass what it stands for.")
    return tuple(None if value is OMITTED else value for value in values.values())


def is_flag(value: Any) -> bool:
    """Whether a value says yes or no; None says no, as there."""
    return (
        value is None or isinstance(value, (bool, np.bool_)) or (isinstance(value, int) and value in (0, 1))
    )


def is_number(value: Any) -> bool:
    """Whether a value is one real number."""
    if type(value) in (float, int):
        return True
    if isinstance(value, (np.ndarray, np.generic)):
        return value.ndim == 0 and value.dtype.kind in "fiub"
    return hasattr(value, "__float__") and not isinstance(value, (str, type)) and np.ndim(value) == 0


def is_index(value: Any) -> bool:
    """Whether a value is a whole number."""
    if type(value) is int:
        return True
    return hasattr(value, "__index__") and not isinstance(value, type) and np.ndim(value) == 0


def _has_class(name: str) -> Callable[[Any], bool]:
    known: dict[type, bool] = {}  # looking through base classes costs more than a product of placements

    def accepts(value: Any) -> bool:
        cls = type(value)
        if cls not in known:
            known[cls] = any(base.__name__ == name for base in cls.__mro__)
        return known[cls]

    return accepts


_NAMED_AS_THEY_ARE = """
    SE3 Motion Force Inertia Symmetric3 Quaternion Frame JointModel JointData GeometryObject CollisionPair LieGroup
    PseudoInertia ModelPool GeometryType AngleAxis RigidConstraintModel BaumgarteCorrectorParameters
"""
_KINDS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "bool": (is_flag, "True or False"),
    "float": (is_number, "a real number"),
    "int": (is_index, "a whole number"),
    "str": (lambda value: isinstance(value, str), "a text"),
    "Convention": (_has_class("Convention"), "Convention.LOCAL or Convention.WORLD"),
    "Model": (_has_class("Model"), "a pinocchio.Model"),
    "KinematicTree": (_has_class("Model"), "a pinocchio.Model"),
    "GeometryCollection": (_has_class("GeometryModel"), "a pinocchio.GeometryModel"),
    "ReferenceFrame": (_has_class("ReferenceFrame"), "LOCAL, WORLD or LOCAL_WORLD_ALIGNED"),
    "JointBase": (_has_class("JointBase"), "a joint, such as pinocchio.JointModelRX()"),
    "Data": (_has_class("Data"), "the data of the model, model.createData()"),
    "GeometryModel": (_has_class("GeometryModel"), "a pinocchio.GeometryModel"),
    "GeometryData": (_has_class("GeometryData"), "the data of the geometries, geometry_model.createData()"),
    **{name: (_has_class(name), f"a pinocchio.{name}") for name in _NAMED_AS_THEY_ARE.split()},
}
"""For annotations: what a value must be, and how a message says that."""
CONVERSIONS: dict[str, Callable[[Any], Any]] = {}
"""By names of classes: what makes an object of that class of another that counts as one; all else stays as it is."""
_HINTS = {
    "RobotWrapper": "A RobotWrapper holds robot.model and robot.data.",
    "Data": "The order is (model, data, ...).",
    "Model": "The order is (model, data, ...).",
    "NoneType": "Was it made before this call?",
}

_MOST_TYPES = 64
"""How many combinations of types are known to be accepted, for each function."""


class _Check(NamedTuple):
    """What is expected of a parameter."""

    place: int
    name: str
    accepts: Callable[[Any], bool]
    expected: str
    optional: bool
    default: Any = inspect.Parameter.empty

    def takes(self, value: Any) -> bool:
        """Whether a value is accepted."""
        return (value is None and self.optional) or self.accepts(value)

    def __call__(self, function: str, value: Any) -> None:
        if self.takes(value):
            return
        hint = _HINTS.get(type(value).__name__, "") if self.name in ("model", "data") else ""
        raise ArgumentError(
            f"{function}: `{self.name}` is {excerpt(repr(value))}; expected {self.expected}. {hint}".rstrip()
        )

    def decided_by_type(self, value: Any) -> bool:
        """Whether all values of the type of an accepted value are accepted."""
        by_value: dict[Any, tuple[type, ...]] = {is_flag: (bool,), is_number: (float, int), is_index: (int,)}
        usual = by_value.get(self.accepts)
        return usual is None or type(value) in (*usual, type(None))


def checked(function: Function) -> Function:
    """Checks the arguments of a function by their annotations, and that its data is of its model.

    Raises of the function returned:
        ArgumentError: An argument has another type.
        InputError: The data was made for another model.
    """
    checks, optional = _checks_of(function), optional_parameters(function)
    if not (checks or optional) or hasattr(function, "arguments_checked"):
        return function
    if any(p.kind not in _NAMED for p in _own_parameters(function)):
        return _checked_tuple(function, checks)
    accepted: set[Any] = set()  # types of checked arguments that passed the checks, whatever their values
    related = {"model", "data"} <= {check.name for check in checks}
    by_type = [check.name for check in checks]
    types = "".join(f"kind_of_({name}), " for name in by_type)
    conditions = [f"({types}) in accepted_", *(["data._layout is model._layout"] if related else [])]
    check_all = _check_all(function.__qualname__.rpartition(">.")[2], checks, related, accepted)
    title = function.__qualname__.rpartition(">.")[2].removesuffix(".__init__")
    absent = "".join(
        f"    if {name} is omitted_: {name} = None\n    elif {name} is None: given_({title!r}, {name}=None)\n"
        for name in optional
    )
    body = f"""{absent}    if not ({" and ".join(conditions)}):
        check_all_({", ".join(by_type)})
    return original_({{arguments}})"""
    converted = [check for check in checks if check.expected.endswith(".SE3")]
    if converted:
        body = body.replace(
            "        check_all_(", f"        {_conversions(converted)}\n        check_all_(", 1
        )
    scope = {"kind_of_": type, "accepted_": accepted, "check_all_": check_all, "original_": function}
    scope |= {"conversions_": CONVERSIONS}
    scope |= {"given_": given, "omitted_": OMITTED}
    called = with_same_parameters(function, body, scope, dict.fromkeys(optional, OMITTED))
    called.arguments_checked = True
    return called


def _conversions(checks: list[_Check]) -> str:
    """The statement that converts the arguments of parameters that take a placement."""
    return "; ".join(f"{check.name} = conversions_['SE3']({check.name})" for check in checks)


def optional_parameters(function: Any) -> list[str]:
    """The parameters whose default is None, for a function that Pinocchio has in C++, where None is no argument."""
    if not written_in_cpp(function):
        return []
    return [p.name for p in inspect.signature(function).parameters.values() if p.default is None]


def written_in_cpp(function: Any) -> bool:
    """Whether Pinocchio has a function in C++, where None does not stand for an argument that is left out."""
    return function.__module__.startswith(_IN_CPP) and function.__module__ not in _WITH_NONE


_IN_CPP = tuple(
    f"pinocchio.{name}"
    for name in ("_algorithms", "_constraints", "_geometry", "_model", "_spatial", "explog", "rpy")
)
_WITH_NONE = ("pinocchio._constraints.contact_inverse_dynamics",)
"""Where Pinocchio takes None for an argument in C++, too."""


def with_same_parameters(
    function: Any, body: str, scope: dict[str, Any], other_defaults: dict[str, Any]
) -> Any:
    """A function with the parameters of another, and its name and documentation.

    Args:
        function: The other; none of its parameters stands for several arguments.
        body: The lines of its body; `{arguments}` is replaced by the arguments for a call of the other.
        scope: What the names in these lines mean.
        other_defaults: The defaults of parameters that have others here.

    Returns:
        The function.
    """
    parameters = inspect.signature(function).parameters.values()
    defaults = {f"{p.name}__default": p.default for p in parameters if p.default is not p.empty}
    defaults |= {f"{name}__default": default for name, default in other_defaults.items()}
    heads, passed = [], []
    for p in parameters:
        by_name = p.kind is p.KEYWORD_ONLY
        if by_name and "*" not in heads:
            heads.append("*")
        heads.append(f"{p.name}={p.name}__default" if f"{p.name}__default" in defaults else p.name)
        passed.append(f"{p.name}={p.name}" if by_name else p.name)
    name = function.__name__
    lines = f"def {name}({', '.join(heads)}):\n{body.replace('{arguments}', ', '.join(passed))}"
    names = {**scope, **defaults}
    exec(compile(lines, f"<checks of {function.__qualname__}>", "exec"), names)
    return functools.update_wrapper(names[name], function)


def _own_parameters(function: Any) -> list[inspect.Parameter]:
    """The parameters that a function really has, whatever it wraps."""
    return list(inspect.signature(function, follow_wrapped=False).parameters.values())


_NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


def _check_all(title: str, checks: list[_Check], related: bool, accepted: set[Any]) -> Callable[..., None]:
    """A function that raises where one of the checked arguments is not accepted, and notes their types."""

    def check_all(*values: Any) -> None:
        decided = True
        for check, value in zip(checks, values, strict=True):
            if value is check.default and not check.takes(value):
                decided = False  # a default that is none of its kind
                continue
            check(title, value)
            decided = decided and check.decided_by_type(value)
        if related:
            named = {check.name: value for check, value in zip(checks, values, strict=True)}
            model, data = named["model"], named["data"]
            check_layout(model, data)
            decided = decided and model is not None and data is not None
        if decided and len(accepted) < _MOST_TYPES:
            accepted.add(tuple(map(type, values)))

    return check_all


def _checked_tuple(function: Any, checks: list[_Check]) -> Any:
    """The same for a function with a parameter that stands for several arguments."""
    title = function.__qualname__.rpartition(">.")[2]
    accepted: set[tuple[type, ...]] = set()  # types of arguments that passed the checks

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        if not named and tuple(map(type, args)) in accepted:
            return function(*args)
        args = tuple(map(CONVERSIONS["SE3"], args))
        count = len(args)
        for check in checks:
            if check.place < count:
                check(title, args[check.place])
            elif check.name in named:
                check(title, named[check.name])
        arguments = {check.name: args[check.place] for check in checks if check.place < count} | named
        if {"model", "data"} <= arguments.keys():
            check_layout(arguments["model"], arguments["data"])
        elif (
            not named
            and len(accepted) < _MOST_TYPES
            and all(check.decided_by_type(args[check.place]) for check in checks if check.place < count)
        ):
            accepted.add(tuple(map(type, args)))
        return function(*args, **named)

    called.arguments_checked = True  # type: ignore[attr-defined]
    return called


def checks_itself(function: Function) -> Function:
    """Marks a function that checks its arguments itself, where its quick way does not apply."""
    function.arguments_checked = True  # type: ignore[attr-defined]
    return function


def checked_functions(names: dict[str, Any]) -> dict[str, Any]:
    """Those functions of a namespace that do not check their arguments themselves, with checks."""
    return {
        name: checked(function)
        for name, function in names.items()
        if inspect.isfunction(function) and not name.startswith("_") and name not in CHECKING_THEMSELVES
    }


def check_methods(classes: Iterable[Any]) -> None:
    """Has those methods of classes check their arguments whose annotations name a class, or a number.

    Args:
        classes: Classes of the package; others are left alone, and so are bases whose `_called_by_users` is False.
    """
    public = [cls for cls in classes if inspect.isclass(cls) and cls.__module__.startswith("pinocchio.")]
    for cls in dict.fromkeys(base for one in public for base in one.__mro__):
        if not cls.__module__.startswith("pinocchio.") or not vars(cls).get("_called_by_users", True):
            continue
        for name, member in list(vars(cls).items()):
            function = member.__func__ if isinstance(member, staticmethod) else member
            if not inspect.isfunction(function) or (name.startswith("_") and name != "__init__"):
                continue
            if hasattr(function, "orders") or hasattr(function, "arguments_checked"):
                continue
            made = checked(function)
            if made is not function:
                setattr(cls, name, staticmethod(made) if isinstance(member, staticmethod) else made)


CHECKING_THEMSELVES = {
    *("distance", "neutral", "normalize"),
    *("integrate", "difference", "randomConfiguration"),
    *("updateFramePlacement", "updateFramePlacements", "exp3", "log3", "exp6", "log6", "checked_functions"),
}
"""Functions called so often that they check their arguments only where the compiled kernel does not take them."""


def _checks_of(function: Callable[..., Any]) -> list[_Check]:
    checks = []
    for k, parameter in enumerate(inspect.signature(function).parameters.values()):
        first, _, rest = str(parameter.annotation).partition(" | ")
        positional = parameter.kind in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD)
        if (
            first in _KINDS
            and rest in ("", "None")
            and (positional or parameter.kind == parameter.KEYWORD_ONLY)
        ):
            optional = parameter.default is None or rest == "None"
            place = k if positional else 10**6
            checks.append(_Check(place, parameter.name, *_KINDS[first], optional, parameter.default))
    return checks


def check_model_and_data(function: str, model: Any, data: Any) -> None:
    """Checks the model and the data of a function as `checked` does.

    Args:
        function: Name of the function, for messages.
    """
    for place, (name, value) in enumerate({"model": model, "data": data}.items()):
        _Check(place, name, *_KINDS[name.capitalize()], False)(function, value)
    check_layout(model, data)


def wrong_model(function: str, model: Any) -> ArgumentError:
    """The error for what is no model.

    Args:
        function: Name of the function.
        model: What was passed.

    Returns:
        The error to raise.
    """
    return ArgumentError(f"{function}: `model` is {excerpt(repr(model))}; expected a pinocchio.Model.")


def check_layout(model: Any, data: Any) -> None:
    """Checks that a Data was made for a model of the same joints.

    Raises:
        InputError: It was made for another model.
    """
    if data is None or model is None or data._layout is model._layout or data._layout == model._layout:
        return
    raise InputError(
        f"This Data was made for a model of {len(data._layout)} joints that are not those of the model, which "
        f"now has {model.njoints}. Make a new one: data = model.createData()."
    )


def check_text(value: Any, name: str) -> None:
    """Checks that an argument is a text.

    Args:
        value: What was passed.
        name: Name of the argument, for messages.

    Raises:
        ArgumentError: It is no text.
    """
    if not isinstance(value, str):
        raise ArgumentError(f"`{name}` is {excerpt(repr(value))}; expected a text.")


def check_size(value: Any, name: str, most: int = 10**6) -> int:
    """Checks a count.

    Args:
        value: What was passed.
        name: Name of the argument, for messages.
        most: Largest count.

    Returns:
        The count.

    Raises:
        ArgumentError: It is no whole number.
        InputError: It is below zero, or so large that it must be a mistake.
        SizeError: The same as InputError, also of the class that Pinocchio raises.
    """
    if not is_index(value):
        raise ArgumentError(f"`{name}` is {excerpt(repr(value))}; expected a whole number.")
    count = value.__index__()
    if not 0 <= count <= most:
        raise SizeError(f"`{name}` is {count}; expected a whole number from 0 to {most}.")
    return count


@final
class NoSequence(InputError, TypeError, AttributeError):
    """An argument of which the entries are asked has none; also of the class that Pinocchio raises."""


@final
class SizeError(InputError, OverflowError, MemoryError):
    """A count is below zero, or too large; Pinocchio raises an OverflowError or a MemoryError."""
