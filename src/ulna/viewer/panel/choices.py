"""Controls with options: a menu, radio boxes, a row of buttons."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, final

from ulna.checks.values import one_of, short_repr, text
from ulna.errors import InputError
from ulna.viewer.panel.controls import DisableableControl, LabelledControl


def delegated_property(part: str, name: str) -> Any:
    """A property that reads and writes a property of a part.

    Args:
        part: Name of the attribute that holds the part.
        name: Name of the part's property.

    Returns:
        The property.
    """
    return property(
        lambda self: getattr(getattr(self, part), name),
        lambda self, value: setattr(getattr(self, part), name, value),
    )


class _ControlWithOptions(LabelledControl):
    """A control with choices."""

    __slots__ = ()

    @property
    def options(self) -> tuple[str, ...]:
        """The choices, in their order."""
        return tuple(self._handle.options)

    @options.setter
    def options(self, options: Sequence[str]) -> None:
        names, first = checked_choices(self._label, options, None)
        self._set("options", names)
        if self._handle.value not in names:
            self._handle.value = first


@final
class Choice(_ControlWithOptions, DisableableControl):
    """A menu or boxes of which one is chosen; where its choices change and lack that one, the first is."""

    __slots__ = ()

    @property
    def value(self) -> str:
        """What is chosen; assigning calls no function."""
        return self._handle.value

    @value.setter
    def value(self, value: str) -> None:
        self._set("value", checked_choices(self._label, self.options, text("value", value))[1])


@final
class Buttons(_ControlWithOptions):
    """Buttons of which any is pressed; `value` is the last that was, empty before.

    Args:
        handle: The control of viser.
        label: Its label.
    """

    __slots__ = ("_pressed",)

    def __init__(self, handle: Any, label: str) -> None:
        super().__init__(handle, label)
        self._pressed = ""

    @property
    def value(self) -> str:
        """The last that was pressed."""
        return self._pressed

    def press(self, option: str) -> None:
        """One was pressed."""
        self._pressed = option


@final
class ButtonMenu:
    """Many choices to press, as one handle of the page: a menu, and a button under it that presses.

    A menu alone would seem to have chosen its first, and could not choose the same again.

    Args:
        menu: The menu of viser.
        button: The button of viser.
    """

    def __init__(self, menu: Any, button: Any) -> None:
        self._menu, self._button = menu, button

    label, options = delegated_property("_menu", "label"), delegated_property("_menu", "options")
    value = delegated_property("_menu", "value")

    @property
    def visible(self) -> bool:
        """Whether they can be seen."""
        return self._menu.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._menu.visible = self._button.visible = visible

    def on_click(self, function: Any) -> None:
        """Have a function called when the button is pressed."""
        self._button.on_click(function)

    def remove(self) -> None:
        """Take both out."""
        self._menu.remove()
        self._button.remove()


@final
class RadioBoxes:
    """Boxes under a heading of which exactly one is ticked, as one handle of the page.

    Args:
        heading: The folder they stand in.
        options: The labels beside them.
        value: Which is ticked.
        make: Makes a box: its label, and whether it is ticked.
    """

    def __init__(
        self, heading: Any, options: tuple[str, ...], value: str, make: Callable[[str, bool], Any]
    ) -> None:
        self._heading, self._make = heading, make
        self._value, self._boxes, self._disabled = value, {}, False
        self.options = options

    label, visible = delegated_property("_heading", "label"), delegated_property("_heading", "visible")

    @property
    def value(self) -> str:
        """Which is ticked."""
        return self._value

    @value.setter
    def value(self, value: str) -> None:
        self._value = value
        for option, box in self._boxes.items():
            if box.value != (option == value):
                box.value = option == value

    @property
    def options(self) -> tuple[str, ...]:
        """The labels beside them."""
        return tuple(self._boxes)

    @options.setter
    def options(self, options: tuple[str, ...]) -> None:
        for box in self._boxes.values():
            box.remove()
        with self._heading:
            self._boxes = {o: self._make(o, o == self._value) for o in options}
        self.disabled = self._disabled

    @property
    def disabled(self) -> bool:
        """Whether they are disabled in the page."""
        return self._disabled

    @disabled.setter
    def disabled(self, disabled: bool) -> None:
        self._disabled = disabled
        for box in self._boxes.values():
            box.disabled = disabled

    def remove(self) -> None:
        """Take all of them out."""
        self._heading.remove()


def checked_choices(label: str, options: Sequence[str], value: str | None) -> tuple[tuple[str, ...], str]:
    """Choices as texts, and the one that is chosen: `value`, or the first.

    Args:
        label: Label of the control, for messages.
        options: The choices.
        value: The one that is chosen; None for the first.

    Returns:
        The choices, and the one that is chosen.

    Raises:
        InputError: There are none, or one twice.
        UnknownName: `value` is none of them.
    """
    if isinstance(options, str | bytes) or not isinstance(options, Iterable):
        raise InputError(
            f"`options` of {label!r} are {short_repr(options)}; expected words, as in ('open', 'closed')."
        )
    text("label", label)
    names = tuple(text("options", o) for o in options)
    if not names or len(set(names)) != len(names):
        raise InputError(f"{label!r} has the choices {names}; expected at least one, and each once.")
    return names, names[0] if value is None else one_of(f"choice of {label!r}", value, names)
