"""StateMachine of a model: states play clips, events and ends of clips start transitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mimics_app.contracts.errors import require_key
from mimics_app.world.components.animation import AnimationState, AnimationTransition
from mimics_app.world.content.motion.animator import Animator

__all__ = ["StateMachine"]


class StateMachine:
    """State machine of an animator's lowest layer.

    Args:
        animator: The animator.
        states: States by name, at least one.
        transitions: Transitions; the first that matches is taken.
        start: Initial state; "": the first.

    Attributes:
        state: Name of the present state.
        names: Names of all states.

    Raises:
        KeyError: a state or a clip is missing; the message names the nearest.
    """

    def __init__(
        self,
        animator: Animator,
        states: Mapping[str, AnimationState],
        transitions: Sequence[AnimationTransition] = (),
        start: str = "",
    ) -> None:
        self._animator = animator
        self._states = states
        self.names = frozenset(states)
        self._transitions = transitions
        named = [each.target for each in transitions] + [state.next for state in states.values()]
        for name in (start or next(iter(states)), *(each for each in named if each is not None)):
            require_key(name, states, "state")
        self.state = start or next(iter(states))
        self._layer = animator.change(states[self.state].clip, 0.0, *self._how(self.state))
        animator.directors.append(self.step)

    def trigger(self, cause: str) -> bool:
        """Handle an event; return True when a state starts."""
        for transition in self._transitions:
            if transition.on == cause and transition.source in (None, self.state):
                self.enter(transition.target, transition.fade)
                return True
        return False

    def step(self, seconds: float) -> None:
        """Enter the next state when the clip ends within this time step [s]."""
        state = self._states[self.state]
        if state.next is not None and not state.loop:
            left = self._layer.clip.duration - self._layer.at
            if left <= max(seconds, state.fade) * abs(state.speed):
                self.enter(state.next, state.fade)

    def enter(self, name: str, fade: float, share: float = 0.0) -> None:
        """Enter a state, independent of transitions.

        Args:
            name: Name of the state.
            fade: Duration of the cross-fade [s].
            share: Share of its clip that is skipped at the start, 0 to 1.

        Raises:
            KeyError: the state is unknown; the message names the nearest.
        """
        require_key(name, self._states, "state")
        self.state = name
        self._layer = self._animator.change(self._states[name].clip, fade, *self._how(name))
        self._layer.at = share * self._layer.clip.duration

    def _how(self, name: str) -> tuple[float, bool]:
        return self._states[name].speed, self._states[name].loop
