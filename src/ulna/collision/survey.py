"""Which pairs of links always touch and which never do, found by trying configurations."""

from __future__ import annotations

from typing import Any, final

import numpy as np

from ulna import algorithms
from ulna.collision.exact import Checker
from ulna.collision.pairs import LinkPair, link_pairs
from ulna.collision.solids import Missing
from ulna.data_classes import dataclass
from ulna.errors import InputError
from ulna.model import Model
from ulna.model.of_robot import model_of


@final
@dataclass(frozen=True)
class Survey:
    """What a survey of pairs of links found.

    "Never" is what was seen, and no proof: a pair that touches in one configuration of a million may be among them.

    Attributes:
        always: Pairs that touched in every configuration tried: their shapes overlap by construction.
        never: Pairs that touched in none.
        sometimes: The rest, with the share of configurations in which they touched.
        count: How many configurations were tried.
    """

    always: tuple[LinkPair, ...]
    never: tuple[LinkPair, ...]
    sometimes: dict[LinkPair, float]
    count: int


def survey(
    model: Model | Any,
    count: int = 2000,
    seed: Any = 0,
    *,
    margin: float = 0.0,
    convex: bool = False,
    missing: Missing = "error",
) -> Survey:
    """Tries random configurations within the limits on every pair of links, also adjacent and disabled ones.

    Args:
        model: The Model, or its Robot.
        count: How many configurations.
        seed: A number or a `numpy.random.Generator`.
        margin: Shapes that come as near as this count as touching [m].
        convex: Whether meshes are replaced by their convex hulls.
        missing: What to do about a mesh file that is missing: "error", or "skip" it with a warning.

    Returns:
        Which pairs touch in every, in no and in some configurations.

    Raises:
        InputError: `count` is not a whole number from 1.
    """
    if int(count) != count or count < 1:
        raise InputError(f"`count` is {count!r}; expected 1 or more configurations.")
    model = model_of(model, "model")
    pairs = link_pairs(model, adjacent=True, disabled=True)
    checker = Checker(model, pairs=pairs, convex=convex, missing=missing)
    q = algorithms.random(model, np.random.default_rng(seed), (int(count),))
    share = checker.touching(q, margin=margin).mean(axis=0)
    shares = dict(zip(checker.owners, share.tolist(), strict=True))
    return Survey(
        tuple(pair for pair, s in shares.items() if s == 1.0),
        tuple(pair for pair, s in shares.items() if s == 0.0),
        {pair: s for pair, s in shares.items() if 0.0 < s < 1.0},
        int(count),
    )
