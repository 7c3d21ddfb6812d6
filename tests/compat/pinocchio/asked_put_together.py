"""Models that are put together and models with joints locked: asked of whichever pinocchio is imported, by a test."""

import json
import sys
import warnings

import coal
import numpy as np
import pinocchio as pin

warnings.simplefilter("ignore")
M = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.3), np.cos(0.3)]))


def described(model):
    """All of a model, in lists."""
    out = {"sizes": [model.nq, model.nv, model.nbodies, model.name], "names": list(model.names)}
    out["joints"] = [[j.shortname(), j.idx_q, j.idx_v] for j in list(model.joints)[1:]]
    out |= {
        "parents": [int(i) for i in model.parents],
        "limits": np.clip(model.upperPositionLimit, -9, 9).tolist(),
    }
    out["placements"] = [p.homogeneous.tolist() for p in list(model.jointPlacements)[1:]]
    out["inertias"] = [i.matrix().tolist() for i in model.inertias]
    out["frames"] = [[f.name, str(f.type), int(f.parentJoint), int(f.parentFrame)] for f in model.frames]
    out["frame placements"] = [f.placement.homogeneous.tolist() for f in model.frames]
    out["frame inertias"] = [f.inertia.matrix().tolist() for f in model.frames]
    out["postures"] = [[entry.key(), entry.data().tolist()] for entry in model.referenceConfigurations]
    return out


ARRAYS = (
    *(
        "armature",
        "damping",
        "rotorInertia",
        "rotorGearRatio",
        "lowerDryFrictionLimit",
        "upperDryFrictionLimit",
    ),
    *("lowerPositionLimit", "upperPositionLimit", "positionLimitMargin"),
    *("lowerVelocityLimit", "upperVelocityLimit", "lowerEffortLimit", "upperEffortLimit"),
)


def described_with_arrays(model):
    """The same, with what joints have for each entry of q or v, and gravity."""
    out = described(model)
    out |= {key: np.clip(getattr(model, key), -9, 9).tolist() for key in ARRAYS}
    out["indices"] = [[j.id, j.idx_vExtended, j.nq, j.nv, j.nvExtended] for j in list(model.joints)[1:]]
    return out | {"gravity": model.gravity.vector.tolist(), "nvExtended": int(model.nvExtended)}


def numbered(model):
    """A model whose numbers all differ."""
    for k, key in enumerate(ARRAYS):
        setattr(model, key, np.linspace(1.0, 2.0, getattr(model, key).size) + k)
    model.gravity.linear = np.array([0.1, 0.2, -9.0])
    return model


def many_kinds():
    """A tree of joints of many kinds, two of them after one, with frames between them."""
    model = pin.Model()
    kinds = (
        *(pin.JointModelFreeFlyer(), pin.JointModelRevoluteUnaligned(np.array([0.6, 0.0, 0.8]))),
        *(pin.JointModelPZ(), pin.JointModelSpherical(), pin.JointModelRY(), pin.JointModelRUBX()),
        *(pin.JointModelPrismaticUnaligned(np.array([0.6, 0.8, 0.0])), pin.JointModelPlanar()),
    )
    for k, (kind, parent) in enumerate(zip(kinds, (0, 1, 2, 2, 4, 5, 1, 7), strict=True)):
        place = pin.XYZQUATToSE3(np.array([0.1 * k, 0.2, 0.3, 0.0, np.sin(k), 0.0, np.cos(k)]))
        joint = model.addJoint(parent, kind, place, f"joint {k}")
        model.appendBodyToJoint(joint, pin.Inertia.FromBox(1.0 + k, 0.2, 0.3, 0.4), M)
        model.addJointFrame(joint)
        model.addBodyFrame(f"body {k}", joint, M, -1)
    return model


def reduced(found):
    """Models of many kinds of joints, and with joints that follow others, without some."""
    model = numbered(many_kinds())
    q = pin.integrate(model, pin.neutral(model), np.linspace(-1.0, 1.0, model.nv))
    for locked in ([1], [2], [3, 7], [4], [6, 5], [8], [2, 4, 7, 8], [8, 3, 1], list(range(1, 9))):
        found[f"kinds without {locked}"] = described_with_arrays(pin.buildReducedModel(model, locked, q))
    arm = numbered(pin.transformJointIntoMimic(pin.buildSampleModelManipulator(), 2, 5, 0.5, 0.1))
    q = np.linspace(0.2, 0.9, arm.nq)
    for locked in ([1], [5], [6], [2, 5], [5, 3], [1, 4, 6], [3, 2, 5]):
        found[f"mimic without {locked}"] = described_with_arrays(pin.buildReducedModel(arm, locked, q))


def solids(model, name):
    """A geometry model with a ball on some joints, in no order."""
    out = pin.GeometryModel()
    for joint in (model.njoints - 1, 1, 0):
        frame = next(k for k, f in enumerate(model.frames) if f.parentJoint == joint)
        out.addGeometryObject(pin.GeometryObject(f"{name}{joint}", joint, frame, M, coal.Sphere(0.1)))
    out.addCollisionPair(pin.CollisionPair(0, 1))
    return out


def all_of(geometries):
    shapes = [
        [g.name, int(g.parentJoint), int(g.parentFrame), g.placement.homogeneous.tolist()]
        for g in geometries.geometryObjects
    ]
    return [shapes, [[int(pair.first), int(pair.second)] for pair in geometries.collisionPairs]]


def main(target, *files):
    found = {}
    arm, legs, second = (
        pin.buildModelFromUrdf(file, *([pin.JointModelFreeFlyer()] if "solo" in file else []))
        for file in files
    )
    for frame in second.frames:
        frame.name = frame.name if frame.name == "universe" else "second " + frame.name
    for k in range(1, second.njoints):
        second.names[k] = "second " + second.names[k]
    for model, scale in ((arm, 1.0), (legs, 2.0), (second, 3.0)):
        model.referenceConfigurations["home"] = scale * np.arange(1.0, model.nq + 1.0)
    second.referenceConfigurations["its own"] = pin.neutral(second) + 7.0
    for name, model in (("arm", arm), ("legs", legs)):
        n = model.njoints
        q = pin.integrate(model, pin.neutral(model), np.linspace(-1.0, 1.0, model.nv))
        for locked in ([1], [n - 1], [2, 4], [4, 2, 3], list(range(2, n)), list(range(1, n)), []):
            found[f"{name} without {locked}"] = described(pin.buildReducedModel(model, locked, q))
        for frame in (0, 1, model.nframes // 2, model.nframes - 1):
            both, shapes = pin.appendModel(model, second, solids(model, "a"), solids(second, "b"), frame, M)
            found[f"{name} and another on frame {frame}"] = described(both) | {"shapes": all_of(shapes)}
    reduced(found)
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": found}))


if __name__ == "__main__":
    main(*sys.argv[1:])
