"""Collision of robots with themselves and with worlds: exact through coal, and compiled by covering spheres."""

from ulna.collision.compiled import SphereChecker
from ulna.collision.covering import fit
from ulna.collision.exact import Checker
from ulna.collision.objective import sphere_clearance
from ulna.collision.objects import Attachment, Obstacle
from ulna.collision.pair_tables import PairTable
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.refine import refine
from ulna.collision.result import Distance, Proximity
from ulna.collision.robot_poses import robot_poses
from ulna.collision.segment import first_contact
from ulna.collision.sphere_files import read_spheres, spheres_of
from ulna.collision.spheres import LinkSpheres, Spheres
from ulna.collision.survey import Survey, survey
from ulna.collision.world import World

__all__ = [
    "Attachment",
    "Checker",
    "Distance",
    "LinkPair",
    "LinkSpheres",
    "Obstacle",
    "PairTable",
    "Proximity",
    "SphereChecker",
    "Spheres",
    "Survey",
    "World",
    "first_contact",
    "fit",
    "link_pairs",
    "read_spheres",
    "refine",
    "robot_poses",
    "sphere_clearance",
    "spheres_of",
    "survey",
]
