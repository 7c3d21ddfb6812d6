"""Quantities that are made of recursions, and of what NumPy computes with whole batches and matrices."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, final

import numpy as np

from ulna.algorithms import Friction, friction_torque
from ulna.compiler.procedures import Procedure
from ulna.recursions.recursion import Recursion, Shape
from ulna.typing import Floats


class Composition(ABC):
    """What is evaluated like a recursion, and is made of some.

    Args:
        outputs: The shapes of its outputs.
        main: The part with the most code, whose code `ir` shows.
    """

    def __init__(self, outputs: tuple[Shape, ...], main: Recursion | Composition) -> None:
        self.outputs = outputs
        self._main: Any = main.evaluator()

    @final
    def evaluator(self) -> Composition:
        """The object that evaluates samples: this one."""
        return self

    @final
    def procedure(self, is_batch: bool) -> Procedure:
        """The procedure of the part with the most code.

        Args:
            is_batch: Whether to return the procedure for batches, not that for one sample.

        Returns:
            The procedure.
        """
        return self._main.procedure(is_batch)

    @abstractmethod
    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Evaluator.evaluate`.

        Args:
            inputs: An array (samples, size) for each input.
            outputs: An array (samples, size) for each output, C-contiguous; overwritten.
        """


AnyRecursion = Recursion | Composition


class _SampleBySample(Composition):
    """What is evaluated sample by sample."""

    @final
    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        for k in range(len(outputs[0])):
            self._evaluate_one([x[k : k + 1] for x in inputs], [x[k : k + 1] for x in outputs])

    @abstractmethod
    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes one sample."""


@final
class WithFriction(Composition):
    """Inverse or forward dynamics with the friction of the joints; v is the second input, tau the third or the output.

    Args:
        frictionless: The recursion without.
        law: The friction.
        is_forward: Whether torques come in, not out.
    """

    def __init__(self, frictionless: AnyRecursion, law: Friction, is_forward: bool) -> None:
        super().__init__(frictionless.outputs, frictionless)
        self._law, self._is_forward = law, is_forward

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Composition.evaluate`."""
        q, v, last, *rest = inputs
        torque = friction_torque(v, self._law)
        if self._is_forward:
            self._main.evaluate([q, v, last + torque, *rest], outputs)
        else:
            self._main.evaluate(inputs, outputs)
            np.subtract(outputs[0], torque, out=outputs[0])


@final
class MimicMatrices(_SampleBySample):
    """Matrices of a robot with mimic joints, made of those with a column for every joint.

    A column of a mimic joint is that of its own motion times its multiplier; what belongs to one entry of v is added.

    Args:
        columns: The recursion of the tree in which every column of a motion subspace has its own entry of velocity.
        entries: The entry of v that every column belongs to, shape (columns,).
        armature: That of the joints, shape (nv,) [kg m^2 or kg], for the last output if it is a mass matrix; else None.
        nv: How many entries v has.
    """

    def __init__(self, columns: Recursion, entries: np.ndarray, armature: Floats | None, nv: int) -> None:
        super().__init__(((nv, nv),) * len(columns.outputs), columns)
        self._entries, self._armature, self._size = entries, armature, nv
        self._shapes = columns.outputs
        self._are_velocities = [len(shape) == 1 for shape in columns.inputs[1:]]

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, *others = inputs
        kinds = zip(others, self._are_velocities, strict=True)
        expanded = [x[:, self._entries] if is_velocity else x for x, is_velocity in kinds]
        matrices = [np.empty((1, shape[0] * shape[1])) for shape in self._shapes]
        self._main.evaluate([q, *expanded], matrices)
        for matrix, shape, output in zip(matrices, self._shapes, outputs, strict=True):
            output[0] = self._added(matrix.reshape(shape)).reshape(-1)
        if self._armature is not None:
            outputs[-1].reshape(self.outputs[-1])[np.diag_indices(self._size)] += self._armature

    def _added(self, matrix: Floats) -> Floats:
        rows = np.zeros((self._size, len(self._entries)))
        columns = np.zeros((self._size, self._size))
        for k, entry in enumerate(self._entries.tolist()):
            rows[entry] += matrix[k]
        for k, entry in enumerate(self._entries.tolist()):
            columns[entry] += rows[:, k]
        return columns.T


@final
class CentroidalResults(_SampleBySample):
    """What follows from the derivatives of the centroidal momentum at rest or without acceleration.

    Args:
        derivatives: Those of the momentum by q, and of its rate by q, v and a.
        outputs: The shapes of the results.
        combine: Makes the results of the four matrices.
    """

    def __init__(
        self, derivatives: Recursion, outputs: tuple[Shape, ...], combine: Callable[..., Sequence[Floats]]
    ) -> None:
        super().__init__(outputs, derivatives)
        self._shapes, self._combine = derivatives.outputs, combine

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, v = inputs
        matrices = [np.empty((1, shape[0] * shape[1])) for shape in self._shapes]
        self._main.evaluate([q, v, np.zeros(v.shape)], matrices)
        shaped = (matrix.reshape(shape) for matrix, shape in zip(matrices, self._shapes, strict=True))
        for output, result in zip(outputs, self._combine(*shaped), strict=True):
            output[0] = result.reshape(-1)


