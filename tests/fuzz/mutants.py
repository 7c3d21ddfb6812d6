"""Damaged documents: each mutation keeps most of a document's structure, so that it gets far into a reader."""

from __future__ import annotations

import copy
import random
import struct
from collections.abc import Callable
from typing import Any

from lxml import etree

NUMBERS = (
    *(
        "nan",
        "inf",
        "-inf",
        "1e999",
        "1e49",
        "-1e49",
        "1e300",
        "1e-320",
        "0",
        "-0.0",
        "",
        " ",
        "1,2",
        "0x10",
        "1 2",
    ),
    *(
        "1 2 3",
        "0 0 0",
        "1 0 0 0",
        "1 2 3 4 5 6 7",
        "--1",
        "٣",
        "9" * 400,
        "1" * 5000 + "x",
        "4294967296",
        "-1",
    ),
)
NAMES = (
    *(
        "",
        " ",
        "a",
        "world",
        "universe",
        "nothing",
        "fixed",
        "revolute",
        "floating",
        "planar",
        "box",
        "a/b",
        "//",
        "../..",
    ),
    *(
        "ä",
        "\u202e",
        "x" * 3000,
        "'",
        '"',
        "<",
        "&amp;",
        "%s",
        "{0}",
        "${x}",
        "a b",
        "package://x/y",
        "/dev/zero",
        "true",
    ),
)
WORDS = tuple(struct.pack("<I", n) for n in (0, 1, 3, 255, 65536, 2**31 - 1, 2**31, 2**32 - 1)) + tuple(
    struct.pack("<f", x) for x in (float("nan"), float("inf"), 1e38, -1e38, 1e-45)
)


def text_mutant(seed: str, rng: random.Random) -> bytes:
    """An XML document with some elements, attributes or characters changed."""
    data = seed.encode()
    if rng.random() < 0.8:
        root = etree.fromstring(data, etree.XMLParser(remove_blank_text=False))
        for _ in range(rng.choice((1, 1, 2, 3, 8))):
            rng.choice(_TREE_CHANGES)(root, rng)
        data = etree.tostring(root, encoding="utf-8")
    else:
        for _ in range(rng.choice((1, 2, 5))):
            data = _changed_bytes(data, rng)
    return data


def binary_mutant(seed: bytes, rng: random.Random) -> bytes:
    """A document with some of its bytes, or of its words of 32 bits, changed."""
    for _ in range(rng.choice((1, 1, 2, 4, 10))):
        seed = _changed_bytes(seed, rng)
    return seed


def _changed_bytes(data: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(max(len(data), 1)) if rng.random() < 0.6 else rng.randrange(min(len(data), 200) or 1)
    end = min(len(data), at + rng.choice((1, 4, 50)))
    kind = rng.choice((0, 0, 4, 4, 1, 2, 3, 5, 6))
    if kind == 0:
        return data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    if kind == 1:
        return data[:at]
    if kind == 2:
        return data[:at] + data[end:]
    if kind == 3:
        return data[:at] + data[at:end] * rng.choice((2, 3, 100)) + data[end:]
    if kind == 4:
        return data[:at] + rng.choice(WORDS) + data[at + 4 :]
    if kind == 5:
        return data[:at] + rng.choice((*NUMBERS, *NAMES)).encode() + data[end:]
    return (
        data[:at] + rng.choice((b"<!--", b"<![CDATA[", b"&x;", b"\0", b"\xff", b"<?xml ?>", b'"')) + data[at:]
    )


def _elements(root: Any) -> list[Any]:
    return list(root.iter("*"))


def _change_attribute(root: Any, rng: random.Random) -> None:
    chosen = [e for e in _elements(root) if e.attrib]
    if chosen:
        element = rng.choice(chosen)
        name = rng.choice(list(element.attrib))
        others = [e.get(name) for e in chosen if e.get(name) is not None]
        numeric = any(c.isdigit() for c in element.get(name)) and rng.random() < 0.8
        words = NUMBERS if numeric else NAMES
        element.set(name, rng.choice(others) if rng.random() < 0.3 else rng.choice(words))


def _change_one_number(root: Any, rng: random.Random) -> None:
    chosen = [(e, n) for e in _elements(root) for n, v in e.attrib.items() if any(c.isdigit() for c in v)]
    if chosen:
        element, name = rng.choice(chosen)
        words = element.get(name).split() or [""]
        words[rng.randrange(len(words))] = rng.choice(NUMBERS)
        element.set(name, " ".join(words))


def _drop_attribute(root: Any, rng: random.Random) -> None:
    chosen = [e for e in _elements(root) if e.attrib]
    if chosen:
        element = rng.choice(chosen)
        del element.attrib[rng.choice(list(element.attrib))]


def _drop_element(root: Any, rng: random.Random) -> None:
    chosen = _elements(root)[1:]
    if chosen:
        element = rng.choice(chosen)
        element.getparent().remove(element)


def _copy_element(root: Any, rng: random.Random) -> None:
    chosen = _elements(root)
    rng.choice(chosen).append(copy.deepcopy(rng.choice(chosen[1:] or chosen)))


def _move_element(root: Any, rng: random.Random) -> None:
    chosen = _elements(root)
    if len(chosen) > 2:
        element, place = rng.choice(chosen[1:]), rng.choice(chosen)
        if place not in element.iter("*"):
            place.insert(0, element)


def _rename_element(root: Any, rng: random.Random) -> None:
    chosen = _elements(root)
    rng.choice(chosen).tag = rng.choice(
        [e.tag for e in chosen] + ["x", "link", "joint", "body", "default", "include"]
    )


def _repeat_element(root: Any, rng: random.Random) -> None:
    chosen = _elements(root)[1:]
    if chosen:
        element = rng.choice(chosen)
        for _ in range(rng.choice((1, 30))):
            element.addnext(copy.deepcopy(element))


def _add_text(root: Any, rng: random.Random) -> None:
    rng.choice(_elements(root)).text = rng.choice([*NUMBERS, "ä" * 100, "a b c"])


_TREE_CHANGES: tuple[Callable[[Any, random.Random], None], ...] = (
    *(
        _change_attribute,
        _change_attribute,
        _change_one_number,
        _change_one_number,
        _drop_attribute,
        _drop_element,
    ),
    *(_copy_element, _move_element, _rename_element, _repeat_element, _add_text),
)
