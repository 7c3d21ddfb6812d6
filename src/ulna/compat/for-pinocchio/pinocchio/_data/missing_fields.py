"""What is said of fields that a Data does not have: intermediate results of recursions that are compiled as a whole."""

from __future__ import annotations

from collections.abc import Iterable

from ulna.errors import nearest

_ALTERNATIVES = {
    "B dAdq dAdv": "data.C after computeCoriolisMatrix, and the matrices of computeRNEADerivatives",
    "Fcrb": "data.M after crba, and data.Ag after ccrba",
    "oYaba_augmented of_augmented": "data.ddq after aba, data.Yaba, and data.Minv after computeMinverse",
    "dac_dq dac_dv dvc_dq": "data.ddq_dq and data.ddq_dv after computeConstraintDynamicsDerivatives",
    "oK oL": "data.oMi, data.oMf and the results of constraintDynamics",
    "lambda_c_prox primal_dual_contact_solution primal_rhs_contact": "data.lambda_c and data.ddq after "
    "constraintDynamics",
}
_READ = {name: instead for names, instead in _ALTERNATIVES.items() for name in names.split()}


def missing_field_message(name: str, fields: Iterable[str]) -> str:
    """What to read instead of a field that a Data does not have.

    Args:
        name: The name.
        fields: Those that it has.

    Returns:
        The message.
    """
    text = f"Data has no field {name!r}"
    if name in _READ:
        return f"{text}: intermediate results of recursions are not kept. Read {_READ[name]}."
    near = nearest(name, fields, 1, 0.6)
    return f"{text}. Did you mean {near[0]!r}?" if near else f"{text}; dir(data) lists its fields."
