"""What a recipe is, and the words that recipes share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ulna.errors import InputError
from ulna.model import Frame, Model

Size = str | tuple[int | str, ...]
Arguments = tuple[tuple[str, Size], ...]

Q: Arguments = (("q", "nq"),)
QV: Arguments = (*Q, ("v", "nv"))
QVA: Arguments = (*QV, ("a", "nv"))
QVTAU: Arguments = (*QV, ("tau", "nv"))
QQ: Arguments = (("q0", "nq"), ("q1", "nq"))
FRAME = {"frame": None}
IN_FRAME = {"frame": None, "reference": "local_world_aligned"}


def no_more(options: Mapping[str, Any]) -> Arguments:
    """No arguments, whatever the options."""
    return ()


@dataclass(frozen=True)
class Recipe:
    """How a kernel is made.

    `build(model, **options)` returns a function of arrays; `arguments` are their names and sizes: "nq", "nv", or a
    shape of such and of numbers. `options` are the names `build` takes with their default values; `more` are the
    arguments that the chosen options add at the end.
    """

    build: Callable[..., Callable[..., Any]]
    arguments: Arguments
    options: Mapping[str, Any]
    doc: str
    more: Callable[[Mapping[str, Any]], Arguments] = no_more


def frame_of(model: Model, name: str | None) -> Frame:
    """The frame of that name; the model's tool for None."""
    if name is not None and not isinstance(name, str):
        raise InputError(f"`frame` is {name!r}; expected the name of one frame, or None for the tool.")
    return model.frame(model.tool if name is None else name)


def on_model(function: Callable[..., Any]) -> Callable[..., Callable[..., Any]]:
    """Recipe of an algorithm that needs only the model, arrays, and options of the same names."""

    def build(model: Model, **options: Any) -> Callable[..., Any]:
        return lambda *arrays: function(model, *arrays, **options)

    return build
