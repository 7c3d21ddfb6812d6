"""Public functions of two or more arguments say what they take, return and raise, with shapes and units.

`python tests/architecture/test_docstrings.py [FILE OR FOLDER ...]` prints what is missing.
"""

from __future__ import annotations

import ast
import inspect
import re
import runpy
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from ulna.compat.documentation import with_arguments
from ulna.quantities import THEMES

SOURCE = Path(__file__).parents[2] / "src" / "ulna"
FILES = sorted(SOURCE.rglob("*.py"))

PACKAGES = {
    "compat/for-pinocchio/gepetto/": "corbaserver/documentation.py",
    "compat/for-pinocchio/pinocchio/": "_containers/documentation.py",
    "compat/for-roboticstoolbox/roboticstoolbox/": "_common/documentation.py",
}
"""Packages whose public names are defined in private folders, too, and what arguments of the same name mean in each."""
COMPLETED = ("compat/for-pinocchio/pinocchio/",)
"""Those that complete the docstrings of what is in private folders as they are imported."""

ARRAYS = re.compile(r"\b(Array|ArrayLike|Floats|NDArray|ndarray)\b")
NUMBERS = re.compile(rf"{ARRAYS.pattern}|\bfloat\b")
FLOATS = ("float", "float | None")
SHAPE = re.compile(r"\((\.\.\.)?\)|\((\.\.\.|[\w.+*/ -]+)(,\s*[\w.+*/ -]*)+\)")
UNIT = re.compile(r"\[[^\[\]]+\]")
PHYSICAL = frozenset(
    ["q", "v", "tau", "dt", "duration", "timeout", "period", "mass", "gravity", "radius", "angle"]
)
WITHOUT_UNITS = ("compiler", "checks")  # their numbers have no physical meaning
SPECIAL = ("__init__", "__call__")
SECTIONS = ("Args", "Returns", "Yields", "Raises")

Function = ast.FunctionDef | ast.AsyncFunctionDef


@cache
def parsed(path: Path) -> ast.Module:
    """The syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


@cache
def classes_by_name() -> dict[str, list[ast.ClassDef]]:
    """The classes of all modules by their names."""
    classes: dict[str, list[ast.ClassDef]] = {}
    for path in FILES:
        for node in parsed(path).body:
            if isinstance(node, ast.ClassDef):
                classes.setdefault(node.name, []).append(node)
    return classes


def base_names(node: ast.ClassDef) -> list[str]:
    """The names of the bases of a class, without package and type arguments."""
    return [ast.unparse(base).partition("[")[0].rpartition(".")[2] for base in node.bases]


def arguments(function: Function) -> list[ast.arg]:
    """All arguments without self or cls."""
    a = function.args
    every = [*a.posonlyargs, *a.args, *([a.vararg] if a.vararg else []), *a.kwonlyargs]
    every += [a.kwarg] if a.kwarg else []
    return [x for k, x in enumerate(every) if not (k == 0 and x.arg in ("self", "cls"))]


def package_of(path: Path) -> str | None:
    """The package of `PACKAGES` that a file belongs to."""
    return next((one for one in PACKAGES if path.relative_to(SOURCE).as_posix().startswith(one)), None)


@cache
def argument_texts(package: str | None) -> dict[str, str]:
    """What the package writes of arguments that a docstring has no entry of."""
    return runpy.run_path(str(SOURCE / package / PACKAGES[package]))["ARGUMENTS"] if package else {}


def is_public(path: Path) -> bool:
    """Whether neither the file nor a folder above it begins with an underscore."""
    return not any(part.startswith("_") and part != "__init__.py" for part in path.relative_to(SOURCE).parts)


def public_functions(module: ast.Module) -> Iterator[tuple[str, Function, ast.ClassDef | None]]:
    """Name, definition and class of each public function, method, constructor or call of two or more arguments."""
    todo: list[tuple[str, ast.stmt, ast.ClassDef | None]] = [("", node, None) for node in module.body]
    while todo:
        prefix, node, owner = todo.pop(0)
        if isinstance(node, (ast.If, ast.Try)):
            todo += [(prefix, child, owner) for child in [*node.body, *node.orelse]]
        if not isinstance(node, ast.ClassDef | Function) or (
            node.name.startswith("_") and node.name not in SPECIAL
        ):
            continue
        if isinstance(node, ast.ClassDef):
            if "Protocol" not in base_names(node):
                todo += [(f"{prefix}{node.name}.", child, node) for child in node.body]
        elif len(arguments(node)) >= 2 and not any(
            re.search(r"\boverload$|\.setter$", ast.unparse(decorator)) for decorator in node.decorator_list
        ):
            yield prefix + node.name, node, owner


def sections(doc: str) -> dict[str, str]:
    """The indented text below each title such as `Args:` of a docstring."""
    parts = re.split(rf"^({'|'.join(SECTIONS)}):[ \t]*\n(?=[ \t])", doc, flags=re.M)
    return {
        title: re.split(r"\n(?=\S)", text, maxsplit=1)[0]
        for title, text in zip(parts[1::2], parts[2::2], strict=True)
    }


def entries(section: str) -> dict[str, str]:
    """What a section says of each name: `name: text` or `name, name: text` at the section's own indentation."""
    indent = section[: len(section) - len(section.lstrip())]
    name = r"\*{0,2}[A-Za-z_][\w.]*"
    parts = re.split(rf"^{indent}({name}(?:, {name})*):", section, flags=re.M) if indent else [""]
    return {
        one.strip().lstrip("*"): text
        for names, text in zip(parts[1::2], parts[2::2], strict=True)
        for one in names.split(",")
    }


