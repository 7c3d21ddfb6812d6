"""What a script puts into the panel: sliders, buttons, labels, menus, boxes; their functions run in its own thread."""

from __future__ import annotations

import abc
from collections.abc import Callable, Iterable, Sequence
from typing import Any, ClassVar

import numpy as np

from ulna.errors import InputError, UnknownName

Notice = Callable[["SwiftElement", Any], None]
"""Told which element was changed in the page, and to what."""


class Settled:
    """A value of an element that can be set until the element is in the panel."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, element: Any, owner: type | None = None) -> Any:
        return self if element is None else element.__dict__[self._name]

    def __set__(self, element: Any, value: Any) -> None:
        if element.shown:
            raise NotImplementedError(
                f"`{self._name}` of a {type(element).__name__} that is in the panel is not changed. "
                "Set it before `env.add`, or add another one."
            )
        element.__dict__[self._name] = value


class SwiftElement(abc.ABC):
    """A control of the panel.

    Args:
        cb: Called with what was chosen, in the thread of the script, by `env.step`, `env.run`, `env.hold` or
            `env.process_events`.
        label: The words beside it.
        desc: An older name of `label`.
    """

    kind: ClassVar[str] = "element"

    def __init__(
        self, cb: Callable[[Any], Any] | None = None, label: str = "", desc: str | None = None
    ) -> None:
        self._controls: list[Any] = []
        self.id: int | None = None
        self.cb = cb
        self.label = str(label if desc is None else desc)

    @property
    def shown(self) -> bool:
        """Whether it is in a panel."""
        return self.id is not None

    label = Settled()

    @property
    def desc(self) -> str:
        """An older name of `label`."""
        return self.label

    @desc.setter
    def desc(self, words: str) -> None:
        self.label = words

    @property
    def state(self) -> Any:
        """What it shows, for `env.values`."""
        return None

    def show(self, panel: Any, number: int, notice: Notice) -> None:
        """Put it into a panel of `ulna.Viewer`."""
        self._controls = self._build(panel, lambda value: notice(self, value))
        self.id = number

    @abc.abstractmethod
    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        """Its controls in the panel."""

    @abc.abstractmethod
    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""

    def choose(self, e: Any) -> None:
        """Take over what was chosen in the page, and tell `cb`."""
        self.update(e)
        if self.cb is not None:
            self.cb(e)

    def _bring(self, *values: Any) -> None:
        """Have the panel show values that the script chose; that calls nothing."""
        for control, value in zip(self._controls, values, strict=False):
            control.value = value

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {"element": self.kind, "id": self.id, "builtin": False, "label": self.label}


class Slider(SwiftElement):
    """A slider.

    Args:
        cb: Called with the value.
        min: The least value.
        max: The largest value.
        step: From one value to the next.
        value: Where it starts.
        label: The words beside it.
        unit: What the value is measured in.
        precision: Digits that Swift shows; the panel shows those of `step`.
        desc: An older name of `label`.

    Raises:
        InputError: `min` is not below `max`, or `step` not above zero.
    """

    kind = "slider"
    min, max, step, unit, precision = Settled(), Settled(), Settled(), Settled(), Settled()

    def __init__(
        self,
        cb: Callable[[float], Any] | None = None,
        min: float = 0,
        max: float = 100,
        step: float = 1,
        value: float = 0,
        label: str = "",
        unit: str = "",
        precision: int = 3,
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, desc)
        self.min, self.max, self.step, self.unit, self.precision = (
            float(min),
            float(max),
            float(step),
            unit,
            precision,
        )
        self._value = float(value)
        if not (np.isfinite([min, max, value]).all() and min < max and step > 0):
            raise InputError(
                f"The slider {self.label!r} runs from {min} to {max} in steps of {step}, at {value}; expected "
                "min < max and a step above zero."
            )

    @property
    def value(self) -> float:
        """Where it stands; assigning moves it and calls nothing."""
        return self._value

    @value.setter
    def value(self, value: float) -> None:
        self.update(value)
        self._bring(float(np.clip(self._value, self.min, self.max)))

    @property
    def state(self) -> float:
        """What it shows, for `env.values`."""
        return self._value

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        label, unit = self.label or "slider", str(self.unit)
        return [panel.slider(label, self.min, self.max, self._value, changed, step=self.step, unit=unit)]

    def update(self, e: float) -> None:
        """Take over a value; calls nothing."""
        self._value = float(e)

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        names = ("min", "max", "step", "value", "unit", "precision")
        return {**super().to_dict(), **{name: getattr(self, name) for name in names}}


class Button(SwiftElement):
    """A button.

    Args:
        cb: Called with 0, as Swift does.
        label: The words on it.
        desc: An older name of `label`.
    """

    kind = "button"

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        panel.button(self.label or "button", lambda: changed(0))
        return []

    def update(self, e: Any) -> None:
        """Nothing is to be taken over; calls nothing."""


class Label(SwiftElement):
    """Words.

    Args:
        label: The words; they can be changed at any time.
        compact: Whether they take little room, which they always do here.
        desc: An older name of `label`.
    """

    kind = "label"

    def __init__(self, label: str = "", compact: bool = False, desc: str | None = None) -> None:
        self.compact = bool(compact)
        super().__init__(None, label, desc)

    @property
    def label(self) -> str:
        """The words."""
        return self._words

    @label.setter
    def label(self, label: str) -> None:
        self._words = str(label)
        self._bring(self._words)

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        return [panel.text(self._words)]

    def update(self, e: Any) -> None:
        """Nothing is to be taken over; calls nothing."""

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "compact": self.compact}


class _Choice(SwiftElement):
    """An element with options."""

    options = Settled()

    def __init__(
        self, cb: Callable[[Any], Any] | None, label: str, options: Iterable[str], desc: str | None
    ) -> None:
        super().__init__(cb, label, desc)
        self.options = [str(o) for o in options]
        if len(set(self.options)) != len(self.options):
            raise InputError(f"{self.label!r} has the options {self.options}; expected each once.")

    def _number(self, value: Any) -> int:
        """The index of an option, given by its index or its name."""
        if isinstance(value, str):
            if value not in self.options:
                raise UnknownName(f"option of {self.label!r}", value, self.options)
            return self.options.index(value)
        number = int(value)
        if not 0 <= number < max(len(self.options), 1):
            raise InputError(
                f"{self.label!r} has {len(self.options)} options; there is none of index {value}."
            )
        return number

    def _ticks(self, ticks: Sequence[Any]) -> list[bool]:
        out = [bool(t) for t in ticks]
        if len(out) > len(self.options):
            raise InputError(f"{self.label!r} has {len(self.options)} options; got {len(out)} values.")
        return out + [False] * (len(self.options) - len(out))

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "options": list(self.options)}


class Select(_Choice):
    """A menu of which one is chosen.

    Args:
        cb: Called with the index of what was chosen.
        label: The words beside it.
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
        self._value = self._number(value)

    @property
    def value(self) -> int:
        """The index of what is chosen; assigning chooses and calls nothing."""
        return self._value

    @value.setter
    def value(self, value: Any) -> None:
        self.update(value)
        self._bring(self.options[self._value])

    @property
    def state(self) -> int:
        """What it shows, for `env.values`."""
        return self._value

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        chosen = self.options[self._value] if self.options else None
        label = self.label or "select"
        return [panel.select(label, self.options, chosen, lambda option: changed(self._number(option)))]

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        self._value = self._number(e)

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "value": self._value}


