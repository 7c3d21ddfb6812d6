"""Pictures of a moving robot, whose background is drawn once, are those of figures that are drawn anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("spatialmath")
matplotlib = pytest.importorskip("matplotlib")

from support.compat_packages import using  # noqa: E402


def _drawn_anew(env: Any) -> Any:
    env.fig.canvas.draw()
    return np.asarray(env.fig.canvas.buffer_rgba())[..., :3]


def test_pictures_are_those_of_a_full_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib.use("agg")
    with matplotlib.rc_context(), using("roboticstoolbox"):
        matplotlib.rcdefaults()  # other tests leave styles, under which grid lines lie above the robot
        matplotlib.use("agg")
        import roboticstoolbox as rtb
        from roboticstoolbox.backends.PyPlot import PyPlot

        robot = rtb.models.DH.Planar3()
        env = PyPlot()
        env.launch(limits=[-3, 3])
        shown = []
        for k, q in enumerate(([0.1, 0.2, 0.3], [0.5, -0.4, 0.9])):
            env.show(robot, np.array(q), f"t = {k}")
            shown.append(env.picture())
            assert (shown[-1] == _drawn_anew(env)).all()
        assert (shown[0] != shown[1]).any()
        with monkeypatch.context() as context:  # from here on the background is that of the first picture
            context.setattr(env.fig.canvas, "draw", lambda: pytest.fail("the background was drawn again"))
            env.show(robot, np.array([0.2, 0.1, 0.4]), "t = 2")
            shown.append(env.picture())
        assert (shown[-1] == _drawn_anew(env)).all()
        env.ax.set_title("beside", loc="left")
        assert (env.picture() == _drawn_anew(env)).all() and (env.picture() != shown[-1]).any()
        env.ax.view_init(90, -90)
        assert (env.picture() == _drawn_anew(env)).all()
        env.close()
