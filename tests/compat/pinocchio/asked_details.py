"""Signs of quaternions, joint 0, frames added twice and loaded robots: asked of whichever pinocchio is imported, by a test."""

from __future__ import annotations

import json
import sys
import warnings
from typing import Any

import numpy as np
import pinocchio as pin

warnings.simplefilter("ignore")


def integrated() -> list[Any]:
    """Free flyers turned by up to two turns, from several orientations; alone, in a composite, as a Lie group."""
    free = pin.buildModelFromXML('<robot name="r"><link name="a"/></robot>', pin.JointModelFreeFlyer())
    turn = np.array([0.0, 0.6, 0.8])
    found = []
    for angle in (1.0, 3.1, 3.2, 4.0, 6.2, 6.4, 9.0, 13.0):
        v = np.array([0.1, 0.2, 0.3, *(angle * turn)])
        for quat in ([0, 0, 0, 1.0], [0.5, 0.5, 0.5, 0.5], [0.5, 0.5, 0.5, -0.5], [0, 1.0, 0, 0]):
            q = np.array([1.0, 2.0, 3.0, *quat])
            found.append(pin.integrate(free, q, v).tolist())
            found.append(pin.liegroups.SE3().integrate(q, v).tolist())
            found.append(pin.liegroups.SO3().integrate(q[3:], v[3:]).tolist())
            pair = pin.liegroups.SE3() * pin.liegroups.R1()
            found.append(pair.integrate(np.append(q, 0.5), np.append(v, 0.1)).tolist())
    return found


def split() -> list[Any]:
    """Roll, pitch and yaw of rotations whose pitch is a right angle, with first columns that divide the turn."""
    found = []
    for s in (1.0, -1.0):
        for r in (0.0, 0.3, -2.5):
            R = np.array([[0, s * np.sin(r), s * np.cos(r)], [0, np.cos(r), -np.sin(r)], [-s, 0, 0]])
            found.append(pin.rpy.matrixToRpy(R).tolist())
    for first, second in ((1e-17, 0.0), (1e-17, 1e-17), (1e-16, 1e-17), (1e-16, 2e-16), (-1e-17, 2e-16)):
        R = np.array([[first, 0.6, 0.8], [second, 0.8, -0.6], [-1.0, 0, 0]])
        found.append(pin.rpy.matrixToRpy(R).tolist())
    return found


def joints_and_frames() -> list[Any]:
    model = pin.buildSampleModelManipulator()
    first = model.joints[0]
    found: list[Any] = [first.nq, first.nv, first.nvExtended, list(model.nqs), list(model.nvs)]
    found += [model.addFrame(model.frames[k]) for k in (0, 1, 2, 5)]
    tool = pin.Frame("tool", 2, 1, pin.SE3.Identity(), pin.FrameType.OP_FRAME)
    other = pin.Frame("tool", 3, 1, pin.SE3.Identity(), pin.FrameType.OP_FRAME)
    return [*found, model.addFrame(tool), model.addFrame(tool), model.addFrame(other), model.nframes]


def transforms() -> list[Any]:
    """What takes an SE3 takes a transform of coal."""
    import coal

    M = pin.exp6(np.arange(6.0) / 10.0)
    there = coal.Transform3s(M.rotation, M.translation)
    model = pin.buildSampleModelManipulator()
    model.addJoint(6, pin.JointModelRX(), there, "wrist")
    places = [M * there, M.act(there), M.actInv(there), model.jointPlacements[7]]
    places += [pin.Frame("tool", 2, 1, there, pin.FrameType.OP_FRAME).placement]
    places += [pin.GeometryObject("ball", 0, there, coal.Sphere(0.1)).placement]
    arrays = [place.homogeneous for place in places]
    arrays += [pin.log6(there).vector, pin.SE3ToXYZQUAT(there), [float(M.isApprox(there))]]
    return [np.ravel(array).tolist() for array in arrays]


def loaded(urdf: str, srdf: str, posture: str) -> list[Any]:
    """What a loader of example-robot-data does, step by step; the package's own loader is compared with it."""
    model = pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer())
    pin.loadRotorParameters(model, srdf, False)
    model.armature = np.multiply(model.rotorInertia, np.square(model.rotorGearRatio))
    pin.loadReferenceConfigurations(model, srdf, False)
    q = pin.normalize(model, model.referenceConfigurations[posture].copy())
    return [model.armature.tolist(), q.tolist()]


if __name__ == "__main__":
    target, *files = sys.argv[1:]
    answers = {
        "integrate": integrated(),
        "rpy": split(),
        "joints and frames": joints_and_frames(),
        "transforms": transforms(),
        "loaded": loaded(*files),
    }
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": answers}))