class Checkbox(_Choice):
    """Boxes to tick.

    Args:
        cb: Called with a list of which are ticked.
        label: The words above them.
        options: The words beside them.
        checked: Which are ticked at first.
        desc: An older name of `label`.

    Raises:
        InputError: There are more ticks than boxes, or two boxes of one name.
    """

    kind = "checkbox"

    def __init__(
        self,
        cb: Callable[[list[bool]], Any] | None = None,
        label: str = "",
        options: Iterable[str] = (),
        checked: Sequence[bool] = (),
        desc: str | None = None,
    ) -> None:
        super().__init__(cb, label, options, desc)
        self._checked = self._ticks(checked)

    @property
    def checked(self) -> list[bool]:
        """Which are ticked; assigning ticks them and calls nothing."""
        return list(self._checked)

    @checked.setter
    def checked(self, checked: Any) -> None:
        self.update(checked)
        self._bring(*self._checked)

    @property
    def state(self) -> list[bool]:
        """What it shows, for `env.values`."""
        return self.checked

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        def ticked(k: int) -> Callable[[bool], None]:
            return lambda on: changed((k, on))

        with panel.folder(self.label or "checkbox"):
            return [panel.checkbox(o, self._checked[k], ticked(k)) for k, o in enumerate(self.options)]

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        self._checked = self._ticks(e)

    def choose(self, e: Any) -> None:
        """Take over which are ticked, or one box (index, ticked) that was clicked, and tell `cb`."""
        if isinstance(e, tuple):
            k, on = e
            e = [on if i == k else was for i, was in enumerate(self._checked)]
        super().choose(e)

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "checked": self.checked}


class Radio(_Choice):
    """Boxes of which exactly one is ticked.

    Args:
        cb: Called with the index of the one that was ticked.
        label: The words above them.
        options: The words beside them.
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
        self._bring(self.options[self._value])

    @property
    def state(self) -> list[bool]:
        """What it shows, for `env.values`."""
        return self.checked

    def _build(self, panel: Any, changed: Callable[[Any], None]) -> list[Any]:
        chosen = self.options[self._value] if self.options else None
        label = self.label or "radio"
        return [panel.radio(label, self.options, chosen, lambda option: changed(self._number(option)))]

    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""
        if isinstance(e, int | str | np.integer):
            self._value = self._number(e)
        else:
            ticks = self._ticks(e)
            self._value = ticks.index(True) if any(ticks) else 0

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {**super().to_dict(), "checked": self.checked}
