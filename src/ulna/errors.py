"""Every exception and warning of Ulna, in one tree, each carrying its data and the fix.

UlnaError
├── InputError (ValueError)          what was passed in cannot be used
│   ├── ShapeError                   an array has the wrong shape
│   ├── DtypeError                   an array has a type that does not convert to real numbers
│   ├── NonFiniteError               an array holds nan or inf
│   └── MissingFolder (FileNotFoundError) a file cannot be written, since its folder does not exist
├── UnknownName (LookupError)        a frame, joint, robot, kernel ... of that name does not exist
├── UnknownAttribute (AttributeError) an object has no attribute of that name
├── UnknownArgument (TypeError)      a function has no argument of that name
├── UnknownOperation (TypeError)     an operator is not defined for these objects
├── ModelError (ValueError)          a robot model contradicts itself
│   └── FormatError                  a model file is broken: file, line, element, fix
├── InfeasibleError (ValueError)     limits and constraints leave no motion at all
├── MissingExtra (ImportError)       an optional dependency is not installed
├── TraceError (TypeError)           a traced function does what cannot be traced
├── ProcedureError (TypeError)       a procedure says what cannot be compiled: file, line, fix
├── OutOfBounds (IndexError)         a procedure reads or writes beside an array: file, line, index
├── DivisionByZero (ZeroDivisionError) a procedure divides an integer by zero: file, line
├── CompileError (RuntimeError)      LLVM refused a kernel (a bug in Ulna; please report it)
├── TooLargeError (RuntimeError)     a kernel would take more operations than the limit
├── DeviceError (RuntimeError)       there is no GPU, or no driver for it
├── VersionMismatch (RuntimeError)   a task came from a process with another version of Ulna
├── JobStopped (RuntimeError)        a job on a cluster ended before all of it was done; it can be continued
└── ViewerError (RuntimeError)       the viewer cannot do what was asked

UlnaWarning (UserWarning)
├── ModelWarning                     a model file is odd but usable (a missing mesh, a massless link)
├── CacheWarning                     the kernel cache cannot be used; costs time, never correctness
└── TraceWarning                     a function calls what happens once, while it is compiled
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from ulna.extras import install_command

LONGEST_MESSAGE = 4000
"""No message of Ulna has more characters: what was given may have millions."""

LONGEST_ECHO = 100
"""How many characters of a name that was given a message repeats."""

MOST_CHOICES = 2000
"""Among more names than this no similar one is searched for: it would take longer than the work itself."""


def excerpt(text: str, most: int = LONGEST_ECHO) -> str:
    """A text, or its beginning and its end with a count of its characters.

    Args:
        text: The text.
        most: The largest number of characters.

    Returns:
        At most that many characters.
    """
    if len(text) <= most:
        return text
    note = f" ... ({len(text)} characters) ... "
    shown = max(most - len(note), 2)
    return text[: shown - shown // 3] + note + text[len(text) - shown // 3 :]


def nearest(given: str, choices: Iterable[str], count: int = 3, cutoff: float = 0.5) -> list[str]:
    """Up to `count` different names similar to the given one, whatever their case, the nearest first.

    None for a name too long to be misspelt, and where there are too many choices to compare.

    Args:
        given: The name that is unknown.
        choices: The valid names.
        count: The largest number of names.
        cutoff: How similar they must be, from 0 to 1, by the measure of `difflib` [-].

    Returns:
        The names; none where nothing is similar.
    """
    by_folded: dict[str, list[str]] = {}
    for choice in dict.fromkeys(choices):
        if len(choice) <= LONGEST_ECHO:
            by_folded.setdefault(choice.casefold(), []).append(choice)
        if len(by_folded) > MOST_CHOICES:
            return []
    if len(given) > LONGEST_ECHO:
        return []
    import difflib  # slow to import, and needed only for errors

    suggestions = difflib.get_close_matches(given.casefold(), by_folded, n=count, cutoff=cutoff)
    return [choice for folded in suggestions for choice in by_folded[folded]][:count]


class UlnaError(Exception):
    """Base of every exception that Ulna raises on purpose."""

    def __init__(self, *args: object) -> None:
        super().__init__(*(excerpt(a, LONGEST_MESSAGE) if isinstance(a, str) else a for a in args))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self.args, dict(self.__dict__))


def _restored(kind: type[UlnaError], args: tuple[Any, ...], data: dict[str, Any]) -> UlnaError:
    """An error as it was before it was pickled: its classes take other arguments than the message."""
    error = (OSError if issubclass(kind, OSError) else kind).__new__(kind, *args)
    error.args = args  # not set for an OSError whose class has an `__init__`
    error.__dict__.update(data)
    return error


class InputError(UlnaError, ValueError):
    """What was passed in cannot be used."""


class ShapeError(InputError):
    """An array has the wrong shape.

    Args:
        name: The name of the argument.
        given: The shape it has.
        expected: What was expected.
        fix: How to correct it.
    """

    def __init__(self, name: str, given: tuple[int, ...], expected: str, fix: str = "") -> None:
        self.name, self.given, self.expected = name, given, expected
        text = f"`{name}` has shape {given}; expected {expected}."
        super().__init__(f"{text} {fix}" if fix else text)


class DtypeError(InputError, TypeError):
    """An array has a type that does not convert to real numbers.

    Args:
        name: The name of the argument.
        given: The type it has.
        expected: What was expected.
        fix: How to correct it.
    """

    def __init__(self, name: str, given: str, expected: str = "real numbers", fix: str = "") -> None:
        self.name, self.given, self.expected = name, given, expected
        text = f"`{name}` has dtype {given}; expected {expected}."
        super().__init__(f"{text} {fix}" if fix else text)


FIND_NAN = "Look where it comes from, or call the bare kernel (robot.kernel(...)), which lets nan through."
"""The advice where numbers that a kernel takes are not finite."""


class NonFiniteError(InputError):
    """An array holds nan or inf.

    Args:
        name: The name of the argument.
        index: Where the first such entry is.
        value: That entry [any].
        fix: How to correct it.
    """

    def __init__(
        self,
        name: str,
        index: tuple[int, ...],
        value: float,
        fix: str = FIND_NAN,
    ) -> None:
        self.name, self.index, self.value = name, index, value
        where = f"[{', '.join(map(str, index))}]" if index else ""
        super().__init__(f"`{name}{where}` is {value}; expected finite numbers. {fix}")


class MissingFolder(InputError, FileNotFoundError):
    """A file cannot be written, since there is no folder in its place; says which one is missing.

    Args:
        folder: The folder.
        path: The path of the file, as it was given.
    """

    def __init__(self, folder: str, path: str) -> None:
        self.folder, self.path = folder, path
        super().__init__(
            f"{excerpt(repr(path))} cannot be written: there is no folder {excerpt(repr(folder))}. Make it first, or "
            "give another path."
        )


class UnknownName(UlnaError, LookupError):
    """A frame, joint, robot or kernel of that name does not exist; the nearest names are offered.

    Args:
        kind: What it names, such as "joint".
        given: The unknown name.
        choices: The valid names.
        fix: How to correct it.
    """

    def __init__(self, kind: str, given: object, choices: Iterable[str], fix: str = "") -> None:
        self.kind, self.given, self.choices = kind, given, tuple(choices)
        suggestions = nearest(str(given), self.choices)
        self.nearest = suggestions[0] if suggestions else None
        if suggestions:
            hint = "Did you mean " + " or ".join(repr(n) for n in suggestions) + "?"
        elif self.choices:
            distinct = list(dict.fromkeys(self.choices))
            shown = ", ".join(excerpt(repr(c)) for c in distinct[:12])
            more = f", ... ({len(distinct)} in all)" if len(distinct) > 12 else ""
            hint = f"There are: {shown}{more}."
        else:
            hint = f"There is no {kind} at all."
        text = f"No {kind} named {excerpt(repr(given))}. {hint}"
        super().__init__(f"{text} {fix}" if fix else text)


class UnknownAttribute(UlnaError, AttributeError):
    """An object has no attribute of that name; says what to use instead.

    Args:
        subject: The object, as text.
        name: The unknown attribute.
        choices: The valid ones.
        advice: What to use instead.
    """

    def __init__(self, subject: str, name: str, choices: Iterable[str] = (), advice: str = "") -> None:
        suggestions = nearest(name, tuple(choices))
        hint = f"Did you mean {' or '.join(map(repr, suggestions))}?" if suggestions else ""
        subject = f"The {subject}" if subject[:1].islower() else subject
        text = " ".join(
            part for part in (f"{subject} has no attribute {excerpt(name)!r}.", advice, hint) if part
        )
        super().__init__(text)
        self.name, self.obj = (
            name,
            None,
        )  # without the object Python appends no guess to this advice


class UnknownArgument(UlnaError, TypeError):
    """A function has no argument of that name; says which was meant.

    Args:
        function: The name of the function.
        given: The unknown argument.
        choices: The valid ones.
        meant: The one that was meant; None for the most similar.
    """

    def __init__(self, function: str, given: str, choices: Iterable[str], meant: str | None = None) -> None:
        self.function, self.given, self.choices = function, given, tuple(choices)
        suggestions = [meant] if meant in self.choices else nearest(given, self.choices)
        named = ", ".join(f"`{name}`" for name in self.choices)
        hint = (
            f"Did you mean {' or '.join(f'`{n}`' for n in suggestions)}?"
            if suggestions
            else f"It has: {named}."
        )
        super().__init__(f"{function}() has no argument `{excerpt(given)}`. {hint}")


class UnknownOperation(UlnaError, TypeError):
    """An operator is not defined for these objects; says which one is."""


class ModelError(UlnaError, ValueError):
    """A robot model contradicts itself."""


class FormatError(ModelError):
    """A model file is broken; says where and how to fix it.

    Args:
        message: What is wrong.
        file: The file; None for text.
        line: The line in it; None where that is unknown.
        element: The element, as text; empty for none.
        fix: How to correct it.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        element: str = "",
        fix: str = "",
    ) -> None:
        self.message, self.file, self.line, self.element, self.fix = message, file, line, element, fix
        place = f"{file or '<string>'}" + (f":{line}" if line else "")
        parts = [f"{place}: {message}"]
        if element:
            parts.append(f"In {element}.")
        if fix:
            parts.append(fix)
        super().__init__(" ".join(parts))


