"""Names of `pinocchio` that are imported when first used: read by type checkers and by `lazy_names`."""

from __future__ import annotations

from typing import Any

from pinocchio import cholesky as cholesky
from pinocchio import graph as graph
from pinocchio import liegroups as liegroups
from pinocchio import linalg as linalg
from pinocchio import robot_wrapper as robot_wrapper
from pinocchio import serialization as serialization
from pinocchio import shortcuts as shortcuts
from pinocchio import visualize as visualize
from pinocchio._algorithms.kinematic_regressors import (
    computeFrameKinematicRegressor as computeFrameKinematicRegressor,
)
from pinocchio._algorithms.kinematic_regressors import (
    computeJointKinematicRegressor as computeJointKinematicRegressor,
)
from pinocchio._algorithms.parallel import ModelPool as ModelPool
from pinocchio._algorithms.parallel import abaInParallel as abaInParallel
from pinocchio._algorithms.parallel import rneaInParallel as rneaInParallel
from pinocchio._algorithms.supported_inertia import (
    computeSupportedForceByFrame as computeSupportedForceByFrame,
)
from pinocchio._algorithms.supported_inertia import (
    computeSupportedInertiaByFrame as computeSupportedInertiaByFrame,
)
from pinocchio._constraints.anchors import (
    FrameAnchorConstraintData,
    FrameAnchorConstraintModel,
    PointAnchorConstraintData,
    PointAnchorConstraintModel,
    PointContactConstraintData,
    PointContactConstraintModel,
)
from pinocchio._constraints.constraint_model import ConstraintData, ConstraintModel
from pinocchio._constraints.joint_constraints import (
    JointFrictionConstraintData,
    JointFrictionConstraintModel,
    JointLimitConstraintData,
    JointLimitConstraintModel,
)
from pinocchio._constraints.lanczos import LanczosDecomposition as LanczosDecomposition
from pinocchio._constraints.lanczos import TridiagonalSymmetricMatrix as TridiagonalSymmetricMatrix
from pinocchio._constraints.rigid_constraint import RigidConstraintData
from pinocchio._constraints.rigid_constraint_model import RigidConstraintModel
from pinocchio._containers.arrays import StdVec
from pinocchio._containers.named_configurations import StdMap_String_VectorXd as StdMap_String_VectorXd
from pinocchio._data.data import Data
from pinocchio._geometry.broadphase import BroadPhaseManager, BroadPhaseManagerPool
from pinocchio._geometry.broadphase import CollisionObject as CollisionObject
from pinocchio._geometry.collision_callbacks import CollisionCallBackBase as CollisionCallBackBase
from pinocchio._geometry.collision_callbacks import CollisionCallBackCollect as CollisionCallBackCollect
from pinocchio._geometry.collision_callbacks import CollisionCallBackDefault as CollisionCallBackDefault
from pinocchio._geometry.collision_pair import CollisionPair as CollisionPair
from pinocchio._geometry.collisions import computeBodyRadius as computeBodyRadius
from pinocchio._geometry.collisions import computeCollision as computeCollision
from pinocchio._geometry.collisions import computeCollisions as computeCollisions
from pinocchio._geometry.collisions import computeCollisionsInParallel as computeCollisionsInParallel
from pinocchio._geometry.collisions import computeContactPatch as computeContactPatch
from pinocchio._geometry.collisions import computeContactPatches as computeContactPatches
from pinocchio._geometry.collisions import computeDistance as computeDistance
from pinocchio._geometry.collisions import computeDistances as computeDistances
from pinocchio._geometry.geometry_data import GeometryData as GeometryData
from pinocchio._geometry.geometry_model import GeometryModel as GeometryModel
from pinocchio._geometry.geometry_object import GeometryObject as GeometryObject
from pinocchio._geometry.geometry_pool import GeometryPool as GeometryPool
from pinocchio._geometry.materials import CONCRETE as CONCRETE
from pinocchio._geometry.materials import ICE as ICE
from pinocchio._geometry.materials import METAL as METAL
from pinocchio._geometry.materials import PLASTIC as PLASTIC
from pinocchio._geometry.materials import WOOD as WOOD
from pinocchio._geometry.materials import FrictionCoefficientMatrix as FrictionCoefficientMatrix
from pinocchio._geometry.materials import GeometryNoMaterial as GeometryNoMaterial
from pinocchio._geometry.materials import GeometryPhongMaterial as GeometryPhongMaterial
from pinocchio._geometry.materials import PhysicsMaterial as PhysicsMaterial
from pinocchio._geometry.materials import PhysicsMaterialType as PhysicsMaterialType
from pinocchio._geometry.materials import getFrictionCoefficientMatrix as getFrictionCoefficientMatrix
from pinocchio._geometry.pair_functors import ComputeCollision as ComputeCollision
from pinocchio._geometry.pair_functors import ComputeDistance as ComputeDistance
from pinocchio._geometry.placements import updateGeometryPlacements as updateGeometryPlacements
from pinocchio._model.frame import Frame
from pinocchio._model.joint_data import JointData as JointData
from pinocchio._model.joint_model import JointModel
from pinocchio._model.model import Model
from pinocchio._package.settings import Exception as Exception
from pinocchio._package.settings import LogLevel as LogLevel
from pinocchio._package.settings import ScalarType as ScalarType
from pinocchio._package.settings import omp_get_max_threads as omp_get_max_threads
from pinocchio._package.settings import sharedMemory as sharedMemory
from pinocchio._parsers.geometry_urdf import buildGeomFromUrdf as buildGeomFromUrdf
from pinocchio._parsers.geometry_urdf import buildGeomFromUrdfString as buildGeomFromUrdfString
from pinocchio._parsers.mjcf import buildGeomFromMJCF as buildGeomFromMJCF
from pinocchio._parsers.mjcf import (
    buildModelAndConstraintsFromMJCF as buildModelAndConstraintsFromMJCF,
)
from pinocchio._parsers.mjcf import (
    buildModelAndLegacyConstraintsFromMJCF as buildModelAndLegacyConstraintsFromMJCF,
)
from pinocchio._parsers.mjcf import buildModelFromMJCF as buildModelFromMJCF
from pinocchio._parsers.mjcf import buildModelFromMJCFAndRootJoint as buildModelFromMJCFAndRootJoint
from pinocchio._parsers.sample_geometry import (
    buildSampleGeometryModelHumanoid as buildSampleGeometryModelHumanoid,
)
from pinocchio._parsers.sample_geometry import (
    buildSampleGeometryModelManipulator as buildSampleGeometryModelManipulator,
)
from pinocchio._parsers.sample_models import buildSampleModelHumanoid as buildSampleModelHumanoid
from pinocchio._parsers.sample_models import buildSampleModelHumanoidRandom as buildSampleModelHumanoidRandom
from pinocchio._parsers.sample_models import buildSampleModelManipulator as buildSampleModelManipulator
from pinocchio._parsers.srdf import loadReferenceConfigurations as loadReferenceConfigurations
from pinocchio._parsers.srdf import loadReferenceConfigurationsFromXML as loadReferenceConfigurationsFromXML
from pinocchio._parsers.srdf import loadRotorParameters as loadRotorParameters
from pinocchio._parsers.srdf import removeCollisionPairs as removeCollisionPairs
from pinocchio._parsers.srdf import removeCollisionPairsFromXML as removeCollisionPairsFromXML
from pinocchio._spatial.inertia import Inertia
from pinocchio._spatial.motion_force import Force, Motion
from pinocchio._spatial.pseudo_inertia import LogCholeskyParameters as LogCholeskyParameters
from pinocchio._spatial.pseudo_inertia import PseudoInertia as PseudoInertia
from pinocchio._spatial.se3 import SE3
from pinocchio._spatial.symmetric3 import Symmetric3
from pinocchio.liegroups import LieGroup as LieGroup
from pinocchio.liegroups import lieGroup as lieGroup
from pinocchio.linalg import isOrthonormal as isOrthonormal
from pinocchio.linalg import orthogonalization as orthogonalization
from pinocchio.linalg import orthonormalization as orthonormalization
from pinocchio.robot_wrapper import RobotWrapper as RobotWrapper
from pinocchio.shortcuts import (
    buildModelsAndConstraintsFromMJCF as buildModelsAndConstraintsFromMJCF,
)
from pinocchio.shortcuts import buildModelsFromMJCF as buildModelsFromMJCF
from pinocchio.shortcuts import buildModelsFromUrdf as buildModelsFromUrdf
from pinocchio.shortcuts import createDatas as createDatas
from pinocchio.visualize import GepettoVisualizer as GepettoVisualizer
from pinocchio.visualize import MeshcatVisualizer as MeshcatVisualizer
from pinocchio.visualize import ViserVisualizer as ViserVisualizer
from pinocchio.visualize import Visualizer as Visualizer
from ulna.typing import Floats

