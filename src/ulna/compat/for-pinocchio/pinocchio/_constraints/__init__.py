"""Constraints between frames and at joints: models, cones, dynamics, solvers."""

from typing import Any

from pinocchio._package.former_modules import former_class


def __getattr__(name: str) -> Any:
    return former_class(__name__, name)
