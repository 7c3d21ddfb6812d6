"""Results that hold Dask arrays: Dask computes them like its own collections."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

from ulna.errors import InputError
from ulna.lazy.apply import is_dask, is_deferred


class Collection(ABC):
    """A result whose arrays may be lazy; `dask.compute(result)` and `result.compute()` make it one of NumPy arrays."""

    __slots__ = ()

    @abstractmethod
    def _arrays(self) -> tuple[Any, ...]:
        """The arrays that may be lazy."""

    @abstractmethod
    def _with_arrays(self, arrays: Sequence[Any]) -> Any:
        """The same result with other arrays."""

    @property
    def is_lazy(self) -> bool:
        """Whether it holds arrays that are not computed yet."""
        return any(is_dask(getattr(array, "data", array)) for array in self._arrays() if is_deferred(array))

    def compute(self, **options: Any) -> Any:
        """The result with its arrays computed.

        Args:
            **options: Of `dask.compute`, such as `scheduler`.

        Returns:
            A result of NumPy arrays; this one where it is not lazy.
        """
        if not self.is_lazy:
            return self
        from dask.base import compute  # pyright: ignore[reportMissingImports]

        return self._with_arrays(compute(*self._arrays(), **options))

    def persist(self, **options: Any) -> Any:
        """The result with its arrays computed where the workers are, and still lazy.

        Args:
            **options: Of `dask.persist`, such as `scheduler`.

        Returns:
            A lazy result; this one where it is not lazy.
        """
        if not self.is_lazy:
            return self
        from dask.base import persist  # pyright: ignore[reportMissingImports]

        return self._with_arrays(persist(*self._arrays(), **options))

    def _require_numbers(self, what: str) -> None:
        """Refuses what a lazy result cannot say."""
        if self.is_lazy:
            raise InputError(f"`{what}` is known once the result is computed: result.compute().{what}.")

    def __dask_graph__(self) -> Any:
        if not self.is_lazy:
            return None
        from dask.highlevelgraph import HighLevelGraph  # pyright: ignore[reportMissingImports]

        return HighLevelGraph.merge(*(array.__dask_graph__() for array in self._arrays()))

    def __dask_keys__(self) -> list[Any]:
        return [array.__dask_keys__() for array in self._arrays()]

    def __dask_layers__(self) -> tuple[str, ...]:
        return tuple(layer for array in self._arrays() for layer in array.__dask_layers__())

    def __dask_tokenize__(self) -> Any:
        from dask.base import normalize_token  # pyright: ignore[reportMissingImports]

        return type(self).__name__, [normalize_token(array) for array in self._arrays()]

    @property
    def __dask_optimize__(self) -> Any:
        from dask.array import Array  # pyright: ignore[reportMissingImports]

        return Array.__dask_optimize__

    @property
    def __dask_scheduler__(self) -> Any:
        from dask.array import Array  # pyright: ignore[reportMissingImports]

        return Array.__dask_scheduler__

    def __dask_postcompute__(self) -> tuple[Any, tuple[Any, ...]]:
        return self._finished, ([array.__dask_postcompute__() for array in self._arrays()],)

    def _finished(self, results: Sequence[Any], steps: Sequence[Any]) -> Any:
        pairs = zip(results, steps, strict=True)
        return self._with_arrays([finish(result, *rest) for result, (finish, rest) in pairs])

    def __dask_postpersist__(self) -> tuple[Any, tuple[Any, ...]]:
        return self._persisted, ([array.__dask_postpersist__() for array in self._arrays()],)

    def _persisted(self, graph: Any, steps: Sequence[Any], rename: Any = None) -> Any:
        options = {} if rename is None else {"rename": rename}
        return self._with_arrays([finish(graph, *rest, **options) for finish, rest in steps])
