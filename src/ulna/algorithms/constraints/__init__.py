"""Dynamics under constraints: contacts, loops, impacts, friction cones."""
