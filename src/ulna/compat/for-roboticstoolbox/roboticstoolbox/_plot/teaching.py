"""A slider for each joint: beside the stick figure in matplotlib, or in the panel of the viewer."""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._common.numbers import vector
from roboticstoolbox._common.poses import to_spatial
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from roboticstoolbox._plot.figure import PyPlot, PyPlot2, pyplot
from ulna.spatial import matrix_to_rpy
from ulna.typing import Floats


class Teaching(RobotMixin):
    """Robots that are moved by hand."""

    def teach(
        self,
        q: Any = None,
        block: bool = True,
        limits: Any = None,
        vellipse: bool = False,
        fellipse: bool = False,
        backend: str | None = None,
        view: str | None = None,
    ) -> Any:
        """Shows the robot with a slider for each joint; `robot.q` follows them.

        Args:
            q: Where they start, (n,), a row or a column; `robot.q` when not given.
            block: Whether to wait until the window or the page is closed; never where there is none.
            limits: Of the picture in matplotlib, x, y, z from and to [m].
            vellipse: Whether to draw the ellipsoid of velocities, in matplotlib.
            fellipse: Whether to draw the ellipsoid of forces, in matplotlib.
            backend: "pyplot" or "swift"; None for what `plot` takes.
            view: "xy", "xz" or "yz" to look at that plane, in matplotlib.

        Returns:
            The figure or environment; `sliders` are the sliders.

        Raises:
            WrongShape: `q` has another shape.
        """
        at = self.q.copy() if q is None else vector("q", q, self.n)
        self.q = at
        if self._backend_for(backend) == "swift":
            return self._teach_in_viewer(at, block)
        kinds = [kind for kind, wanted in (("velocity", vellipse), ("force", fellipse)) if wanted]
        return self._teach_in_figure(at, block, limits, kinds, view)

    def _teach_in_figure(
        self, at: Floats, block: bool, limits: Any, kinds: list[str], view: str | None
    ) -> PyPlot:
        plt = pyplot()
        from matplotlib.widgets import Slider

        figure = plt.figure(f"teach {self.name}", figsize=(8.0, 5.0))
        kind = PyPlot if self._size == 4 else PyPlot2
        env = kind(figure.add_axes((0.35, 0.02, 0.63, 0.94), projection="3d"), limits)
        env.launch(view=view)

        env.heading, self._figure = self._end_pose_text(at), env
        drawing = env.add(self, readonly=True, q=at)
        drawing.ellipsoids = tuple(kinds)

        def draw() -> None:
            drawing.q, env.heading = at, self._end_pose_text(at)
            env.redraw()

        draw()
        low, high = self.qlim
        sliders = []
        for j in range(self.n):
            place = figure.add_axes((0.06, 0.92 - 0.8 * j / max(self.n, 1), 0.22, 0.03))
            slider = Slider(place, f"q{j}", low[j], high[j], valinit=at[j])

            def moved(value: float, j: int = j) -> None:
                at[j] = value
                self.q = at
                draw()

            slider.on_changed(moved)
            sliders.append(slider)
        env.sliders = sliders  # type: ignore[attr-defined]
        if block:
            env.hold()
        return env

    def _teach_in_viewer(self, at: Floats, block: bool) -> Any:
        import swift

        env = self._launched_environment(realtime=True)
        env.add(self, readonly=True)
        label = swift.Label(self._end_pose_text(at))
        env.add(label)
        low, high = self.todegrees(self.qlim[0]), self.todegrees(self.qlim[1])
        shown = self.todegrees(at)
        sliders = []
        for j, turns in enumerate(self.revolutejoints):

            def moved(value: float, j: int = j, turns: bool = turns) -> None:
                q = self.q.copy()
                q[j] = np.radians(value) if turns else value
                self.q = q
                label.label = self._end_pose_text(q)

            step, unit = (1.0, "°") if turns else (float(high[j] - low[j]) / 100.0, "m")
            value = float(np.clip(shown[j], low[j], high[j]))
            slider = swift.Slider(moved, float(low[j]), float(high[j]), step, value, f"q{j}", unit)
            env.add(slider, name=f"q{j}")
            sliders.append(slider)
        env.sliders = sliders
        env.step(0.0)
        if block:
            env.run()
        return env

    def _end_pose_text(self, q: Floats) -> str:
        """The pose of the end as text."""
        T = to_spatial(self.fkine(q).A)
        place = ", ".join(f"{x:.3f}" for x in T[:3, 3])
        angles = ", ".join(f"{x:.1f}°" for x in np.degrees(matrix_to_rpy(T[:3, :3])))
        return f"{self.name}: {place} m; {angles}"
