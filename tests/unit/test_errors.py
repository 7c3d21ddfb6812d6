"""What the messages of the exception tree say."""

from __future__ import annotations

import pytest

from ulna.errors import InputError, NonFiniteError, UnknownName


@pytest.mark.parametrize(
    ("index", "said"), [((), "`t` is nan;"), ((2,), "`t[2]` is nan;"), ((4, 1), "`t[4, 1]` is nan;")]
)
def test_where_a_number_is_not_finite(index: tuple[int, ...], said: str) -> None:
    assert str(NonFiniteError("t", index, float("nan"))).startswith(said)


@pytest.mark.parametrize(
    ("given", "nearest"),
    [
        ("panda_hnad", "panda_hand"),
        ("PANDA_HAND", "panda_hand"),
        ("Panda_Link0", "panda_link0"),
        ("RightHand", "right_hand"),
        ("base", "Base"),
    ],
)
def test_the_nearest_name_is_found_whatever_its_case(given: str, nearest: str) -> None:
    error = UnknownName("frame", given, ["panda_hand", "panda_link0", "right_hand", "Base"])
    assert error.nearest == nearest
    assert f"Did you mean {nearest!r}" in str(error)


def test_a_name_like_no_other_is_shown_what_there_is() -> None:
    error = UnknownName("reference", "xyz", ["world", "local"])
    assert error.nearest is None
    assert str(error) == "No reference named 'xyz'. There are: 'world', 'local'."


def test_errors_of_first_calls_come_without_the_error_of_a_cache() -> None:
    """They began with "KeyError ... During handling of the above exception, another exception occurred"."""
    import traceback

    import ulna

    robot = ulna.load("panda")
    q = robot.configurations["ready"]
    calls = [
        lambda: robot.fk(q, "panda_hnd"),
        lambda: robot.jacobian(q, "panda_hnd"),
        lambda: robot.jacobian(q, reference="locl"),
        lambda: robot.ik(robot.fk(q), q, "panda_hnd"),
        lambda: robot.ik(robot.fk(q), q, attempts=-1),
        lambda: robot.ik(robot.fk(q), q, seed="x"),
    ]
    for call in calls:
        with pytest.raises((InputError, UnknownName)) as caught:
            call()
        text = "".join(traceback.format_exception(caught.value))
        assert "KeyError" not in text and "During handling" not in text
