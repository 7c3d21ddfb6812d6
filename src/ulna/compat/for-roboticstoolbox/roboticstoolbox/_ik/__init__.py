"""Inverse kinematics: solvers as objects, and closed forms."""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.former_modules import former_class


def __getattr__(name: str) -> Any:
    return former_class(__name__, name)
