"""Arguments and attributes of the viewer by their former names."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from ulna.viewer import Viewer
from ulna.viewer.graph.content import Text
from ulna.viewer.graph.theme import DARK, Theme


def test_themes_take_and_have_former_names() -> None:
    theme = Theme(dark=True, ink=(1, 2, 3), lamps=0.5, room=0.25)  # pyright: ignore[reportCallIssue]
    assert theme == Theme(dark=True, text=(1, 2, 3), light_factor=0.5, environment_intensity=0.25)
    assert (theme.ink, theme.lamps, theme.room) == ((1, 2, 3), 0.5, 0.25)  # pyright: ignore[reportAttributeAccessIssue]
    assert pickle.loads(pickle.dumps(DARK)) == DARK


def test_text_takes_and_has_its_former_name() -> None:
    assert Text(words="a") == Text("a") and Text("a").words == "a"  # pyright: ignore
    with Viewer(page=False) as viewer:
        label = viewer.text(words="a", position=np.zeros(3))
    assert label.text == "a"


def test_a_former_and_a_present_name_together_raise() -> None:
    with pytest.raises(TypeError, match="`ink` is the former name of `text`"):
        Theme(ink=(1, 2, 3), text=(1, 2, 3))  # pyright: ignore[reportCallIssue]
