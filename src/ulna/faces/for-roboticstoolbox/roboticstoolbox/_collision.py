"""Whether a robot touches things, and bounds on velocities that keep it from doing so."""

from __future__ import annotations


class Collision:
    """Contacts and distances."""
