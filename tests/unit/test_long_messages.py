"""However long what was given is, messages stay short and keep what says how to go on."""

from __future__ import annotations

import warnings

import pytest

import ulna
from ulna.errors import (
    LONGEST_MESSAGE,
    FormatError,
    InputError,
    ModelWarning,
    UlnaWarning,
    UnknownName,
    excerpt,
    nearest,
)
from ulna.formats.ets import ETS

LONG = "n" * 100_000


def test_excerpts_keep_both_ends_and_count() -> None:
    assert excerpt("short") == "short"
    cut = excerpt("a" * 500 + "z" * 500, 60)
    assert len(cut) <= 60 and cut.startswith("aaa") and cut.endswith("zzz") and "1000 characters" in cut


def test_nothing_is_offered_twice() -> None:
    assert nearest("pinochio", ["pinocchio", "pinocchio"]) == ["pinocchio"]
    error = UnknownName("viewer", "pinochio", ["pinocchio", "pinocchio", "pinocchio"])
    assert str(error).endswith("Did you mean 'pinocchio'?") and error.nearest == "pinocchio"
    assert str(UnknownName("x", "?", ["a", "a", "b"])).endswith("There are: 'a', 'b'.")


def test_names_that_differ_in_case_alone_are_both_offered() -> None:
    assert nearest("tool", ["Tool", "TOOL", "tool"]) == ["Tool", "TOOL", "tool"]


@pytest.mark.parametrize(
    "text",
    [
        f'<robot name="r"><link name="{LONG}"/><link name="{LONG}"/></robot>',
        f'<robot name="r"><link name="a"><visual><geometry><{LONG}/></geometry></visual></link></robot>',
        f'<robot name="r"><link name="a"/><joint name="j" type="{LONG}"/></robot>',
        f'<robot name="r"><link name="a"/><joint name="j" type="fixed"><parent link="{LONG}"/></joint></robot>',
        f'<robot name="r"><link name="a"><inertial><mass value="nan({LONG}"/></inertial></link></robot>',
        f"<{LONG}/>",
        f'<robot name="r"><xacro:{LONG}/></robot>',
        f'<!DOCTYPE r [<!ENTITY {LONG} "b">]><robot name="r"/>',
    ],
)
def test_messages_about_files_stay_short(text: str) -> None:
    with pytest.raises(FormatError) as refused:
        ulna.load(text)
    assert len(str(refused.value)) <= LONGEST_MESSAGE


def test_messages_about_arguments_stay_short() -> None:
    robot = ulna.load("ur5", visuals="simple")
    for call in (
        lambda: robot.fk(robot.neutral, LONG),
        lambda: ulna.load(LONG),
        lambda: ulna.load("panda", visuals=LONG),
        lambda: ETS.parse(f"Rz({LONG})"),
        lambda: ETS.parse(LONG),
        lambda: robot.fk(LONG),
    ):
        with pytest.raises((InputError, UnknownName, TypeError)) as refused:
            call()
        assert len(str(refused.value)) <= LONGEST_MESSAGE


def test_warnings_stay_short() -> None:
    text = f'<robot name="r"><link name="a"><visual><geometry><mesh filename="{LONG}"/></geometry></visual></link></robot>'
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ulna.load(text)
    assert caught and issubclass(caught[0].category, ModelWarning)
    assert all(len(str(w.message)) <= LONGEST_MESSAGE for w in caught)
    assert len(str(UlnaWarning(LONG))) <= LONGEST_MESSAGE
