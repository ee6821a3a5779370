"""The trials of a session in their order: blocks, repetitions, and orders drawn from the session's seed."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import msgspec

from mimics_app.contracts.errors import UsageError
from mimics_app.tasks.task import TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec, Order

__all__ = [
    "Trial",
    "check_first_trial",
    "order_conditions",
    "plan_trials",
    "repeated",
    "trial_blocks",
    "williams_square",
]

_SHORTEST_TRIAL_S = 5.0
"""Shortest time of approach, travel, result and rest of a trial [s]."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One planned trial.

    Attributes:
        number: 0 first, over the whole session.
        block: Name of its block.
        label: Name of its condition.
        repetition: Number of the repetition in its block, 0 first.
        practice: Left out of the session's score.
        values: Parameter values set before it.
        time_limit_s: Longest travel [s].
        rest_s: Rest after it [s].
    """

    number: int
    block: str
    label: str
    repetition: int
    practice: bool
    time_limit_s: float | None
    rest_s: float | None
    values: Mapping[str, float] = field(default_factory=dict)


def plan_trials(blocks: Sequence[BlockSpec], seed: int) -> list[Trial]:
    """Lay out a session. The same blocks and seed give the same trials on every machine and Python version."""
    trials: list[Trial] = []
    for b, block in enumerate(blocks):
        orders = order_conditions(len(block.trials), block.repetitions, block.order, seed=seed * 1_000_003 + b)
        for repetition, order in enumerate(orders):
            for i in order:
                spec = block.trials[i]
                trials.append(
                    Trial(
                        number=len(trials),
                        block=block.name or f"block {b + 1}",
                        label=spec.label or f"condition {i + 1}",
                        repetition=repetition,
                        practice=block.practice,
                        values=spec.values,
                        time_limit_s=spec.time_limit_s,
                        rest_s=spec.rest_s,
                    )
                )
    return trials


def check_first_trial(number: int, count: int) -> None:
    """Check the number of the first trial, 1 first, in a session of `count` trials.

    Raises:
        UsageError: The trial is unknown.
    """
    if not 1 <= number <= count:
        raise UsageError(f"the session has no trial {number}", f"it has {count}")


def repeated(spec: TaskSpec, seconds: float) -> TaskSpec:
    """Return the task with its last counting block repeated so often that it lasts at least a given time [s].

    For a learning system, which continues as long as the session.
    """
    blocks = list(trial_blocks(spec))
    last = max((i for i, block in enumerate(blocks) if not block.practice), default=None)
    if last is None:
        return spec
    rounds = math.ceil(seconds / (_SHORTEST_TRIAL_S * len(blocks[last].trials)))
    blocks[last] = msgspec.structs.replace(blocks[last], repetitions=max(blocks[last].repetitions, rounds))
    return msgspec.structs.replace(spec, trials=blocks)


def trial_blocks(spec: TaskSpec) -> list[BlockSpec]:
    """Return the blocks of a task whose trial file has been read."""
    if isinstance(spec.trials, str):
        raise TypeError(f'trial file "{spec.trials}" has not been read; call tasks.trial_file.resolve_trials first')
    return spec.trials


def order_conditions(count: int, repetitions: int, order: Order, seed: int) -> list[list[int]]:
    """Indices of `count` conditions for each repetition, one row per repetition."""
    source = random.Random(seed)
    listed = list(range(count))
    if order == "listed":
        return [listed] * repetitions
    if order == "shuffled":
        return [_shuffled(listed, source) for _ in range(repetitions)]
    square = williams_square(count)
    names = _shuffled(listed, source)
    return [[names[i] for i in square[r % len(square)]] for r in range(repetitions)]


def williams_square(count: int) -> list[list[int]]:
    """Orders of `count` conditions balanced for position and for first-order carry-over.

    Williams, E. J. (1949), Experimental designs balanced for the estimation of residual effects of treatments,
    Australian Journal of Scientific Research A 2:149-168. `count` rows when even, else those and their reversals.
    """
    zigzag = [(i + 1) // 2 if i % 2 else (count - i // 2) % count for i in range(count)]
    rows = [[(condition + shift) % count for condition in zigzag] for shift in range(count)]
    return rows if count % 2 == 0 or count == 1 else rows + [row[::-1] for row in rows]


def _shuffled(items: Sequence[int], source: random.Random) -> list[int]:
    """Fisher-Yates over random(), the one method whose sequence Python promises never to change."""
    order = list(items)
    for last in range(len(order) - 1, 0, -1):
        other = int(source.random() * (last + 1))
        order[last], order[other] = order[other], order[last]
    return order
