"""The kinds of joints."""

from ulna.model.joints.ball import FreeFlyer as FreeFlyer
from ulna.model.joints.ball import Spherical as Spherical
from ulna.model.joints.circle import Circle as Circle
from ulna.model.joints.circle import PlanarCircle as PlanarCircle
from ulna.model.joints.composite import Composite as Composite
from ulna.model.joints.constant_velocity import ConstantVelocity as ConstantVelocity
from ulna.model.joints.ellipsoid import Ellipsoid as Ellipsoid
from ulna.model.joints.fixed import Fixed as Fixed
from ulna.model.joints.joint_kind import Coordinate as Coordinate
from ulna.model.joints.joint_kind import ElementaryJoint as ElementaryJoint
from ulna.model.joints.joint_kind import JointKind as JointKind
from ulna.model.joints.joint_kind import VectorKind as VectorKind
from ulna.model.joints.planar import Planar as Planar
from ulna.model.joints.rolling import Rolling as Rolling
from ulna.model.joints.sliding import Prismatic as Prismatic
from ulna.model.joints.sliding import Translation as Translation
from ulna.model.joints.turning import Continuous as Continuous
from ulna.model.joints.turning import Cylindrical as Cylindrical
from ulna.model.joints.turning import Helical as Helical
from ulna.model.joints.turning import Revolute as Revolute
from ulna.model.joints.turning import Universal as Universal
