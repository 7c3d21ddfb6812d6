"""Placements, motions, forces and inertias."""
