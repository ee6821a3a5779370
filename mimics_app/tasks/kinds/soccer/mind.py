"""The mind of a soccer player: from what it sees to how it walks and when it kicks, by a skill of 0 to 1.

One policy plays the opponent and a simulated person. It chases the ball from behind, dribbles it towards the goal,
shoots where the ball would go between the posts, tackles who has the ball, clears it when pressed, and keeps its own
goal. With a skill below 1 it is slower, sees the ball late, and aims badly; with skill 0 it only keeps its goal.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

__all__ = ["Act", "Deed", "Mind", "PlayerView", "turn_to_ball"]

_BEHIND = 0.85
"""How far behind the ball a player goes before dribbling it [m]."""
_REACH, _SWEPT = 0.95, 0.16
"""Distance of the ball at which a player shoots, and how far it may be aside of the swinging leg [m]."""
_SHOOTS, _FARTHER = 9.0, 7.0
"""Distance from the goal within which a player without skill shoots, and from how much farther one with skill 1 [m]."""
_CLEARS, _AWAY = 0.6, 0.3
"""Skill from which on a player clears a ball that the other one may reach, and least cosine to the goal for it."""
_BESIDE = 0.2
"""Distance from where a player can get, aside, within which the ball lies at a board [m]."""
_TURNED = 0.4
"""Angle between heading and a near ball from which on a player hardly walks until they have turned [rad]."""
_INSIDE = 0.25
"""Distance from a post within which a player does not aim [m]."""
_OWNS = 0.9
"""Distance at which the other one has the ball [m]."""
_TURN, _MOST_TURN, _NIMBLE = 4.0, 2.4, 1.6
"""Rate of turn per angle left [1/s], the largest one without skill, and what skill 1 adds to it [rad/s]."""
_LATE_S, _ASKEW = 0.9, 0.45
"""Delay of what is seen [s] and standard deviation of the aim [rad] without any skill."""
_KEEPS = 1.6
"""Distance before the own goal at which a keeper stands [m]."""
_LOOKAHEAD_S, _RUNS = 0.8, 3.0
"""How far ahead a player with skill 1 sees the ball at most [s], and the speed for which they reckon [m/s]."""
_FRAME_S = 1.0 / 60.0
_BACK, _PAST = 1.3, 0.7
"""Where a person who is not before the ball goes: before it, and past its side while it is behind them [m]."""
_ACROSS, _CONE = 0.1, 0.35
"""Distance across the way to the goal up to which the ball is run at: here [m], and more per metre to go."""
_IN_LINE = 0.5
"""Share of the distance from the ball at which the way there comes into line with the goal."""
_FOOT = 0.1
"""Distance of a foot's plane from the middle [m]."""
_LED_TURN = 1.8
"""Largest rate of turn of a person whose legs are led [rad/s]."""


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
        post: Half the width of a goal [m].
        bounds: Greatest distances of a player's place from the middle of the pitch, x + i z [m].
    """

    me: complex
    heading: float
    other: complex
    ball: complex
    ball_velocity: complex
    goal: complex
    post: float
    bounds: complex


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
        if self._would_score(view, ball):
            self._askew = float(self._rng.normal(0.0, (1.0 - self.skill) * _ASKEW))
            return Deed(Act.SHOOT, 1.0, 0.0, kicks=True)
        ball += self.skill * min(abs(ball - view.me) / _RUNS, _LOOKAHEAD_S) * view.ball_velocity
        if self._threatened(view, ball):
            return self._go(view, self._keeping(view, ball), Act.KEEP)
        way = view.goal - ball
        behind = _within(ball - _BEHIND * way / max(abs(way), 1e-6), view.bounds)
        to_ball = ball - view.me
        if self._between_posts(view, ball, to_ball):
            return self._attack(view, to_ball)
        act = Act.TACKLE if abs(view.other - ball) < _OWNS else Act.CHASE
        ahead = (to_ball * way.conjugate()).real / max(abs(way), 1e-6)
        return self._go(view, self._round(view, ball, behind, ahead), act)

    def _would_score(self, view: PlayerView, ball: complex) -> bool:
        """Whether the leg would meet the ball, and send it between the posts as far as the player can tell."""
        ahead = complex(math.sin(view.heading), math.cos(view.heading))
        place = (ball - view.me) * ahead.conjugate()
        if not (0.2 < place.real < _REACH and abs(place.imag) < _SWEPT):
            return False
        way = view.goal.imag - ball.imag
        pressed = abs(view.other - ball) < 2.0 * _OWNS or abs(ball.real) > view.bounds.real - _BESIDE
        if self.skill > _CLEARS and pressed and ahead.imag * way > _AWAY * abs(way):
            return True
        aim = ahead * complex(math.cos(self._askew), math.sin(self._askew))
        return abs(way) < _SHOOTS + _FARTHER * self.skill and self._between_posts(view, ball, aim)

    @staticmethod
    def _between_posts(view: PlayerView, ball: complex, aim: complex) -> bool:
        """Whether a ball that is sent along a direction goes between the posts."""
        way = view.goal.imag - ball.imag
        if aim.imag * way <= 0.0:
            return False
        return abs(ball.real + aim.real / aim.imag * way - view.goal.real) < view.post - _INSIDE

    def _attack(self, view: PlayerView, to_ball: complex) -> Deed:
        """Run at the ball, which is before the goal; near it, turn to it first."""
        off = math.remainder(math.atan2(to_ball.real, to_ball.imag) - view.heading, 2.0 * math.pi)
        speed = 1.0 if abs(to_ball) > _REACH else max(1.0 - abs(off) / _TURNED, 0.1)
        return Deed(Act.DRIBBLE, speed, self._turn(off))

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

    def _turn(self, off: float) -> float:
        most = _MOST_TURN + _NIMBLE * self.skill
        return min(max(_TURN * off, -most), most)


def turn_to_ball(view: PlayerView) -> float:
    """Return the rate of turn to the left [rad/s] of a person in a gait orthosis.

    The legs walk on, and nobody turns by them. Far from the ball the way goes to where the goal lies behind it; near
    it, to where the nearer foot meets it.
    """
    to_ball, goal = view.ball - view.me, view.goal - view.ball
    ahead = complex(math.sin(view.heading), math.cos(view.heading))
    way = goal / max(abs(goal), 1e-6)
    left = to_ball * way.conjugate()  # along the way to the goal, and across it to the right
    if left.real > 0.0 and abs(left.imag) < _ACROSS + _CONE * left.real:
        aside = (to_ball * ahead.conjugate()).imag
        aim = to_ball - _IN_LINE * (left.real - abs(left.imag)) * way - 1j * math.copysign(_FOOT, aside) * ahead
    else:
        past = math.copysign(_PAST, left.imag) if left.real < _BACK / 2.0 else 0.0
        aim = to_ball - (_BACK + 1j * past) * way
    off = math.remainder(math.atan2(aim.real, aim.imag) - view.heading, 2.0 * math.pi)
    return min(max(_TURN * off, -_LED_TURN), _LED_TURN)


def _within(place: complex, bounds: complex) -> complex:
    """Return the place nearest to one at which a player can stand."""
    return complex(min(max(place.real, -bounds.real), bounds.real), min(max(place.imag, -bounds.imag), bounds.imag))
