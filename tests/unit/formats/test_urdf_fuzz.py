"""Thousands of damaged URDF texts: each loads or is refused with an error of ours, and quickly."""

from __future__ import annotations

import random
import re
import time
import warnings
from collections.abc import Callable

import pytest

from ulna.errors import UlnaError
from ulna.formats.resolve import Resolver
from ulna.formats.urdf import model_from_urdf
from ulna.formats.urdf_parse import parse_urdf

SECONDS = 10.0
"""Processor time that one text may take; the median is below two milliseconds."""

SMALL = """<?xml version="1.0" encoding="utf-8"?>
<robot name="small">
  <material name="blue"><color rgba="0 0 0.8 1"/></material>
  <link name="base"><visual><geometry><box size="0.6 0.1 0.2"/></geometry>
    <material name="blue"/></visual></link>
  <link name="arm">
    <inertial><origin xyz="0 0 0.1" rpy="0 0.2 0"/><mass value="1.5"/>
      <inertia ixx="0.1" ixy="0" ixz="0.01" iyy="0.2" iyz="0" izz="0.15"/></inertial>
    <visual><geometry><mesh filename="package://small/arm.stl" scale="1 1 1"/></geometry></visual>
    <collision><origin xyz="0 0 1" rpy="1 0 0"/><geometry><cylinder radius="0.1" length="1"/></geometry>
    </collision>
  </link>
  <link name="hand"/><link name="left"/><link name="right"/>
  <joint name="shoulder" type="revolute"><origin xyz="0 0 0.5" rpy="0 1.57079632679 0"/><parent link="base"/>
    <child link="arm"/><axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" velocity="2" effort="10"/>
    <dynamics damping="0.1" friction="0.2"/></joint>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/>
    <axis xyz="0.6 0 0.8"/></joint>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" velocity="1" effort="5"/></joint>
  <joint name="grip2" type="prismatic"><parent link="hand"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.04" velocity="1" effort="5"/>
    <mimic joint="grip" multiplier="1" offset="0"/></joint>
</robot>
"""

TREE = (
    '<robot name="tree">'
    + "".join(f'<link name="l{i}"/>' for i in range(8))
    + "".join(
        f'<joint name="j{i}" type="{kind}"><origin xyz="{i} 0 1e-2"/><parent link="l{i // 2}"/>'
        f'<child link="l{i + 1}"/><axis xyz="0 0 1"/></joint>'
        for i, kind in enumerate(
            ("floating", "planar", "continuous", "fixed", "spherical", "fixed", "continuous")
        )
    )
    + "</robot>"
)

NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e999",
    "-1e49",
    "1e-320",
    "0",
    "-0.0",
    "1e49",
    "",
    " ",
    "1,2",
    "0x10",
    "1 2",
    "٣",
    "--1",
)
NAMES = (
    "revolute",
    "fixed",
    "planar",
    "base",
    "arm",
    "j0",
    "",
    "\u00e9",
    "a" * 3000,
    "&lt;",
    "floating",
    "grip2",
)
WORDS = ("link", "joint", "robot", "origin", "limit", "mimic", "inertial", "mesh", "x:y", "xacro:macro")

ATTRIBUTE = re.compile(r'\s([\w:]+)="([^"]*)"')
TAG = re.compile(r"<(/?)(\w+)")
ELEMENT = re.compile(r"<(link|joint|visual|origin|limit|geometry|inertial|mimic|parent|child)\b[^<>]*/>")


def pick(rng: random.Random, pattern: re.Pattern[str], text: str) -> re.Match[str] | None:
    found = list(pattern.finditer(text))
    return rng.choice(found) if found else None


def replace(text: str, span: tuple[int, int], new: str) -> str:
    return text[: span[0]] + new + text[span[1] :]


def flip_bytes(rng: random.Random, text: str) -> bytes:
    data = bytearray(text.encode())
    for _ in range(rng.choice((1, 1, 2, 8))):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data)


def drop_attribute(rng: random.Random, text: str) -> str:
    found = pick(rng, ATTRIBUTE, text)
    return replace(text, found.span(), "") if found else text


def change_value(rng: random.Random, text: str) -> str:
    found = pick(rng, ATTRIBUTE, text)
    return replace(text, found.span(2), rng.choice(NAMES + NUMBERS)) if found else text


def change_number(rng: random.Random, text: str) -> str:
    found = pick(rng, re.compile(r"-?\d+\.?\d*(e-?\d+)?"), text)
    return replace(text, found.span(), rng.choice(NUMBERS)) if found else text


