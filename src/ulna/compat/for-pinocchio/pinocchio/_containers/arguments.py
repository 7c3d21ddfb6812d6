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


def is_flag(value: Any) -> bool:
    """Whether a value says yes or no."""
    return isinstance(value, (bool, np.bool_)) or (isinstance(value, int) and value in (0, 1))


def is_number(value: Any) -> bool:
    """Whether a value is one real number."""
    if type(value) in (float, int):
        return True
    return hasattr(value, "__float__") and np.ndim(value) == 0 and not isinstance(value, str)


def is_index(value: Any) -> bool:
    """Whether a value is a whole number."""
    return type(value) is int or (hasattr(value, "__index__") and np.ndim(value) == 0)


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

    def __call__(self, function: str, value: Any) -> None:
        if (value is None and self.optional) or self.accepts(value):
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
    checks = _checks_of(function)
    if not checks or hasattr(function, "arguments_checked"):
        return function
    title = function.__qualname__.rpartition(">.")[2]
    places = {check.name: check.place for check in checks}
    related = {"model", "data"} <= places.keys()
    at_model, at_data = (places["model"], places["data"]) if related else (0, 0)
    accepted: set[tuple[type, ...]] = (
        set()
    )  # types of arguments that passed the checks, whatever their values

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        if not named and tuple(map(type, args)) in accepted:  # as it is nearly always: nothing else is asked
            if related and args[at_data]._layout is not args[at_model]._layout:
                check_layout(args[at_model], args[at_data])
            return function(*args)
        count = len(args)
        for check in checks:
            if check.place < count:
                check(title, args[check.place])
            elif check.name in named:
                check(title, named[check.name])
        if related:
            model = args[at_model] if at_model < count else named.get("model")
            data = args[at_data] if at_data < count else named.get("data")
            if data is None or model is None or data._layout is not model._layout:
                check_layout(model, data)
        decided = not named and all(c.decided_by_type(args[c.place]) for c in checks if c.place < count)
        if related and decided:
            decided = max(at_model, at_data) < count and None not in (args[at_model], args[at_data])
        if decided and len(accepted) < _MOST_TYPES:
            accepted.add(tuple(map(type, args)))
        return function(*args, **named)

    called.arguments_checked = True  # type: ignore[attr-defined]
    return called  # type: ignore[return-value]


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
    *("integrate", "difference", "randomConfiguration", "computeJointJacobian", "computeFrameJacobian"),
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
            checks.append(_Check(k if positional else 10**6, parameter.name, *_KINDS[first], optional))
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
class SizeError(InputError, OverflowError):
    """A count is below zero, or too large."""
