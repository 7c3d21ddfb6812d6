"""The job of many plans: problems in parts, each with its own seed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from ulna.collision import World
from ulna.model.content import fingerprint
from ulna.planning import Plan, Planner
from ulna.robot import Robot
from ulna.scale import archive, growing
from ulna.scale.job import SampledJob, Samples, State
from ulna.scale.plan_set import OUTCOMES, PlanSet
from ulna.system.cached import cached_property
from ulna.typing import Floats

_DRAWS, _TRIES = 8, 256  # configurations that are drawn at a time for a random problem, and how often
_PLANNERS = 8  # that a worker keeps
_NUMBERS = ("worlds", "outcomes", "certified", "cost", "iterations")


@final
@dataclass(frozen=True, eq=False)
class Plans(SampledJob):
    """The job of many plans.

    Attributes:
        robot: The robot.
        samples: The problems, in parts.
        starts: Where the robot is, (n, nq) [rad, m]; None where problems are drawn, and on workers.
        goals: Goals, (n, nq) or (n, 4, 4) [rad, m]; likewise.
        worlds: The worlds; on workers only where there is one.
        world_count: How many worlds there are.
        frame: Whose pose the goals are; None for the tool.
        lengths: Of `ulna.planning.Planner`: margin, step, longest [m, m, rad or m].
        searching: Of `Planner.plan`: shorten, improve, iterations, timeout.
    """

    kind: ClassVar[str] = PlanSet.KIND
    robot: Robot
    samples: Samples
    starts: Floats | None
    goals: Floats | None
    worlds: tuple[World | None, ...]
    world_count: int
    frame: str | None
    lengths: Mapping[str, Any]
    searching: Mapping[str, Any]

    def description(self) -> dict[str, Any]:
        """All that the plans depend on."""
        worlds = [None if world is None else world.fingerprint for world in self.worlds]
        return {
            **self.subject(),
            "problems": self.samples.count,
            "chunk": self.samples.chunk,
            "seed": self.samples.seed,
            "starts and goals": "random" if self.starts is None else fingerprint(self.starts, self.goals),
            "worlds": fingerprint(worlds),
            "frame": self.frame,
            **self.lengths,
            **{name: repr(value) for name, value in self.searching.items()},
        }

    def for_workers(self) -> Plans:
        """The job without its problems; with the world, where there is one for all."""
        return replace(self, starts=None, goals=None, worlds=self.worlds if self.world_count == 1 else ())

    def inputs(self, part: int) -> tuple[Any, ...]:
        """Starts and goals of a part, None where they are drawn, and its worlds by number; of one world nothing."""
        rows = self._rows(part)
        numbers = sorted({self._world(row) for row in rows}) if self.world_count > 1 else []
        worlds = {number: self.worlds[number] for number in numbers}
        if self.starts is None or self.goals is None:
            return None, None, worlds
        here = slice(rows.start, rows.stop)
        return self.starts[here], self.goals[here], worlds

    def prepare(self, to: Path | None) -> None:
        """Refuses robots, frames and options that cannot be planned with, before anything is written."""
        if self.frame is not None:
            self.robot.model.frame(self.frame)
        q = self.robot.neutral
        self._planner(self.worlds[0]).plan(q, q, **{**self.searching, "improve": 0})

    def start(self) -> State:
        """No plans yet."""
        n, nq = self.samples.count, self.robot.model.nq
        kinds = {
            "worlds": np.int64,
            "outcomes": np.uint8,
            "certified": bool,
            "cost": float,
            "iterations": np.int64,
        }
        state = {name: np.zeros(n, kind) for name, kind in kinds.items()}
        state |= {"points_of": np.zeros(n, np.int64), "letters_of": np.zeros(n, np.int64)}
        if self.starts is None:
            state |= {"starts": np.zeros((n, nq)), "goals": np.zeros((n, nq))}
        return (
            state | growing.start("points", np.zeros((0, nq))) | growing.start("texts", np.zeros(0, np.uint8))
        )

    def work(self, part: int, *inputs: Any) -> State:
        """What became of each problem of a part; points and texts one after the other."""
        starts, goals, worlds = inputs
        rows, results, ends = self._rows(part), [], []
        for k, row in enumerate(rows):
            number = self._world(row)
            world = worlds[number] if worlds else self.worlds[0]
            seeds = np.random.SeedSequence(self.samples.seed, spawn_key=(row,))
            a, b = self._drawn(world, seeds) if starts is None else (starts[k], goals[k])
            seed = int(seeds.generate_state(1)[0])
            results.append(self._planner(world).plan(a, b, frame=self.frame, seed=seed, **self.searching))
            ends.append((a, b))
        out = _arrays(results, self.robot.model.nq)
        out["worlds"] = np.array([self._world(row) for row in rows], np.int64)
        if starts is None:
            out["starts"], out["goals"] = (np.array(values) for values in zip(*ends, strict=True))
        return out

    def fold(self, state: State, part: int, result: State) -> None:
        """Keeps the plans of a part."""
        rows = self._rows(part)
        growing.add(state, "points", result.pop("points"))
        growing.add(state, "texts", result.pop("texts"))
        for name, values in result.items():
            state[name][rows.start : rows.stop] = values

    def existing(self, to: Path) -> PlanSet:
        """The plans in `to`."""
        archive.check(to, self.description())
        return PlanSet.load(to)

    def finish(self, state: State, to: Path | None) -> PlanSet:
        """The plans, written to `to`."""
        ends: Any = (state["starts"], state["goals"]) if self.starts is None else (self.starts, self.goals)
        plan_set = PlanSet(
            *ends,
            **{name: state[name] for name in _NUMBERS},
            points=growing.rows(state, "points"),
            offsets=np.concatenate([[0], np.cumsum(state["points_of"])]),
            texts=growing.rows(state, "texts"),
            text_offsets=np.concatenate([[0], np.cumsum(state["letters_of"])]),
            job=self.description(),
        )
        if to is not None:
            plan_set.save(to)
        return plan_set

    def _rows(self, part: int) -> range:
        """The numbers of the problems of a part."""
        first = part * self.samples.chunk
        return range(first, first + self.samples.size(part))

    def _world(self, row: int) -> int:
        return row * self.world_count // self.samples.count

    @cached_property
    def _planners(self) -> dict[str, Planner]:
        return {}

    def _planner(self, world: World | None) -> Planner:
        """The planner of a world; the last ones are kept."""
        key = "" if world is None else world.fingerprint
        planner = self._planners.get(key)
        if planner is None:  # other threads may add and remove planners meanwhile
            planner = Planner(self.robot, world, method="spheres", **self.lengths)
            if len(self._planners) >= _PLANNERS:
                self._planners.clear()
            planner = self._planners.setdefault(key, planner)
        return planner

    def _drawn(self, world: World | None, seeds: np.random.SeedSequence) -> tuple[Floats, Floats]:
        """Two random configurations that touch nothing; where there are none, the planner says so of the last ones."""
        rng = np.random.default_rng(seeds)
        free: list[Floats] = []
        for _ in range(_TRIES):
            q = self.robot.random_configuration(_DRAWS, rng)
            touches = self.robot.collides(q, world, margin=self.lengths["margin"], method="spheres")
            free += list(q[~touches][:2])
            if len(free) >= 2:
                break
        a, b, *_ = [*free, *self.robot.random_configuration(2, rng)]
        return a, b


def _arrays(plans: Sequence[Plan], nq: int) -> State:
    """Plans as arrays."""
    texts = [np.frombuffer(plan.reason.encode(), np.uint8) for plan in plans]
    return {
        "outcomes": np.array([OUTCOMES.index(plan.outcome) for plan in plans], np.uint8),
        "certified": np.array([plan.is_certified for plan in plans]),
        "cost": np.array([plan.cost if plan else np.nan for plan in plans]),
        "iterations": np.array([plan.iterations for plan in plans], np.int64),
        "points_of": np.array([len(plan.points) for plan in plans], np.int64),
        "letters_of": np.array([len(text) for text in texts], np.int64),
        "points": np.concatenate([np.zeros((0, nq)), *(plan.points for plan in plans)]),
        "texts": np.concatenate([np.zeros(0, np.uint8), *texts]),
    }
