"""Rates and Hessians of Jacobians, derivatives of motions, out of the fields of a Data as they are, whoever wrote them.

| symbol | meaning | shape |
|---|---|---|
| T | pose of the frame in the world, that of its joint times its placement there | (4, 4) |
| J_j, dJ_j | column j of the Jacobian in the world, and its rate | (6,) |
| V, A | twist and spatial acceleration of the frame in the world | (6,) |
| V_p, A_p | those of the joint before that of column j, whose own twist is V_i | (6,) |
| W_j | V_p x J_j = dJ_j + (V_p - V_i) x J_j, the last term zero where the joint has one column | (6,) |

A column moves all beyond it, so that in the world

    dV/dq_j = (V_p - V) x J_j
    dA/dv_j = dJ_j + (V_p - V) x J_j
    dA/dq_j = (A_p - A) x J_j + (V_p - V) x W_j

and in the axes of the frame, which turn with the column, V x J_j and A x J_j are added to the derivatives by q. Motion
subspaces are constant in the frames of their joints. Source: Featherstone, sections 2.9 and 2.10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from pinocchio._data.data import Data
from pinocchio._model.model import Model
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.small_kernels import as_motion, pose
from ulna import spatial
from ulna.algorithms.kinematics.hessian import hessian_of_columns
from ulna.algorithms.kinematics.jacobian import Column as PlacedColumn
from ulna.algorithms.multibody.batch_shapes import batch_zeros
from ulna.algorithms.multibody.references import Reference
from ulna.numeric import cross, skew
from ulna.spatial import Motion
from ulna.typing import Array, Floats


class Column(NamedTuple):
    """A column that moves a frame: its index, its joint, the joint before, and whether its joint has no other one."""

    index: int
    joint: int
    before: int
    is_only: bool


@final
class Carrier(NamedTuple):
    """What carries a frame, and where results are expressed.

    Attributes:
        joint: The index of its joint, 0 for the universe.
        columns: The columns that move it, from the world on.
        nv: How many columns there are in all.
        is_placed: Whether the frame is at a placement on the joint, the first input; else it is the joint's.
        reference: The reference frame.
    """

    joint: int
    columns: tuple[Column, ...]
    nv: int
    is_placed: bool
    reference: Reference

    def split(self, inputs: tuple[Array, ...]) -> tuple[spatial.SE3, spatial.SE3, tuple[Array, ...]]:
        """The placement of the frame on its joint, its pose in the world, and the inputs after these.

        Args:
            inputs: The inputs: the placement (4, 4) where there is one, the pose of the joint (4, 4), and others.

        Returns:
            The placement, the pose, and the others.
        """
        if not self.is_placed:
            return spatial.SE3.identity(), pose(inputs[0]), inputs[1:]
        placement = pose(inputs[0])
        return placement, pose(inputs[1]) @ placement, inputs[2:]

    def moved(self, T: spatial.SE3, motion: Motion) -> Motion:
        """A motion in the world, expressed in the reference frame.

        Args:
            T: The pose of the frame in the world.
            motion: The motion.

        Returns:
            The motion there.
        """
        if self.reference == "local":
            return T.act_inverse(motion)
        if self.reference == "world":
            return motion
        return Motion(motion.linear - cross(T.translation, motion.angular), motion.angular)

    def matrix(self, columns: Iterator[Motion]) -> Array:
        """The matrix (6, nv) of these columns, one for each of its own; zero where the frame is not moved.

        Args:
            columns: The columns.

        Returns:
            The matrix.
        """
        found = {k: motion.vector() for (k, *_), motion in zip(self.columns, columns, strict=True)}
        return np.stack([found.get(k, np.zeros(6)) for k in range(self.nv)], axis=-1)


def carrier_of(model: Model, joint: int, is_placed: bool, reference: Reference) -> Carrier:
    """What carries a frame on a joint.

    Args:
        joint: The index of the joint.
        is_placed: Whether the frame is at a placement on it.
        reference: Where results are expressed.

    Returns:
        The carrier.
    """
    columns = [
        Column(model.joints[i].idx_v + k, i, model.parents[i], model.joints[i].nv == 1)
        for i in list(model.supports[joint])[1:]
        for k in range(model.joints[i].nv)
    ]
    return Carrier(joint, tuple(columns), model.nv, is_placed, reference)


def has_constant_subspaces(model: Model) -> bool:
    """Whether the motion subspaces of all joints are constant in their frames."""
    identity = spatial.SE3.identity()
    kinds = [joint.kind for joint in list(model.joints)[1:]]
    return all(kind is not None and len(kind.elementary_joints(identity)) == 1 for kind in kinds)


def bound_to_fields(
    model: Model,
    data: Data,
    key: tuple[Any, ...],
    function: Callable[..., Any],
    read: Sequence[Floats],
    fields: Sequence[str],
    watch: list[tuple[Any, Any]],
    last_target: Floats | None = None,
    passes_placement: bool = False,
) -> Callable[..., Any]:
    """A function of what a Data holds, compiled for all models with the same joints, and bound to these arrays.

    Args:
        key: Key in the cache of kernels.
        function: The function of arrays.
        read: What it is called with: arrays (...) of the Data, the placement of a frame first.
        fields: The fields among them that are computed when they are read.
        watch: Pairs of arrays (...) that are equal while the kernel applies, besides the marks of these fields.
        last_target: The array (...) that the last output is written to, which is not returned then.
        passes_placement: Whether the placement is passed with every call, as an SE3.

    Returns:
        What returns copies of the outputs; NotImplemented where it does not apply.
    """
    sizes: dict[str, Any] = {f"x{k}": x.shape for k, x in enumerate(read)}
    kernel = model._compiled_structure().compile(key, lambda _: function, **sizes)
    targets = [np.zeros(port.shape) for port in kernel.function.outputs]
    returned = len(targets) if last_target is None else len(targets) - 1
    targets = [*targets[:returned], *([] if last_target is None else [last_target])]
    marks = [(data._mark_of(field), np.zeros(())) for field in fields]

    def bind(otherwise: Callable[..., Any]) -> Any:
        return kernel.into(
            *targets,
            returns=tuple(range(returned)),
            watch=[*watch, *marks],
            otherwise=otherwise,
            trailing_inputs=read[passes_placement:],
            input_holders=[SE3] * passes_placement,
        )

    return data._bound_after_reads(fields, bind)


def placement_of(placement: Floats | None) -> tuple[Floats, ...]:
    """A placement (4, 4) as the first input of a function, or none."""
    return () if placement is None else (placement,)


def jacobian_rate(carrier: Carrier) -> Callable[..., Array]:
    """The rate (6, nv) of the Jacobian of a frame.

    It is a function of the placement where the carrier has one, of `oMi` of the joint, J, dJ, and, but in the world's
    frame, of the joint's twist: in its own axes for "local", in the world's for "local_world_aligned".

    Args:
        carrier: What carries the frame.

    Returns:
        The function.
    """

    def run(*inputs: Array) -> Array:
        placement, T, (J, dJ, *velocity) = carrier.split(inputs)
        twist = as_motion(velocity[0]) if velocity else Motion.zero()
        twist = placement.act_inverse(twist) if carrier.reference == "local" else carrier.moved(T, twist)

        def rate(k: int) -> Motion:
            moved, column = (carrier.moved(T, as_motion(x[:, k])) for x in (dJ, J))
            if carrier.reference == "local":
                return moved - twist.cross(column)
            if carrier.reference == "world":
                return moved
            return Motion(moved.linear - cross(twist.linear, column.angular), moved.angular)

        return carrier.matrix(rate(column.index) for column in carrier.columns)

    return run


def motion_derivatives(carrier: Carrier, with_accelerations: bool) -> Callable[..., tuple[Array, ...]]:
    """Derivatives (6, nv) of the motion of a frame, and its pose (4, 4).

    It is a function of the placement where the carrier has one, of `oMi` of the joint, J and `ov`, and for
    accelerations of dJ, `oa`, and `v` of the joint.

    Args:
        carrier: What carries the frame.
        with_accelerations: Whether those of the acceleration by q, v and a follow that of the velocity by q; else that
            of the velocity by v.

    Returns:
        The function; its results are (6, nv), and the pose (4, 4).
    """

    def run(*inputs: Array) -> tuple[Array, ...]:
        placement, T, (J, ov, *more) = carrier.split(inputs)
        columns = [as_motion(J[:, column.index]) for column in carrier.columns]
        V_q = [W.cross(j) for W, j in zip(_before(carrier, ov), columns, strict=True)]
        J_frame = carrier.matrix(carrier.moved(T, column) for column in columns)
        by_q = carrier.matrix(carrier.moved(T, motion) for motion in V_q)
        if not with_accelerations:
            return by_q, J_frame, T.matrix()
        dJ, oa, v = more
        rates = [as_motion(dJ[:, column.index]) for column in carrier.columns]
        turned = [W.cross(j) for W, j in zip(_before(carrier, oa), columns, strict=True)]
        swept = _swept(carrier, ov, columns, V_q, rates)
        A_q = carrier.matrix(carrier.moved(T, x + y) for x, y in zip(turned, swept, strict=True))
        A_v = carrier.matrix(carrier.moved(T, x + y) for x, y in zip(rates, V_q, strict=True))
        if carrier.reference == "local":
            turning = placement.act_inverse(as_motion(v)).cross_matrix()
            A_q, A_v = A_q - turning @ by_q, A_v - turning @ J_frame
        return by_q, A_q, A_v, J_frame, T.matrix()

    return run


def point_derivatives(carrier: Carrier, with_accelerations: bool) -> Callable[..., tuple[Array, ...]]:
    """Derivatives (3, nv) of how the origin of a frame moves, as a point: of its velocity by q, then as of motions.

    It is a function of the placement, of `oMi` of the joint, J and `ov`, and for accelerations of dJ and `oa`. The
    frame turns, so that those of w x u follow for a velocity u and an angular velocity w; along the world's axes those
    of the rotation, too.

    Args:
        carrier: What carries the frame, which is at a placement.
        with_accelerations: Whether those of the acceleration by q, v and a follow that of the velocity by q; else that
            of the velocity by v.

    Returns:
        The function; its results are (3, nv).
    """
    of_motions = motion_derivatives(carrier._replace(reference="local"), with_accelerations)
    turns = carrier.reference != "local"

    def run(M: Array, oMi: Array, J: Array, ov: Array, *more: Array) -> tuple[Array, ...]:
        own = as_motion(ov[carrier.joint])
        moved = (*more, pose(oMi).act_inverse(own).vector()) if with_accelerations else ()
        V_q, *of_acceleration, J_frame, pose_of_frame = of_motions(M, oMi, J, ov, *moved)
        T = pose(pose_of_frame)
        V = T.act_inverse(own)
        u, w = skew(V.linear), skew(V.angular)
        by_q = V_q[:3] - u @ J_frame[3:] if turns else V_q[:3]
        results = [by_q, J_frame[:3]]
        if with_accelerations:
            (A_q, A_v), A = of_acceleration, T.act_inverse(as_motion(more[1][carrier.joint]))
            a_q, a_v = (x[:3] + w @ y[:3] - u @ y[3:] for x, y in ((A_q, V_q), (A_v, J_frame)))
            if turns:
                a_q = a_q - skew(A.linear + cross(V.angular, V.linear)) @ J_frame[3:]
            results = [by_q, a_q, a_v, J_frame[:3]]
        return tuple(T.rotation @ x for x in results) if turns else tuple(results)

    return run


def orders_of(model: Model, carrier: Carrier) -> tuple[int, ...] | None:
    """For each column that moves a frame, its place in the chain; those that move each other have the same.

    Args:
        model: The model.
        carrier: What carries the frame.

    Returns:
        The places; None where columns are not separate: of joints that follow others, or that turn twice by one angle.
    """
    places: dict[int, int] = {}
    for joint in dict.fromkeys(column.joint for column in carrier.columns):
        kind, first = model.joints[joint].kind, model.joints[joint].idx_v
        parts = () if kind is None else kind.elementary_joints(spatial.SE3.identity())
        entries = [(first + part.start_v + k, n) for n, part in enumerate(parts) for k in range(part.kind.nv)]
        if len(dict(entries)) < len(entries) or not entries:
            return None
        places |= {entry: len(carrier.columns) * joint + n for entry, n in entries}
    return tuple(places[column.index] for column in carrier.columns)


def hessian(carrier: Carrier, orders: tuple[int, ...]) -> Callable[..., Array]:
    """The derivative (6, nv, nv) of the Jacobian of a frame, a function of the placement, of `oMi` of the joint, and J.

    Args:
        carrier: What carries the frame.
        orders: The places of its columns; see `orders_of`.

    Returns:
        The function; its result (6, nv, nv) has the entry of q last.
    """

    def run(*inputs: Array) -> Array:
        _, T, (J,) = carrier.split(inputs)
        columns = [
            PlacedColumn(order, column.index, carrier.moved(T, as_motion(J[:, column.index])))
            for column, order in zip(carrier.columns, orders, strict=True)
        ]
        zeros = batch_zeros((carrier.nv, 6, carrier.nv), J[0])
        return np.moveaxis(hessian_of_columns(columns, zeros, carrier.reference), 0, 2)

    return run


def _before(carrier: Carrier, motions: Array) -> list[Motion]:
    """For each column the motion of the joint before its own; but in the frame's axes, less that of the frame."""
    before = [
        as_motion(motions[column.before]) if column.before else Motion.zero() for column in carrier.columns
    ]
    own = as_motion(motions[carrier.joint])
    return before if carrier.reference == "local" else [motion - own for motion in before]


def _swept(
    carrier: Carrier, ov: Array, columns: list[Motion], V_q: list[Motion], rates: list[Motion]
) -> list[Motion]:
    """For each column the last term of dA/dq; in the frame's axes without the turning of the frame."""
    swept = []
    parts = zip(carrier.columns, _before(carrier, ov), columns, V_q, rates, strict=True)
    for (_, joint, before, is_only), turn, column, by_q, rate in parts:
        if not before:
            swept.append(Motion.zero())
        elif carrier.reference == "local":
            swept.append(turn.cross(by_q))
        else:
            own = Motion.zero() if is_only else (as_motion(ov[before]) - as_motion(ov[joint])).cross(column)
            swept.append(turn.cross(rate + own))
    return swept