class Couplings(NamedTuple):
    """Which columns of motion subspaces move together.

    Attributes:
        entries: The entry of v that every column belongs to, (columns,).
        sources: A column of every entry of v, (nv,).
        followers: The other columns, (m,).
        leaders: The column among `sources` that each of them follows, (m,).
    """

    entries: np.ndarray
    sources: np.ndarray
    followers: np.ndarray
    leaders: np.ndarray

    @classmethod
    def of(cls, entries: np.ndarray) -> Couplings:
        """Those of columns.

        Args:
            entries: The entry of v that every column belongs to, (columns,).

        Returns:
            The couplings.
        """
        sources = np.unique(entries, return_index=True)[1]
        followers = np.setdiff1d(np.arange(len(entries)), sources)
        return cls(entries, sources, followers, sources[entries[followers]])

    def jacobian(self) -> Floats:
        """The Jacobian of the couplings, (m, columns): the velocity of each follower less that of its leader."""
        J = np.zeros((len(self.followers), len(self.entries)))
        rows = np.arange(len(self.followers))
        J[rows, self.followers], J[rows, self.leaders] = 1.0, -1.0
        return J


_LARGEST_RESIDUAL = 1e-9
"""Of torques that coupled accelerations take, beside the largest; beyond it the mass matrix is solved."""


@final
class CoupledAccelerations(_SampleBySample):
    """Forward dynamics of a robot of whose joints some mimic others, at a cost linear in the joints for each of these.

    Every joint moves by itself under forces that keep followers beside their leaders; these are found as those of
    constraints are. The result is checked by inverse dynamics. Where it is not precise, as where a follower moves no
    inertia of its own, `solved` computes it.

    Args:
        free: Forward dynamics of the tree in which every column has its own entry of velocity: of q, v, tau, and
            what comes after.
        response: The same of a weightless robot at rest.
        couplings: Which columns move together.
        torques: Inverse dynamics: of q, v, a, and what comes after.
        solved: Forward dynamics by the mass matrix.
    """

    def __init__(
        self,
        free: Recursion,
        response: Recursion,
        couplings: Couplings,
        torques: Recursion,
        solved: SolvedAccelerations,
    ) -> None:
        super().__init__(solved.outputs, free)
        self._response, self._torques = response.evaluator(), torques.evaluator()
        self._couplings, self._jacobian, self._solved = couplings, couplings.jacobian(), solved

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, v, tau, *rest = inputs
        c = self._couplings
        loads, free = np.zeros((1, len(c.entries))), np.empty((1, len(c.entries)))
        loads[:, c.sources] = tau
        self._main.evaluate([q, v[:, c.entries], loads, *rest], [free])
        X = np.empty(self._jacobian.shape)
        self._response.evaluate([np.repeat(q, len(X), axis=0), np.zeros(X.shape), self._jacobian], [X])
        try:
            G = X[:, c.followers] - X[:, c.leaders]
            forces = np.linalg.solve(G.T, free[0, c.leaders] - free[0, c.followers])
        except np.linalg.LinAlgError:
            self._solved.evaluate(inputs, outputs)
            return
        outputs[0][0] = (free[0] + forces @ X)[c.sources]
        taken, bias = np.empty(tau.shape), np.empty(tau.shape)
        self._torques.evaluate([q, v, outputs[0], *rest], [taken])
        self._torques.evaluate([q, v, np.zeros(v.shape), *rest], [bias])
        size = max(np.abs(tau).max(), np.abs(bias).max())
        if not np.abs(taken - tau).max() <= _LARGEST_RESIDUAL * size:  # also where it is nan
            self._solved.evaluate(inputs, outputs)


@final
class SolvedAccelerations(_SampleBySample):
    """Forward dynamics of a robot with mimic joints: M a = tau - h.

    Args:
        bias: Torques h of q, v and what comes after tau.
        mass_matrix: M of q.
    """

    def __init__(self, bias: Recursion, mass_matrix: Recursion) -> None:
        super().__init__(bias.outputs, bias)
        self._mass_matrix: Any = mass_matrix.evaluator()
        self._shape = mass_matrix.outputs[0]

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, v, tau, *rest = inputs
        h, M = np.empty(tau.shape), np.empty((1, self._shape[0] * self._shape[1]))
        self._main.evaluate([q, v, *rest], [h])
        self._mass_matrix.evaluate([q], [M])
        outputs[0][0] = np.linalg.solve(M.reshape(self._shape), (tau - h)[0])


@final
class InverseOfMassMatrix(_SampleBySample):
    """The inverse mass matrix of a robot with mimic joints.

    Args:
        mass_matrix: M of q.
    """

    def __init__(self, mass_matrix: Recursion) -> None:
        super().__init__(mass_matrix.outputs, mass_matrix)

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        self._main.evaluate(inputs, outputs)
        inverse = np.linalg.inv(outputs[0].reshape(self.outputs[0]))
        outputs[0][0] = (0.5 * (inverse + inverse.T)).reshape(-1)


@final
class DerivativesOfAccelerations(_SampleBySample):
    """-M^-1 dtau/dq, -M^-1 dtau/dv and M^-1, at the acceleration of forward dynamics [Carpentier & Mansard 2018].

    Args:
        accelerations: Forward dynamics.
        derivatives: Derivatives of inverse dynamics.
        inverse: The inverse mass matrix.
    """

    def __init__(
        self,
        accelerations: AnyRecursion,
        derivatives: AnyRecursion,
        inverse: AnyRecursion,
    ) -> None:
        super().__init__(derivatives.outputs, derivatives)
        self._accelerations: Any = accelerations.evaluator()
        self._inverse: Any = inverse.evaluator()

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, v, _tau, *rest = inputs
        *results, inverse = outputs
        a = np.empty(v.shape)
        self._accelerations.evaluate(inputs, [a])
        torque_derivatives = [np.empty(x.shape) for x in outputs]  # by q and v; the third, by a, is not used
        self._main.evaluate([q, v, a, *rest], torque_derivatives)
        self._inverse.evaluate([q], [inverse])
        shape = self.outputs[0]
        for derivative, result in zip(torque_derivatives, results, strict=False):
            np.matmul(inverse.reshape(shape), derivative.reshape(shape), out=result.reshape(shape))
            np.negative(result, out=result)
