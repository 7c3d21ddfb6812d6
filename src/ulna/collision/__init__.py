"""Collision of robots: exact through coal, and compiled by spheres."""

from ulna.collision.exact import Checker
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.result import Distance, Proximity
from ulna.collision.world import Obstacle, World, robot_poses

__all__ = [
    "Checker",
    "Distance",
    "LinkPair",
    "Obstacle",
    "Proximity",
    "World",
    "link_pairs",
    "robot_poses",
]
