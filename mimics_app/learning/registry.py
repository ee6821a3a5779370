"""Registry of policies: the built-in ones, and those of installed packages (entry points `mimics_app.policies`)."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.plugins import load_plugin
from mimics_app.learning.bandits import LinUcb, Thompson
from mimics_app.learning.policy import Policy
from mimics_app.learning.rules import Fixed, KalmanSkill, Proportional, RandomLevel, Staircase
from mimics_app.learning.temporal import ActorCritic, SarsaLambda, TabularQ

__all__ = ["ENTRY_POINT_GROUP", "EXPLORERS", "POLICIES", "build_policy", "check_policy"]

ENTRY_POINT_GROUP = "mimics_app.policies"

POLICIES: dict[str, Callable[[], Policy]] = {
    "fixed": Fixed,
    "random": RandomLevel,
    "staircase": Staircase,
    "proportional": Proportional,
    "kalman_performance": lambda: KalmanSkill(use_load=False),
    "kalman": KalmanSkill,
    "linucb": LinUcb,
    "thompson": Thompson,
    "q": TabularQ,
    "sarsa": SarsaLambda,
    "actor_critic": ActorCritic,
}
"""Built-in policies by name."""

EXPLORERS = frozenset({"random", "linucb", "thompson", "q", "sarsa", "actor_critic"})
"""Built-in policies that explore."""


def check_policy(name: str) -> None:
    """Check that a policy exists.

    Raises:
        UsageError: There is none of this name.
    """
    names = [*POLICIES, *(point.name for point in entry_points(group=ENTRY_POINT_GROUP))]
    if name not in names:
        raise UsageError(f'there is no policy "{name}"', nearest(name, names))


def build_policy(name: str) -> Policy:
    """Build a policy by its name.

    Raises:
        UsageError: There is none of this name.
    """
    check_policy(name)
    if name in POLICIES:
        return POLICIES[name]()
    (point,) = entry_points(group=ENTRY_POINT_GROUP, name=name)
    try:
        builder: Callable[[], Policy] = load_plugin(point)
    except ValueError as fault:
        raise UsageError(f'there is no policy "{name}": {fault}') from fault
    return builder()
