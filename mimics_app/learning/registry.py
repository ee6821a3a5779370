"""Registry of policies: the built-in ones, and those of installed packages (entry points `mimics_app.policies`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import cast

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.ports.members import load_member, member_names
from mimics_app.contracts.ports.plugins import PluginError, PluginGroup, fault_of_builder
from mimics_app.learning import policies
from mimics_app.learning.goals import is_among
from mimics_app.learning.policy import Policy

__all__ = ["PLUGINS", "POLICIES", "build_policy", "check_goal", "check_policy"]

PLUGINS = PluginGroup("mimics_app.policies", fault_of_builder(Policy))

POLICIES: Mapping[str, Callable[[], Policy]] = {
    name: build
    for module in member_names(policies)
    for name, build in load_member(policies, module, "POLICIES", dict).items()
}
"""Builders of the built-in policies by name."""


def check_policy(name: str) -> None:
    """Check that a policy exists.

    Raises:
        UsageError: There is none of this name, or its plug-in cannot be loaded.
    """
    _find(name)


def check_goal(name: str, goal: str) -> None:
    """Check that a policy can follow a goal.

    Raises:
        UsageError: It cannot, or declares no goals; the message names the built-in ones that can.
        ValueError: The goal is unknown.
    """
    follows = getattr(build_policy(name), "follows", ())
    if is_among(goal, follows):
        return
    able = ", ".join(other for other, build in POLICIES.items() if is_among(goal, build().follows))
    what = f"follows {' and '.join(follows)} only" if follows else "declares no goals that it follows"
    raise UsageError(f'the policy "{name}" cannot follow the goal "{goal}": it {what}', f"these can: {able}")


def build_policy(name: str) -> Policy:
    """Build a policy by its name.

    Raises:
        UsageError: There is none of this name, or its plug-in cannot be loaded.
    """
    return _find(name)()


def _find(name: str) -> Callable[[], Policy]:
    if name in POLICIES:
        return POLICIES[name]
    names = PLUGINS.names()
    if name not in names:
        raise UsageError(f'there is no policy "{name}"', nearest(name, [*POLICIES, *names]))
    try:
        return cast(Callable[[], Policy], PLUGINS.load(name))
    except PluginError as error:
        raise UsageError(f'the policy "{name}" is not available: {error}') from error
