"""Adjustments of a task by the therapist: easier or harder than the scene's, with a given number of trials."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import Literal

import msgspec

from mimics_app.tasks.task import ParameterSpec, TaskSpec
from mimics_app.tasks.trial_specs import BlockSpec, TrialSpec
from mimics_app.tasks.trials import Trial, plan_trials, trial_blocks

__all__ = ["Difficulty", "at_difficulty", "with_trials"]

Difficulty = Literal["easier", "usual", "harder"]

_SHARE = 0.5
"""Share of the range from the scene's value to the easiest or hardest one [-]."""


def at_difficulty(spec: TaskSpec, difficulty: Difficulty) -> TaskSpec:
    """Return the task with every parameter of known difficulty moved half-way to its easy or hard end.

    Args:
        spec: The task; its defaults have been filled in, its trial file has been read.
        difficulty: The difficulty.
    """
    if difficulty == "usual":
        return spec
    direction = 1 if difficulty == "harder" else -1
    parameters = {
        name: msgspec.structs.replace(
            each, default=_moved(each, each.min if each.default is None else each.default, direction)
        )
        for name, each in spec.parameters.items()
    }
    blocks = [
        msgspec.structs.replace(block, trials=[_trial_moved(each, spec.parameters, direction) for each in block.trials])
        for block in trial_blocks(spec)
    ]
    return msgspec.structs.replace(spec, parameters=parameters, trials=blocks)


def with_trials(spec: TaskSpec, count: int, seed: int) -> TaskSpec:
    """Return the task with a given number of counting trials: the first of the session's, repeated where too few.

    Practice is unchanged. The order is drawn from the seed, as that of the whole session, and then listed.

    Args:
        spec: The task; its trial file has been read.
        count: Number of trials; 0 leaves the task as it is.
        seed: Seed of the session.
    """
    blocks = trial_blocks(spec)
    in_a_round = sum(len(block.trials) * block.repetitions for block in blocks if not block.practice)
    if count == 0 or in_a_round == 0:
        return spec
    rounds = math.ceil(count / in_a_round)
    longer = [
        block if block.practice else msgspec.structs.replace(block, repetitions=block.repetitions * rounds)
        for block in blocks
    ]
    kept = _first(plan_trials(longer, seed), count)
    return msgspec.structs.replace(spec, trials=[_listed(name, list(trials)) for name, trials in _by_block(kept)])


def _first(plan: list[Trial], count: int) -> list[Trial]:
    """Return all practice, and the first `count` of the other trials."""
    numbers = [trial.number for trial in plan if not trial.practice][:count]
    return [trial for trial in plan if trial.practice or trial.number in numbers]


def _by_block(plan: list[Trial]) -> Iterator[tuple[str, Iterator[Trial]]]:
    return groupby(plan, key=lambda trial: trial.block)


def _listed(name: str, trials: list[Trial]) -> BlockSpec:
    return BlockSpec(
        name=name,
        practice=trials[0].practice,
        trials=[
            TrialSpec(
                label=trial.label, values=dict(trial.values), time_limit_s=trial.time_limit_s, rest_s=trial.rest_s
            )
            for trial in trials
        ],
    )


def _trial_moved(trial: TrialSpec, parameters: Mapping[str, ParameterSpec], direction: int) -> TrialSpec:
    values = {name: _moved(parameters[name], value, direction) for name, value in trial.values.items()}
    return msgspec.structs.replace(trial, values=values)


def _moved(parameter: ParameterSpec, value: float, direction: int) -> float:
    """Return a value moved half-way to the harder (direction 1) or easier (-1) end, on the parameter's grid."""
    if parameter.harder == 0:
        return value
    end = parameter.max if parameter.harder * direction > 0 else parameter.min
    moved = value + _SHARE * (end - value)
    if parameter.step > 0.0:
        moved = parameter.min + parameter.step * round((moved - parameter.min) / parameter.step)
    return min(max(moved, parameter.min), parameter.max)
