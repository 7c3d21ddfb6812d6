"""Old import paths and names of the viewer still work."""

import importlib
import importlib.util

import pytest

from ulna.viewer import renamed

OLD_NAMES = """
AROUND Assigned Boxes Client Cloud Companions Crowd Dial Drawing Figure File Followed Follower Ghosts
GhostsHandle HEAVY INKS INSET KEY KNOWN Kept LAMP LOOKS Labelled Menu Motion Moved Named PACE PLAIN Path Paths
Pendant Places Recorded SHOWINGS Showing Shown Stage Studio Trail UNSEEN Valued View Waiting Words allowed
answer build check_even check_film checked_height checked_page checked_picture checked_showing choices coarse
colours cookie decorate dials digits display dress_rows entry frame frames gather gif_times hold is_clear joined
known knows lay_floor link_looks look_from look_of moments of_inertias of_jacobian paint png read shades smooth
srgb standing through tour unit unpacked weld words_glb write write_film write_words written
"""


@pytest.mark.parametrize("old", sorted(renamed.MODULES))
def test_old_modules_have_the_public_names_of_the_new_ones(old):
    module = importlib.import_module(f"ulna.viewer.{old}")
    for new in renamed.MODULES[old]:
        place = importlib.import_module(f"ulna.viewer.{new}")
        for name, value in vars(place).items():
            if getattr(value, "__module__", None) == place.__name__:
                assert getattr(module, name) is value


def test_old_names_are_the_new_classes():
    for old, name in (("handles", "Cloud"), ("figure", "Figure"), ("tour", "tour"), ("pendant", "Pendant")):
        module = importlib.import_module(f"ulna.viewer.{old}")
        assert getattr(module, name).__name__ == renamed.NAMES[name]
    held = dict.fromkeys(OLD_NAMES.split(), False)
    assert held.keys() == renamed.NAMES.keys()
    for old, news in renamed.MODULES.items():
        module = importlib.import_module(f"ulna.viewer.{old}")
        for place in (vars(importlib.import_module(f"ulna.viewer.{new}")) for new in news):
            for name, new_name in renamed.NAMES.items():
                if new_name in place:
                    held[name] |= getattr(module, name) is place[new_name]
    assert all(held.values()), held


def test_what_was_never_there_is_not_there_now():
    with pytest.raises(ImportError):
        importlib.import_module("ulna.viewer.telescope")
    with pytest.raises(AttributeError, match="telescope"):
        _ = importlib.import_module("ulna.viewer.camera").telescope


def test_old_methods_are_the_new_ones():
    from ulna.sim import Body, Simulation
    from ulna.viewer import RobotHandle, Scene, Viewer
    from ulna.viewer.panel.teach_panel import TeachPanel
    from ulna.viewer.show import Show

    pairs = {
        Scene: {"together": "atomic", "later": "defer", "look": "appearance", "set_look": "set_appearance"},
        Viewer: {"pendant": "teach_panel"},
        Show: {"aim": "set_target"},
        TeachPanel: {"aim": "set_target", "glide_to": "move_to"},
        RobotHandle: {"put": "set_checked_q"},
        Body: {"put": "set_checked_q"},
    }
    for cls, names in pairs.items():
        for old, new in names.items():
            assert getattr(cls, old) is getattr(cls, new)
    simulation = Simulation()
    simulation.patience = bool
    assert simulation.can_resume is bool is simulation.patience


def test_every_old_module_leads_to_modules_that_exist():
    for old, news in renamed.MODULES.items():
        for new in news:
            assert importlib.util.find_spec(f"ulna.viewer.{new}") is not None, (old, new)
