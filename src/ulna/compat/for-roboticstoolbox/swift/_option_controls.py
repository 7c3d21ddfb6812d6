"""Menus and boxes of the panel: controls with options."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from swift._element import Setting, SwiftElement
from ulna.errors import InputError, UnknownName


def _option_names(options: Iterable[Any]) -> list[str]:
    return [str(o) for o in options]


class _OptionControl(SwiftElement):
    """An element with options; where they change, what is chosen stays chosen by its place."""

    options: Any = Setting(_option_names)

    def __init__(
        self, cb: Callable[[Any], Any] | None, label: str, options: Iterable[str], desc: str | None
    ) -> None:
        super().__init__(cb, label, desc)
        self.options = options
        self._check()

    def _check(self) -> None:
        if len(set(self.options)) != len(self.options):
            raise InputError(f"{self.label!r} has the options {self.options}; expected each once.")

    def _index_of(self, value: Any) -> int:
        """The index of an option, given by its index or its name."""
        if isinstance(value, str):
            if value not in self.options:
                raise UnknownName(f"option of {self.label!r}", value, self.options)
            return self.options.index(value)
        index = int(value)
        if not 0 <= index < max(len(self.options), 1):
            raise InputError(
                f"{self.label!r} has {len(self.options)} options; there is none of index {value}."
            )
        return index

    def _ticks(self, ticks: Any) -> list[bool]:
        """Which options are ticked, given by a list, or the index or the name of one."""
        if isinstance(ticks, int | str | np.integer):
            index = self._index_of(ticks)
            return [k == index for k in range(len(self.options))]
        if not isinstance(ticks, Iterable):
            raise InputError(
                f"{self.label!r} was given {ticks!r}; expected a list of which options are ticked, or the index or the "
                "name of one."
            )
        out = [bool(t) for t in ticks]
        if len(out) > len(self.options):
            raise InputError(f"{self.label!r} has {len(self.options)} options; got {len(out)} values.")
        return out + [False] * (len(self.options) - len(out))

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "options": list(self.options)}


class _SingleChoice(_OptionControl):
    """An element with options of which one is chosen."""

    _value = 0

    def _check(self) -> None:
        super()._check()
        self._value = min(self._value, max(len(self.options) - 1, 0))
        self._share()

    def _chosen(self) -> str | None:
        return self.options[self._value] if self.options else None

    def _pressed(self, option: str) -> None:
        self._on_change(self._index_of(option))

    def _synchronize(self, *controls: Any) -> None:
        (choice,) = controls
        choice.label = self.label or self.kind
        choice.options, choice.value = self.options, self._chosen()


class Select(_SingleChoice):
    """A menu of which one is chosen.

    Args:
        cb: Called with the index of what was chosen.
        label: The text beside it.
        options: What there is to choose.
        value: The index of what is chosen at first.
        desc: An older name of `label`.

    Raises:
        InputError: There is no such index, or one option is there twice.
    """

    kind = "select"

    def __init__(
        self,
        cb: Callable[[int], Any] | None = None,
        label: str = "",
        options: Iterable[str] = (),
        value: int = 0,
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, options, desc)
        self._value = self._index_of(value)

    @property
    def value(self) -> int:
        """The index of what is chosen; assigning chooses and calls nothing."""
        return self._value

    @value.setter
    def value(self, value: Any) -> None:
        self.update(value)
        self._refresh()

    def _build(self, panel: Any) -> list[Any]:
        return [panel.select(self.label or self.kind, self.options, self._chosen(), self._pressed)]

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        self._value = self._index_of(e)
        self._share()

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "value": self._value}


class Radio(_SingleChoice):
    """Boxes of which exactly one is ticked.

    Args:
        cb: Called with the index of the one that was ticked.
        label: The text above them.
        options: The texts beside them.
        checked: The index of the one that is ticked at first, or a list of which.
        desc: An older name of `label`.

    Raises:
        InputError: There is no such index, or one option is there twice.
    """

    kind = "radio"

    def __init__(
        self,
        cb: Callable[[int], Any] | None = None,
        label: str = "",
        options: Iterable[str] = (),
        checked: int | Sequence[bool] = (),
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, options, desc)
        self.update(checked)

    @property
    def checked(self) -> list[bool]:
        """Which one is ticked, as a list; an index can be assigned, too, which calls nothing."""
        return [k == self._value for k in range(len(self.options))]

    @checked.setter
    def checked(self, checked: Any) -> None:
        self.update(checked)
        self._refresh()

    def _build(self, panel: Any) -> list[Any]:
        return [panel.radio(self.label or self.kind, self.options, self._chosen(), self._pressed)]

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        ticks = self._ticks(e)
        self._value = ticks.index(True) if any(ticks) else 0

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "checked": self.checked}


class Tick(NamedTuple):
    """One box that was clicked in the page."""

    place: int
    on: bool


class Checkbox(_OptionControl):
    """Boxes to tick.

    Args:
        cb: Called with a list of which are ticked.
        label: The text above them.
        options: The texts beside them.
        checked: Which are ticked at first, a list, or the index of the only one.
        desc: An older name of `label`.

    Raises:
        InputError: There is no such index, there are more ticks than boxes, or two boxes of one name.
    """

    kind = "checkbox"
    _checked: Sequence[bool] = ()

    def __init__(
        self,
        cb: Callable[[list[bool]], Any] | None = None,
        label: str = "",
        options: Iterable[str] = (),
        checked: int | Sequence[bool] = (),
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, options, desc)
        self._checked = self._ticks(checked)

    def _check(self) -> None:
        super()._check()
        self._checked = self._ticks(self._checked[: len(self.options)])

    @property
    def checked(self) -> list[bool]:
        """Which are ticked; a list, or the index of the only one, can be assigned, which calls nothing."""
        return list(self._checked)

    @checked.setter
    def checked(self, checked: Any) -> None:
        self.update(checked)
        self._refresh()

    def _build(self, panel: Any) -> list[Any]:
        def ticked(k: int) -> Callable[[bool], None]:
            return lambda on: self._on_change(Tick(k, on))

        self._built = list(self.options)
        with panel.folder(self.label or self.kind) as folder:
            boxes = [panel.checkbox(o, self._checked[k], ticked(k)) for k, o in enumerate(self.options)]
        return [folder, *boxes]

    def _synchronize(self, *controls: Any) -> None:
        folder, *boxes = controls
        if self._built != self.options:  # other boxes: they come at the end of the panel
            folder.remove()
            self._controls = self._build(self._panel)
            return
        folder.label = self.label or self.kind
        for box, on in zip(boxes, self._checked, strict=True):
            box.value = on

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        self._checked = self._ticks(e)

    def choose(self, e: Any) -> None:
        """Take over which are ticked, or a `Tick`, and call `cb`."""
        if isinstance(e, Tick):
            e = [e.on if k == e.place else was for k, was in enumerate(self._checked)]
        super().choose(e)

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "checked": self.checked}
