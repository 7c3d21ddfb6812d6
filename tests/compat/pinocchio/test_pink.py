"""pink, which stands on Pinocchio, takes the same way on Ulna's package."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.two_pythons import both
from ulna.robots.example_robot_data import files


@pytest.mark.parametrize(
    ("robot", "root", "frame"),
    [
        ("ur5", "", "tool0"),
        pytest.param("panda", "", "panda_hand", marks=pytest.mark.slow),
        pytest.param("talos", "free", "gripper_left_joint", marks=pytest.mark.slow),
    ],
)
def test_pink_takes_the_same_way(robot: str, root: str, frame: str, tmp_path: Path) -> None:
    pytest.importorskip("pink")
    script = Path(__file__).parent / "pink_path.py"
    own, wanted = (np.array(p) for p in both(script, tmp_path, str(files(robot)[0]), root, frame))
    assert np.abs(wanted[-1] - wanted[0]).max() > 0.05
    np.testing.assert_allclose(own, wanted, rtol=0, atol=1e-9)
