"""Colours as people write them."""

import numpy as np
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
        ([0.1, 1.0, 0.0, 0.5], (0.1, 1.0, 0.0, 0.5)),
        ((1.0 + 1e-9, -1e-9, 0.5), (1.0, 0.0, 0.5, 1.0)),
        ((255, 128, 0), (1.0, 128 / 255, 0.0, 1.0)),
        ((255, 0, 0, 51), (1.0, 0.0, 0.0, 0.2)),
        ((1, 0, 0), (1.0, 0.0, 0.0, 1.0)),
        (np.array([1, 0, 0], dtype=np.uint8), (1 / 255, 0.0, 0.0, 1.0)),
        ("#f08", (1.0, 0.0, 0x88 / 255, 1.0)),
        ("k", (0.0, 0.0, 0.0, 1.0)),
        ("C1", (1.0, 0x7F / 255, 0x0E / 255, 1.0)),
        ("tab:blue", (0x1F / 255, 0x77 / 255, 0xB4 / 255, 1.0)),
    ],
)
def test_a_colour_is_what_is_written(written, rgba):
    assert colour(written) == pytest.approx(rgba)


def test_all_names_of_css_are_known():
    assert len(NAMES) == 148
    assert all(len(colour(name)) == 4 for name in NAMES)


def test_an_invalid_colour_is_refused():
    with pytest.raises(UnknownName, match="tomato"):
        colour("tomatoe")
    for wrong in ((255.0, 128.0, 0.0), (300, 0, 0), (-0.1, 0, 0), (0.5, 2, 0)):
        with pytest.raises(InputError, match="from 0 to 1. Numbers from 0 to 255 are divided by 255"):
            colour(wrong)
    for wrong in ("#12345", "#zzzzzz", "", "#ff00804"):
        with pytest.raises(UnknownName):
            colour(wrong)
    for wrong in ((1, 2), (1, 2, 3, 4, 5), (float("nan"), 0, 0), 3, None, ("a", "b", "c")):
        with pytest.raises(InputError, match="A colour is"):
            colour(wrong)
