"""Raising errors without the one that is being handled, such as the KeyError of a cache."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_context() -> Iterator[None]:
    """Errors that leave the block are shown without the one that is being handled, such as the KeyError of a cache."""
    try:
        yield
    except Exception as error:
        error.__suppress_context__ = True
        raise
