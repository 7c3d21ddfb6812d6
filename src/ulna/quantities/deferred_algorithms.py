"""The functions of `ulna.algorithms` as declarations name them: each file is imported when one is first called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ulna import algorithms
else:

    class _Algorithms:
        """Has a function of the same name for each of `ulna.algorithms`."""

        def __getattr__(self, name: str) -> Any:
            def algorithm(*arguments: Any, **options: Any) -> Any:
                from ulna import algorithms

                return getattr(algorithms, name)(*arguments, **options)

            algorithm.__name__ = algorithm.__qualname__ = name
            return algorithm

    algorithms = _Algorithms()

__all__ = ["algorithms"]
