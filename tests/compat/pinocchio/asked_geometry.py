"""What Ulna's package and Pinocchio are both asked about geometries of files, of models put together, and of pairs."""

import json
import sys

import numpy as np
import pinocchio as pin
from asked import answers

FILES = """
! v = pin.buildModelFromUrdf(urdf); c = pin.buildGeomFromUrdf(v, urdf, pin.GeometryType.COLLISION, package_dirs=share)
! c.addAllCollisionPairs(); pin.removeCollisionPairs(v, c, srdf); d = v.createData(); x = c.createData()
[o.geometry.num_vertices for o in c.geometryObjects if hasattr(o.geometry, "num_vertices")]; [type(o.geometry).__name__ for o in c.geometryObjects]
! q = rng.normal(size=v.nq); pin.updateGeometryPlacements(v, d, c, x, q)
pin.computeCollisions(c, x); pin.computeDistances(c, x); [r.min_distance for r in x.distanceResults]
[np.array(r.getNearestPoint1()) for r in x.distanceResults]; [r.numContacts() for r in x.collisionResults]
pin.computeCollisions(geometry_model=c, geometry_data=x, stop_at_first_collision=True); pin.computeDistance(c, x, pair_index=2).min_distance
! h = pin.buildModelFromUrdf(humanoid); o = pin.buildGeomFromUrdf(h, humanoid, pin.GeometryType.COLLISION, share).geometryObjects
[type(g.geometry).__name__ for g in o]; [g.meshPath[-7:] for g in o]; o[0].geometry.radius; o[1].geometry.num_points
"""

MASSLESS = """
<robot name="r"><link name="a"/><link name="b"><visual><geometry><box size="1 1 1"/></geometry><material name="m"/></visual>
</link><joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>
"""
BARE = """
! m = pin.buildModelFromXML(massless); g = pin.buildGeomFromUrdfString(m, massless, pin.GeometryType.VISUAL)
m.nbodies; m.nframes; g.geometryObjects[0].overrideMaterial; g.geometryObjects[0].meshColor
"""

TOGETHER = """
! m = pin.buildSampleModelHumanoid(); g = pin.buildSampleGeometryModelHumanoid(m); g.addAllCollisionPairs()
! a = pin.buildSampleModelManipulator(); b = pin.buildSampleGeometryModelManipulator(a); b.addAllCollisionPairs()
! b.addGeometryObject(pin.GeometryObject("foot", 0, 0, place, pin.hppfcl.Box(1, 1, 1)))
! w, u = pin.appendModel(m, a, g, b, frame_in_modelA=m.getFrameId("larm_effector_body"), aMb=place)
[o.name for o in u.geometryObjects]; [o.parentJoint for o in u.geometryObjects]; [o.parentFrame for o in u.geometryObjects]
[o.placement for o in u.geometryObjects]; [[p.first, p.second] for p in u.collisionPairs]; w.njoints
! q = pin.integrate(m, pin.neutral(m), rng.normal(size=m.nv))
! r, s = pin.buildReducedModel(m, geom_model=g, list_of_joints_to_lock=[3, 4, 9], reference_configuration=q)
r.njoints; [o.parentJoint for o in s.geometryObjects]; [o.placement for o in s.geometryObjects]; len(s.collisionPairs)
! g.geometryObjects[3].geometry = pin.hppfcl.Box(1, 2, 3); k = g.createData(); pin.updateGeometryPlacements(m, m.createData(), g, k, q)
pin.computeCollisions(g, k); [r.isCollision() for r in k.collisionResults]; g.geometryObjects[3].meshPath
! g.geometryObjects[3].geometry.halfSide = np.array([0.01, 0.01, 0.01])
pin.computeCollisions(g, k); [r.isCollision() for r in k.collisionResults]
"""

PAIRS = """
! p = pin.CollisionPair(1, 2); r = pin.CollisionPair(2, 1); n = pin.GeometryModel(); ball = pin.hppfcl.Sphere(1.0)
p == r; p != r; str(p); repr(p); pin.CollisionPair().first == pin.GeometryObject("a", 0, place, ball).parentFrame
! p.first = 5; o = pin.GeometryObject("a", 0, place, ball); _ = n.addGeometryObject(o), n.addGeometryObject(o), n.addGeometryObject(o); held = n.collisionPairs
p.first; n.ngeoms; n.getGeometryId("a"); str(n)
! n.geometryObjects[0].parentJoint = 1; n.addAllCollisionPairs(); n.addCollisionPair(pin.CollisionPair(1, 0))
len(held); n.findCollisionPair(pin.CollisionPair(2, 0)); n.collisionPairMapping
! c, k = n.copy(), n.clone(); n.geometryObjects[0].geometry.radius = 3.0
c.geometryObjects[0].geometry.radius; k.geometryObjects[0].geometry.radius; c == n; k == n
"""

if __name__ == "__main__":
    target, urdf, srdf, share, humanoid = sys.argv[1:]
    names = {
        "rng": np.random.default_rng(3),
        "urdf": urdf,
        "srdf": srdf,
        "share": share,
        "humanoid": humanoid,
    }
    names["massless"] = MASSLESS
    names["place"] = pin.XYZQUATToSE3(np.array([0.1, 0.2, 0.3, 0.0, 0.0, np.sin(0.2), np.cos(0.2)]))
    result = {}
    for group in (FILES, BARE, TOGETHER, PAIRS):
        result |= {f"{len(result)} {said}": value for said, value in answers(group, dict(names)).items()}
    with open(target, "w", encoding="utf-8") as out:
        out.write(json.dumps({"file": pin.__file__, "answers": result}))
