"""Collision-free inverse kinematics of a robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from ulna.methods.collision import CollisionQueries, Method, _checker
from ulna.methods.ik import InverseKinematics
from ulna.typing import ArrayLike

if TYPE_CHECKING:
    from ulna.collision import World
    from ulna.ik.free import FreeSolution


class FreeInverseKinematics(InverseKinematics, CollisionQueries):
    """Which configuration puts the hand there, and touches nothing."""

    __slots__ = ()

    def ik_free(
        self,
        T: Any,
        world: World | None = None,
        q0: ArrayLike | None = None,
        frame: str | Sequence[str] | None = None,
        *,
        margin: float = 0.0,
        moving: Mapping[str, ArrayLike] | None = None,
        mask: Any = None,
        joints: Sequence[str] | None = None,
        position_tolerance: float = 1e-6,
        rotation_tolerance: float = 1e-6,
        seed: int = 0,
        attempts: int = 256,
        method: Method = "exact",
        **options: Any,
    ) -> FreeSolution:
        """Inverse kinematics: a configuration within the limits, at the goal, that touches neither robot nor world.

        Of a six-joint arm all solutions are looked at, the nearest to `q0` first, so that "all collide" is the last
        word; of other arms those met from more and more starting points, farther and farther from `q0`, and the nearest
        free one of the first round that has one is returned. What is returned has passed the exact check, or the check
        by covering spheres, which is faster, needs no coal, and refuses answers in which shapes are nearly in contact.

        Args:
            T: The goal, as for `ik`; a batch is solved goal by goal.
            world: Obstacles; None for the robot alone.
            q0: Configuration to stay near, (..., nq) [rad or m]; None for anywhere.
            frame: As for `ik`.
            margin: What comes as near as this counts as touching [m].
            moving: Poses of the world's moving obstacles by name, T_world_shape (4, 4).
            mask: As for `ik`.
            joints: As for `ik`.
            position_tolerance: As for `ik` [m].
            rotation_tolerance: As for `ik` [rad].
            seed: Chooses the starting points.
            attempts: How many starting points are tried at most, of arms without finitely many solutions.
            method: "exact", or "spheres" that cover the links.
            **options: Of the check, as for `robot.collision.checker`.

        Returns:
            A solution with `.q`, `.success`, `.position_error`, `.rotation_error`, `.candidates`, `.distance` and
            `.reason`. Where all that was found collides, `q` is what overlaps least, and `reason` names the two that
            overlap, and by how much.

        Raises:
            InputError, ShapeError, DtypeError, NonFiniteError, UnknownName: As for `ik` and `collides`.
            ModelError: If the robot has no collision geometry, or a mesh file is missing.
            MissingExtra: If coal is not installed, for "exact".

        Example:
            >>> from ulna.collision import World
            >>> from ulna.geometry import Box
            >>> robot = ulna.load("panda")
            >>> q = robot.configurations["ready"]
            >>> world = World().add("shelf", Box((0.5, 0.6, 0.02)), (0.55, 0.0, 0.6))
            >>> answer = robot.ik_free(ulna.SE3.pointing_down((0.5, 0.0, 0.2)), world, q0=q)
            >>> answer.success, bool(robot.collides(answer.q, world))
            (True, False)
        """
        from ulna.ik.contacts import exact_contacts, sphere_contacts
        from ulna.ik.free import FreeOptions, FreeSolver

        search_options = FreeOptions(margin, moving, position_tolerance, rotation_tolerance, seed, attempts)
        goals, solver = self._solver(T, frame, mask, joints)
        checker = _checker(self, world, method=method, **options)
        contacts = (
            sphere_contacts(checker)
            if method == "spheres"
            else exact_contacts(checker, partial(_sphere_check, self, world, options))
        )
        return FreeSolver(solver, contacts, self._kernel("distance"))(goals, q0, search_options)


def _sphere_check(part: Any, world: World | None, options: dict[str, Any]) -> Any:
    """The check by spheres that rules out contact before coal is asked; None where it would take long to prepare."""
    from ulna.collision import fit, link_pairs
    from ulna.collision.covering import is_fitted
    from ulna.collision.table_choice import are_known

    missing = options.get("missing", "error")
    if options.get("convex") or (world and world.attachments):
        return None
    known = part._searches.setdefault("fitted spheres", {})
    pairs = options.get("pairs")
    chosen_pairs = link_pairs(part.model) if pairs is None else tuple(pairs)
    if (missing, chosen_pairs) not in known:
        if not is_fitted(part.model, missing):
            return None
        known[missing, chosen_pairs] = are_known(
            part.model, fit(part.model, missing=missing), chosen_pairs, missing
        )
    chosen = {name: options[name] for name in ("pairs", "missing") if name in options}
    return _checker(part, world, method="spheres", tables=known[missing, chosen_pairs], **chosen)
