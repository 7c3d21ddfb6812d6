"""The arrays of a Data, each made when it is first needed."""

from __future__ import annotations

from typing import final

import numpy as np

from pinocchio._model.building import KinematicTree
from ulna.typing import Floats

MATRICES = {
    "M": "vv",
    "Minv": "vv",
    "C": "vv",
    "J": "6v",
    "dJ": "6v",
    "Ag": "6v",
    "dAg": "6v",
    "Jcom": "3v",
    "tau": "v",
    "nle": "v",
    "g": "v",
    "ddq": "v",
    "dtau_dq": "vv",
    "dtau_dv": "vv",
    "ddq_dq": "vv",
    "ddq_dv": "vv",
    "ddq_dtau": "vv",
    "dHdq": "6v",
    "dFdq": "6v",
    "dFdv": "6v",
    "dFda": "6v",
    "dAdq": "6v",
    "dAdv": "6v",
    "kineticEnergyRegressor": "p",
    "potentialEnergyRegressor": "p",
    "jointTorqueRegressor": "vp",
    "staticRegressor": "3s",
    "bodyRegressor": "6t",
    "dq_after": "v",
    "osim": "00",
    "lambda_c": "0",
    "impulse_c": "0",
    "dlambda_dq": "00",
    "dlambda_dv": "00",
    "dlambda_dtau": "00",
    "dac_da": "00",
    **dict.fromkeys(("dac_dq", "dac_dv", "dvc_dq"), "00"),
    **dict.fromkeys(("lambda_c_prox", "primal_dual_contact_solution", "primal_rhs_contact"), "0"),
}
"""A letter for each size. Those of constraints are empty until an algorithm knows how many rows there are."""
FORCES = ("f", "h", "of", "oh", "of_augmented")
MOTIONS = ("v", "a", "a_gf", "ov", "oa", "oa_gf")
CENTRES = ("com", "vcom", "acom")
MATRIX_LISTS = {"B": "n66", "Fcrb": "n6v", "oL": "n66", "oK": "n66", "oYaba_augmented": "n66"}
"""Fields that have a matrix for each joint."""
ARTICULATED_TERMS = {"Yaba": "n66", "oYaba": "n66", "U of bodies": "6v", "Dinv of bodies": "vv"}
"""What is computed with `Yaba`, whose mark stands for all of them."""
PER_JOINT = ("oMi", "liMi", *MOTIONS, *FORCES, *CENTRES)
UNUSED = {
    **{"q_in": "q", "v_in": "v", "a_in": "v", "tau_in": "v"},
    **{"vxI": "n66", "Ivx": "n66", "iMf": "n44"},
}
"""Fields that no algorithm reads or writes, in Pinocchio 4.1 as here; programs may keep something there."""
_SHAPES = {
    **MATRICES,
    **UNUSED,
    **MATRIX_LISTS,
    **ARTICULATED_TERMS,
    **dict.fromkeys(("oMi", "liMi"), "n44"),
    "oMf": "f44",
    **dict.fromkeys((*MOTIONS, *FORCES), "n6"),
    **dict.fromkeys(CENTRES, "n3"),
    "composite inertias": "ni",
    "U of mass": "vv",
    "D of mass": "v",
    **{
        "hg": "6",
        "dhg": "6",
        "Ig": "i",
        "energy K": "",
        "energy P": "",
        "energy K + P": "",
        "gravity by q": "vv",
        "mass changes": "",
        "subtree momenta": "",
    },
}
_INPUT_SHAPES = {"q": "q", "v": "v", "a": "v", "f": "m6"}


@final
class FieldArrays(dict[str, Floats]):
    """The arrays by the names of fields, and of stored inputs by names such as "rnea q"."""

    def __init__(self, model: KinematicTree) -> None:
        nj, nf, nv, bodies = model.njoints, model.nframes, model.nv, model.njoints - 1
        sizes = {"n": nj, "f": nf, "m": bodies, "v": nv, "q": model.nq, "p": 10 * bodies, "s": 4 * bodies}
        self._sizes = sizes | {"0": 0, "3": 3, "4": 4, "6": 6, "t": 10, "i": 13}
        self["a_gf"] = np.zeros((nj, 6))
        self["a_gf"][0] = -model.gravity.vector

    def __missing__(self, name: str) -> Floats:
        letters = _SHAPES[name] if name in _SHAPES else _INPUT_SHAPES[name[-1]]
        block = np.zeros([self._sizes[x] for x in letters])
        if letters.endswith("44"):
            block[...] = np.eye(4)
        return self.setdefault(name, block)  # another thread may have made it meanwhile

    def copied(self) -> FieldArrays:
        """A copy of all arrays."""
        out = FieldArrays.__new__(FieldArrays)
        out._sizes = self._sizes
        out.update({name: values.copy() for name, values in self.items()})
        return out

    def whole(self) -> dict[str, Floats]:
        """All of them."""
        for name in _SHAPES:
            self[name]
        return dict(self)


FILLED_BY = {
    "Ag": "computeCentroidalMap(model, data, q)",
    "Jcom": "jacobianCenterOfMass(model, data, q)",
    "Minv": "computeMinverse(model, data, q)",
    "Fcrb": "crba(model, data, q)",
    "dAdq": "computeRNEADerivatives(model, data, q, v, a)",
    "dFda": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dFdq": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dFdv": "computeCentroidalDynamicsDerivatives(model, data, q, v, a)",
    "dtau_dq": "computeRNEADerivatives(model, data, q, v, a)",
    "dtau_dv": "computeRNEADerivatives(model, data, q, v, a)",
    "dlambda_dtau": "computeConstraintDynamicsDerivatives(model, data, contact_models, contact_datas)",
    "g": "computeGeneralizedGravity(model, data, q)",
    "oa": "computeForwardKinematicsDerivatives(model, data, q, v, a)",
    "of": "computeRNEADerivatives(model, data, q, v, a)",
    "tau": "rnea(model, data, q, v, a)",
}
"""The call that fills a field that others invalidate."""
READ_INSTEAD = {
    "primal_rhs_contact": "An impact has none.",
    "oYaba_augmented": "Read data.ddq and the forces of the constraints.",
    "of_augmented": "Read data.ddq and the forces of the constraints.",
}
"""What to read in place of a field that an algorithm invalidates and no other fills."""
