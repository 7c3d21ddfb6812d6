"""Every exception and warning of Ulna, in one tree, each carrying its data and the mend.

UlnaError
├── InputError (ValueError)          what was passed in cannot be used
│   ├── ShapeError                   an array has the wrong shape
│   ├── DtypeError                   an array has a type that does not convert to real numbers
│   └── NonFiniteError               an array holds nan or inf
├── UnknownName (LookupError)        a frame, joint, robot, kernel ... of that name does not exist
├── ModelError (ValueError)          a robot model contradicts itself
│   └── FormatError                  a model file is broken: file, line, element, mend
├── InfeasibleError (ValueError)     limits and constraints leave no motion at all
├── MissingExtra (ImportError)       an optional dependency is not installed
├── TraceError (TypeError)           a traced function does what cannot be traced
├── CompileError (RuntimeError)      LLVM refused a kernel (a bug in Ulna; please report it)
└── ViewerError (RuntimeError)       the viewer cannot do what was asked

UlnaWarning (UserWarning)
├── ModelWarning                     a model file is odd but usable (a missing mesh, a massless link)
└── CacheWarning                     the kernel cache cannot be used; costs time, never correctness
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from ulna.extras import install_command


class UlnaError(Exception):
    """Base of every exception that Ulna raises on purpose."""


class InputError(UlnaError, ValueError):
    """What was passed in cannot be used."""


class ShapeError(InputError):
    """An array has the wrong shape."""

    def __init__(self, name: str, given: tuple[int, ...], expected: str, mend: str = "") -> None:
        self.name, self.given, self.expected = name, given, expected
        text = f"`{name}` has shape {given}; expected {expected}."
        super().__init__(f"{text} {mend}" if mend else text)


class DtypeError(InputError, TypeError):
    """An array has a type that does not convert to real numbers."""

    def __init__(self, name: str, given: str, expected: str = "real numbers", mend: str = "") -> None:
        self.name, self.given, self.expected = name, given, expected
        text = f"`{name}` has dtype {given}; expected {expected}."
        super().__init__(f"{text} {mend}" if mend else text)


class NonFiniteError(InputError):
    """An array holds nan or inf."""

    def __init__(
        self,
        name: str,
        index: tuple[int, ...],
        value: float,
        mend: str = "Look where it comes from, or call the bare kernel (robot.kernel(...)), which lets nan through.",
    ) -> None:
        self.name, self.index, self.value = name, index, value
        where = f"[{', '.join(map(str, index))}]" if index else ""
        super().__init__(f"`{name}{where}` is {value}; expected finite numbers. {mend}")


def _nearest(given: str, choices: tuple[str, ...]) -> list[str]:
    """Up to three names like the given one, whatever their case, the nearest first."""
    by_folded: dict[str, list[str]] = {}
    for choice in choices:
        by_folded.setdefault(choice.casefold(), []).append(choice)
    near = difflib.get_close_matches(given.casefold(), by_folded, n=3, cutoff=0.5)
    return [choice for folded in near for choice in by_folded[folded]][:3]


class UnknownName(UlnaError, LookupError):
    """A frame, joint, robot or kernel of that name does not exist; the nearest names are offered."""

    def __init__(self, kind: str, given: object, choices: Iterable[str], mend: str = "") -> None:
        self.kind, self.given, self.choices = kind, given, tuple(choices)
        near = _nearest(str(given), self.choices)
        self.nearest = near[0] if near else None
        if near:
            hint = "Did you mean " + " or ".join(repr(n) for n in near) + "?"
        elif self.choices:
            shown = ", ".join(repr(c) for c in self.choices[:12])
            more = f", ... ({len(self.choices)} in all)" if len(self.choices) > 12 else ""
            hint = f"There are: {shown}{more}."
        else:
            hint = f"There is no {kind} at all."
        text = f"No {kind} named {given!r}. {hint}"
        super().__init__(f"{text} {mend}" if mend else text)


class ModelError(UlnaError, ValueError):
    """A robot model contradicts itself."""


class FormatError(ModelError):
    """A model file is broken; says where and what mends it."""

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        element: str = "",
        mend: str = "",
    ) -> None:
        self.message, self.file, self.line, self.element, self.mend = message, file, line, element, mend
        place = f"{file or '<string>'}" + (f":{line}" if line else "")
        parts = [f"{place}: {message}"]
        if element:
            parts.append(f"In {element}.")
        if mend:
            parts.append(mend)
        super().__init__(" ".join(parts))


class InfeasibleError(UlnaError, ValueError):
    """Limits and constraints leave no motion at all; names those that contradict each other."""

    def __init__(self, parts: tuple[str, ...], text: str) -> None:
        self.parts = parts
        super().__init__(text)


class MissingExtra(UlnaError, ImportError):
    """An optional dependency is not installed; names the extra that brings it."""

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        self.package, self.extra, self.purpose = package, extra, purpose
        command = install_command(extra, package)
        super().__init__(f"{purpose} needs the package {package!r}. Install it with: {command}")


class TraceError(UlnaError, TypeError):
    """A traced function does what cannot be traced."""


class CompileError(UlnaError, RuntimeError):
    """LLVM refused a kernel."""


class ViewerError(UlnaError, RuntimeError):
    """The viewer cannot do what was asked."""


class UlnaWarning(UserWarning):
    """Base of every warning of Ulna."""


class ModelWarning(UlnaWarning):
    """A model file is odd but usable."""


class CacheWarning(UlnaWarning):
    """The kernel cache cannot be used; costs time, never correctness."""
