"""Properties computed once, without a lock.

`functools.cached_property` of Python 3.11 holds one lock for all instances of a class while it computes: threads wait
for each other, and a child forked meanwhile waits for ever. Later versions have no lock, and neither has this one:
threads that ask at the same moment each compute, and all get the first result.
"""

from __future__ import annotations

import functools
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING or sys.version_info >= (3, 12):
    cached_property = functools.cached_property
else:

    class cached_property(functools.cached_property):
        """A property whose value is computed at its first use and kept in the object."""

        def __get__(self, instance: Any, owner: Any = None) -> Any:
            """The value."""
            if instance is None:
                return self
            value = instance.__dict__.get(self.attrname, self)
            return (
                instance.__dict__.setdefault(self.attrname, self.func(instance)) if value is self else value
            )


__all__ = ["cached_property"]
