"""Builder of the learning stage of a task: steps inside a trial, or demands between trials."""

from __future__ import annotations

from mimics_app.contracts.errors import UsageError
from mimics_app.contracts.messages.action_space import ActionSpace, Parameter
from mimics_app.contracts.ports.stages import Learning
from mimics_app.learning.agent import Agent
from mimics_app.learning.goals import STATES, is_among
from mimics_app.learning.policy import Policy
from mimics_app.learning.registry import check_goal, check_policy
from mimics_app.learning.stepwise import STEP_POLICIES, StepAgent

__all__ = ["build_learning", "build_with", "check_learning"]


def build_learning(policy: str, goal: str, space: ActionSpace, seed: int) -> Learning:
    """Build the learning stage.

    Args:
        policy: Name of a policy.
        goal: Text of the goal.
        space: Parameters to choose, without those the therapist has vetoed.
        seed: Seed of the session.

    Raises:
        UsageError: The policy is unknown, or it does not choose what this task asks for.
        ValueError: The goal is unknown.
    """
    stepped = _stepped(space)
    if stepped is None:
        return Agent(policy, space, seed)
    for name in STEP_POLICIES:
        if name == policy:
            return StepAgent(name, stepped, seed, 1.0 if is_among(goal, STATES) else 0.0)
    check_policy(policy)
    what = f'the policy "{policy}" chooses demands between trials; "{stepped.name}" is chosen at every step of a trial'
    raise UsageError(what, f"these can: {', '.join(STEP_POLICIES)}")


def build_with(policy: Policy, goal: str, space: ActionSpace, seed: int) -> Learning:
    """Build the learning stage of a policy that is given itself; it chooses demands, no neutral parameters.

    Raises:
        UsageError: It cannot follow the goal, or the task wants a choice at every step.
        ValueError: The goal is unknown.
    """
    if (stepped := _stepped(space)) is not None:
        raise UsageError(f'"{stepped.name}" is chosen at every step of a trial', "name a policy that does so")
    follows = getattr(policy, "follows", ())
    if not is_among(goal, follows):
        what = f'the policy {type(policy).__name__} cannot follow the goal "{goal}"'
        raise UsageError(what, f"its goals: {', '.join(follows)}" if follows else "give it an attribute follows")
    return Agent(policy, space, seed)


def check_learning(policy: str, goal: str, space: ActionSpace) -> None:
    """Check that a policy chooses what a task asks for, and can follow a goal.

    Raises:
        UsageError: It does not; the message names those that do.
        ValueError: The goal is unknown.
    """
    if _stepped(space) is None:
        check_goal(policy, goal)
        return
    build_learning(policy, goal, space, 0)
    able = [name for name, goals in STEP_POLICIES.items() if is_among(goal, goals)]
    if policy not in able:
        what = f'the policy "{policy}" cannot follow the goal "{goal}" step by step'
        raise UsageError(what, f"these can: {', '.join(able)}" if able else "name another goal, e.g. task")


def _stepped(space: ActionSpace) -> Parameter | None:
    """Return the parameter that is chosen at every step: the first one of an avatar's actions."""
    return next((p for p in space if p.kind == "avatar" and p.step > 0.0), None)
