"""Conformance kit of policies: what the agent and the cohorts take for granted of one, built in or of a package."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import deepcopy

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.learning.goals import build_goal
from mimics_app.learning.policy import REWARDS, Choice, Outcome, Policy

SEED = 20
TRIALS = 30
OVERRULED = 0.15
"""Share of trials at another demand than the chosen one: the scene's limits, or the therapist."""


def check_policy(build: Callable[[], Policy]) -> None:
    """Play trials of one person, as a session does, and of seven; raises AssertionError at what it must not do."""
    follows = build().follows
    assert follows and all(goal.partition(":")[0] in REWARDS for goal in follows), "it says which goals it can follow"
    assert all(build_goal(goal) for goal in follows if ":" in goal), "it says which goals it can follow"
    for people in (1, 7):
        first, again = (_played(build(), people) for _ in range(2))
        for one, other in zip(first, again, strict=True):
            np.testing.assert_array_equal(one.demand, other.demand, "its chance is the generator it is given")


def _played(policy: Policy, people: int) -> list[Choice]:
    """The choices of a policy; learning comes first: a session begins with the trial that its scene asks for."""
    chance = np.random.default_rng(SEED)
    start = np.linspace(0.3, 0.7, people)
    policy.begin(start, np.random.default_rng(SEED))
    np.testing.assert_array_equal(start, np.linspace(0.3, 0.7, people), "it changes nothing of the caller's")
    choices: list[Choice] = []
    copies: list[tuple[F8, F8]] = []
    demand = start
    for outcome in _outcomes(chance, people):
        outcome.demand[:] = np.where(chance.random(people) < OVERRULED, chance.random(people), demand)
        given = deepcopy(outcome)
        policy.learn(outcome)
        for name in Outcome.__slots__:
            what = f"it changes nothing of the caller's: {name}"
            np.testing.assert_array_equal(getattr(outcome, name), getattr(given, name), what)
        choice = policy.act()
        _check_choice(choice, people)
        choices.append(choice)
        copies.append((choice.demand.copy(), choice.propensity.copy()))
        demand = choice.demand
    for choice, (demand, propensity) in zip(choices, copies, strict=True):
        np.testing.assert_array_equal(choice.demand, demand, "a choice that was made stays what it was")
        np.testing.assert_array_equal(choice.propensity, propensity, "a choice that was made stays what it was")
    return choices


def _outcomes(chance: np.random.Generator, people: int) -> Iterator[Outcome]:
    """Trials with everything known, with single values unknown, with nothing known, and all failed or succeeded."""
    for trial in range(TRIALS):
        known = [chance.random(people) for _ in range(5)]
        if trial % 3 == 1:
            known = [np.where(chance.random(people) < 0.5, np.nan, value) for value in known]
        if trial % 7 == 6:
            known = [np.full(people, np.nan) for _ in known]
        if trial % 5 == 4:
            known[1] = np.full(people, float(trial % 2))
        yield Outcome(*known)


def _check_choice(choice: Choice, people: int) -> None:
    for values in (choice.demand, choice.propensity):
        assert values.shape == (people,) and values.dtype == np.float64, "a choice has a row for each person"
    assert ((choice.demand >= 0.0) & (choice.demand <= 1.0)).all(), "a demand is 0 to 1, whatever is unknown"
    inside = (choice.propensity > 0.0) & (choice.propensity <= 1.0 + 1e-12)
    assert inside.all(), "what was chosen was possible: off-policy evaluation divides by its propensity"
