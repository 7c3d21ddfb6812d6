"""Asks RobotWrapper and its geometries, of Ulna's package or of Pinocchio, for what both answer alike."""

import json
import os
import sys
from typing import Any

import numpy as np
import pinocchio as pin
from pinocchio.robot_wrapper import RobotWrapper

ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "ur_description/srdf/ur5.srdf", ""),
    "panda_collision": (
        "panda_description/urdf/panda_collision.urdf",
        "panda_description/srdf/panda.srdf",
        "default",
    ),
    "solo12": ("solo_description/robots/solo12.urdf", "solo_description/srdf/solo.srdf", "standing"),
}


def placed(M: Any) -> list[Any]:
    return np.array(M.homogeneous).tolist()


def geometries(model: Any) -> list[Any]:
    return [
        [
            g.name,
            int(g.parentJoint),
            int(g.parentFrame),
            os.path.normpath(g.meshPath),
            bool(g.overrideMaterial),
            type(g.geometry).__name__,
            np.array(g.meshScale).tolist(),
            np.round(np.array(g.meshColor), 6).tolist(),
            placed(g.placement),
        ]
        for g in model.geometryObjects
    ]


def answers(robot: Any, srdf: str, posture: str) -> dict[str, Any]:
    model = robot.model
    pin.loadReferenceConfigurations(model, srdf, False)
    moved = 0.3 * np.cos(np.arange(model.nv))
    q = pin.integrate(model, robot.q0, moved)
    v, a = np.sin(np.arange(model.nv)), np.cos(2.0 * np.arange(model.nv))
    last = model.njoints - 1
    frame = model.nframes - 1
    out: dict[str, Any] = {
        "visual": geometries(robot.visual_model),
        "collision": geometries(robot.collision_model),
    }
    if posture:
        out["posture"] = np.array(model.referenceConfigurations[posture]).tolist()
    out["com"] = [np.array(x).tolist() for x in robot.com(q, v, a)]
    out["vcom"], out["acom"] = robot.vcom(q, v).tolist(), robot.acom(q, v, a).tolist()
    out["momentum"] = robot.centroidalMomentum(q, v).vector.tolist()
    out["map"] = np.array(robot.centroidalMap(q)).tolist()
    out["variation"] = robot.centroidalMomentumVariation(q, v, a).vector.tolist()
    out["velocity"] = robot.velocity(q, v, last).vector.tolist()
    out["velocity world"] = robot.velocity(q, v, last, True, pin.WORLD).vector.tolist()
    out["acceleration"] = robot.acceleration(q, v, a, last).vector.tolist()
    out["classical"] = robot.classicalAcceleration(q, v, a, last).vector.tolist()
    out["frame"] = placed(robot.framePlacement(q, frame))
    out["frame jacobian"] = robot.computeFrameJacobian(q, frame).tolist()
    out["jacobian"] = robot.computeJointJacobian(q, last).tolist()
    out["all"] = robot.computeJointJacobians(q).tolist()
    out["joint jacobian"] = robot.getJointJacobian(last).tolist()
    robot.updateGeometryPlacements(q, visual=True)
    robot.updateGeometryPlacements(q)
    out["oMg"] = [placed(M) for M in robot.visual_data.oMg] + [placed(M) for M in robot.collision_data.oMg]
    reduced = robot.buildReducedRobot([model.names[last], last - 1])
    out["reduced"] = [reduced.nq, reduced.nv, list(reduced.model.names), geometries(reduced.visual_model)]
    pairs = robot.collision_model
    pairs.addAllCollisionPairs()
    out["pairs"] = len(pairs.collisionPairs)
    pin.removeCollisionPairs(model, pairs, srdf, False)
    out["pairs kept"] = [[int(p.first), int(p.second)] for p in pairs.collisionPairs]
    robot.rebuildData()
    robot.forwardKinematics(robot.q0)
    touching = pin.computeCollisions(model, robot.data, pairs, robot.collision_data, q, False)
    hits = [
        k for k in range(len(pairs.collisionPairs)) if pin.computeCollision(pairs, robot.collision_data, k)
    ]
    out["touching"] = [bool(touching), hits]
    nearest = pin.computeDistances(model, robot.data, pairs, robot.collision_data, q)
    if len(pairs.collisionPairs):
        out["nearest"] = float(robot.collision_data.distanceResults[nearest].min_distance)
    return out


def main(out: str, folder: str) -> None:
    found = {}
    for name, (urdf, srdf, posture) in ROBOTS.items():
        robot = RobotWrapper.BuildFromURDF(f"{folder}/robots/{urdf}", [folder + "/.."])
        found[name] = answers(robot, f"{folder}/robots/{srdf}", posture)
    with open(out, "w", encoding="utf-8") as file:
        file.write(json.dumps({"file": pin.__file__, "found": found}))


main(*sys.argv[1:])
