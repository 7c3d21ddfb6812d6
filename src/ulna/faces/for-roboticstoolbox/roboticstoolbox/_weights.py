"""What the links of a robot weigh: tables, payloads, and robots with less friction or other masses."""

from __future__ import annotations

from typing import Any, Self

import numpy as np

from roboticstoolbox._part import Part
from roboticstoolbox._table import grid
from ulna.spatial import Inertia


class Weights(Part):
    """Masses, motors and friction."""

    def payload(self, m: float, p: Any = None) -> None:
        """Adds a point mass `m` [kg] at `p` in the last link's frame [m]."""
        last = self._links[-1]
        body = last._inertia()
        more = Inertia.from_point(float(m), np.zeros(3) if p is None else np.asarray(p, dtype=float))
        whole = more if body is None else body + more
        last.m, last.r, last.I = float(whole.mass), whole.com, whole.inertia

    def nofriction(self, coulomb: bool = True, viscous: bool = False) -> Self:
        """A copy without Coulomb friction, without viscous friction."""
        out = self.copy()
        for link in out._links:
            if coulomb:
                link.Tc = [0.0, 0.0]
            if viscous:
                link.B = 0.0
        return out

    def perturb(self, p: float = 0.1) -> Self:
        """A copy with masses and inertias off at random by up to the fraction `p`."""
        out = self.copy()
        out.name = f"P/{self.name}"
        draw = np.random.default_rng()
        for link in out._links:
            link.m = link.m * (1.0 + draw.uniform(-p, p))
            link.I = link.I * (1.0 + draw.uniform(-p, p))
        return out

    def dynamics(self) -> None:
        """Prints what the links weigh, as a table."""

        def listed(x: Any) -> str:
            return ",  ".join(f"{v:.3g}" for v in x)

        rows = []
        for link in self._links:
            if link.isjoint:
                I = link.I
                six = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[1, 2], I[0, 2])
                numbers = [listed(link.r), listed(six), f"{link.Jm:.3g}", f"{link.B:.3g}", listed(link.Tc)]
                rows.append([link.name, f"{link.m:.3g}", *numbers, f"{link.G:.3g}"])
        print(grid(["j", "m", "r", "I", "Jm", "B", "Tc", "G"], rows, [False] * 8))

    def dynamics_list(self) -> None:
        """Prints what each link weighs."""
        for i, link in enumerate(self._links):
            print(f"\nLink {i}:: {link}")
            print(link.dyn())

    def jointdynamics(self, q: Any, qd: Any = None) -> list[tuple[tuple[float], tuple[float, float]]]:
        """The transfer function of each motor, 1 / (J s + B): numerator and denominator, as seen by the motor."""
        M = np.diagonal(self.inertia(q))
        return [((1,), (float(m / link.G**2), link.B)) for m, link in zip(M, self._joints(), strict=True)]
