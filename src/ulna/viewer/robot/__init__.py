"""Robots in a scene: the meshes of their links, what is drawn along with them, and how they follow targets."""
