"""Moves functions that are rarely called, such as sines of huge arguments, into modules that kernels share.

These functions are marked `cold`. Each takes as long to compile as all else in the kernel of a small robot, and is the
same in most kernels. So a process compiles it once, and kernels call it by a name that has the hash of its text.
"""

from __future__ import annotations

import hashlib
import re

_MARK = " noinline cold nounwind {\n"
_PREFIX = "ulna.rare."
_SYMBOL = re.compile(rb"ulna\.rare\.[0-9a-f]{32}")
_NAME = re.compile(r"@([\w.$-]+)")
_PARAMETER = re.compile(r" %[\w.$-]+")


def with_rare_functions_apart(ir: str) -> tuple[str, dict[str, str]]:
    """The module without its rarely called functions, and their modules.

    Args:
        ir: The text of an LLVM module.

    Returns:
        The text, in which they are declared; and by the name of each the text of the module that defines it, with what
        it needs. A function that needs what modules cannot share, such as variables, stays where it is.
    """
    found = _rare_functions(ir)
    rest = ir
    for text in found.values():
        rest = rest.replace(text, "", 1)
    called = [name for name in found if f"@{name}(" in rest]  # others are only called by these
    needs = {name: _needed(found[name], found, rest) for name in called}
    modules: dict[str, str] = {}
    if not needs or None in needs.values():
        return ir, modules
    for name, lines in needs.items():
        text = found[name]
        content = "".join((*(lines or ()), text))
        new = _PREFIX + hashlib.sha256(content.encode()).hexdigest()[:32]
        head, _, body = text.partition("\n")
        signature = head.removeprefix("define internal ").replace(f"@{name}(", f"@{new}(")
        module = content.replace(text, f"define {signature}\n{body}")
        modules[new] = module.replace(_MARK, " noinline nounwind {\n")  # there they are not taken apart again
        declared = _PARAMETER.sub("", signature.removesuffix(" {"))
        rest = f"declare {declared}\n" + rest.replace(f"@{name}(", f"@{new}(")
    return rest, modules


def rare_functions_of(content: bytes) -> list[str]:
    """The names of such functions that an object file refers to.

    Args:
        content: The object file.

    Returns:
        The names, each once.
    """
    return sorted({name.decode() for name in _SYMBOL.findall(content)})


def _rare_functions(ir: str) -> dict[str, str]:
    """The texts of the definitions that are marked, by their names."""
    found: dict[str, str] = {}
    at = ir.find(_MARK)
    while at >= 0:
        start, end = ir.rfind("\n", 0, at) + 1, ir.index("\n}", at) + 3
        text = ir[start:end]
        name = _NAME.search(text)
        assert name is not None
        found[name[1]] = text
        at = ir.find(_MARK, end)
    return found


def _needed(text: str, rare: dict[str, str], rest: str) -> list[str] | None:
    """What a function needs in a module of its own: functions that it calls, declarations and constants.

    Args:
        text: The definition of the function.
        rare: All such functions of the module by name.
        rest: The text of the module without them.

    Returns:
        The texts, or None where it needs something else.
    """
    needed: dict[str, str] = {}
    waiting = [text]
    while waiting:
        for name in dict.fromkeys(_NAME.findall(waiting.pop())):
            if name in needed or rare.get(name) == text:
                continue
            if name in rare:
                needed[name] = rare[name]
                waiting.append(rare[name])
                continue
            named = re.escape(name)
            line = re.search(
                rf"^(?:declare [^\n]*@{named}\(|@{named} = [^\n]*\bconstant )[^\n]*\n", rest, re.MULTILINE
            )
            if line is None:
                return None
            needed[name] = line[0]
    return list(needed.values())
