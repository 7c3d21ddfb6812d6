"""Links by Denavit and Hartenberg's parameters.

Standard: Rz(theta) tz(d) tx(a) Rx(alpha). Modified: tx(a) Rx(alpha) tz(d) Rz(theta), a and alpha of the link before.
"""

from __future__ import annotations

from typing import Any

from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link


class DHLink(Link):
    """A link of four numbers, one of which is a joint's."""

    def __init__(
        self,
        d: float = 0.0,
        alpha: float = 0.0,
        theta: float = 0.0,
        a: float = 0.0,
        sigma: int = 0,
        mdh: bool = False,
        offset: float = 0.0,
        flip: bool = False,
        qlim: Any = None,
        **more: Any,
    ) -> None:
        """`sigma` is 0 for a joint that turns (theta), 1 for one that slides (d); `more` are arguments of `Link`."""
        self.d, self.alpha, self.theta, self.a = d, alpha, theta, a
        self.sigma, self.mdh, self.offset = sigma, bool(mdh), offset
        joint = ET("tz" if sigma else "Rz", flip=flip, qlim=qlim)
        turned = [ET.Rz(theta)] if sigma and theta else [ET.Rz(offset)] if not sigma and offset else []
        lifted = [ET.tz(d)] if not sigma and d else [ET.tz(offset)] if sigma and offset else []
        beside = ([ET.tx(a)] if a else []) + ([ET.Rx(alpha)] if alpha else [])
        if mdh:
            steps = [*beside, *turned, *lifted, joint]
        else:
            steps = [*turned, *([*lifted, joint] if sigma else [joint, *lifted]), *beside]
        super().__init__(ETS(steps), **more)

    def _joint_text(self) -> tuple[str, str]:
        shift = f" + {self.offset}" if self.offset else ""
        if self.sigma:
            return f"{self.theta}", f"q{shift}"
        return f"q{shift}", f"{self.d}"

    def __str__(self) -> str:
        theta, d = self._joint_text()
        head = f"{type(self).__name__}:{' ' * (2 if self.sigma else 3)}"
        return f"{head}θ={theta},  d={d},  a={self.a},  ⍺={float(self.alpha)}"

    def __repr__(self) -> str:
        first = f"θ={self.theta:.3g}" if self.sigma else f"d={self.d:.3g}"
        head = f"{first}, a={self.a:.3g}, ⍺={self.alpha:.3g}"
        parts = [head, f'name = "{self.name}"', *self._details()]
        return f"{type(self).__name__}({', '.join(parts)})"


class _RevoluteLink(DHLink):
    _modified = False

    def __init__(
        self, d: float = 0.0, a: float = 0.0, alpha: float = 0.0, offset: float = 0.0, **more: Any
    ) -> None:
        super().__init__(d=d, a=a, alpha=alpha, offset=offset, sigma=0, mdh=self._modified, **more)


class _PrismaticLink(DHLink):
    _modified = False

    def __init__(
        self, theta: float = 0.0, a: float = 0.0, alpha: float = 0.0, offset: float = 0.0, **more: Any
    ) -> None:
        super().__init__(theta=theta, a=a, alpha=alpha, offset=offset, sigma=1, mdh=self._modified, **more)


class RevoluteDH(_RevoluteLink):
    """A joint that turns, standard parameters."""


class PrismaticDH(_PrismaticLink):
    """A joint that slides, standard parameters."""


class RevoluteMDH(_RevoluteLink):
    """A joint that turns, modified parameters."""

    _modified = True


class PrismaticMDH(_PrismaticLink):
    """A joint that slides, modified parameters."""

    _modified = True


__all__ = ["DHLink", "PrismaticDH", "PrismaticMDH", "RevoluteDH", "RevoluteMDH"]
