"""Data classes of `ulna.data_classes` behave as those of `dataclasses` do."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import KW_ONLY, field
from typing import Any, ClassVar

import pytest

from ulna.data_classes import dataclass


def classes(dataclass: Any) -> dict[str, Any]:
    """The same classes, made by one of the two decorators."""

    @dataclass(frozen=True)
    class Plain:
        """Fields with and without default values."""

        a: int
        b: str = "b"
        c: list[int] = field(default_factory=list, compare=False)
        kind: ClassVar[str] = "plain"

    @dataclass(frozen=True)
    class One:
        """One field, which a subclass follows."""

        a: float

    @dataclass(frozen=True)
    class Derived(One):
        """More fields; counts how often it is made."""

        b: float = field(default=2.0, repr=False)
        c: float = field(default=3.0, init=False)
        d: list[int] = field(default_factory=list, init=False)
        made: ClassVar[list[int]] = []

        def __post_init__(self) -> None:
            self.made.append(1)

    class Child(One):
        """Not decorated: may have attributes of its own."""

    @dataclass(frozen=True, slots=True)
    class Slots:
        """Without a dictionary."""

        a: int
        b: int = 1

    @dataclass(frozen=True, slots=True)
    class MoreSlots(Slots):
        """Derived from one without a dictionary."""

        c: int = 2

    @dataclass(frozen=True, eq=False, repr=False)
    class Bare:
        """Compared by identity."""

        a: int

    @dataclass
    class Changing:
        """Data that changes."""

        a: int = 0
        _: KW_ONLY
        b: int = 1

    @dataclass(frozen=True, kw_only=True)
    class Named:
        """By name alone."""

        a: int
        b: int = 1

    @dataclass(frozen=True)
    class Own:  # noqa: PLW1641, the decorator gives it a hash
        """With its own equality, text and constructor."""

        a: int

        def __init__(self) -> None:
            object.__setattr__(self, "a", 5)

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Own)

        def __repr__(self) -> str:
            return "own"

    @dataclass(frozen=True)
    class OwnHash:
        """With its own hash."""

        a: int

        def __hash__(self) -> int:
            return 7

    @dataclass(frozen=True)
    class Empty:
        """Without fields."""

    @dataclass(frozen=True)
    class Nested:
        """May contain itself."""

        items: list[Any]

    return {name: kind for name, kind in locals().items() if name != "dataclass"}


OURS, THEIRS = classes(dataclass), classes(dataclasses.dataclass)


NAN = float("nan")


def recursive(kinds: dict[str, Any]) -> str:
    """The text of a record that contains itself."""
    nested = kinds["Nested"]([])
    nested.items.append(nested)
    return repr(nested)


BEHAVIOURS: dict[str, Callable[[dict[str, Any]], Any]] = {
    "values": lambda k: vars(k["Plain"](1, c=[2])),
    "new default values": lambda k: k["Plain"](1).c is k["Plain"](1).c,
    "equal": lambda k: (k["Plain"](1, c=[2]) == k["Plain"](1), k["Plain"](1) == k["Plain"](2)),
    "equal to others": lambda k: (k["One"](1.0) == k["Derived"](1.0), k["One"](1.0) == (1.0,)),
    "equal nan": lambda k: k["One"](NAN) == k["One"](NAN),
    "hash": lambda k: (hash(k["Plain"](1)), hash(k["One"](1.0)), hash(k["Own"]), hash(k["Empty"]())) and 1,
    "hashes": lambda k: (
        hash(k["Plain"](1)) == hash((1, "b")), hash(k["One"](1.0)) == hash((1.0,)), hash(k["OwnHash"](1)),
        hash(k["Own"]()) == hash((5,)), hash(k["Empty"]()) == hash(()),
    ),
    "hash of lists": lambda k: hash(k["Nested"]([])),
    "hash of data that changes": lambda k: hash(k["Changing"]()),
    "identity": lambda k: k["Bare"](1) == k["Bare"](1),
    "text": lambda k: [repr(k[name](1)).split("<locals>.")[-1] for name in ("Plain", "Derived", "Slots", "MoreSlots")],
    "text of others": lambda k: (repr(k["Own"]()), repr(k["Empty"]()).split(".")[-1], repr(k["Changing"](b=3)).split(".")[-1]),
    "recursive text": lambda k: recursive(k).split("<locals>.")[-1],
    "assign": lambda k: setattr(k["Plain"](1), "a", 2),
    "assign another": lambda k: setattr(k["Plain"](1), "z", 2),
    "assign to slots": lambda k: setattr(k["MoreSlots"](1), "a", 2),
    "assign in a derived class": lambda k: setattr(k["Derived"](1.0), "z", 2),
    "delete": lambda k: delattr(k["Plain"](1), "a"),
    "delete another": lambda k: delattr(k["Derived"](1.0), "z"),
    "assign a field of a child": lambda k: setattr(k["Child"](1.0), "a", 2),
    "assign another of a child": lambda k: setattr(k["Child"](1.0), "z", 2),
    "delete a field of a child": lambda k: delattr(k["Child"](1.0), "a"),
    "data that changes": lambda k: setattr(k["Changing"](), "a", 2),
    "too few": lambda k: k["Plain"](),
    "too many": lambda k: k["Plain"](1, "b", [], 4),
    "unknown": lambda k: k["Plain"](1, z=3),
    "by name alone": lambda k: k["Named"](1),
    "after a mark": lambda k: k["Changing"](1, 2),
    "copies": lambda k: [vars(copy.copy(k["Derived"](4.0))), copy.deepcopy(k["Slots"](4)) == k["Slots"](4)],
    "replace": lambda k: (vars(dataclasses.replace(k["Plain"](1), a=5)), dataclasses.replace(k["Slots"](1), b=5).b),
    "replace one that is not given": lambda k: dataclasses.replace(k["Derived"](1.0), c=1.0),
    "as a dictionary": lambda k: (dataclasses.asdict(k["Derived"](1.0)), dataclasses.asdict(k["MoreSlots"](1))),
    "fields": lambda k: [f.name for name in k for f in (dataclasses.fields(k[name]))],
    "flags": lambda k: [str(kind.__dataclass_params__) for name, kind in k.items() if name != "Child"],
    "match": lambda k: [kind.__match_args__ for kind in k.values()],
    "has no dictionary": lambda k: hasattr(k["MoreSlots"](1), "__dict__"),
    "class attributes": lambda k: (k["Plain"].b, k["Plain"].kind, hasattr(k["Plain"], "c"), k["Derived"].c),
    "signatures": lambda k: [str(inspect.signature(kind)) for kind in k.values()],
    "annotations": lambda k: k["Plain"].__init__.__annotations__,
    "after it is made": lambda k: (k["Derived"].made.clear(), k["Derived"](1.0), k["Derived"].made)[-1],
    "values that are not given": lambda k: (k["Derived"](1.0).d, k["Derived"](1.0).c),
    "not decorated": lambda k: (k["Child"](1.0).a, k["Child"](1.0) == k["Child"](1.0), k["Child"](1.0) == k["One"](1.0)),
    "unfrozen from frozen": lambda k: dataclasses.dataclass(type("Bad", (k["One"],), {})),
    "frozen from frozen": lambda k: repr(dataclasses.dataclass(frozen=True)(type("Good", (k["One"],), {}))(1.0)).split(".")[-1],
}  # fmt: skip


def answer(behaviour: Callable[[dict[str, Any]], Any], kinds: dict[str, Any]) -> Any:
    """What is returned, or the error and its text, without the places of the classes."""
    try:
        return behaviour(kinds)
    except Exception as error:
        return type(error), str(error).replace("<locals>.", "")


@pytest.mark.parametrize("name", BEHAVIOURS)
def test_as_dataclasses(name: str) -> None:
    assert answer(BEHAVIOURS[name], OURS) == answer(BEHAVIOURS[name], THEIRS)


@dataclass(frozen=True, slots=True)
class Kept:
    """In a module, so that it can be pickled."""

    a: int
    b: list[int]


@dataclass(frozen=True, slots=True)
class KeptMore(Kept):
    """Derived from it."""

    c: int = 3


@dataclass(frozen=True)
class KeptWhole:
    """With a dictionary."""

    a: int


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("record", [Kept(1, [2]), KeptMore(1, [2], 4), KeptWhole(1)])
def test_pickles(record: Any, protocol: int) -> None:
    again = pickle.loads(pickle.dumps(record, protocol))
    assert again == record and type(again) is type(record)
    with pytest.raises(dataclasses.FrozenInstanceError):
        again.a = 2


def test_methods_that_a_frozen_class_cannot_have() -> None:
    with pytest.raises(TypeError, match="__setattr__"):
        dataclass(frozen=True)(type("Bad", (), {"__setattr__": lambda self, name, value: None}))


def test_importing_ulna_compiles_little_text() -> None:
    """Each text that is compiled takes 0.1 ms and more: what `dataclasses` does for each class, six times."""
    script = (
        "import numpy, sys; texts = []\n"
        "sys.addaudithook(lambda event, values: event == 'compile' and values[1] in (None, '<string>') and texts.append(values))\n"
        "import ulna\n"
        "print(len(texts))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert int(done.stdout) <= 75
