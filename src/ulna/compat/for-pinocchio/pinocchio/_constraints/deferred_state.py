"""Placements, velocities and errors of constraints at a state: computed when they are read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from pinocchio._constraints.kernels import core_constraints
from pinocchio._constraints.rigid_constraint import RigidConstraintData
from pinocchio._data.deferred_fields import stacked
from ulna import algorithms
from ulna.algorithms.constraints.frame_errors import constraint_twists, frame_of
from ulna.model import Model as CoreModel
from ulna.typing import Array, Floats


@final
class DeferredConstraintState:
    """Placements, velocities and errors of constraints at one state, not computed yet."""

    def __init__(
        self, compiled: Any, datas: Sequence[RigidConstraintData], shapes: Any, *state: Floats
    ) -> None:
        """`state`: q, v, placements and gains, arrays that nothing else writes to."""
        self.compiled, self.datas, self.shapes, self.state = compiled, datas, shapes, state

    def fill(self) -> None:
        """Computes them, and writes them into the data of the constraints that still wait for them."""
        sizes: dict[str, Any] = dict(
            zip(("q", "v", "places", "gains"), (x.shape for x in self.state), strict=True)
        )
        kernel = self.compiled.compile(("constraint state", self.shapes), _state(self.shapes), **sizes)
        results = kernel(*self.state)
        for k, data in enumerate(self.datas):
            if data._deferred is self:
                data._deferred = None
                for block, rows in zip(data._blocks.values(), results, strict=True):
                    block[...] = rows[k]


def _state(shapes: Any) -> Any:
    def build(core: CoreModel) -> Any:
        def run(q: Array, v: Array, places: Array, gains: Array) -> tuple[Array, ...]:
            frame_pairs = core_constraints(shapes, places)
            twists = constraint_twists(
                core, q, v, [frame_pair._replace(local=True) for frame_pair in frame_pairs]
            )
            poses, velocities, errors = [], [], []
            start = 0
            for k, frame_pair in enumerate(frame_pairs):
                assert frame_pair.second is not None
                first, second = frame_of(frame_pair.first), frame_of(frame_pair.second)
                T1, T2 = (algorithms.frame_pose(core, q, frame) for frame in (first, second))
                poses.append((T1, T2, T1.inverse() @ T2))
                velocities.append(
                    [
                        algorithms.frame_velocity(core, q, v, frame, "local").vector()
                        for frame in (first, second)
                    ]
                )
                rows = slice(start, start + frame_pair.size)
                padding = np.zeros(6 - frame_pair.size)
                e, c = (np.concatenate([x[rows], padding]) for x in (twists.error, twists.velocity))
                correction = -(gains[k, 0] * e + gains[k, 1] * c)
                if not frame_pair.local:
                    correction = np.concatenate([T1.rotation @ correction[:3], T1.rotation @ correction[3:]])
                errors.append((e, c, correction))
                start += frame_pair.size
            return (
                *(stacked([p[i] for p in poses]) for i in range(3)),
                *(np.stack([s[i] for s in velocities]) for i in range(2)),
                *(np.stack([e[i] for e in errors]) for i in range(3)),
            )

        return run

    return build
