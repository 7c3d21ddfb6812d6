"""Calls by position whose overloads are distinguished by types, asked of the package and of Pinocchio.

`python asked_positions.py out.json ur5.urdf panda.urdf packages`
"""

import json
import sys

import numpy as np
import pinocchio as pin

CALLS = """
built(pin.buildModelsFromUrdf(f, [packages], FF, False, None, pin.VISUAL))
built(pin.buildModelsFromUrdf(f, [packages], FF, "base", False, None, [pin.COLLISION]))
built(pin.buildModelsFromUrdf(f, [packages], FF, "base", False, None, []))
built(pin.buildModelsFromUrdf(panda, [], None, False, None, [], True))
built(pin.buildModelsFromUrdf(panda, [], FF, False, None, [], True))
built((pin.buildModelFromUrdf(panda, True),))
built((pin.buildModelFromUrdf(panda, FF, True),))
built((pin.buildModelFromUrdf(panda, FF, "base", True),))
built((pin.buildModelFromUrdf(panda, kept(pin.Model()), True),))
built((pin.buildModelFromUrdf(panda, FF, kept(pin.Model()), True),))
built((pin.buildModelFromUrdf(panda, FF, "base", kept(pin.Model()), False),))
built((pin.RobotWrapper.BuildFromURDF(f, [packages], FF, "base").model,))
pin.centerOfMass(m, d, q, False); pin.centerOfMass(m, d, q, v, False); pin.centerOfMass(m, d, q, v, a, False)
pin.centerOfMass(m, d, True); pin.centerOfMass(m, d, pin.VELOCITY); pin.centerOfMass(m, d, pin.POSITION, False)
pin.jacobianCenterOfMass(m, d, q, False); pin.jacobianCenterOfMass(m, d, True); pin.jacobianCenterOfMass(m, d)
pin.jacobianSubtreeCenterOfMass(m, d, 2); pin.jacobianSubtreeCenterOfMass(m, d, q, 2)
pin.aba(m, d, q, v, a, pin.Convention.WORLD); pin.aba(m, d, q, v, a, forces, pin.Convention.LOCAL)
pin.aba(m, d, q, v, a, forces); pin.crba(m, d, q, pin.Convention.WORLD)
pin.getFrameJacobian(m, d, 3, pin.WORLD); pin.getFrameJacobian(m, d, 3, M, pin.WORLD)
pin.forwardDynamics(m, d, q, v, a, J, np.zeros(2), 0.1); pin.forwardDynamics(m, d, a, J, np.zeros(2), 0.1)
pin.impulseDynamics(m, d, q, v, J, 0.5, 0.1); pin.impulseDynamics(m, d, v, J, 0.5, 0.1)
"""


def built(models: tuple) -> list:
    model, *geometries = models
    return [list(model.names), model.nq, *([g.name for g in each.geometryObjects] for each in geometries)]


def kept(model: pin.Model) -> pin.Model:
    """The model, which lives on: Pinocchio returns a reference to what it was given."""
    KEPT.append(model)
    return model


KEPT: list[pin.Model] = []


def main() -> None:
    """Writes the answers."""
    f, panda, packages = sys.argv[2:5]
    m = pin.buildSampleModelManipulator()
    d, q, v, a = m.createData(), np.linspace(0.1, 0.6, 6), np.linspace(-1.0, 1.0, 6), np.ones(6)
    forces = pin.StdVec_Force()
    forces.extend([pin.Force(np.arange(6.0)) for _ in range(m.njoints)])
    names = {
        "pin": pin,
        "np": np,
        "m": m,
        "d": d,
        "q": q,
        "v": v,
        "a": a,
        "f": f,
        "panda": panda,
        "built": built,
    }
    names |= {
        "M": pin.SE3(np.eye(3), np.ones(3)),
        "J": np.eye(2, 6),
        "forces": forces,
        "FF": pin.JointModelFreeFlyer(),
    }
    names |= {"packages": packages, "kept": kept}
    pin.forwardKinematics(m, d, q, v, a)
    pin.computeJointJacobians(m, d, q)
    answers = {}
    for line in CALLS.strip().replace(";", "\n").splitlines():
        answer = eval(line.strip(), names)
        answers[line] = np.round(answer, 9).tolist() if isinstance(answer, np.ndarray) else answer
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": answers}))


if __name__ == "__main__":
    main()
