"""Friction of joints: viscous, Coulomb, Stribeck, smooth through rest within a stated width.

| symbol | meaning | shape | unit | equation |
|---|---|---|---|---|
| v | joint velocity | (nv) | [rad/s] or [m/s] | |
| B | viscous friction | (nv) | [N m s/rad] or [N s/m] | |
| Tc+, Tc- | Coulomb friction in forward and in backward motion | (nv) | [N m] or [N] | both not negative |
| Ts | static friction, at breakaway; not below Tc | (nv) | [N m] or [N] | |
| vs | velocity at which the excess of static friction has faded to 1/e | (nv) | [rad/s] or [m/s] | |
| d | width: the friction at v = d is 76 % of Tc | () | [rad/s] or [m/s] | s = tanh(v / d) |
| f | torque of friction | (nv) | [N m] or [N] | f = -(B v + (Tc + (Ts - Tc) exp(-(v/vs)^2)) s) |

Source: Siciliano, section 7.2.3 (viscous and Coulomb friction); Armstrong-Helouvry, Dupont & Canudas de Wit, A survey
of models ... for the control of machines with friction (1994), for Stribeck's curve. A step in f at v = 0 makes an
adaptive solver crawl and a fixed step chatter; a slope does not, but cannot hold a load at rest: it creeps, at most at
the width. Time stepping with an exact law of dry friction is in `ulna.sim`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, final

import numpy as np

from ulna.data_classes import dataclass
from ulna.errors import InputError, ShapeError
from ulna.model import Drive, Model, with_drives
from ulna.numeric import exp, is_symbolic, less, tanh, where
from ulna.system.cached import cached_property
from ulna.typing import Array, Floats


@final
@dataclass(frozen=True, eq=False)
class Friction:
    """The friction of a robot's joints; every number is one for all, or one for each entry of v.

    Attributes:
        viscous: B [N m s/rad, N s/m].
        coulomb: Tc in forward motion, and in backward motion if `backward` is None [N m, N].
        backward: Tc in backward motion, as a number that is not negative; None for that of forward motion.
        static: Ts [N m, N]; None for no more than Coulomb's.
        stribeck: vs [rad/s, m/s].
        width: d, the velocity [rad/s, m/s] within which Coulomb friction passes smoothly through zero.
    """

    viscous: Any = 0.0
    coulomb: Any = 0.0
    backward: Any = None
    static: Any = None
    stribeck: Any = 0.05
    width: float = 1e-2

    def __post_init__(self) -> None:
        shapes = {()}
        for name in (f.name for f in fields(self)):
            entry = getattr(self, name)
            if entry is None or is_symbolic(entry):
                continue
            value = np.array(entry, dtype=float)  # the caller's own array stays writeable, and may change
            least = "above" if name in ("stribeck", "width") else "not below"
            if (
                not np.isfinite(value).all()
                or (value < 0.0).any()
                or (least == "above" and (value == 0.0).any())
            ):
                raise InputError(f"`{name}` of a friction is {entry}; expected finite numbers {least} zero.")
            if value.ndim > 1 or (name == "width" and value.ndim):
                raise ShapeError(name, value.shape, "one number" + (" or (nv,)" if name != "width" else ""))
            shapes.add(value.shape)
            value.setflags(write=False)
            object.__setattr__(self, name, float(value) if value.ndim == 0 else value)
        if len(shapes) > 2:
            raise InputError(
                f"The numbers of a friction have the shapes {sorted(shapes)}; expected one (nv,)."
            )

    @cached_property
    def _key(self) -> tuple[Any, ...]:
        """What two frictions are compared by: numbers as they are, arrays by their bytes, traced values themselves."""
        return tuple(
            id(x) if is_symbolic(x) else x.tobytes() if isinstance(x, np.ndarray) else x
            for x in self._entries()
        )

    def _entries(self) -> list[Any]:
        return [getattr(self, f.name) for f in fields(self)]

    @property
    def is_traced(self) -> bool:
        """Whether some of its numbers are values of a function that is being traced."""
        return is_symbolic(*(x for x in self._entries() if x is not None))

    def __eq__(self, other: object) -> bool:
        """Whether the numbers are the same, so that kernels of equal frictions are compiled once."""
        return self._key == other._key if isinstance(other, Friction) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key)

    @classmethod
    def of(cls, model: Model, width: float = 1e-2) -> Friction:
        """The friction a model names for its joints: `damping` and `friction`.

        Args:
            model: The robot.
            width: The velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].

        Returns:
            Its viscous and Coulomb friction.
        """
        return cls(np.array(model.damping), np.array(model.friction), width=width)

    @classmethod
    def of_drives(cls, model: Model, drives: Mapping[str, Drive], width: float = 1e-2) -> Friction:
        """The friction of motors behind gears, with its two directions.

        Args:
            model: The robot.
            drives: The motor and gear of some joints, by the name of the joint.
            width: The velocity within which Coulomb friction passes smoothly through zero [rad/s, m/s].

        Returns:
            The friction of these joints as their drives have it, of the others as the model has it.
        """
        driven = with_drives(model, drives)
        forward, backward = np.array(driven.friction), np.array(driven.friction)
        for name, drive in drives.items():
            k = model.joint(name).idx_v
            there, back = drive.both_ways
            forward[k] += 0.5 * abs(drive.gear) * (there - back)
            backward[k] += 0.5 * abs(drive.gear) * (back - there)
        return cls(np.array(driven.damping), forward, backward, width=width)

    @property
    def is_viscous(self) -> bool:
        """Whether there is any viscous friction."""
        return bool(np.asarray(self.viscous).any())

    @property
    def is_dry(self) -> bool:
        """Whether there is any Coulomb or static friction."""
        dry = (self.coulomb, self.backward, self.static)
        return any(x is not None and np.asarray(x).any() for x in dry)

    def dry_bounds(self, v: Array) -> tuple[Any, Any]:
        """How large dry friction can be against forward and against backward motion as fast as `v` [N m, N]."""
        bounds = [self.coulomb, self.coulomb if self.backward is None else self.backward]
        if self.static is not None:
            ratio = v / self.stribeck
            fading = exp(-(ratio * ratio))
            bounds = [bound + (self.static - bound) * fading for bound in bounds]
        return bounds[0], bounds[1]

    def dry_bound(self, v: Array) -> Any:
        """How large dry friction can be at velocity `v`, in its direction, (..., nv) [N m, N]."""
        forward, backward = self.dry_bounds(v)
        return forward if self.backward is None else where(less(v, 0.0), backward, forward)

    def torque(self, v: Array) -> Any:
        """The torque of friction on the joints at velocity `v`, (..., nv) [N m, N]; it opposes the motion."""
        return friction_torque(v, self)

    def numbers(self, nv: int) -> tuple[Floats, Floats, Floats]:
        """B, Tc+ and Tc- as arrays (nv,); ShapeError if they are for another robot."""
        back = self.coulomb if self.backward is None else self.backward
        return (
            _broadcast("viscous", self.viscous, nv),
            _broadcast("coulomb", self.coulomb, nv),
            _broadcast("backward", back, nv),
        )


def friction_torque(v: Array, friction: Friction) -> Any:
    """What friction adds to the torques of the drives, against the motion.

    Args:
        v: Velocity, shape (..., nv) [rad/s, m/s].
        friction: The friction of the joints.

    Returns:
        f, shape (..., nv) [N m, N].
    """
    smooth = tanh(v / friction.width)
    return -(friction.viscous * v + friction.dry_bound(v) * smooth)


def _broadcast(name: str, value: Any, nv: int) -> Floats:
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (nv,)):
        raise ShapeError(name, array.shape, f"one number or ({nv},)")
    return np.broadcast_to(array, (nv,))
