"""Data: the arrays that algorithms fill, and how compiled algorithms are bound to them."""

from typing import Any

from pinocchio._package.former_modules import former_class


def __getattr__(name: str) -> Any:
    return former_class(__name__, name)
