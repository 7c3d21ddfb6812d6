"""Lets a library be imported without waiting for packages that it needs only now and then.

While the library is imported, a stand-in answers for such a package. Classes and functions of it that are known to be
called, or asked about, later on are stand-ins, too; whatever else is wanted of the package imports it. Afterwards
nothing is in the way: whoever imports the package gets it itself.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import ModuleType
from typing import Any, final


@contextmanager
def deferred_imports(names: Mapping[str, Iterable[str]]) -> Iterator[None]:
    """Within, modules are not imported by who imports them, but when they are used.

    Args:
        names: Modules, with the classes and functions of each that may be taken from it without importing it. Modules
            that are imported already, or whose package is not installed, stay as they are.
    """
    absent = [module for module in names if module not in sys.modules and _spec(module.partition(".")[0])]
    made = {module: DeferredModule(module, names[module]) for module in absent}
    finder: Any = _SubmoduleFinder(made)
    sys.modules.update(made)
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)
        for module in made.values():
            module._unregister()


@final
class DeferredModule(ModuleType):
    """Stands for a module that is not imported yet.

    Args:
        name: The dotted name of the module.
        names: What can be imported from it.
    """

    def __init__(self, name: str, names: Iterable[str]) -> None:
        super().__init__(name)
        self._names = frozenset(names)
        top, *inner = name.split(".")
        places = getattr(_spec(top), "submodule_search_locations", None)
        if places is not None:
            self.__path__ = [os.path.join(place, *inner) for place in places]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        below = sys.modules.get(f"{self.__name__}.{name}")
        if type(below) is DeferredModule:
            return below
        if name in self._names and sys.modules.get(self.__name__) in (None, self):
            return DeferredName(self.__name__, name)
        return getattr(self._import_module(), name)

    def _unregister(self) -> None:
        if sys.modules.get(self.__name__) is self:
            del sys.modules[self.__name__]

    def _import_module(self) -> ModuleType:
        self._unregister()
        return importlib.import_module(self.__name__)


@final
class DeferredName:
    """Stands for a class or a function of a module that is not imported yet.

    Args:
        module: The dotted name of the module.
        name: The name in it.
    """

    __slots__ = ("_module", "_name")

    def __init__(self, module: str, name: str) -> None:
        self._module, self._name = module, name

    def _real(self) -> Any:
        module = importlib.import_module(self._module)
        if type(module) is DeferredModule:  # it is used while imports are still deferred
            module = module._import_module()
        return getattr(module, self._name)

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Calls the function or class, which is imported at the first use.

        Args:
            *args, **options: As for the function or class.

        Returns:
            What the function, or the class, returns.
        """
        return self._real()(*args, **options)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self._real(), name)

    def __instancecheck__(self, instance: Any) -> bool:
        """Nothing is of a class whose module is not imported."""
        module = sys.modules.get(self._module)
        if module is None or type(module) is DeferredModule:
            return False
        return isinstance(instance, getattr(module, self._name))

    def __mro_entries__(self, bases: Any) -> tuple[Any, ...]:
        return (self._real(),)

    def __repr__(self) -> str:
        return f"<{self._module}.{self._name}, imported when used>"


@final
class _SubmoduleFinder:
    """Sees modules below a stand-in being imported: that takes the real package."""

    def __init__(self, made: Mapping[str, DeferredModule]) -> None:
        self._made = made

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        """Finds nothing itself; the finders after it do."""
        parent = self._made.get(name.rpartition(".")[0])
        if parent is not None and sys.modules.get(parent.__name__) is parent:
            parent._import_module()


def _spec(name: str) -> Any:
    try:
        return importlib.util.find_spec(name)
    except ValueError:  # a module without a spec, such as one of a notebook
        return None
