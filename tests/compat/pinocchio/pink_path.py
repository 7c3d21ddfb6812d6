"""The joints' path of pink's inverse kinematics: frame, posture and centre of mass, within limits."""

import json
import sys

import numpy as np
import pink
import pinocchio as pin
from pink.tasks import ComTask, FrameTask, PostureTask

target, urdf, root, frame = sys.argv[1:]
model = pin.buildModelFromUrdf(urdf, *([pin.JointModelFreeFlyer()] if root else []))
middle = np.clip(model.lowerPositionLimit, -1, 1) + np.clip(model.upperPositionLimit, -1, 1)
start = pin.neutral(model) if root else 0.5 * middle
configuration = pink.Configuration(model, model.createData(), start)
hand = FrameTask(frame, position_cost=1.0, orientation_cost=0.5, lm_damping=1.0)
posture, balance = PostureTask(cost=1e-3), ComTask(cost=1e-2)
step = pin.exp6(pin.Motion(np.array([0.1, -0.05, 0.08, 0.2, 0.1, -0.1])))
hand.set_target(configuration.get_transform_frame_to_world(frame) * step)
posture.set_target(start)
balance.set_target_from_configuration(configuration)
path = []
for _ in range(30):
    v = pink.solve_ik(configuration, [hand, posture, balance], 0.02, solver="daqp")
    configuration.integrate_inplace(v, 0.02)
    path.append(configuration.q.tolist())
with open(target, "w", encoding="utf-8") as out:
    out.write(json.dumps({"file": pin.__file__, "answers": path}))
