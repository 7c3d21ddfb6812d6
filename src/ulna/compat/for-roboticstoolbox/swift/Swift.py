"""The environment once more, for `from swift.Swift import ...`."""

from swift._swift import Swift

__all__ = ["Swift"]
