"""What a Data knows of its contents: the states they belong to, and what is computed only when it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pinocchio._runs import Runs
from ulna.errors import InputError
from ulna.typing import Floats

if TYPE_CHECKING:
    from pinocchio._data import Data
    from pinocchio._engine import Engine
    from pinocchio._model import Model

STATES = {
    "places": "q",
    "own": "q",
    "speeds": "qv",
    "gains": "qva",
    "jacobians": "q",
    "rates": "qv",
    "bodies": "qva",
    "moments": "qva",
    "forward": "qva",
    "weights": "q",
    "derivatives": "qva",
}
"""What results are of: of `oMi`, of `liMi`, of `v`, of `a`, of `J`, of `dJ`, of bodies, of centres, of what torques
give, of forces of gravity, of derivatives."""
OWN, SPEED, BODIES, COM, VCOM, ACOM, MASS, GAIN, WEIGHT = (1 << k for k in range(9))
"""Bits of `Data._due`: what is computed when it is asked for, of the state of that name in `_DUE`."""
OF_MOTION = ("v", "a_gf", "f", "h")
"""What rnea leaves of every body."""
FROZEN = 9
"""Shifted by this they say: of numbers the model had before."""
NOT_SPEED, NOT_MOTION, NOT_BODIES = (~(bits | bits << FROZEN) for bits in (SPEED, SPEED | GAIN, BODIES))
"""What stays due when an algorithm has written velocities, accelerations too, or forces on bodies."""
_DUE = {
    OWN: "own",
    SPEED: "bodies",
    BODIES: "bodies",
    COM: "moments",
    VCOM: "moments",
    ACOM: "moments",
    MASS: "own",
    GAIN: "forward",
    WEIGHT: "weights",
}
_IN_WORLD = {"ov": "v", "oa": "a", "oa_gf": "a_gf", "of": "f", "oh": "h"}


class States:
    """What of a Data is about its states."""

    _blocks: dict[str, Floats]
    _tails: dict[str, Floats]
    _heads: dict[str, Floats]
    _layout: Any
    _model: Model
    _engine: Engine | None
    _run: Runs
    _run_at: dict[Any, Any]
    _ties: list[Any]
    _due: int
    _frozen: dict[int, Any]
    _known: set[str]
    _q: Any
    _qv: Any
    _qva: Any
    _q_of_jacobians: Any
    _qv_of_jacobians: Any
    _of_derivatives: Any

    def target(self, name: str) -> Floats:
        """Where an algorithm writes: the array of that name, of the joints but the universe, of the whole robot."""
        return self._tails.get(name, self._heads.get(name, self._blocks.get(name)))  # type: ignore[return-value]

    def attach(self, model: Model) -> Engine:
        """The kernels of the model's present numbers; what was bound to others is let go.

        Raises:
            InputError: see `engine_for`.
        """
        engine = engine_for(model, self)
        if engine is not self._engine or model is not self._model:
            for bit, state in _DUE.items():
                if self._due & bit:
                    self.leave(bit, (self._engine, *(x.copy() for x in self._state(state))))
            self._run, self._run_at, self._ties = Runs(), {}, []
            self._engine, self._model = engine, model
        return engine

    def _state(self, name: str) -> tuple[Floats, ...]:
        return tuple(self._blocks[f"{name} {x}"] for x in STATES[name])

    def claim(self, bit: int) -> tuple[Any, ...] | None:
        """What is due of a bit: the kernels, and the state they are called with; it is due no more."""
        due, old = self._due, self._frozen.pop(bit, None)
        self._due = due & ~(bit | bit << FROZEN)
        if due & bit:
            return (self._engine, *self._state(_DUE[bit]))
        return old if due & bit << FROZEN else None

    def leave(self, bit: int, due: tuple[Any, ...]) -> None:
        """Leaves to do what `claim` will return."""
        self._frozen[bit] = due
        self._due = self._due & ~bit | bit << FROZEN

    def keep(self, engine: Engine, q: Floats) -> Floats:
        """Remembers what the placements are of; returns a copy of q."""
        self.attach(self._model)
        self._q = self._blocks["own q"][...] = q
        self._due |= OWN
        return q.copy()

    def pull(self, name: str) -> None:
        """Computes what was left to be computed until it is asked for."""
        if name == "liMi":
            due = self.claim(OWN)
            if due is not None:
                from pinocchio._kinematics import own_poses

                engine, q = due
                kernel = engine.made("liMi", lambda m: lambda q: own_poses(m, q), q=q.shape)
                self._tails["liMi"][...] = kernel(q)
        elif name in _IN_WORLD:
            self.pull(_IN_WORLD[name])
            self._carry(name)
        elif name == "a":
            due = self.claim(GAIN)
            if due is not None:
                from pinocchio._kinematics import gains

                engine, *state = due
                self._tails["a"][...] = gains(engine, *state[:3])
                self._qva = state[:3]
        elif name in OF_MOTION:
            from pinocchio._dynamics import bodies

            for bit, names in ((SPEED, ("v",)), (WEIGHT, ("a_gf", "f")), (BODIES, OF_MOTION[1:])):
                due = self.claim(bit)
                if due is not None:
                    if bit == WEIGHT:
                        due += (np.zeros(self._model.nv),) * 2
                    found: dict[str, Floats] = dict(zip(OF_MOTION, bodies(*due), strict=True))
                    for field in names:
                        self._tails[field][...] = found[field]
                    if bit == SPEED:
                        self._qv = due[1:3]

    def _carry(self, name: str) -> None:
        """From the joints' own frames into the world's, by `oMi`."""
        T, own = self._blocks["oMi"], self._blocks[_IN_WORLD[name]]
        R, p = T[:, :3, :3], T[:, :3, 3]
        first, last = (np.einsum("nij,nj->ni", R, own[:, part]) for part in (slice(3), slice(3, 6)))
        motion = name in (
            "ov",
            "oa",
            "oa_gf",
        )  # of a motion the linear half takes of the angular; of a force, the other way
        arm = np.cross(p, last if motion else first)
        self._blocks[name][...] = np.hstack([first + arm, last] if motion else [first, last + arm])

    def settle(self) -> None:
        """Computes all that was left for each body."""
        for name in ("liMi", "a", *OF_MOTION, *_IN_WORLD):
            self.pull(name)

    def require(self, what: Any, mend: str) -> Any:
        """`what`, a state that an earlier algorithm leaves.

        Raises:
            InputError: it has not been left yet.
        """
        if what is None:
            raise InputError(f"This Data holds nothing to answer from yet. Call {mend} first.")
        return what


_OF_LATE = {"speeds": "v", "gains": "a"}


def _left(name: str) -> property:
    """What results are of: an array, or several in a tuple; None until an algorithm has left them."""
    keys = [f"{name} {x}" for x in STATES[name]]

    def get(self: States) -> Any:
        if name in _OF_LATE and self._due:
            self.pull(_OF_LATE[name])
        if name not in self._known:
            return None
        return self._blocks[keys[0]] if len(keys) == 1 else self._state(name)

    def put(self: States, value: Any) -> None:
        self._known.add(name)
        for key, values in zip(keys, (value,) if len(keys) == 1 else value, strict=True):
            self._blocks[key][...] = values

    return property(get, put)


for _name, _of in {
    "_q": "places",
    "_qv": "speeds",
    "_qva": "gains",
    "_q_of_jacobians": "jacobians",
    "_qv_of_jacobians": "rates",
    "_of_derivatives": "derivatives",
}.items():
    setattr(States, _name, _left(_of))


def engine_for(model: Model, data: States) -> Engine:
    """The kernels of the model's present numbers, when the Data fits the model.

    Raises:
        InputError: joints were added since the Data was made, or it was made for another robot.
    """
    if data._layout is not model._layout and data._layout != model._layout:
        raise InputError(
            f"This Data was made for a model of {len(data._layout)} joints that are not those of the model, which "
            f"now has {model.njoints}. Make a new one: data = model.createData()."
        )
    return model.engine()


def frames_fit(model: Model, data: Data) -> None:
    """Raises InputError when frames were added since the Data was made."""
    if data.nframes != len(model.frames):
        raise InputError(
            f"This Data was made when the model had {data.nframes} frames; now it has {model.nframes}. "
            "Make a new one: data = model.createData() (robot.rebuildData() for a RobotWrapper)."
        )
