"""Names that are imported when they are asked for, so that `import pinocchio` loads no viewer."""

from __future__ import annotations

import importlib
from typing import Any

_SEARCHES = ("DynamicAABBTree", "DynamicAABBTreeArray", "IntervalTree", "Naive", "SSaP", "SaP")
_OF: dict[str, tuple[str, ...]] = {
    "_broadphase": (
        "CollisionObject",
        *(
            f"{tree}BroadPhaseManager_{search}CollisionManager"
            for tree in ("", "Tree")
            for search in _SEARCHES
        ),
        *(f"{tree}BroadPhaseManagerPool_DynamicAABBTreeCollisionManager" for tree in ("", "Tree")),
    ),
    "_collisions": (
        "ComputeCollision",
        "ComputeDistance",
        "computeBodyRadius",
        "computeCollision",
        "computeCollisions",
        "computeCollisionsInParallel",
        "computeContactPatch",
        "computeContactPatches",
        "computeDistance",
        "computeDistances",
    ),
    "_geometry": (
        "CollisionPair",
        "GeometryData",
        "GeometryModel",
        "GeometryObject",
        "updateGeometryPlacements",
    ),
    "_geometry_urdf": ("buildGeomFromUrdf", "buildGeomFromUrdfString"),
    "_package": (
        *(
            "Exception",
            "LogLevel",
            "ScalarType",
            "omp_get_max_threads",
            "sharedMemory",
        ),
    ),
    "_callbacks": ("CollisionCallBackBase", "CollisionCallBackCollect", "CollisionCallBackDefault"),
    "_calibration": ("computeFrameKinematicRegressor", "computeJointKinematicRegressor"),
    "_supported": ("computeSupportedForceByFrame", "computeSupportedInertiaByFrame"),
    "_srdf": (
        "loadReferenceConfigurations",
        "loadReferenceConfigurationsFromXML",
        "loadRotorParameters",
        "removeCollisionPairs",
        "removeCollisionPairsFromXML",
    ),
    "_samples": ("buildSampleModelHumanoid", "buildSampleModelHumanoidRandom", "buildSampleModelManipulator"),
    "_sample_geometry": ("buildSampleGeometryModelHumanoid", "buildSampleGeometryModelManipulator"),
    "_mjcf": ("buildGeomFromMJCF", "buildModelFromMJCF"),
    "_materials": ("GeometryNoMaterial", "GeometryPhongMaterial", "PhysicsMaterial", "PhysicsMaterialType"),
    "_parallel": ("GeometryPool", "ModelPool", "abaInParallel", "rneaInParallel"),
    "linalg": ("isOrthonormal", "orthogonalization", "orthonormalization"),
    "_postures": ("StdMap_String_VectorXd",),
    "_pseudo": ("LogCholeskyParameters", "PseudoInertia"),
    "liegroups": ("LieGroup", "lieGroup"),
    "robot_wrapper": ("RobotWrapper",),
    "shortcuts": (
        *("buildModelFromMJCFAndRootJoint", "buildModelsFromMJCF", "buildModelsFromUrdf", "createDatas"),
    ),
    "visualize": ("GepettoVisualizer", "MeshcatVisualizer", "ViserVisualizer", "Visualizer"),
}
_JOINT_DATA = (
    *("RX", "RY", "RZ", "RUBX", "RUBY", "RUBZ", "PX", "PY", "PZ", "HX", "HY", "HZ", "RevoluteUnaligned"),
    *(
        "RevoluteUnboundedUnalignedTpl",
        "PrismaticUnaligned",
        "HelicalUnaligned",
        "Universal",
        "FreeFlyer",
        "Planar",
    ),
    *("Spherical", "SphericalZYX", "Translation", "Mimic", "Composite", ""),
)
_CONSTRAINTS = ("", "FrameAnchor", "JointFriction", "JointLimit", "PointAnchor", "PointContact", "Rigid")
_VECTORS = (
    *("Bool", "BooleanVector", "CollisionObject", "CollisionPair", "CollisionResult", "ComputeCollision"),
    *(
        "ComputeDistance",
        "Contact",
        "Data",
        "DistanceResult",
        "Double",
        "EigenIndex",
        "EigenIndexVector",
        "Force",
    ),
    *("Frame", "GeometryData", "GeometryModel", "GeometryObject", "Index", "IndexVector", "Inertia"),
    *(
        "JointDataVector",
        "JointModelVector",
        "Matrix6",
        "Matrix6x",
        "MatrixXs",
        "Model",
        "Motion",
        "SE3",
        "Scalar",
    ),
    *("StdString", "StdVec_Int", "Symmetric3", "Vec3s", "Vector3", "coal_CollisionObjectPointer", "int"),
    *(
        "BroadPhaseManager_DynamicAABBTreeCollisionManager",
        "TreeBroadPhaseManager_DynamicAABBTreeCollisionManager",
    ),
    *(f"{word}Constraint{what}" for word in _CONSTRAINTS for what in ("Data", "Model")),
)
OF_COAL = (
    *("CachedMeshLoader", "CollisionGeometry", "CollisionResult", "Contact", "DistanceResult", "MeshLoader"),
)
"""The names that are those of coal."""
LATE: dict[str, str] = {
    **{name: module for module, names in _OF.items() for name in names},
    **dict.fromkeys(("CONCRETE", "ICE", "METAL", "PLASTIC", "WOOD"), "_materials"),
    **dict.fromkeys(OF_COAL, "coal"),
    **{f"JointData{word}": "_joint_data" for word in _JOINT_DATA},
    **{f"StdVec_{word}": "_arrays" for word in _VECTORS},
}
"""The module of each of these names."""
MODULES = (
    *(
        "cholesky",
        "coal",
        "hppfcl",
        "liegroups",
        "linalg",
        "robot_wrapper",
        "serialization",
        "shortcuts",
        "visualize",
    ),
)


def late(name: str) -> Any:
    """What a name of `LATE`, or a module of `MODULES`, stands for; all containers are one class of lists."""
    if name in ("coal", "hppfcl") or name in OF_COAL:
        from ulna.collision.narrow import coal

        return getattr(coal(), name, coal())
    if name in MODULES:
        return importlib.import_module(f"pinocchio.{name}")
    module = importlib.import_module(f"pinocchio.{LATE[name]}")
    return getattr(module, "StdVec" if name.startswith("StdVec_") else name)
