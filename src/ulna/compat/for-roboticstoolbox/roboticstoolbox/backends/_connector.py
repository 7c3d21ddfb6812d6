"""What a backend must have: the protocol that scripts derive their own backends from."""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, Protocol, runtime_checkable


@runtime_checkable
class Connector(Protocol):
    """A graphical backend.

    Attributes:
        supports_teach: Whether it has sliders for joints.
        supports_ellipse: Whether it draws ellipses.
    """

    supports_teach: bool = True
    supports_ellipse: bool = False

    @abstractmethod
    def launch(self, *args: Any, **kwargs: Any) -> Any:
        """Opens the scene."""

    @abstractmethod
    def step(self, *args: Any, **kwargs: Any) -> Any:
        """Moves the robots on in time, and draws them."""

    @abstractmethod
    def reset(self, *args: Any, **kwargs: Any) -> Any:
        """Goes back to the scene that was opened."""

    @abstractmethod
    def restart(self, *args: Any, **kwargs: Any) -> Any:
        """Closes the scene and opens it again."""

    @abstractmethod
    def close(self, *args: Any, **kwargs: Any) -> Any:
        """Closes the scene."""

    @abstractmethod
    def add(self, *args: Any, **kwargs: Any) -> Any:
        """Adds an object; returns its number."""

    @abstractmethod
    def remove(self, *args: Any, **kwargs: Any) -> Any:
        """Takes an object out."""

    @abstractmethod
    def hold(self, *args: Any, **kwargs: Any) -> Any:
        """Keeps the scene open."""
