"""Messages for names that another library has: the table of them, and ways for classes to use it."""

from __future__ import annotations

import functools
import inspect
from abc import ABCMeta
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, TypeVar

from ulna.errors import UnknownArgument, UnknownAttribute
from ulna.idioms import module_names, robot_names, scene_names, value_names
from ulna.idioms.robot_names import PINOCCHIO, TOOLBOX

C = TypeVar("C", bound=type)
F = TypeVar("F", bound=Callable[..., Any])


class Idiom(NamedTuple):
    """What to write instead of a name."""

    library: str
    """Where the name comes from."""
    use: str
    """The expression to write, Python."""
    why: str = ""
    """A sentence more."""


_STATE = "A robot has no state: pass configurations and velocities to its methods; `ulna.Simulation` has one."
_SCRIPTS = " Its scripts run unchanged with: ulna run script.py"


def _table(names: Mapping[str, Mapping[str, str]]) -> dict[str, Idiom]:
    return {name: Idiom(library, use) for library, part in names.items() for name, use in part.items()}


IDIOMS: dict[str, dict[str, Idiom]] = {
    "robot": _table(robot_names.ROBOT)
    | {name: Idiom("", use, _STATE) for name, use in robot_names.STATE.items()},
    "model": _table(module_names.MODEL),
    "module ulna": _table(module_names.MODULE),
    "viewer": _table(scene_names.VIEWER),
    "handle": _table(scene_names.HANDLE),
    "kernel": _table(value_names.KERNEL),
    "solution": _table(value_names.SOLUTION),
    "world": _table(value_names.WORLD),
    "simulation": _table(value_names.SIMULATION),
    "SE3": _table(value_names.POSE),
    "SO3": _table(value_names.ROTATION),
}
"""For each kind of object, names of other libraries and what to use instead."""


def unknown_attribute(subject: str, name: str, there: Iterable[str]) -> AttributeError:
    """The error for an attribute that is not there; it says what to use.

    Args:
        subject: What it is; names of other libraries are known for the keys of `IDIOMS`.
        name: The attribute asked for.
        there: Names of the attributes that exist, for the nearest of them.

    Returns:
        The error to raise.
    """
    idiom = IDIOMS.get(subject, {}).get(name)
    if name.startswith("_"):  # asked for by Python, IPython, copy or pickle, never by a user
        return AttributeError(f"The {subject} has no attribute {name!r}.")
    if idiom is None:
        return UnknownAttribute(subject, name, [n for n in there if not n.startswith("_")])
    return UnknownAttribute(subject, name, (), _advice(idiom))


def _advice(idiom: Idiom) -> str:
    text = f"Use: {idiom.use}."
    if idiom.why:
        return f"{idiom.why} {text}"
    scripts = _SCRIPTS if idiom.library in (TOOLBOX, PINOCCHIO) else ""
    known = f" (The name is known from {idiom.library}.{scripts})" if scripts else ""
    return text + known


class Explained(ABCMeta):
    """The type of classes decorated with `explained`: their `dir` leaves out the names of other libraries."""

    def __dir__(cls) -> list[str]:
        return _listed_names(cls, super().__dir__())


def explained(subject: str, unlisted: Iterable[str] = ()) -> Callable[[C], C]:
    """Has a class explain names of other libraries where they are asked for as attributes.

    Reading an attribute that exists costs nothing more, as `__getattr__` would make it: each foreign name is a
    descriptor that raises AttributeError. So `hasattr` is False for them, and `dir` does not list them.

    Args:
        subject: A key of `IDIOMS`.
        unlisted: Names that work and that `dir` leaves out: former ones.

    Returns:
        The decorator.
    """

    def dressed(cls: C) -> C:
        setattr(cls, "_unlisted", frozenset(unlisted))  # noqa: B010
        for name in IDIOMS[subject]:
            if not hasattr(cls, name):
                setattr(cls, name, _Foreign(subject, name))
        setattr(cls, "__dir__", _listed)  # noqa: B010
        return cls

    return dressed


def _listed(self: Any) -> list[str]:
    return _listed_names(type(self), object.__dir__(self))


def _listed_names(cls: type, names: Iterable[str]) -> list[str]:
    """The names without those of other libraries, and without former ones."""
    former = getattr(cls, "_unlisted", ())
    foreign = (n for n in names if isinstance(inspect.getattr_static(cls, n, None), _Foreign))
    return sorted({*names}.difference(former, foreign))


class _Foreign:
    """A name of another library in a class."""

    __slots__ = ("name", "subject")

    def __init__(self, subject: str, name: str) -> None:
        self.subject, self.name = subject, name

    def __get__(self, instance: object, owner: type) -> Any:
        raise unknown_attribute(self.subject, self.name, ())


def check_keywords(f: F) -> F:
    """Has a function name the keyword that was meant, where it is given one that it does not have."""
    names = [p.name for p in inspect.signature(f).parameters.values() if p.kind is not p.VAR_KEYWORD]
    names = [name for name in names if name != "self"]

    @functools.wraps(f)
    def checked(*args: Any, **keywords: Any) -> Any:
        for name in keywords:
            if name not in names:
                known = (module_names.KEYWORDS.get(name), scene_names.KEYWORDS.get(name))
                meant = next((other for other in known if other in names), None)
                raise UnknownArgument(f.__name__, name, names, meant)
        return f(*args, **keywords)

    return checked  # type: ignore[return-value]