def swap_tag(rng: random.Random, text: str) -> str:
    found = pick(rng, TAG, text)
    if found is None:
        return text
    if rng.random() < 0.5:  # one side only: broken XML
        return replace(text, found.span(2), rng.choice(WORDS))
    return re.sub(rf"(</?){found[2]}\b", rf"\g<1>{rng.choice(WORDS)}", text)


def truncate(rng: random.Random, text: str) -> str:
    start = rng.randrange(len(text)) if rng.random() < 0.2 else 0
    return text[start : rng.randrange(start, len(text))]


def drop_element(rng: random.Random, text: str) -> str:
    found = pick(rng, ELEMENT, text)
    return replace(text, found.span(), "") if found else text


def repeat_element(rng: random.Random, text: str) -> str:
    found = pick(rng, ELEMENT, text)
    return replace(text, found.span(), found[0] * rng.choice((2, 2, 50))) if found else text


def move_element(rng: random.Random, text: str) -> str:
    found = pick(rng, ELEMENT, text)
    if found is None:
        return text
    rest = replace(text, found.span(), "")
    place = rng.choice([i for i, c in enumerate(rest) if c == "<"])
    return replace(rest, (place, place), found[0])


def repeat_block(rng: random.Random, text: str) -> str:
    found = pick(rng, re.compile(r"<(link|joint)\b.*?</\1>", re.DOTALL), text)
    return replace(text, found.span(), found[0] * 2) if found else text


def nest(rng: random.Random, text: str) -> str:
    tag, depth = rng.choice(WORDS[:8]), rng.choice((3, 60, 300, 5000))
    place = rng.choice([i for i, c in enumerate(text) if c == "<"])
    return replace(text, (place, place), f"<{tag}>" * depth + f"</{tag}>" * depth)


def rewire(rng: random.Random, text: str) -> str:
    links = re.findall(r'<link name="([^"]*)"', text)
    found = pick(rng, re.compile(r'link="([^"]*)"'), text)
    return replace(text, found.span(1), rng.choice(links)) if found and links else text


def declare(rng: random.Random, text: str) -> str:
    body = text[text.index("<robot") :] if "<robot" in text else text
    head = rng.choice(
        (
            '<!DOCTYPE robot [<!ENTITY e "x">]>',
            '<!DOCTYPE robot SYSTEM "file:///etc/passwd">',
            '<!DOCTYPE robot [<!ENTITY % p SYSTEM "http://127.0.0.1:9/x"> %p;]>',
            '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">'
            + "".join(f'<!ENTITY b{i} "{"&a;" * 10 if i == 0 else f"&b{i - 1};" * 10}">' for i in range(9))
            + "]>",
            '<?xml version="1.0" encoding="utf-16"?>',
            '<?xml version="2.0" encoding="none"?>',
            "\ufeff",
            "<?php ?>",
        )
    )
    return head + body.replace('name="base"', 'name="&b8;"', 1) if rng.random() < 0.5 else head + body


MUTATIONS: tuple[Callable[[random.Random, str], str | bytes], ...] = (
    flip_bytes,
    drop_attribute,
    change_value,
    change_number,
    swap_tag,
    truncate,
    drop_element,
    repeat_element,
    move_element,
    repeat_block,
    nest,
    rewire,
    declare,
)


def survive(data: str | bytes) -> bool:
    """Whether it loads; anything but success and our own errors is raised."""
    start = time.thread_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            model_from_urdf(parse_urdf(data, "fuzz.urdf"), resolver=Resolver("/nowhere/fuzz.urdf", (), {}))
        return True
    except UlnaError as error:
        assert str(error).strip()
        return False
    finally:
        assert time.thread_time() - start < SECONDS


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda m: m.__name__)
def test_one_damage(mutation):
    rng = random.Random(mutation.__name__)
    outcomes = [survive(mutation(rng, rng.choice((SMALL, TREE)))) for _ in range(250)]
    assert not all(outcomes)


def test_several_damages():
    rng = random.Random(7)
    loaded = 0
    for _ in range(1000):
        text: str | bytes = rng.choice((SMALL, TREE))
        for mutation in rng.sample(MUTATIONS[1:], rng.choice((1, 2, 2, 3))):
            text = mutation(rng, text if isinstance(text, str) else text.decode("utf-8", "replace"))
            text = text or " "
            if len(text) < 20:
                break
        loaded += survive(text)
    assert loaded > 50


def test_the_texts_themselves_load():
    assert survive(SMALL)
    assert survive(TREE)


def test_random_bytes():
    rng = random.Random(3)
    assert not any(survive(rng.randbytes(rng.randrange(200))) for _ in range(300))
