"""Base of all controls of the panel: a label, a callback, and settings that can change at any time."""

from __future__ import annotations

import abc
import warnings
from collections.abc import Callable
from typing import Any, ClassVar

Notice = Callable[["SwiftElement", Any], None]
"""Called with the element that was changed in the page, and its value."""


class Setting:
    """Something of an element that can be set at any time; a value that does not fit raises and changes nothing."""

    def __init__(self, kind: Callable[[Any], Any] = str) -> None:
        self._kind = kind

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, element: Any, owner: type | None = None) -> Any:
        return self if element is None else element.__dict__[self._name]

    def __set__(self, element: Any, value: Any) -> None:
        before = dict(element.__dict__)
        element.__dict__[self._name] = self._kind(value)
        if self._name in before:  # not the first time, while the element is made
            try:
                element._check()
            except Exception:
                element.__dict__.clear()
                element.__dict__.update(before)
                raise
            element._refresh()


class SwiftElement(abc.ABC):
    """A control of the panel.

    Args:
        cb: Called with what was chosen, in the thread of the script, by `env.step`, `env.run`, `env.hold` or
            `env.process_events`.
        label: The text beside it.
        desc: An older name of `label`.
    """

    kind: ClassVar[str] = "element"

    def __init__(
        self, cb: Callable[[Any], Any] | None = None, label: str = "", desc: str | None = None
    ) -> None:
        self._controls: list[Any] = []
        self._panel: Any = None
        self._shared: tuple[dict[str, Any], str] | None = None
        self.id: int | None = None
        self.cb = cb
        if desc is not None:
            # one level for each `__init__` on the way here, that of `object` standing for the call itself
            level = sum("__init__" in kind.__dict__ for kind in type(self).__mro__)
            warnings.warn(
                "`desc` of a control is the former name of `label`", DeprecationWarning, stacklevel=level
            )
        self.label = label if desc is None else desc

    label = Setting()

    def __getattr__(self, name: str) -> Any:
        if name in ("name", "builtin"):
            raise AttributeError(
                f"A control has no {name!r}; env.add_ui(control, name) names it for `env.values`."
            )
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    @property
    def desc(self) -> str:
        """An older name of `label`."""
        warnings.warn("`desc` of a control is the former name of `label`", DeprecationWarning, stacklevel=2)
        return self.label

    @desc.setter
    def desc(self, text: str) -> None:
        warnings.warn("`desc` of a control is the former name of `label`", DeprecationWarning, stacklevel=2)
        self.label = text

    @property
    def shown(self) -> bool:
        """Whether it is in a panel."""
        return self.id is not None

    def share(self, values: dict[str, Any] | None, name: str = "") -> None:
        """Keeps an entry of a dict up to date from now on, if the element has a `value`.

        Args:
            values: The dict; None to take the entry out.
            name: The key.
        """
        if self._shared is not None:
            self._shared[0].pop(self._shared[1], None)
        self._shared = None if values is None or not hasattr(type(self), "value") else (values, name)
        self._share()

    def _share(self) -> None:
        if self._shared is not None:
            values, name = self._shared
            values[name] = self.value

    def show(self, panel: Any, number: int, notice: Notice) -> None:
        """Adds the control to a panel of `ulna.Viewer`.

        Args:
            panel: The panel.
            number: The control's number.
            notice: Called when the control changes.
        """
        self._panel, self._notice = panel, notice
        self._controls = self._build(panel)
        self.id = number

    def remove(self) -> None:
        """Take it out of the panel; it can be put into one again."""
        for control in self._controls:
            control.remove()
        self._controls, self._panel, self.id = [], None, None

    def _on_change(self, value: Any) -> None:
        """Something was chosen in the page; that comes in on another thread."""
        self._notice(self, value)

    @abc.abstractmethod
    def _build(self, panel: Any) -> list[Any]:
        """Its controls in the panel."""

    def _check(self) -> None:  # noqa: B027 - most elements have nothing to check
        """Raise for settings that do not fit together."""

    def _refresh(self) -> None:
        """Bring the panel up to date; that calls nothing."""
        if self.shown:
            self._synchronize(*self._controls)

    @abc.abstractmethod
    def _synchronize(self, *controls: Any) -> None:
        """Bring its controls up to date."""

    @abc.abstractmethod
    def update(self, e: Any) -> None:
        """Take over a value; calls nothing."""

    def choose(self, e: Any) -> None:
        """Take over what was chosen in the page, and call `cb`."""
        self.update(e)
        if self.cb is not None:
            self.cb(e)

    def to_dict(self) -> dict[str, Any]:
        """What it is, in plain values."""
        return {"element": self.kind, "id": self.id, "builtin": False, "label": self.label}
