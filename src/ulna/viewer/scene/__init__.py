"""Placing robots, shapes, meshes and annotations into a scene, each under a name."""

from ulna.viewer.scene.scene import Scene as Scene
