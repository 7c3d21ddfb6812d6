"""Robots as text: the tables that the toolbox prints."""

from __future__ import annotations

import numpy as np

from roboticstoolbox._common.text_table import bordered, grid
from roboticstoolbox._mixins.robot_mixin import RobotMixin


class RobotText(RobotMixin):
    """The text of a robot."""

    def _kind_name(self) -> str:
        kind = type(self)
        module, _, part = kind.__module__.partition(".")
        is_general = module == "roboticstoolbox" and not part.startswith(
            "models"
        )  # not of a model or a script
        if is_general or kind.__name__ == "URDFRobot":
            return kind.__name__
        return f"{kind.__mro__[1].__name__}.{kind.__name__}"

    def _headline(self) -> str:
        maker = f" (by {self.manufacturer})" if self.manufacturer else ""
        parts = [f"{self._kind_name()}: {self.name}{maker}", f"{self.n} joints ({self.structure})"]
        if self._grippers:
            count = len(self._grippers)
            parts.append(f"{count} gripper{'s' if count > 1 else ''}")
        if self.nbranches > 1:
            parts.append(f"{self.nbranches} branches")
        parts += [
            word
            for word, there in (
                ("dynamics", self.hasdynamics),
                ("geometry", self.hasgeometry),
                ("collision", self.hascollision),
            )
            if there
        ]
        return ", ".join(parts)

    def __str__(self) -> str:
        ends = {id(link) for link in self.ee_links}
        rows = []
        for i, link in enumerate(self._links):
            mark = "@" if id(link) in ends else ""
            joint = "" if link.jindex is None else str(link.jindex)
            rows.append(
                [str(i), mark + link.name, joint, link.parent_name or "BASE", link.ets.__str__("q{0}")]
            )
        header = ["link", "link", "joint", "parent", "ETS: parent to link"]
        right = [True, False, True, False, False]
        return f"{self._headline()}\n{grid(header, rows, right)}{self.configurations_str()}"

    def __repr__(self) -> str:
        return str(self)

    def configurations_str(self, border: str = "thin") -> str:
        """The named configurations as a table."""
        if not self._configs:
            return ""
        turns = self.revolutejoints
        rows = [
            [
                name,
                *(
                    f"{np.degrees(x): .3g}°" if turn else f"{x: .3g}"
                    for x, turn in zip(q, turns, strict=True)
                ),
            ]
            for name, q in self._configs.items()
        ]
        header = ["name", *(f"q{j}" for j in range(self.n))]
        columns = [True] + [False] * self.n
        return "\n" + bordered(grid(header, rows, columns, ragged=True), border)
