"""What every part of `Robot` stands on: a model, and its kernels by name."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from ulna.model import Model


class Part(ABC):
    """A theme of questions to a robot."""

    __slots__ = ()

    model: Model

    @abstractmethod
    def _checked(self, name: str, **options: Any) -> Any:
        """The kernel of that name and options, which checks its inputs."""
