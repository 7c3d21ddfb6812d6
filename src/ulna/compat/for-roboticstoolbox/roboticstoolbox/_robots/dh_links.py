"""Links by Denavit and Hartenberg's parameters.

Standard: Rz(theta) tz(d) tx(a) Rx(alpha). Modified: tx(a) Rx(alpha) tz(d) Rz(theta), a and alpha of the link before.
"""

from __future__ import annotations

from typing import Any

from roboticstoolbox._common.class_registry import registered_class
from roboticstoolbox._common.errors import WrongType
from roboticstoolbox._common.symbols import is_symbol
from roboticstoolbox._ets.elementary_transform import ET
from roboticstoolbox._ets.ets import ETS
from roboticstoolbox._links.link import Link
from ulna.errors import InputError


class _DHParameter:
    """A parameter of a link: setting it changes the transforms of the link, and so those of its robot."""

    def __set_name__(self, _: type, name: str) -> None:
        self._name = f"_{name}"

    def __get__(self, link: Any, _: type | None = None) -> Any:
        return self if link is None else link.__dict__[self._name]

    def __set__(self, link: Any, value: Any) -> None:
        unused = {"_theta": 0, "_d": 1}.get(self._name)
        if unused is not None and link.sigma == unused and value:
            raise InputError(
                f"`{self._name[1:]}` is {value!r}; it is this link's joint coordinate: expected 0; set `offset`."
            )
        link.__dict__[self._name] = int(value) if self._name == "_mdh" else value
        link._parameters_changed()


class DHLink(Link):
    """A link of four numbers, one of which is a joint's."""

    d, alpha, theta, a = _DHParameter(), _DHParameter(), _DHParameter(), _DHParameter()
    sigma, mdh, offset = _DHParameter(), _DHParameter(), _DHParameter()

    def __init__(
        self,
        d: Any = 0.0,
        alpha: Any = 0.0,
        theta: Any = 0.0,
        a: Any = 0.0,
        sigma: int = 0,
        mdh: bool = False,
        offset: Any = 0,
        flip: bool = False,
        qlim: Any = None,
        **more: Any,
    ) -> None:
        """`sigma` is 0 for a joint that turns (theta), 1 for one that slides (d); `more` are arguments of `Link`."""
        if (theta and not sigma) or (d and sigma):
            raise WrongType(
                "`theta` of a joint that turns, and `d` of one that slides, is its coordinate; use `offset`."
            )
        self.__dict__.update(
            _d=d, _alpha=alpha, _theta=theta, _a=a, _sigma=sigma, _mdh=int(mdh), _offset=offset
        )
        super().__init__(self._transforms(ET("tz" if sigma else "Rz", flip=flip, qlim=qlim)), **more)
        self.number = None
        self.mesh: Any = None

    def _transforms(self, joint: Any) -> ETS:
        """The transforms of the present parameters around a joint."""

        def constant(make: Any, value: Any) -> list[Any]:
            return [] if value == 0 else [make(value)]

        turned = constant(ET.Rz, self.theta if self.sigma else self.offset)
        lifted = constant(ET.tz, self.offset if self.sigma else self.d)
        beside = [*constant(ET.tx, self.a), *constant(ET.Rx, self.alpha)]
        if self.mdh:
            return ETS([*beside, *turned, *lifted, joint])
        return ETS([*turned, *([*lifted, joint] if self.sigma else [joint, *lifted]), *beside])

    def _parameters_changed(self) -> None:
        old: Any = self.v
        limits = old.qlim if old.istranslation == bool(self.sigma) else None
        joint = ET("tz" if self.sigma else "Rz", jindex=old.jindex, flip=old.isflip, qlim=limits)
        self._ets = self._transforms(joint)
        self._limits_or_shapes_changed()

    def __add__(self, other: Any) -> Any:
        """A robot of this link, and of another one or the links of a robot."""
        robot = registered_class("DHRobot")
        if isinstance(other, DHLink):
            return robot([self, other])
        if not isinstance(other, robot):
            return NotImplemented
        more = {name: getattr(other, name) for name in ("name", "manufacturer", "base", "tool", "gravity")}
        return robot([self, *other.links], **more)

    def _joint_text(self) -> tuple[str, str]:
        shift = f" + {self.offset}" if is_symbol(self.offset) or self.offset != 0 else ""
        if self.sigma:
            return f"{self.theta}", f"q{shift}"
        return f"q{shift}", f"{self.d}"

    def __str__(self) -> str:
        theta, d = self._joint_text()
        head = f"{type(self).__name__}:{' ' * (2 if self.sigma else 3)}"
        return f"{head}θ={theta},  d={d},  a={self.a},  ⍺={self.alpha}"

    def __repr__(self) -> str:
        first = f"θ={_brief(self.theta)}" if self.sigma else f"d={_brief(self.d)}"
        head = f"{first}, a={_brief(self.a)}, ⍺={_brief(self.alpha)}"
        parts = [head, f'name = "{self.name}"', *self._details()]
        return f"{type(self).__name__}({', '.join(parts)})"


def _brief(value: Any) -> str:
    return str(value) if is_symbol(value) else f"{value:.3g}"


class _RevoluteLink(DHLink):
    _modified = False

    def __init__(
        self,
        d: float = 0.0,
        a: float = 0.0,
        alpha: float = 0.0,
        offset: float = 0.0,
        qlim: Any = None,
        flip: bool = False,
        **more: Any,
    ) -> None:
        joint = {"sigma": 0, "mdh": self._modified, "qlim": qlim, "flip": flip}
        super().__init__(d=d, a=a, alpha=alpha, offset=offset, **joint, **more)


class _PrismaticLink(DHLink):
    _modified = False

    def __init__(
        self,
        theta: float = 0.0,
        a: float = 0.0,
        alpha: float = 0.0,
        offset: float = 0.0,
        qlim: Any = None,
        flip: bool = False,
        **more: Any,
    ) -> None:
        joint = {"sigma": 1, "mdh": self._modified, "qlim": qlim, "flip": flip}
        super().__init__(theta=theta, a=a, alpha=alpha, offset=offset, **joint, **more)


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
