"""What varies in a sweep: numbers of the model and of its state, each within a range.

| symbol | meaning | shape |
|---|---|---|
| x | the factors: what varies | (n, d) |
| u | the same, from -1 at the low end of each range to 1 at the high end | (n, d) |
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna import model as models
from ulna.checks.arrays import finite_array
from ulna.errors import InputError, ShapeError, UnknownName
from ulna.model import Model
from ulna.typing import Array, Floats

STATES = ("q", "v", "a", "tau")
_BODIES = ("mass", "payload")
_PARAMETERS = (
    "inertia",
    "placement",
    "shift",
    "offset",
    "base",
    "tool",
    "gravity",
    "armature",
    "damping",
    "friction",
)


@final
@dataclass(frozen=True, eq=False)
class Factors:
    """What varies, and how it becomes arguments of a kernel.

    Attributes:
        model: The model.
        values: What arguments are where nothing varies, by name; "mass" and "payload" among them.
        varied: The names of what varies, with the flat places of the entries that do.
        low: The low ends of the ranges, (d,).
        high: The high ends, (d,).
    """

    model: Model
    values: Mapping[str, Floats]
    varied: Mapping[str, Array]
    low: Floats
    high: Floats

    @classmethod
    def of(cls, model: Model, vary: Mapping[str, Any], at: Mapping[str, Any]) -> Factors:
        """The factors of a sweep.

        Args:
            model: The model.
            vary: Ranges by name, as `ulna.scale.sweep` takes them.
            at: The state, by the names of its arrays.

        Returns:
            The factors.

        Raises:
            InputError: If a range is none, or nothing varies.
            ShapeError: If a range or a state has a wrong shape.
            UnknownName: If the model has no such parameter.
        """
        values = {name: _state(model, name, value) for name, value in at.items()}
        varied, lows, highs = {}, [np.zeros(0)], [np.zeros(0)]
        for name, span in vary.items():
            if name not in values:
                values[name] = _present(model, name)
            low, high = _range(name, span, values[name])
            places = np.flatnonzero(low.reshape(-1) < high.reshape(-1))
            varied[name] = places
            lows.append(low.reshape(-1)[places])
            highs.append(high.reshape(-1)[places])
        low, high = np.concatenate(lows), np.concatenate(highs)
        if not len(low):
            raise InputError("Nothing varies; expected ranges such as vary={'mass': 0.1, 'payload': (0, 3)}.")
        return cls(model, values, varied, low, high)

    @property
    def names(self) -> tuple[str, ...]:
        """A name for each factor, such as "payload[0]"."""
        out = []
        for name, places in self.varied.items():
            index = np.unravel_index(places, self.values[name].shape)
            out += [
                f"{name}[{', '.join(map(str, k))}]" for k in zip(*(i.tolist() for i in index), strict=True)
            ]
        return tuple(out)

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters of the kernel that vary."""
        names = ["inertia"] if any(name in self.varied for name in _BODIES) else []
        return tuple(dict.fromkeys([*names, *(n for n in self.varied if n not in (*STATES, *_BODIES))]))

    def scaled(self, u: Floats) -> Floats:
        """x, (..., d), of u, (..., d)."""
        return self.low + 0.5 * (u + 1.0) * (self.high - self.low)

    def arguments(self, x: Floats) -> dict[str, Floats]:
        """States and parameters of kernels at values of the factors.

        Args:
            x: The factors, (n, d).

        Returns:
            Arrays by name: (n, ...) of what varies, (...) of what does not.
        """
        out, first = dict(self.values), 0
        for name, places in self.varied.items():
            value = np.repeat(self.values[name].reshape(1, -1), len(x), axis=0)
            value[:, places] = x[:, first : first + len(places)]
            out[name] = value.reshape(len(x), *self.values[name].shape)
            first += len(places)
        if "inertia" in self.parameters:
            bodies = out.get("inertia", models.parameters(self.model, "inertia"))
            bodies = bodies.reshape(*bodies.shape[:-1], -1, 10)
            bodies = bodies * out.pop("mass", np.ones(1))[..., None]
            if "payload" in out:
                bodies = np.array(np.broadcast_to(bodies, (len(x), *bodies.shape[-2:])))
                frame = self.model.frame(self.model.tool)
                bodies[:, frame.joint] += _point_mass(out.pop("payload"), frame.placement)
            out["inertia"] = bodies.reshape(*bodies.shape[:-2], -1)
        return out


def _state(model: Model, name: str, value: Any) -> Floats:
    size = model.nq if name == "q" else model.nv
    array = finite_array(name, value)
    if array.shape != (size,):
        raise ShapeError(name, array.shape, f"({size},): one state, about which the sweep is made")
    return array


def _present(model: Model, name: str) -> Floats:
    """What the model has for a parameter."""
    if name == "mass":
        return np.ones(len(model.joints))
    if name == "payload":
        if model.frame(model.tool).joint < 0:
            raise InputError(f"The tool {model.tool!r} does not move; a payload there changes nothing.")
        return np.zeros(4)
    if name not in _PARAMETERS and not name.startswith("frame:"):
        raise UnknownName("number that can vary", name, (*_BODIES, *_PARAMETERS, *STATES))
    return np.asarray(models.parameters(model, name), dtype=float)


def _range(name: str, span: Any, value: Floats) -> tuple[Floats, Floats]:
    """The low and high ends of a range, each of the shape of the value."""
    middle = np.zeros(1)
    if isinstance(span, tuple | list) and len(span) == 2:
        ends = [finite_array(name, end) for end in span]
        if name == "payload":  # the mass alone: at the tool
            ends = [np.concatenate([end[None], np.zeros(3)]) if end.shape == () else end for end in ends]
    else:
        width = finite_array(name, span)
        if (width < 0.0).any() or name == "payload":
            raise InputError(
                f"The range of {name!r} is {span!r}; expected a width of 0 or more, or a pair (low, high)."
            )
        ends = [-width, width]
        middle = value
    try:
        low, high = (middle + np.broadcast_to(end, value.shape) for end in ends)
    except ValueError:
        shapes = " and ".join(str(end.shape) for end in ends)
        raise ShapeError(name, ends[0].shape, f"ends of shape {value.shape}", f"Here: {shapes}.") from None
    if (low > high).any():
        raise InputError(f"The range of {name!r} is {span!r}; expected low ends not above high ends.")
    return low, high


def _point_mass(payload: Floats, placement: Any) -> Floats:
    """The ten parameters (n, 10) of point masses (n, 4) in a frame, in the axes of the body that carries it."""
    m = payload[:, 0]
    T = np.asarray(placement)
    c = payload[:, 1:] @ T[:3, :3].T + T[:3, 3]
    x, y, z = c.T
    square = (c * c).sum(axis=1)
    rows = [np.ones_like(m), x, y, z, square - x * x, -x * y, square - y * y, -x * z, -y * z, square - z * z]
    return m[:, None] * np.stack(rows, axis=-1)
