"""Dynamic parameters of a robot: tables, payloads, and copies with less friction or other masses."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from roboticstoolbox._common.numbers import vector
from roboticstoolbox._common.text_table import grid
from roboticstoolbox._mixins.robot_mixin import RobotMixin
from ulna.spatial import Inertia


class MassParameters(RobotMixin):
    """Masses, motors and friction."""

    def payload(self, m: float, p: Any = None) -> None:
        """Attaches a point mass to the last link; it replaces an earlier one.

        Args:
            m: The mass [kg]; 0 removes it.
            p: Its position in the link's frame, (3,) [m]; the origin by default.
        """
        ends = self.ee_links
        last = ends[0] if len(ends) == 1 else self._links[self.n - 1]
        before = last.__dict__.setdefault("_empty", (last.m, last.r, last.I))
        last.m, last.r, last.I = before
        if m:
            body = last._inertia()
            more = Inertia.from_point(float(m), np.zeros(3) if p is None else np.asarray(p, dtype=float))
            combined = more if body is None else body + more
            last.m, last.r, last.I = float(combined.mass), combined.com, combined.inertia

    def nofriction(self, coulomb: bool = True, viscous: bool = False) -> Self:
        """A copy of the robot without friction.

        Args:
            coulomb: Whether to leave out Coulomb friction.
            viscous: Whether to leave out viscous friction.

        Returns:
            The copy.
        """
        out = self.copy()
        out.name = f"NF/{self.name}"
        for link in out._links:
            link._remove_friction(coulomb, viscous)
        return out

    def perturb(self, p: float = 0.1) -> Self:
        """A copy with masses and inertias changed at random by up to the fraction `p`."""
        out = self.copy()
        out.name = f"P/{self.name}"
        draw = np.random.default_rng()
        for link in out._links:
            link.m = link.m * (1.0 + draw.uniform(-p, p))
            link.I = link.I * (1.0 + draw.uniform(-p, p))
        return out

    def dynamics(self) -> None:
        """Prints the dynamic parameters of the links as a table."""
        rows = [[link.name, *link._table_cells()] for link in self._links]
        print(grid(["j", "m", "r", "I", "Jm", "B", "Tc", "G"], rows, [True] + [False] * 7))

    def dynamics_list(self) -> None:
        """Prints the dynamic parameters of each link."""
        for i, link in enumerate(self._links):
            print(f"\nLink {i}:: {link}")
            print(link.dyn(indent=2))

    def jointdynamics(self, q: Any, qd: Any = None) -> list[tuple[tuple[float], tuple[float, float]]]:
        """The transfer function of each motor, 1 / (J s + B): numerator and denominator, as seen by the motor.

        Args:
            q: Configuration, (n,) [rad or m].
            qd: Velocity at which Coulomb friction counts, as Tc / qd of B, (n,); without it does not.

        Returns:
            For each motor a numerator (1,) and a denominator (2,) in s.
        """
        at = vector("q", q, self.n)
        rates = np.zeros(self.n) if qd is None else vector("qd", qd, self.n)
        out = []
        for m, rate, link in zip(np.diagonal(self.inertia(at)), rates, self._joints(), strict=True):
            dry = link.Tc[0] / rate if rate > 0.0 else link.Tc[1] / rate if rate < 0.0 else 0.0
            out.append(((1,), (float(m / link.G**2), float(link.B + dry))))
        return out
