"""Collision pairs, distances and margins of shapes of coal."""

import coal
import numpy as np
import pinocchio as pin

model = pin.buildSampleModelManipulator()
data = model.createData()
geom = pin.GeometryModel()
for i, (shape, z) in enumerate(
    [(coal.Sphere(0.1), 0.1), (coal.Capsule(0.08, 0.6), 0.4), (coal.Box(0.2, 0.2, 0.2), 0.0)]
):
    geom.addGeometryObject(
        pin.GeometryObject(f"g{i}", [2, 4, 6][i], pin.SE3(np.eye(3), np.array([0, 0, z])), shape)
    )
geom.addAllCollisionPairs()
print(len(geom.collisionPairs), geom.existGeometryName("g1"), geom.getGeometryId("nothing"))
gd = pin.GeometryData(geom)
rng = np.random.default_rng(0)
hits = []
for _k in range(30):
    q = rng.uniform(-3, 3, 6)
    hit = pin.computeCollisions(model, data, geom, gd, q, False)
    pin.computeDistances(model, data, geom, gd, q)
    hits.append((bool(hit), [round(max(r.min_distance, 0), 5) for r in gd.distanceResults]))
print(hits)
geom.removeCollisionPair(pin.CollisionPair(0, 1))
gd = geom.createData()
for req in gd.collisionRequests:
    req.security_margin = 0.3
print(pin.computeCollisions(model, data, geom, gd, q, True), [cp.first for cp in geom.collisionPairs])