def raised(node: ast.AST, caught: frozenset[str] = frozenset()) -> set[str]:
    """The classes of exceptions that a body raises as `raise X(...)` and does not catch; inner functions do not count."""
    names: set[str] = set()
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call):
        name = ast.unparse(node.exc.func).rpartition(".")[2]
        names |= {name} - caught if name[:1].isupper() else set()
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ClassDef | ast.Lambda | Function):
            continue
        inside = isinstance(node, ast.Try) and child in node.body
        names |= raised(child, caught | exceptions_caught(node) if inside else caught)
    return names


def exceptions_caught(node: ast.Try) -> frozenset[str]:
    """The names of the exceptions that the handlers of a try statement name."""
    kinds = [handler.type for handler in node.handlers if handler.type is not None]
    flat = [one for kind in kinds for one in (kind.elts if isinstance(kind, ast.Tuple) else [kind])]
    return frozenset(ast.unparse(one).rpartition(".")[2] for one in flat)


def base_documents(name: str, function: Function, owner: ast.ClassDef | None) -> bool:
    """Whether a base class has this method with the same arguments and documents them."""
    todo, visited = base_names(owner) if owner else [], set()
    while todo:
        if (base := todo.pop()) in visited:
            continue
        visited.add(base)
        for node in classes_by_name().get(base, []):
            todo += base_names(node)
            for other in node.body:
                if isinstance(other, Function) and other.name == name.rpartition(".")[2]:
                    same = [x.arg for x in arguments(other)] == [x.arg for x in arguments(function)]
                    if same and "Args" in sections(ast.get_docstring(other) or ""):
                        return True
    return False


def docstring(function: Function, owner: ast.ClassDef | None, texts: Mapping[str, str]) -> str:
    """What `help` prints; the decorator `quantity` and `texts` complete what is written."""
    if any(ast.unparse(decorator).startswith("quantity(") for decorator in function.decorator_list):
        theme = next(theme for theme in THEMES if owner is not None and theme.__name__ == owner.name)
        return inspect.getdoc(vars(theme)[function.name]) or ""
    doc = ast.get_docstring(function) or ""
    return with_arguments(doc, [x.arg for x in arguments(function)], texts) if doc and texts else doc


def argument_complaints(function: Function, texts: dict[str, str]) -> Iterator[str]:
    """What the entries of `Args:` lack, given the text of each."""
    names = {x.arg: ast.unparse(x.annotation) if x.annotation else "" for x in arguments(function)}
    for name in names.keys() - texts.keys():
        yield f"`Args:` lacks {name}"
    for name in texts.keys() - names.keys():
        yield f"`Args:` names {name}, which is no argument"
    for name in names.keys() & texts.keys():
        is_array = ARRAYS.search(names[name]) and "Callable" not in names[name]
        if is_array and not SHAPE.search(texts[name]):
            yield f"{name} is an array and has no shape such as (n,)"
        physical = names[name] in FLOATS or (name in PHYSICAL and NUMBERS.search(names[name]))
        if physical and not UNIT.search(texts[name]):
            yield f"{name} has no unit such as [m] or [-]"


