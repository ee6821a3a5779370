"""EncouragingMachine: state machine of a virtual person that reacts to results of trials."""

from __future__ import annotations

from collections.abc import Sequence

from mimics_app.world.components.animation import AnimationState
from mimics_app.world.content.motion.animator import Animator
from mimics_app.world.content.motion.state_machine import StateMachine

__all__ = ["EncouragingMachine"]

_IDLE, _GREET, _CHEER, _CONSOLE, _FAREWELL = "idle", "greet", "cheer", "console", "farewell"
_FADE = 0.35
"""Duration of cross-fades [s]."""
_IN_A_ROW = 3
"""Number of successes in a row that are cheered."""


class EncouragingMachine(StateMachine):
    """State machine whose reactions depend on earlier results, so that they vary.

    Args:
        animator: Animator whose lowest layer plays the clips.
        idle: Clip between reactions.
        greet: Clip at the first trial.
        praise: Clips after a success, in turn.
        cheer: Clip after a success that follows a failure, and after every third in a row.
        console: Clip after an unfinished trial.
        farewell: Clip after the last trial.

    Raises:
        KeyError: a clip is missing; the message names the nearest.
    """

    def __init__(
        self,
        animator: Animator,
        *,
        idle: str,
        greet: str,
        praise: Sequence[str],
        cheer: str,
        console: str,
        farewell: str,
    ) -> None:
        once = {_GREET: greet, _CHEER: cheer, _CONSOLE: console, _FAREWELL: farewell}
        once |= {f"praise {k}": clip for k, clip in enumerate(praise)}
        states = {_IDLE: AnimationState(clip=idle)}
        states |= {name: AnimationState(clip=clip, loop=False, next=_IDLE, fade=_FADE) for name, clip in once.items()}
        super().__init__(animator, states, (), _IDLE)
        self._praises, self._greeted = len(praise), False
        self._given, self._row, self._failed = 0, 0, False

    def trigger(self, cause: str) -> bool:
        state = self._reaction(cause)
        if state is None:
            return False
        self.enter(state, _FADE)
        return True

    def _reaction(self, cause: str) -> str | None:
        """Return the state that reacts to an event, or None."""
        if cause == "ready" and not self._greeted:
            self._greeted = True
            return _GREET
        if cause in ("timeout", "aborted"):
            self._row, self._failed = 0, True
            return _CONSOLE
        if cause == "done":
            return _FAREWELL
        if cause != "goal":
            return None
        self._row += 1
        failed, self._failed = self._failed, False
        if failed or self._row % _IN_A_ROW == 0:
            return _CHEER
        self._given += 1
        return f"praise {(self._given - 1) % self._praises}"
