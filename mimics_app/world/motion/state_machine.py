"""StateMachine of a model: states play clips, events and ends of clips start transitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimics_app.contracts.errors import require_key
from mimics_app.world.motion.animator import Animator

__all__ = ["State", "StateMachine", "Transition"]


@dataclass(frozen=True, slots=True)
class State:
    """A state: one clip.

    Attributes:
        clip: Name of the clip that plays.
        speed: Seconds of it per second.
        loop: True: it repeats from its start.
        following: Next state after a clip that does not loop, or None.
        fade: Duration of the cross-fade to that [s].
    """

    clip: str
    speed: float = 1.0
    loop: bool = True
    following: str | None = None
    fade: float = 0.25


@dataclass(frozen=True, slots=True)
class Transition:
    """A transition on an event.

    Attributes:
        target: State that starts.
        on: The event.
        source: State in which the event counts; None: any.
        fade: Duration of the cross-fade [s].
    """

    target: str
    on: str
    source: str | None = None
    fade: float = 0.25


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
        states: Mapping[str, State],
        transitions: Sequence[Transition] = (),
        start: str = "",
    ) -> None:
        self._animator = animator
        self._states = states
        self.names = frozenset(states)
        self._transitions = transitions
        named = [each.target for each in transitions] + [state.following for state in states.values()]
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
        if state.following is not None and not state.loop:
            left = self._layer.clip.duration - self._layer.at
            if left <= max(seconds, state.fade) * abs(state.speed):
                self.enter(state.following, state.fade)

    def enter(self, name: str, fade: float, share: float = 0.0) -> None:
        """Enter a state, independent of transitions.

        Args:
            name: Name of the state.
            fade: Duration of the cross-fade [s].
            share: Share of its clip that is skipped at the start, 0 to 1.

        Raises:
            KeyError: there is no such state; the message names the nearest.
        """
        require_key(name, self._states, "state")
        self.state = name
        self._layer = self._animator.change(self._states[name].clip, fade, *self._how(name))
        self._layer.at = share * self._layer.clip.duration

    def _how(self, name: str) -> tuple[float, bool]:
        return self._states[name].speed, self._states[name].loop
