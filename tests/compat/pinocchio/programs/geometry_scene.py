"""A scene of shapes: pairs, distances, collisions, placements, and removed pairs."""

import numpy as np
import pinocchio as pin

try:
    import coal
except ImportError:
    import hppfcl as coal

np.set_printoptions(precision=5, suppress=True)
model = pin.buildSampleModelManipulator()
geometries = pin.buildSampleGeometryModelManipulator(model)
print(geometries.ngeoms, [g.name for g in geometries.geometryObjects][:4])
wall = pin.GeometryObject("wall", 0, pin.SE3(np.eye(3), np.array([0.6, 0.0, 0.3])), coal.Box(0.1, 2.0, 2.0))
wall.meshColor = np.array([0.8, 0.2, 0.2, 0.5])
index = geometries.addGeometryObject(wall)
for k in range(index):
    geometries.addCollisionPair(pin.CollisionPair(k, index))
geometries.addCollisionPair(pin.CollisionPair(0, index - 1))
print(len(geometries.collisionPairs), geometries.existCollisionPair(pin.CollisionPair(1, index)))
geometries.removeCollisionPair(pin.CollisionPair(1, index))
data, gdata = model.createData(), geometries.createData()
print(len(gdata.activeCollisionPairs), gdata.activeCollisionPairs[0])
rng = np.random.default_rng(1)
for trial in range(6):
    q = rng.uniform(-1.5, 1.5, model.nq)
    pin.updateGeometryPlacements(model, data, geometries, gdata, q)
    hit = pin.computeCollisions(geometries, gdata, False)
    nearest = pin.computeDistances(geometries, gdata)
    least = gdata.distanceResults[nearest].min_distance
    print(trial, bool(hit), nearest, round(max(least, 0.0), 5), gdata.oMg[3].translation)
pair = geometries.collisionPairs[2]
print(pair.first, pair.second, pair == pin.CollisionPair(pair.first, pair.second))
gdata.deactivateCollisionPair(2)
print(sum(bool(x) for x in gdata.activeCollisionPairs))
print(
    geometries.getGeometryId("wall") == index,
    geometries.existGeometryName("nothing"),
    geometries.getGeometryId("nothing") == geometries.ngeoms,
)
twin = geometries.copy() if hasattr(geometries, "copy") else geometries.clone()
print(twin.ngeoms, twin == geometries)
