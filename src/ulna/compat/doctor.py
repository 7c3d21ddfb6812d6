"""Examines a script: which names of libraries it uses, and which of them the compatibility packages do not offer."""

from __future__ import annotations

import ast
import importlib
import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from ulna.compat.members import missing_keywords, offered_member, refused
from ulna.compat.missing_names import REFUSAL
from ulna.compat.packages import FOLDERS, compatibility_imports, modules
from ulna.compat.script_names import expressions
from ulna.compat.script_objects import KnownObject, Objects, ObjectsOf
from ulna.errors import FormatError, InputError
from ulna.files import read_regular


@final
@dataclass(frozen=True)
class Finding:
    """A name of a library that a script uses.

    Attributes:
        line: Where it does so first.
        name: The dotted name, from the package on.
        offered: Whether the compatibility package has it; None where the text does not say what the name belongs to.
        hint: What to use instead, if it does not.
    """

    line: int
    name: str
    offered: bool | None
    hint: str = ""


def examine(path: str | Path) -> list[Finding]:
    """The names of libraries that a script uses, in the order of their lines; the script is read, not run.

    Attributes and keywords of objects are examined where assignments, classes and annotations say what the object is.
    A finding with `offered` None is a name whose attributes could not be examined.

    Raises:
        InputError: If the file cannot be read.
        FormatError: If it is not Python.
    """
    file = Path(path)
    try:
        tree = ast.parse(read_regular(file), str(file))
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}.") from None
    except (SyntaxError, ValueError) as error:
        # ValueError: null characters
        message, line = getattr(error, "msg", None) or str(error), getattr(error, "lineno", None)
        raise FormatError(f"not Python: {message}", file=str(file), line=line) from None
    known_modules = {module for library in FOLDERS for module in modules(library)}
    used: dict[str, int] = {}
    for line, name in sorted(_used(tree, frozenset(known_modules))):
        used.setdefault(name, line)
    with compatibility_imports(FOLDERS.values(), known_modules):
        from_names = [Finding(line, name, *_is_offered(name)) for name, line in used.items()]
        objects = _of_objects(tree, frozenset(known_modules))
    return sorted(
        {one.name: one for one in [*reversed(objects), *from_names]}.values(), key=lambda one: one.line
    )


def _of_objects(tree: ast.Module, known_modules: frozenset[str]) -> list[Finding]:
    """Attributes and keywords of objects of libraries, and names that were not examined."""

    def load(name: str) -> Any:
        if name.split(".", maxsplit=1)[0] not in known_modules:
            return None
        offered, hint = _is_offered(name)
        if not offered:
            raise AttributeError(hint)
        return _value(name)

    objects_of, findings, added = ObjectsOf(load), [], _added(tree)
    for node, scope in expressions(tree):
        if isinstance(node, ast.Call):
            findings += _of_keywords(node, objects_of(node.func, scope))
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load):
            base = objects_of(node.value, scope)
            if base is not None:
                findings += _of_attribute(node, base, added)
            elif not _is_within_unknown(node.value, lambda part, at=scope: objects_of(part, at)):
                findings.append(Finding(node.lineno, ast.unparse(node.value), None))
    return findings


def _is_within_unknown(value: ast.expr, objects_of: Callable[[ast.expr], Objects]) -> bool:
    """Whether an expression is an attribute, item or result of an attribute of something that is not known itself."""
    while isinstance(value, ast.Attribute | ast.Subscript | ast.Call):
        inner = value.func if isinstance(value, ast.Call) else value.value
        if isinstance(value, ast.Attribute) and objects_of(inner) is None:
            return True
        value = inner
    return False


def _added(tree: ast.Module) -> frozenset[str]:
    """Attributes that the script itself makes: by assignment, or as a named configuration."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add(node.attr)
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "").startswith("addconfiguration"):
            names |= {word.value for word in node.args[:1] if isinstance(word, ast.Constant)}
    return frozenset(names)


def _of_attribute(node: ast.Attribute, base: tuple[KnownObject, ...], added: frozenset[str]) -> list[Finding]:
    instances = [one.value for one in base if one.is_instance]
    if not instances or len(instances) < len(base) or node.attr in added:
        return []
    answers = [offered_member(kind, node.attr) for kind in instances]
    hint = next((hint for offered, hint in answers if not offered), "")
    return [Finding(node.lineno, f"{_full_name(instances[0])}.{node.attr}", any(o for o, _ in answers), hint)]


def _of_keywords(node: ast.Call, called: Objects) -> list[Finding]:
    keywords = [one.arg for one in node.keywords if one.arg is not None]
    if not keywords or not called or any(one.is_instance for one in called):
        return []
    missing = [missing_keywords(one.value, keywords) for one in called]
    owner = called[0].owner
    name = f"{_full_name(owner)}.{called[0].value.__name__}" if owner else _full_name(called[0].value)
    everywhere = [keyword for keyword in missing[0] if all(keyword in other for other in missing)]
    return [Finding(node.lineno, f"{name}({keyword}=)", False) for keyword in everywhere]


def _full_name(value: Any) -> str:
    """The name of a class or function, from its package on, without private modules."""
    parts = [part for part in value.__module__.split(".") if not part.startswith("_")]
    return ".".join([*parts[:1], value.__qualname__])


def _used(tree: ast.AST, known_modules: frozenset[str]) -> Iterator[tuple[int, str]]:
    """Lines and dotted names."""
    meaning: dict[str, str] = {}  # of the names in the script
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] in known_modules:
                    meaning[alias.asname or alias.name.split(".")[0]] = (
                        alias.name if alias.asname else alias.name.split(".")[0]
                    )
                    yield node.lineno, alias.name
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] in known_modules:
            for alias in node.names:
                if alias.name != "*":
                    meaning[alias.asname or alias.name] = f"{node.module}.{alias.name}"
                yield node.lineno, node.module if alias.name == "*" else f"{node.module}.{alias.name}"
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            parts: list[str] = []
            at: ast.AST = node
            while isinstance(at, ast.Attribute):
                parts.insert(0, at.attr)
                at = at.value
            if isinstance(at, ast.Name) and at.id in meaning:
                yield node.lineno, ".".join([meaning[at.id], *parts])


def _is_offered(name: str) -> tuple[bool, str]:
    try:
        value = _value(name)
    except (AttributeError, ImportError) as error:
        return False, str(error)
    refusal = getattr(value, REFUSAL, None) if inspect.ismodule(value) else refused(value)
    return refusal is None, refusal or ""


def _value(name: str) -> Any:
    """What a dotted name of a library stands for.

    Raises:
        AttributeError, ImportError: There is no such thing.
    """
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            value = importlib.import_module(".".join(parts[:count]))
            break
        except ModuleNotFoundError:
            continue
    else:
        raise ImportError("")
    for part in parts[count:]:
        value = getattr(value, part)
    return value


def report(path: str | Path, findings: Sequence[Finding]) -> str:
    """What `ulna doctor` prints.

    Args:
        path: The script.
        findings: The names that it uses.

    Returns:
        Lines of text.
    """
    examined = [f for f in findings if f.offered is not None]
    missing = [f for f in examined if not f.offered]
    head = f"{path}: {len(examined)} names of libraries, {len(examined) - len(missing)} offered."
    lines = [f"  line {f.line}: {f.name} is not offered. {f.hint}".rstrip() for f in missing]
    unknown = [f"{f.name} (line {f.line})" for f in findings if f.offered is None]
    if unknown:
        lines.append(
            f"  Not examined, since the text does not say what they are: attributes of {', '.join(unknown)}."
        )
    return "\n".join([head, *lines])
