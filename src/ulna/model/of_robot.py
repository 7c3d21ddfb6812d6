"""The model of an argument that is a robot or a model."""

from __future__ import annotations

from typing import Any

from ulna.checks.values import short_repr
from ulna.errors import InputError
from ulna.model.model import Model


def model_of(robot: Any, name: str = "robot") -> Model:
    """The model of a robot, or the model itself.

    Args:
        robot: A Robot or a Model.
        name: Name of the argument, for the message.

    Returns:
        The model.

    Raises:
        InputError: It is neither.
    """
    model = getattr(robot, "model", robot)
    if not isinstance(model, Model):
        raise InputError(
            f"`{name}` is {short_repr(robot)}; expected a Robot, such as ulna.load(...) returns, or a Model."
        )
    return model
