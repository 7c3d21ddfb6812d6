"""The table of a model shows what moves how, between which limits, and what it weighs."""

from __future__ import annotations

from support.small_robots import arm
from ulna.model import FreeFlyer, ModelBuilder, with_root_joint, with_tool

ARM = """\
arm: 5 joints (RPRPP), 1 mimic joint, nq 4, nv 4, 7 links, 8.7 kg, tool @tcp
┌───┬───────┬─────────────────────────────┬─────────┬────────┬───────────────────────────────┬─────────────────┬─────────┐
│ # │ joint │ motion                      │ parent  │ link   │ limits                        │ speed, effort   │ mass kg │
├───┼───────┼─────────────────────────────┼─────────┼────────┼───────────────────────────────┼─────────────────┼─────────┤
│   │       │                             │ (world) │ base   │                               │                 │       2 │
│ 0 │ j0    │ revolute z                  │ base    │ link0  │ -1 .. 2 rad (-57.3 .. 114.6°) │ 3 rad/s, 20 N m │       1 │
│ 1 │ j1    │ prismatic (0.707, 0.707, 0) │ link0   │ link1  │ ±0.5 m                        │                 │       2 │
│ 2 │ j2    │ revolute y                  │ link1   │ link2  │ none                          │                 │       3 │
│   │ wrist │ fixed                       │ link2   │ hand   │                               │                 │     0.5 │
│ 3 │ grip  │ prismatic y                 │ hand    │ left   │ 0 .. 0.04 m                   │                 │     0.1 │
│ 4 │ grip2 │ prismatic y                 │ hand    │ right  │ = -grip + 0.01                │                 │     0.1 │
│   │       │ tool frame                  │ hand    │ @tcp   │                               │                 │         │
│   │       │ user frame                  │ link1   │ camera │                               │                 │         │
└───┴───────┴─────────────────────────────┴─────────┴────────┴───────────────────────────────┴─────────────────┴─────────┘
┌───────────────┬────────┬──────┐
│ configuration │   home │ zero │
├───────────────┼────────┼──────┤
│ j0            │  57.3° │   0° │
│ j1            │    0 m │  0 m │
│ j2            │ -28.6° │   0° │
│ grip          │ 0.02 m │  0 m │
└───────────────┴────────┴──────┘"""


def test_the_table_of_the_arm() -> None:
    assert arm().table() == ARM
    assert str(arm()) == ARM


def test_the_tool_is_marked_wherever_it_is() -> None:
    assert "│ @hand" in with_tool(arm(), "hand").table()
    assert "│ @j2 " in with_tool(arm(), "j2").table()
    assert arm().table().count("@") == 2


def test_a_flying_robot() -> None:
    text = with_root_joint(arm(), FreeFlyer(), lower=[-1, -1, 0, *[-float("inf")] * 4]).table()
    assert "free flyer" in text
    assert "x -1 .. inf m; y -1 .. inf m; z 0 .. inf m" in text
    assert "│ root_joint    │ 0 m 0 m 0 m 0 0 0 1 │" in text


def test_a_rock() -> None:
    assert ModelBuilder("rock").add_link("rock").build().table() == (
        "rock: 0 joints, nq 0, nv 0, 1 link, 0 kg, tool @rock\n"
        "┌─────────┬───────┐\n"
        "│ parent  │ link  │\n"
        "├─────────┼───────┤\n"
        "│ (world) │ @rock │\n"
        "└─────────┴───────┘"
    )