class InfeasibleError(UlnaError, ValueError):
    """Limits and constraints leave no motion at all; names those that contradict each other.

    Args:
        parts: The names of the limits that contradict each other.
        text: The message.
    """

    def __init__(self, parts: tuple[str, ...], text: str) -> None:
        self.parts = parts
        super().__init__(text)


class MissingExtra(UlnaError, ImportError):
    """An optional dependency is not installed; names the extra that brings it.

    Args:
        package: The package that is not installed.
        extra: The extra of ulna that installs it.
        purpose: What needs it.
    """

    def __init__(self, package: str, extra: str, purpose: str) -> None:
        self.package, self.extra, self.purpose = package, extra, purpose
        command = install_command(extra, package)
        super().__init__(f"{purpose} needs the package {package!r}. Install it with: {command}")


@contextmanager
def needed(package: str, extra: str, purpose: str) -> Iterator[None]:
    """Around imports of an optional dependency.

    Args:
        package: The package.
        extra: The extra of ulna that installs it.
        purpose: What needs it.

    Returns:
        A context.

    Raises:
        MissingExtra: It is not installed.
    """
    try:
        yield
    except ImportError as error:
        raise MissingExtra(package, extra, purpose) from error


class TraceError(UlnaError, TypeError):
    """A traced function does what cannot be traced."""


