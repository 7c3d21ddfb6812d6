"""The planar arm of two links, by numbers or by symbols, in either convention of Denavit and Hartenberg.

Source: Spong & Vidyasagar 1989, Robot Dynamics and Control, figure 3-6.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from roboticstoolbox._robots.dh_links import RevoluteDH, RevoluteMDH
from roboticstoolbox._robots.dh_robot import DHRobot

_RADIUS = 0.1  # of a link, a cylinder along x [m]


class TwoLink(DHRobot):
    """A planar arm of two links in a vertical plane."""

    def __init__(self, symbolic: bool = False, mdh: bool = False, inertia: Any = False) -> None:
        """An arm.

        Args:
            symbolic: Whether lengths a1, a2, masses m1, m2, centres of mass c1, c2 and gravity g are SymPy symbols.
            mdh: Whether parameters are modified ones, else standard ones.
            inertia: Whether links are cylinders (of radius r where symbolic), else point masses.
        """
        lengths, masses, centres, radius, g = _symbols() if symbolic else _numbers(mdh)
        rows = [
            {"m": m, "r": [c, 0, 0], "I": _cylinder(m, radius, a) if inertia else None}
            for m, c, a in zip(masses, centres, lengths, strict=True)
        ]
        zero, pi = _zero_and_pi(symbolic)
        if mdh:
            tool = np.eye(4, dtype=object if symbolic else float)
            tool[0, 3] = lengths[1]
            links: list[Any] = [
                RevoluteMDH(a=a, alpha=zero, **row) for a, row in zip((0, lengths[0]), rows, strict=True)
            ]
        else:
            tool = None
            links = [RevoluteDH(a=a, alpha=zero, **row) for a, row in zip(lengths, rows, strict=True)]
        super().__init__(links, symbolic=symbolic, name="2 link", tool=tool, keywords=("planar", "dynamics"))
        half, sixth = pi / 2, pi / 6
        named = {
            "qr": [sixth, -sixth],
            "qz": [0, 0],
            "q1": [0, half],
            "q2": [half, -half],
            "qn": [sixth, -sixth],
        }
        for name, q in named.items():
            self.addconfiguration_attr(name, q)
        self.base = np.array(
            [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
        )  # a quarter turn about x
        self.gravity = [0, 0, g]


def _zero_and_pi(symbolic: bool) -> tuple[Any, Any]:
    if not symbolic:
        return 0.0, np.pi
    import sympy

    return sympy.Integer(0), sympy.pi


def _numbers(mdh: bool) -> tuple[Any, ...]:
    centre = 0.5 if mdh else -0.5
    return (1, 1), (1, 1), (centre, centre), _RADIUS, 9.8


def _symbols() -> tuple[Any, ...]:
    import sympy

    names = ("a1 a2", "m1 m2", "c1 c2", "r", "g")
    return tuple(sympy.symbols(name, real=True) for name in names)


def _cylinder(m: Any, r: Any, a: Any) -> Any:
    across = (1 / 12) * m * (3 * r**2 + a**2)
    return [0.5 * m * r**2, across, across]
