"""Base classes of controls: value, label and visibility can be read and assigned at any time."""

from __future__ import annotations

from typing import Any, ClassVar, final

from ulna.checks.attributes import FixedAttributes
from ulna.checks.values import flag, text
from ulna.errors import InputError


@final
class OfflineHandle:
    """Stands in for a control of the page where there is no page: it keeps what it is given."""

    def __init__(self, **values: Any) -> None:
        self.__dict__.update({"visible": True, "disabled": False, "precision": 0} | values)

    def remove(self) -> None:
        """Nobody saw it."""

    def __enter__(self) -> OfflineHandle:
        return self

    def __exit__(self, *_: object) -> None:
        """It contains nothing."""


class Control(FixedAttributes):
    """A control of the panel, used from any thread. What it does not have cannot be assigned to.

    Args:
        handle: What stands for it in the page, as viser has it, or a `Kept`.
        label: The text beside it.
    """

    __slots__ = ("_handle", "_label", "_removed")

    def __init__(self, handle: Any, label: str = "") -> None:
        self._handle, self._label, self._removed = handle, label, False

    @property
    def visible(self) -> bool:
        """Whether it can be seen."""
        return bool(self._handle.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._set("visible", flag("visible", visible))

    @property
    def removed(self) -> bool:
        """Whether it was taken out of the panel."""
        return self._removed

    def remove(self) -> None:
        """Remove it from the panel; its function is not called any more. May be called twice."""
        if not self._removed:
            self._removed = True
            self._handle.remove()

    def __repr__(self) -> str:
        return f"<{self._title()}>"

    def _title(self) -> str:
        return f"{type(self).__name__.lower()} {self._label!r}"

    def _check_not_removed(self) -> None:
        if self._removed:
            raise InputError(f"The {self._title()} was removed from the panel. Make a new one.")

    def _set(self, attribute: str, value: Any) -> None:
        self._check_not_removed()
        if getattr(self._handle, attribute) != value:
            setattr(self._handle, attribute, value)


class LabelledControl(Control):
    """A control with a label beside it."""

    __slots__ = ()
    _label_attribute: ClassVar[str] = "label"

    @property
    def label(self) -> str:
        """The text beside it."""
        return self._label

    @label.setter
    def label(self, label: str) -> None:
        self._check_not_removed()
        self._label = text("label", label)
        self._set(self._label_attribute, self._label_text())

    def _label_text(self) -> str:
        return self._label


class DisableableControl(LabelledControl):
    """A control with a label beside it, that can be out of use for a while."""

    __slots__ = ()

    @property
    def disabled(self) -> bool:
        """Whether it is disabled in the page; the program can still change it."""
        return bool(self._handle.disabled)

    @disabled.setter
    def disabled(self, disabled: bool) -> None:
        self._set("disabled", flag("disabled", disabled))


class ValueControl(DisableableControl):
    """A control with a value."""

    __slots__ = ()

    @property
    def value(self) -> Any:
        """What it shows; assigning calls no function."""
        return self._handle.value

    @value.setter
    def value(self, value: Any) -> None:
        self._set("value", self._checked(value))

    def _checked(self, value: Any) -> Any:
        return value


@final
class Checkbox(ValueControl):
    """A box to tick."""

    __slots__ = ()

    def _checked(self, value: Any) -> bool:
        return flag("value", value)


@final
class Text(Control):
    """Words in Markdown; setting `value` replaces them."""

    __slots__ = ()

    @property
    def value(self) -> str:
        """The text."""
        return self._handle.content

    @value.setter
    def value(self, value: str) -> None:
        self._set("content", text("value", value))


@final
class Button(DisableableControl):
    """A button; `value` counts how often it was clicked.

    Args:
        handle: The control of viser.
        label: Its label.
    """

    __slots__ = ("_clicks",)

    def __init__(self, handle: Any, label: str) -> None:
        super().__init__(handle, label)
        self._clicks = 0

    @property
    def value(self) -> int:
        """How often it was clicked."""
        return self._clicks

    def count(self) -> None:
        """It was clicked once more."""
        self._clicks += 1


@final
class Folder(LabelledControl):
    """A heading with controls under it; hidden or removed, they are, too.

    Args:
        handle: The control of viser.
        label: Its label.
    """

    __slots__ = ("_children",)

    def __init__(self, handle: Any, label: str) -> None:
        super().__init__(handle, label)
        self._children: list[Control] = []

    def add_child(self, control: Control) -> None:
        """Add a control."""
        self._children = [*(c for c in self._children if not c.removed), control]

    def remove(self) -> None:
        """Remove it from the panel with all controls in it. May be called twice."""
        for control in self._children:
            control.remove()
        super().remove()


def with_unit(label: str, unit: str) -> str:
    """A label and a unit: "force [N]".

    Args:
        label: The label.
        unit: The unit; "" for none.

    Returns:
        The text.
    """
    return f"{label} [{text('unit', unit)}]" if text("unit", unit) else label