def complaints(path: Path) -> list[str]:
    """What the docstrings of a file lack: its name, line, name of the function, and what is missing."""
    name = path.relative_to(SOURCE).as_posix()
    if "_procedures" in path.parts:  # types and arguments are those of each call, described in the module
        return []
    package = package_of(path)
    all_completed = package in COMPLETED and not is_public(path)
    wrong = what_is_missing(parsed(path), package, all_completed) if package or is_public(path) else []
    if not is_public(path):  # constructors are overloaded there
        wrong = [text for text in wrong if not re.search(r"\.__\w+__: ", text)]
    if name.startswith(WITHOUT_UNITS):
        wrong = [text for text in wrong if "no unit" not in text]
    return [f"{name}:{text}" for text in wrong]


def what_is_missing(module: ast.Module, package: str | None = None, all_completed: bool = False) -> list[str]:
    """What the docstrings of a module lack: line, name of the function, and what is missing."""
    wrong: list[str] = []
    for name, function, owner in public_functions(module):
        decorators = [*function.decorator_list, *(owner.decorator_list if owner else [])]
        completed = all_completed or "describe_arguments" in map(ast.unparse, decorators)
        doc = docstring(function, owner, argument_texts(package) if completed else {})
        if function.name == "__init__" and owner and "Args" not in sections(doc):  # its class may describe it
            doc = f"{ast.get_docstring(owner) or ''}\n\n{doc}"
        parts = sections(doc)
        if "Args" not in parts and base_documents(name, function, owner):
            continue
        lacks = sorted(argument_complaints(function, entries(parts.get("Args", ""))))
        if not doc or doc.startswith(tuple(f"{title}:" for title in SECTIONS)):
            lacks.append("no summary")
        result = ast.unparse(function.returns) if function.returns else ""
        text = parts.get("Returns", parts.get("Yields", ""))
        if result not in ("None", "NoReturn", "Never") and not text:
            lacks.append("no `Returns:`")
        elif ARRAYS.search(result) and not SHAPE.search(text):
            lacks.append("`Returns:` has no shape such as (n,)")
        elif result in FLOATS and not UNIT.search(text):
            lacks.append("`Returns:` has no unit such as [m] or [-]")
        for error in sorted(raised(function) - entries(parts.get("Raises", "")).keys()):
            lacks.append(f"`Raises:` lacks {error}")
        wrong += [f"{function.lineno} {name}: {text}" for text in lacks]
    return wrong


def test_public_functions_have_complete_docstrings() -> None:
    assert [text for path in FILES for text in complaints(path)] == []


INCOMPLETE = '''
def f(q: Array, force: float, limit: float, *names: str) -> Array:
    """A summary.

    Args:
        q: positions.
        forces: misspelt.
        limit: the largest force.
    """
    if force < 0:
        raise InputError("negative")
    try:
        raise OSError("caught")
    except OSError:
        return q

class Base:
    def g(self, a: int, b: int) -> int:
        """A sum.

        Args:
            a, b: numbers.

        Returns:
            Their sum.
        """

class Derived(Joint):
    def g(self, a: int, b: int) -> int:
        """The same without sections."""

    def _private(self, a, b): ...

class Described:
    """A class.

    Args:
        a: a number.
    """

    def __init__(self, a: int, b: int) -> None: ...
'''


def test_the_check_notices_what_is_missing() -> None:
    texts = [text.partition(" ")[2] for text in what_is_missing(ast.parse(INCOMPLETE))]
    assert texts == [
        "f: `Args:` lacks force",
        "f: `Args:` lacks names",
        "f: `Args:` names forces, which is no argument",
        "f: limit has no unit such as [m] or [-]",
        "f: q has no unit such as [m] or [-]",
        "f: q is an array and has no shape such as (n,)",
        "f: no `Returns:`",
        "f: `Raises:` lacks InputError",
        "Derived.g: `Args:` lacks a",
        "Derived.g: `Args:` lacks b",
        "Derived.g: no `Returns:`",
        "Described.__init__: `Args:` lacks b",
    ]


def main(names: list[str]) -> None:
    """Print what is missing in these files and folders, or everywhere."""
    for path in FILES:
        asked = not names or any(path.is_relative_to(Path(name).resolve()) for name in names)
        for text in complaints(path) if asked else ():
            print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