coal: Any
hppfcl: Any
CachedMeshLoader: Any
CollisionGeometry: Any
CollisionResult: Any
Contact: Any
DistanceResult: Any
MeshLoader: Any
JointDataComposite = JointData
JointDataFreeFlyer = JointData
JointDataHX = JointData
JointDataHY = JointData
JointDataHZ = JointData
JointDataHelicalUnaligned = JointData
JointDataMimic = JointData
JointDataPX = JointData
JointDataPY = JointData
JointDataPZ = JointData
JointDataPlanar = JointData
JointDataPrismaticUnaligned = JointData
JointDataRUBX = JointData
JointDataRUBY = JointData
JointDataRUBZ = JointData
JointDataRX = JointData
JointDataRY = JointData
JointDataRZ = JointData
JointDataRevoluteUnaligned = JointData
JointDataRevoluteUnboundedUnalignedTpl = JointData
JointDataSpherical = JointData
JointDataSphericalZYX = JointData
JointDataTranslation = JointData
JointDataEllipsoid = JointData
JointDataUniversal = JointData
BroadPhaseManagerPool_DynamicAABBTreeCollisionManager = BroadPhaseManagerPool
BroadPhaseManager_DynamicAABBTreeArrayCollisionManager = BroadPhaseManager
BroadPhaseManager_DynamicAABBTreeCollisionManager = BroadPhaseManager
BroadPhaseManager_IntervalTreeCollisionManager = BroadPhaseManager
BroadPhaseManager_NaiveCollisionManager = BroadPhaseManager
BroadPhaseManager_SSaPCollisionManager = BroadPhaseManager
BroadPhaseManager_SaPCollisionManager = BroadPhaseManager
TreeBroadPhaseManagerPool_DynamicAABBTreeCollisionManager = BroadPhaseManagerPool
TreeBroadPhaseManager_DynamicAABBTreeArrayCollisionManager = BroadPhaseManager
TreeBroadPhaseManager_DynamicAABBTreeCollisionManager = BroadPhaseManager
TreeBroadPhaseManager_IntervalTreeCollisionManager = BroadPhaseManager
TreeBroadPhaseManager_NaiveCollisionManager = BroadPhaseManager
TreeBroadPhaseManager_SSaPCollisionManager = BroadPhaseManager
TreeBroadPhaseManager_SaPCollisionManager = BroadPhaseManager
StdVec_Bool = StdVec[bool]
StdVec_BooleanVector = StdVec[Any]
StdVec_BroadPhaseManager_DynamicAABBTreeCollisionManager = StdVec[Any]
StdVec_CollisionObject = StdVec[CollisionObject]
StdVec_CollisionPair = StdVec[CollisionPair]
StdVec_CollisionResult = StdVec[Any]
StdVec_ComputeCollision = StdVec[Any]
StdVec_ComputeDistance = StdVec[Any]
StdVec_ConstraintData = StdVec[ConstraintData]
StdVec_ConstraintModel = StdVec[ConstraintModel]
StdVec_Contact = StdVec[Any]
StdVec_Data = StdVec[Data]
StdVec_DistanceResult = StdVec[Any]
StdVec_Double = StdVec[float]
StdVec_EigenIndex = StdVec[int]
StdVec_EigenIndexVector = StdVec[Any]
StdVec_Force = StdVec[Force]
StdVec_Frame = StdVec[Frame]
StdVec_FrameAnchorConstraintData = StdVec[FrameAnchorConstraintData]
StdVec_FrameAnchorConstraintModel = StdVec[FrameAnchorConstraintModel]
StdVec_GeometryData = StdVec[GeometryData]
StdVec_GeometryModel = StdVec[GeometryModel]
StdVec_GeometryObject = StdVec[GeometryObject]
StdVec_Index = StdVec[int]
StdVec_IndexVector = StdVec[StdVec_Index]
StdVec_Inertia = StdVec[Inertia]
StdVec_JointDataVector = StdVec[JointData]
StdVec_JointFrictionConstraintData = StdVec[JointFrictionConstraintData]
StdVec_JointFrictionConstraintModel = StdVec[JointFrictionConstraintModel]
StdVec_JointLimitConstraintData = StdVec[JointLimitConstraintData]
StdVec_JointLimitConstraintModel = StdVec[JointLimitConstraintModel]
StdVec_JointModelVector = StdVec[JointModel]
StdVec_Matrix6 = StdVec[Floats]
StdVec_Matrix6x = StdVec[Floats]
StdVec_MatrixXs = StdVec[Floats]
StdVec_Model = StdVec[Model]
StdVec_Motion = StdVec[Motion]
StdVec_PointAnchorConstraintData = StdVec[PointAnchorConstraintData]
StdVec_PointAnchorConstraintModel = StdVec[PointAnchorConstraintModel]
StdVec_PointContactConstraintData = StdVec[PointContactConstraintData]
StdVec_PointContactConstraintModel = StdVec[PointContactConstraintModel]
StdVec_RigidConstraintData = StdVec[RigidConstraintData]
StdVec_RigidConstraintModel = StdVec[RigidConstraintModel]
StdVec_SE3 = StdVec[SE3]
StdVec_Scalar = StdVec[float]
StdVec_StdString = StdVec[str]
StdVec_int = StdVec[int]
StdVec_StdVec_Int = StdVec[StdVec_int]
StdVec_Symmetric3 = StdVec[Symmetric3]
StdVec_TreeBroadPhaseManager_DynamicAABBTreeCollisionManager = StdVec[Any]
StdVec_Vec3s = StdVec[Floats]
StdVec_Vector3 = StdVec[Floats]
StdVec_coal_CollisionObjectPointer = StdVec[Any]
