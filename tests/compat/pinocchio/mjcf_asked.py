"""What Ulna's package and Pinocchio are both asked about MJCF files; answers go out as JSON.

`python mjcf_asked.py out.json folder`. The files lie in the folder; the answers are by file and question.
"""

import json
import sys
import warnings
from pathlib import Path

import numpy as np
import pinocchio as pin

KINDS = (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION)


def answers(file: str) -> dict[str, object]:
    m = pin.buildModelFromMJCF(file)
    d, rng = m.createData(), np.random.default_rng(0)
    q = pin.integrate(m, pin.neutral(m), rng.normal(size=m.nv))
    v, a = rng.normal(size=(2, m.nv))
    pin.framesForwardKinematics(m, d, q)
    limits = (m.lowerPositionLimit, m.upperPositionLimit)
    free = (
        3 if m.joints[1].nq == 7 else 0
    )  # Pinocchio bounds where a free body may be by 1.01 m; nobody said so
    geometries = [pin.buildGeomFromMJCF(m, file, kind) for kind in KINDS]
    objects = [o for g in geometries for o in g.geometryObjects]
    return {
        "names": list(m.names),
        "joints": [j.shortname() for j in m.joints][1:],
        "frames": [f.name for f in m.frames],
        "types": [str(f.type) for f in m.frames],
        "parents": list(m.parents),
        "frame parents": [[f.parentJoint, f.parentFrame] for f in m.frames],
        "places": [M.homogeneous.tolist() for M in d.oMf],
        "masses": [Y.mass for Y in m.inertias],
        "M": np.triu(pin.crba(m, d, q)).tolist(),
        "tau": pin.rnea(m, d, q, v, a).tolist(),
        "limits": np.nan_to_num([x[free:] for x in limits], posinf=9e9, neginf=-9e9).tolist(),
        "losses": [m.damping.tolist(), m.armature.tolist(), m.upperDryFrictionLimit.tolist()],
        "gravity": m.gravity.linear.tolist(),
        "configurations": sorted(_configurations(m)),
        "loops": _loops(file) if "connect" in Path(file).read_text() else [],
        "on a joint": [] if "keyframe" in Path(file).read_text() else _on_a_joint(file),
        "geometries": [[o.parentJoint, o.parentFrame] for o in objects],
        "geometry places": [o.placement.homogeneous.tolist() for o in objects],
        "kinds": [o.meshPath for o in objects],
        "colours that were given": [
            o.meshColor.tolist() for o in geometries[0].geometryObjects if 0.0 in o.meshColor
        ],
    }


def _loops(file: str) -> list[list[float]]:
    """Joints, points and the first frame's axes of each constraint, on a floating base."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        _, constraints = pin.buildModelFromMJCF(file, pin.JointModelFreeFlyer(), "root")
    return [
        [
            c.type == pin.ContactType.CONTACT_6D,
            c.joint1_id,
            c.joint2_id,
            *c.joint1_placement.homogeneous.ravel(),
        ]
        + c.joint2_placement.translation.tolist()
        for c in constraints
    ]


def _on_a_joint(file: str) -> list[str]:
    """Joints and frames with a root joint, which counts where the first body has none."""
    m = pin.buildModelAndConstraintsFromMJCF(file, pin.JointModelRX(), "root")[0]
    frames = [f"{f.name} {f.type} {f.parentJoint} {f.parentFrame}" for f in m.frames]
    return [*m.names, *frames, *(str(j.nq) for j in m.joints[1:])]


def _configurations(m: pin.Model) -> list[list[object]]:
    found = m.referenceConfigurations
    pairs = found.items() if hasattr(found, "items") else ((x.key(), x.data()) for x in found)
    return [[name, q.tolist()] for name, q in pairs]


if __name__ == "__main__":
    out, folder = sys.argv[1:]
    found = {file.stem: answers(str(file)) for file in sorted(Path(folder).glob("*.xml"))}
    Path(out).write_text(json.dumps({"file": pin.__file__, "answers": found}), encoding="utf-8")
