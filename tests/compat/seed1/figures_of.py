"""Asks the faces, or real Pinocchio, for every figure that a table of recorded figures holds: figures_of.py in out."""

import json
import sys
from typing import Any

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

FRAMES = {
    "LOCAL": pin.LOCAL,
    "WORLD": pin.WORLD,
    "LOCAL_WORLD_ALIGNED": pin.LOCAL_WORLD_ALIGNED,
}


def placed(M: Any) -> dict[str, Any]:
    return {"rotation": M.rotation.copy(), "translation": M.translation.copy()}


def heavy(inertia: Any) -> dict[str, Any]:
    return {
        "mass": inertia.mass,
        "com": np.array(inertia.lever),
        "inertia_about_com": np.array(inertia.inertia),
    }


def answers(robot: Any, inputs: dict[str, Any], joint: int, frame: int) -> dict[str, Any]:
    model, data = robot.model, robot.data
    q, v, a, tau = (np.array(inputs[key]) for key in ("q", "v", "a", "tau"))
    out: dict[str, Any] = {"com": np.array(robot.com(q)), "Jcom": robot.Jcom(q), "M": robot.mass(q)}
    out |= {"nle": robot.nle(q, v), "gravity": robot.gravity(q)}
    out["rnea"] = pin.rnea(model, data, q, v, a)
    out["aba"] = pin.aba(model, data, q, v, tau)
    out["Minv"] = pin.computeMinverse(model, data, q)
    out["coriolis_matrix"] = pin.computeCoriolisMatrix(model, data, q, v)
    out["dtau_dq"], out["dtau_dv"] = (
        np.array(x) for x in pin.computeRNEADerivatives(model, data, q, v, a)[:2]
    )
    out["ddq_dq"], out["ddq_dv"] = (
        np.array(x) for x in pin.computeABADerivatives(model, data, q, v, tau)[:2]
    )
    out["kinetic_energy"] = pin.computeKineticEnergy(model, data, q, v)
    out["potential_energy"] = pin.computePotentialEnergy(model, data, q)
    momentum, matrix, inertia = robot.centroidal(q, v)
    out |= {"hg": np.array(momentum.vector), "Ag": np.array(matrix), "Ig": heavy(inertia)}
    pin.computeJointJacobiansTimeVariation(model, data, q, v)
    pin.updateFramePlacements(model, data)
    out["dJ_frame_LOCAL"] = pin.getFrameJacobianTimeVariation(model, data, frame, pin.LOCAL)
    robot.computeJointJacobians(q)
    pin.updateFramePlacements(model, data)
    out["J_frame"] = {name: robot.getFrameJacobian(frame, rf) for name, rf in FRAMES.items()}
    out["frame_velocity"] = {
        name: robot.frameVelocity(q, v, frame, True, rf).vector for name, rf in FRAMES.items()
    }
    out["frame_acceleration_LOCAL"] = robot.frameAcceleration(q, v, a, frame).vector
    out["frame_classical_acceleration_LWA"] = robot.frameClassicalAcceleration(
        q, v, a, frame, True, pin.LOCAL_WORLD_ALIGNED
    ).vector
    out["joint_placement"] = placed(robot.placement(q, joint))
    out["frame_placement"] = placed(robot.framePlacement(q, frame))
    out["oMi"] = [placed(M) for M in data.oMi]
    return out


def plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: plain(v) for key, v in value.items()}
    return [plain(v) for v in value] if isinstance(value, list) else np.asarray(value).tolist()


def main(table: str, out: str, folder: str) -> None:
    with open(table, encoding="utf-8") as file:
        inputs = json.load(file)
    found = {}
    for name, figures in inputs.items():
        root = pin.JointModelFreeFlyer() if figures["free_flyer"] else None
        robot = RobotWrapper.BuildFromURDF(f"{folder}/{figures['urdf']}", [folder + "/.."], root)
        model = robot.model
        joint, frame = model.getJointId(figures["joint"]), model.getFrameId(figures["frame"])
        found[name] = {
            "sizes": [model.nq, model.nv, model.njoints, model.nbodies, model.nframes],
            "names": list(model.names),
            "parents": [int(p) for p in model.parents],
            "total_mass": pin.computeTotalMass(model),
            "neutral": robot.q0,
            "visual_names": [g.name for g in robot.visual_model.geometryObjects],
            "collision_names": [g.name for g in robot.collision_model.geometryObjects],
            "configs": [answers(robot, c, joint, frame) for c in figures["configs"]],
        }
    with open(out, "w", encoding="utf-8") as file:
        file.write(json.dumps(plain(found)))


main(*sys.argv[1:])
