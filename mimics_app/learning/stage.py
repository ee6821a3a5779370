"""The learning stage of a scene that is not adapted."""

from __future__ import annotations

from mimics_app.contracts.messages import TaskAction, UserState

__all__ = ["NullLearning"]


class NullLearning:
    """Leaves the task as it is."""

    def choose(self, state: UserState, now_ns: int) -> TaskAction | None:
        """No adaptation."""
        return None