class ProcedureError(UlnaError, TypeError):
    """A procedure says what cannot be compiled.

    Args:
        name: The name of the procedure.
        file: The file.
        line: The line in it.
        code: The code in question; empty for none.
        text: What cannot be compiled.
        fix: How to correct it.
    """

    def __init__(self, name: str, file: str, line: int, code: str, text: str, fix: str = "") -> None:
        self.name, self.file, self.line, self.code = name, file, line, code
        where = f"{file}:{line}, in {name}" + (f": `{excerpt(code)}`" if code else "")
        super().__init__(f"{where}: {text}." + (f" {fix}" if fix else ""))


class OutOfBounds(UlnaError, IndexError):
    """A procedure reads or writes beside an array.

    Args:
        file: The file.
        line: The line in it.
        index: The index.
        extent: The length of the axis.
    """

    def __init__(self, file: str, line: int, index: int, extent: int) -> None:
        self.file, self.line, self.index, self.extent = file, line, index, extent
        super().__init__(
            f"{file}:{line}: index {index} of an axis of length {extent}; indices are 0 to {extent - 1}, and slices "
            "lie within the axis."
        )


class DivisionByZero(UlnaError, ZeroDivisionError):
    """A procedure divides an integer by zero.

    Args:
        file: The file.
        line: The line in it.
    """

    def __init__(self, file: str, line: int) -> None:
        self.file, self.line = file, line
        super().__init__(f"{file}:{line}: an integer is divided by zero.")


class CompileError(UlnaError, RuntimeError):
    """LLVM refused a kernel."""


class TooLargeError(UlnaError, RuntimeError):
    """A kernel would take more operations than the limit, ULNA_MOST_OPERATIONS."""


class VersionMismatch(UlnaError, RuntimeError):
    """A task came from a process with another version of Ulna, NumPy or Python; names both and the machine."""


class JobStopped(UlnaError, RuntimeError):
    """A job ended before all of it was done; says why, what is missing, and how to continue.

    Attributes:
        done: How many of its parts are in the store.
        parts: How many there are.

    Args:
        reason: Why it stopped, as a sentence.
        done: How many parts are done.
        parts: How many there are.
        store: Where they are; empty for nowhere.
    """

    def __init__(self, reason: str, done: int, parts: int, store: str) -> None:
        self.done, self.parts = done, parts
        if store:
            more = f"{done} of {parts} parts are in {store!r}; run the same job again to continue from there."
        else:
            more = f"{done} of {parts} parts were done and are lost: give `to` a folder, and they are kept."
        super().__init__(f"{reason} {more}")


class DeviceError(UlnaError, RuntimeError):
    """There is no GPU that code can run on, or no driver for it."""


class ViewerError(UlnaError, RuntimeError):
    """The viewer cannot do what was asked."""


class UlnaWarning(UserWarning):
    """Base of every warning of Ulna."""

    def __init__(self, *args: object) -> None:
        super().__init__(*(excerpt(a, LONGEST_MESSAGE) if isinstance(a, str) else a for a in args))


class ModelWarning(UlnaWarning):
    """A model file is odd but usable."""


class CacheWarning(UlnaWarning):
    """The kernel cache cannot be used; costs time, never correctness."""


class TraceWarning(UlnaWarning):
    """A function that is compiled calls a clock or draws random numbers; this happens once, not with each call."""
