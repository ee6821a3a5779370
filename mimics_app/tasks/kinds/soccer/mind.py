"""The mind of a soccer player: from what it sees to how it walks and when it kicks, by a skill of 0 to 1.

One policy plays the opponent and a simulated person. It chases the ball from behind, dribbles it towards the goal,
shoots where the way is straight, tackles who has the ball, and keeps its own goal. With a skill below 1 it is slower,
sees the ball late, and aims badly; with skill 0 it only keeps its goal.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

__all__ = ["Act", "Deed", "Mind", "PlayerView"]

_BEHIND = 0.85
"""How far behind the ball a player goes before dribbling it [m]."""
_REACH = 0.95
"""Distance of the ball at which a player shoots [m]."""
_SHOOTS = 11.0
"""Distance from the goal within which a player shoots [m]."""
_ALIGNED, _PATIENCE = 0.26, 0.19
"""Angle between heading and goal within which a player without skill shoots, and how much less it is with skill 1."""
_OWNS = 0.9
"""Distance at which the other one has the ball [m]."""
_TURN, _MOST_TURN = 4.0, 2.4
"""Rate of turn per angle left [1/s], and the largest one [rad/s]."""
_LATE_S, _ASKEW = 0.9, 0.45
"""Delay of what is seen [s] and standard deviation of the aim [rad] without any skill."""
_KEEPS = 1.6
"""Distance before the own goal at which a keeper stands [m]."""
_LOOKAHEAD_S = 0.4
"""How far ahead a player with skill 1 sees the ball [s]."""
_CORNER = 1.0
"""How far aside of the goal's middle a player with skill 1 aims, past the other one [m]."""
_FRAME_S = 1.0 / 60.0


class Act(StrEnum):
    """What a player does."""

    CHASE = "chase"
    TACKLE = "tackle"
    DRIBBLE = "dribble"
    SHOOT = "shoot"
    KEEP = "keep"


@dataclass(frozen=True, slots=True)
class PlayerView:
    """What a player sees. Places are x + i z [m], velocities likewise [m/s].

    Attributes:
        me, heading: The player's place, and angle about +y from +z [rad].
        other: Place of the other player.
        ball, ball_velocity: The ball's.
        goal: Middle of the goal to be scored in; the own goal is at its opposite.
    """

    me: complex
    heading: float
    other: complex
    ball: complex
    ball_velocity: complex
    goal: complex


@dataclass(frozen=True, slots=True)
class Deed:
    """What a player does in a frame.

    Attributes:
        act: What it is.
        speed: Share of the largest speed.
        turn: Rate of turn to the left [rad/s].
        kicks: Whether a kick begins.
    """

    act: Act
    speed: float
    turn: float
    kicks: bool = False


class Mind:
    """One player.

    Args:
        skill: 0 to 1.
        rng: Source of errors of aim.

    Attributes:
        skill: It may change during a match.
    """

    def __init__(self, skill: float, rng: np.random.Generator) -> None:
        self.skill = skill
        self._rng = rng
        self._seen: deque[complex] = deque(maxlen=64)
        self._askew = 0.0

    def decide(self, view: PlayerView) -> Deed:
        """Return what to do in a frame of a 60th of a second."""
        self._seen.append(view.ball)
        late = round((1.0 - self.skill) * _LATE_S / _FRAME_S)
        ball = self._seen[max(len(self._seen) - 1 - late, 0)]
        if self.skill <= 0.0:
            return self._go(view, self._keeping(view, ball), Act.KEEP)
        ball += self.skill * _LOOKAHEAD_S * view.ball_velocity
        if self._threatened(view, ball):
            return self._go(view, self._keeping(view, ball), Act.KEEP)
        way = self._target(view, ball) - ball
        behind = ball - _BEHIND * way / max(abs(way), 1e-6)
        ahead = ((ball - view.me) * way.conjugate()).real / max(abs(way), 1e-6)
        aside = abs(((ball - view.me) * way.conjugate()).imag) / max(abs(way), 1e-6)
        if ahead < 0.15 or aside > 0.6 * ahead + 0.12:
            act = Act.TACKLE if abs(view.other - ball) < _OWNS else Act.CHASE
            return self._go(view, self._round(view, ball, behind, ahead), act)
        return self._attack(view, ball, way)

    def _attack(self, view: PlayerView, ball: complex, way: complex) -> Deed:
        """Dribble the ball, or shoot it."""
        aim = math.atan2(way.real, way.imag) + self._askew
        to_ball = ball - view.me
        near = abs(to_ball) < _REACH
        off = math.remainder(aim - view.heading, 2.0 * math.pi)
        if near and abs(way) < _SHOOTS and abs(off) < _ALIGNED - _PATIENCE * self.skill:
            self._askew = float(self._rng.normal(0.0, (1.0 - self.skill) * _ASKEW))
            return Deed(Act.SHOOT, 1.0, self._turn(off), kicks=True)
        target = aim if near else math.atan2(to_ball.real, to_ball.imag)
        return Deed(Act.DRIBBLE, 1.0, self._turn(math.remainder(target - view.heading, 2.0 * math.pi)))

    def _target(self, view: PlayerView, ball: complex) -> complex:
        """Return the place in the goal to aim at: the corner that the other one does not cover."""
        covered = ((view.other - ball) * (view.goal - ball).conjugate()).imag * (1.0 if view.goal.imag > 0.0 else -1.0)
        side = -1.0 if covered < 0.0 else 1.0
        return view.goal + side * _CORNER * self.skill

    def _round(self, view: PlayerView, ball: complex, behind: complex, ahead: float) -> complex:
        """Return the way to behind the ball that does not push it back: past its side."""
        if ahead > 0.15:
            return behind
        aside = 1j * (behind - ball)
        side = 1.0 if ((view.me - ball) * aside.conjugate()).real >= 0.0 else -1.0
        past = ball + side * aside * 1.1
        return past if abs(view.me - past) > 0.3 else behind

    def _threatened(self, view: PlayerView, ball: complex) -> bool:
        """Whether the ball comes fast at the own goal, and the player is between both."""
        own = -view.goal
        closing = (view.ball_velocity * (own - ball).conjugate()).real / max(abs(own - ball), 1e-6)
        return closing > 2.0 and abs(own - view.me) < abs(own - ball)

    def _keeping(self, view: PlayerView, ball: complex) -> complex:
        """Return where a keeper stands: before the own goal, on the ball's way to it."""
        own = -view.goal
        way = ball - own
        return own + min(_KEEPS, 0.5 * abs(way)) * way / max(abs(way), 1e-6)

    def _go(self, view: PlayerView, place: complex, act: Act) -> Deed:
        """Walk to a place."""
        way = place - view.me
        far = abs(way)
        if far < 0.12:
            ball = view.ball - view.me
            off = math.remainder(math.atan2(ball.real, ball.imag) - view.heading, 2.0 * math.pi)
            return Deed(act, 0.0, self._turn(off))
        off = math.remainder(math.atan2(way.real, way.imag) - view.heading, 2.0 * math.pi)
        speed = max(math.cos(off), 0.15) * min(1.0, far / 0.4)
        return Deed(act, speed, self._turn(off))

    @staticmethod
    def _turn(off: float) -> float:
        return min(max(_TURN * off, -_MOST_TURN), _MOST_TURN)
