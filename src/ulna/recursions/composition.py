"""Derivatives of forward dynamics, from recursions and products of matrices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import final

import numpy as np

from ulna.compiler.procedures import Procedure
from ulna.recursions.recursion import Evaluator, Recursion
from ulna.typing import Floats


@final
class DerivativesOfAccelerations:
    """-M^-1 dtau/dq, -M^-1 dtau/dv and M^-1, at the acceleration of forward dynamics [Carpentier & Mansard 2018].

    Args:
        accelerations: Forward dynamics.
        derivatives: Derivatives of inverse dynamics.
        inverse: The inverse mass matrix.
    """

    def __init__(self, accelerations: Recursion, derivatives: Recursion, inverse: Recursion) -> None:
        self.outputs = derivatives.outputs
        self._accelerations, self._derivatives, self._inverse = map(
            Evaluator, (accelerations, derivatives, inverse)
        )

    def evaluator(self) -> DerivativesOfAccelerations:
        """The object that evaluates samples: this one."""
        return self

    def procedure(self, is_batch: bool) -> Procedure:
        """The procedure of the largest part, the derivatives of inverse dynamics, whose code `ir` shows.

        Args:
            is_batch: Whether to return the procedure for batches, not that for one sample.

        Returns:
            The procedure.
        """
        return self._derivatives.procedure(is_batch)

    def evaluate(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        """Computes samples; see `Evaluator.evaluate`.

        Args:
            inputs: An array (samples, size) for each input.
            outputs: An array (samples, size) for each output, C-contiguous; overwritten.
        """
        for k in range(len(outputs[0])):
            self._evaluate_one([x[k : k + 1] for x in inputs], [x[k : k + 1] for x in outputs])

    def _evaluate_one(self, inputs: Sequence[Floats], outputs: Sequence[Floats]) -> None:
        q, v, _tau = inputs
        *results, inverse = outputs
        a = np.empty(v.shape)
        self._accelerations.evaluate(inputs, [a])
        torque_derivatives = [np.empty(x.shape) for x in outputs]  # by q and v; the third, by a, is not used
        self._derivatives.evaluate([q, v, a], torque_derivatives)
        self._inverse.evaluate([q], [inverse])
        shape = self.outputs[0]
        for derivative, result in zip(torque_derivatives, results, strict=False):
            np.matmul(inverse.reshape(shape), derivative.reshape(shape), out=result.reshape(shape))
            np.negative(result, out=result)
