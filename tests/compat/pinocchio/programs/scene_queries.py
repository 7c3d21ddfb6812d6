"""Collision and distance queries of an arm among boxes and spheres, and a repulsive field made of them."""

import coal
import numpy as np
import pinocchio as pin

np.set_printoptions(precision=4, suppress=True)
model = pin.buildSampleModelManipulator()
geom_model = pin.buildSampleGeometryModelManipulator(model)
print([g.name for g in geom_model.geometryObjects])
for k in range(3):
    place = pin.SE3(np.eye(3), np.array([0.5, -0.4 + 0.4 * k, 1.0]))
    shape = coal.Sphere(0.1) if k % 2 else coal.Box(0.2, 0.1, 0.3)
    obstacle = pin.GeometryObject(f"obstacle{k}", 0, place, shape)
    obstacle.meshColor = np.array([1.0, 0.2 * k, 0.2, 0.5])
    geom_model.addGeometryObject(obstacle)
obstacles = [i for i, g in enumerate(geom_model.geometryObjects) if g.parentJoint == 0]
links = [i for i, g in enumerate(geom_model.geometryObjects) if g.parentJoint > 1]
for i in links:
    for j in obstacles:
        geom_model.addCollisionPair(pin.CollisionPair(i, j))
geom_model.addAllCollisionPairs()
print(len(geom_model.collisionPairs))
for pair in [pin.CollisionPair(p.first, p.second) for p in geom_model.collisionPairs]:
    a, b = (geom_model.geometryObjects[i].parentJoint for i in (pair.first, pair.second))
    if abs(a - b) <= 1:
        geom_model.removeCollisionPair(pair)
print(len(geom_model.collisionPairs), geom_model.existCollisionPair(pin.CollisionPair(0, 1)))
data, geom_data = model.createData(), geom_model.createData()
for request in geom_data.distanceRequests:
    request.enable_signed_distance = True
rng = np.random.default_rng(3)
for _ in range(5):
    q = rng.uniform(-1.5, 1.5, model.nq)
    hit = pin.computeCollisions(model, data, geom_model, geom_data, q, False)
    touching = [k for k, r in enumerate(geom_data.collisionResults) if r.isCollision()]
    nearest = pin.computeDistances(model, data, geom_model, geom_data, q)
    result = geom_data.distanceResults[nearest]
    pair = geom_model.collisionPairs[nearest]
    print(hit, touching, round(result.min_distance, 5), geom_model.geometryObjects[pair.first].name)
q = np.array([0.3, 0.5, -0.2, 0.4, 0.1, 0.2])
for step in range(6):
    pin.computeJointJacobians(model, data, q)
    pin.updateGeometryPlacements(model, data, geom_model, geom_data)
    push = np.zeros(model.nv)
    closest = np.inf
    for k in range(len(geom_model.collisionPairs)):
        d = pin.computeDistance(geom_model, geom_data, k).min_distance
        result = geom_data.distanceResults[k]
        closest = min(closest, d)
        if 1e-6 < d < 0.3:
            joint = geom_model.geometryObjects[geom_model.collisionPairs[k].first].parentJoint
            normal = (result.getNearestPoint1() - result.getNearestPoint2()) / d
            at = pin.SE3(np.eye(3), data.oMi[joint].actInv(result.getNearestPoint1()))
            J = pin.getFrameJacobian(model, data, joint, at, pin.LOCAL_WORLD_ALIGNED)[:3]
            push += J.T @ normal * (0.3 - d)
    q = pin.integrate(model, q, 0.05 * push)
    print(step, round(closest, 4), push.shape)
geom_data.deactivateCollisionPair(0)
geom_data.activateCollisionPair(1)
print(list(geom_data.activeCollisionPairs)[:4])
geom_model.removeGeometryObject("obstacle1")
print(geom_model.ngeoms, geom_model.existGeometryName("obstacle1"), len(geom_model.collisionPairs))
print(geom_model.geometryObjects[-1].name, pin.computeBodyRadius(model, geom_model, geom_data))
