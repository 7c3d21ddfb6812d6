"""What is said of fields that a Data does not have: intermediate results of recursions that are compiled as a whole."""

from __future__ import annotations

from collections.abc import Iterable

from ulna.errors import nearest

_ALTERNATIVES = {
    "B Ivx vxI dAdq dAdv": "data.C after computeCoriolisMatrix, and the matrices of computeRNEADerivatives",
    "Fcrb": "data.M after crba, and data.Ag after ccrba",
    "Yaba oYaba oYaba_augmented a_in q_in tau_in v_in of_augmented": "data.ddq after aba, and data.Minv after "
    "computeMinverse",
    "dac_dq dac_dv dvc_dq": "data.ddq_dq and data.ddq_dv after computeConstraintDynamicsDerivatives",
    "iMf oK oL": "data.oMi, data.oMf and the results of constraintDynamics",
    "lambda_c_prox primal_dual_contact_solution primal_rhs_contact": "data.lambda_c and data.ddq after "
    "constraintDynamics",
    "mimic_parents_fromRow mimic_subtree_joint non_mimic_parents_fromRow idx_vExtended_to_idx_v_fromRow": "the joints' "
    "ids in model.mimicking_joints and model.mimicked_joints",
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
