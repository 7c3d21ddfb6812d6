"""Colours as people write them."""

import pytest

from ulna.errors import InputError, UnknownName
from ulna.viewer.colours import NAMES, colour


@pytest.mark.parametrize(
    ("written", "rgba"),
    [
        ("tomato", (1.0, 0x63 / 255, 0x47 / 255, 1.0)),
        ("Steel Blue", (0x46 / 255, 0x82 / 255, 0xB4 / 255, 1.0)),
        ("#ff0080", (1.0, 0.0, 128 / 255, 1.0)),
        ("#ff008040", (1.0, 0.0, 128 / 255, 64 / 255)),
        ((0.1, 0.2, 0.3), (0.1, 0.2, 0.3, 1.0)),
        ([0.1, 2.0, -1.0, 0.5], (0.1, 1.0, 0.0, 0.5)),
    ],
)
def test_a_colour_is_what_is_written(written, rgba):
    assert colour(written) == pytest.approx(rgba)


def test_all_names_of_css_are_known():
    assert len(NAMES) == 148
    assert all(len(colour(name)) == 4 for name in NAMES)


def test_what_is_no_colour_is_refused():
    with pytest.raises(UnknownName, match="tomato"):
        colour("tomatoe")
    for wrong in ("#12345", "#zzzzzz", "", "#ff00804"):
        with pytest.raises(UnknownName):
            colour(wrong)
    for wrong in ((1, 2), (1, 2, 3, 4, 5), (float("nan"), 0, 0), 3, None, ("a", "b", "c")):
        with pytest.raises(InputError, match="A colour is"):
            colour(wrong)
