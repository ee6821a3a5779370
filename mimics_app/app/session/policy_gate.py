"""What a policy may do: its choices are carried out, only recorded, or proposed to the operator."""

from __future__ import annotations

from typing import Literal

from mimics_app.contracts.commands.vocabulary import Reply
from mimics_app.contracts.messages.stage_messages import TaskAction

__all__ = ["PolicyGate", "PolicyMode"]

PolicyMode = Literal["on", "off", "propose"]


class PolicyGate:
    """Stands between the learning system and the task.

    In each mode the policy is asked and learns from what was played, so that it can be switched on again and a replay
    asks it the same.

    Args:
        has_policy: Whether the session has a policy or a list of actions.

    Attributes:
        mode: "on": carried out; "off": recorded only; "propose": the newest choice waits for `confirm`.
        proposal: The choice that waits; None without one.
    """

    def __init__(self, *, has_policy: bool) -> None:
        self._has_policy = has_policy
        self.mode: PolicyMode = "on"
        self.proposal: TaskAction | None = None
        self._confirmed: TaskAction | None = None

    def switch(self, mode: PolicyMode) -> Reply:
        """Change the mode; a proposal that waits is dropped."""
        if not self._has_policy:
            return Reply(done=False, why="this session has no policy")
        self.mode, self.proposal = mode, None
        return Reply(done=True)

    def confirm(self, *, accept: bool) -> Reply:
        """Carry out the proposal in this frame, or drop it."""
        if self.proposal is None:
            return Reply(done=False, why="nothing is proposed")
        if accept:
            self._confirmed = self.proposal
        self.proposal = None
        return Reply(done=True)

    def passed(self, action: TaskAction | None) -> TaskAction | None:
        """Return what of a new choice is carried out with the next frame."""
        if self.mode == "propose" and action is not None:
            self.proposal = action
        return action if self.mode == "on" else None

    def take_confirmed(self) -> TaskAction | None:
        """Return the proposal that was confirmed in this frame."""
        confirmed, self._confirmed = self._confirmed, None
        return confirmed
