"""States of a model: which clip plays until something happens, and how one goes over to the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimics_app.contracts.errors import nearest
from mimics_app.world.motion.animator import Animator

__all__ = ["State", "StateMachine", "Transition"]


@dataclass(frozen=True, slots=True)
class State:
    """What is done until something else is.

    Attributes:
        clip: Name of the clip that plays.
        speed: Seconds of it in a second.
        loop: Whether it begins again at its end.
        following: State that follows when one that does not loop has ended, or None.
        fade: In which it goes over to that [s].
    """

    clip: str
    speed: float = 1.0
    loop: bool = True
    following: str | None = None
    fade: float = 0.25


@dataclass(frozen=True, slots=True)
class Transition:
    """What makes something else be done.

    Attributes:
        target: State that begins.
        on: What has to happen.
        source: State in which it counts; None: any.
        fade: In which one goes over to the other [s].
    """

    target: str
    on: str
    source: str | None = None
    fade: float = 0.25


class StateMachine:
    """Has an animator do one thing after the other.

    Args:
        animator: Whose lowest layer shows the state.
        states: By name, at least one.
        transitions: The first that fits counts.
        start: State it begins with; "": the first.

    Attributes:
        state: Name of the present one.
        names: Of all states.

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
            if name not in states:
                raise KeyError(f'no state "{name}"; {nearest(name, states)}')
        self.state = start or next(iter(states))
        self._layer = animator.change(states[self.state].clip, 0.0, *self._how(self.state))
        animator.directors.append(self.step)

    def trigger(self, cause: str) -> bool:
        """Pass on what happened; returns whether another state begins."""
        for transition in self._transitions:
            if transition.on == cause and transition.source in (None, self.state):
                self.enter(transition.target, transition.fade)
                return True
        return False

    def step(self, seconds: float) -> None:
        """Go on to what follows a clip that ends within this time [s]."""
        state = self._states[self.state]
        if state.following is not None and not state.loop:
            left = self._layer.clip.duration - self._layer.at
            if left <= max(seconds, state.fade) * abs(state.speed):
                self.enter(state.following, state.fade)

    def enter(self, name: str, fade: float, share: float = 0.0) -> None:
        """Begin a state, whatever transitions say.

        Args:
            name: Of the state.
            fade: In which it comes up [s].
            share: Of its clip that is left out at the beginning, 0 to 1.

        Raises:
            KeyError: there is no such state; the message names the nearest.
        """
        if name not in self._states:
            raise KeyError(f'no state "{name}"; {nearest(name, self._states)}')
        self.state = name
        self._layer = self._animator.change(self._states[name].clip, fade, *self._how(name))
        self._layer.at = share * self._layer.clip.duration

    def pace(self, factor: float) -> None:
        """Play the present state's clip at so many times the speed that its state says."""
        self._layer.speed = factor * self._states[self.state].speed

    def _how(self, name: str) -> tuple[float, bool]:
        return self._states[name].speed, self._states[name].loop
