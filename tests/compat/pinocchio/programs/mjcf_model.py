"""An MJCF model from text: joints, frames, limits, inertias, geometries, and a keyframe."""

import os
import tempfile

import numpy as np
import pinocchio as pin

np.set_printoptions(precision=5, suppress=True)
text = """<mujoco model="crane">
  <compiler angle="degree" autolimits="true"/>
  <default><joint armature="0.01" damping="0.1"/><geom density="500"/></default>
  <worldbody>
    <body name="column" pos="0 0 1">
      <joint name="turn" type="hinge" axis="0 0 1" range="-170 170"/>
      <geom name="post" type="cylinder" size="0.05 0.5"/>
      <body name="arm" pos="0 0 0.5" euler="0 20 0">
        <joint name="lift" type="hinge" axis="0 1 0" range="-60 60"/>
        <inertial pos="0.3 0 0" mass="2" diaginertia="0.01 0.1 0.1"/>
        <geom name="beam" type="box" size="0.3 0.03 0.03" pos="0.3 0 0"/>
        <body name="hook" pos="0.6 0 0">
          <joint name="reel" type="slide" axis="0 0 -1"/>
          <geom name="ball" type="sphere" size="0.06" mass="0.5"/>
          <site name="tip" pos="0 0 -0.06"/>
        </body>
      </body>
    </body>
  </worldbody>
  <keyframe><key name="ready" qpos="0.1 0.2 0.3"/></keyframe>
</mujoco>"""
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "crane.xml")
    with open(path, "w") as file:
        file.write(text)
    model = pin.buildModelFromMJCF(path)
    geometries = pin.buildGeomFromMJCF(model, path, pin.COLLISION)
print(model.name, model.njoints, model.nq, [str(n) for n in model.names])
print([(f.name, f.parentJoint, str(f.type)) for f in model.frames])
print(model.lowerPositionLimit, model.upperPositionLimit)
print(model.armature, model.damping)
for inertia in list(model.inertias)[1:]:
    print(round(inertia.mass, 5), inertia.lever, np.diag(inertia.inertia))
print(sorted(entry.key() for entry in model.referenceConfigurations))
print([g.name for g in geometries.geometryObjects], geometries.ngeoms)
data = model.createData()
q = np.array([0.3, -0.2, 0.4])
pin.framesForwardKinematics(model, data, q)
print(data.oMf[model.getFrameId("tip")])
print(pin.rnea(model, data, q, np.ones(3), np.zeros(3)))
