"""JointModel: a kind of joint, its data and its Lie group."""

from __future__ import annotations

from typing import Any

from pinocchio._containers.arrays import numbers
from pinocchio._model.joint_base import JointBase
from pinocchio._model.joint_data import JointData, data_of
from pinocchio._model.lie_group import LieGroup, of_joint
from pinocchio._model.repeated_joint_calls import JointCalls


class JointModel(JointBase):
    """A kind of joint and, once in a model, its index and its indices in q and v."""

    _repeats = False
    """Whether `calc` may run without Python."""

    def createData(self) -> JointData:
        """What `calc` writes into: a JointData for a joint of a model, else one of the class of its kind."""
        neutral = getattr(self, "_neutral", None)
        if neutral is None:
            neutral = data_of(self, of_any_kind=self._held or type(self) is JointModel)
            if self.parts:  # which may change by themselves
                return neutral
            self._know(_neutral=neutral)
        return neutral.new_like()

    def calc(self, jdata: JointData, q: Any, v: Any = None) -> None:
        """Computes the state of the joint.

        Args:
            jdata: The JointData, which is filled.
            q: Configuration of the model (nq,), or of the joint [rad or m].
            v: Velocity of the model (nv,), or of the joint [rad/s or m/s]; None for none.
        """
        if self.kind is not None:
            velocity = None if v is None else _entries(v, self.idx_v, self.kind.nv)
            jdata.place(self, _entries(q, self.idx_q, self.kind.nq), velocity)
            if self._repeats and not self.parts:
                if getattr(self, "_tables", None) is None:
                    self._know(_tables=JointCalls())
                self._tables.note(self, jdata, q, *(() if v is None else (v,)))

    def lieGroup(self) -> LieGroup:
        """The Lie group of its configurations."""
        return of_joint(self)


def _entries(values: Any, start: int, size: int) -> Any:
    """The `size` entries of a joint among those of its model."""
    first = max(start, 0)
    return numbers(values, "values").reshape(-1)[first : first + size]
