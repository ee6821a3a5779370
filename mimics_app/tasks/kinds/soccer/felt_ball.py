"""The ball at the feet of a person in a gait orthosis: a body of the haptic loop while a foot is at it.

The loop works in the person's frame: x ahead of the hips, y up, z to the right. Away from the feet the ball is the
task's, with its exact motions, and the body is placed where the ball is. Shortly before a foot meets it the body is
left to the loop, in which foot and ball push each other in every tick; the task then takes place and velocity from the
body, and has the ball again once the foot has left it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mimics_app.contracts.arrays import F8, Vec3
from mimics_app.contracts.loop.loop_fields import PointSnapshot
from mimics_app.contracts.messages.orders import HapticField, Numbers
from mimics_app.tasks.kinds.soccer.ball import SoccerBall
from mimics_app.tasks.observation import Observation
from mimics_app.tasks.walking.walker import Walker

__all__ = ["FeltBall"]

_REACH, _BROAD = 0.16, 0.05
"""Distance of a foot's point from the body's axis at which they touch, and half the length of that axis [m]."""
_NEAR, _SOON_S = 0.01, 0.06
"""Distance of foot and ball [m] and time before their touch [s] from which on the loop has the ball: some frames."""
_BEYOND, _PARKED = 1.5, 3.0
"""Distance from which on the body need not follow the ball, and how far ahead it is then [m]."""
_OFF, _OTHER = 0.004, 0.03
"""Differences of place [m] and velocity [m/s] of ball and body from which on the body is placed anew."""
_PUT = 0.2
"""Way of the person from one frame to the next from which on they were put elsewhere [m]: nobody walks at 12 m/s."""
_OWN_PLACEMENT = 1
"""Number of the scene's own placement of a body."""


@dataclass(frozen=True, slots=True)
class _Hips:
    """Frame of the person: hips on the ground, x + i z.

    Attributes:
        at: Place [m].
        ahead: Heading, of length 1.
        t_ns: Time of the frame [ns].
        moves: Velocity over the ground [m/s].
        turn: Rate of turn to the left [rad/s].
    """

    at: complex
    ahead: complex
    t_ns: int
    moves: complex
    turn: float

    @classmethod
    def of(cls, walker: Walker, before: _Hips | None, t_ns: int) -> _Hips:
        """Return that of a walker, who was at `before` in the last frame and may have been put elsewhere since."""
        at, ahead = complex(walker.x, walker.z), cmath.rect(1.0, 0.5 * math.pi - walker.yaw)
        if before is None or t_ns <= before.t_ns or abs(at - before.at) > _PUT:
            return cls(at, ahead, t_ns, walker.speed * ahead, 0.0)
        seconds = (t_ns - before.t_ns) * 1e-9
        turned = -cmath.phase(ahead * before.ahead.conjugate())
        return cls(at, ahead, t_ns, (at - before.at) / seconds, turned / seconds)

    def velocity(self, moves: F8, at: F8) -> F8:
        """Return a velocity over the ground at a place as seen by the person [m/s], [3]."""
        own = (complex(moves[0], moves[2]) - self.moves) * self.ahead.conjugate() + 1j * self.turn * self.place(at)
        return np.array([own.real, moves[1], own.imag])

    def over_ground(self, own: complex, place: complex) -> complex:
        """Return the velocity over the ground [m/s] of what the person sees moving by `own` at a place."""
        return (own - 1j * self.turn * place) * self.ahead + self.moves

    def place(self, at: F8) -> complex:
        """Return a place on the ground as seen by the person [m]."""
        return (complex(at[0], at[2]) - self.at) * self.ahead.conjugate()


class _Seen(NamedTuple):
    """The body in a frame.

    Attributes:
        place: As the person sees it [m].
        t_ns: Time of that place, the loop's [ns].
        touched: Whether a foot touched it in the hundredths of a second before.
    """

    place: Vec3
    t_ns: int
    touched: bool


class FeltBall:
    """The ball as a body of the loop.

    Args:
        body: Its name.
        height: Of its middle in the person's frame while the ball lies on the ground [m].

    Attributes:
        held: Whether the loop moves the ball.
    """

    def __init__(self, body: str, height: float) -> None:
        self._body, self._height = body, height
        self._spawn = _OWN_PLACEMENT
        self._orders: dict[HapticField, Numbers] = {}
        self.restart()

    def restart(self) -> None:
        """Let the task have the ball."""
        self.held = self._touched = False
        self._moves: F8 | None = None  # velocity with which the body was placed
        self._before: _Seen | None = None
        self._hips: _Hips | None = None
        self._given: tuple[F8, F8] | None = None  # place and velocity that the task's ball was given

    @property
    def orders(self) -> Mapping[HapticField, Numbers]:
        """Where the body was placed last."""
        return self._orders

    def follow(self, seen: Observation, ball: SoccerBall, walker: Walker) -> float:
        """Take a frame, after ball and walker have moved.

        Args:
            seen: The frame.
            ball: The task's ball; set to the body while the loop moves it.
            walker: The person.

        Returns:
            Speed of the foot that begins to touch the ball [m/s]; 0 without one.
        """
        place = seen.bodies.get(self._body)
        if place is None:
            return 0.0
        feet = [point.speed for point in seen.points if point.touching]
        begins, self._touched = bool(feet) and not self._touched, bool(feet)
        hips = self._hips = _Hips.of(walker, self._hips, seen.now_ns)  # the walker goes by frames
        body = _Seen(place, seen.snapshot.t_ns, bool(feet))
        moves = hips.velocity(ball.velocity, ball.place)
        near = any(_meet_soon(point, body, moves) for point in seen.snapshot.points)
        if self._is_moved_by_others(ball):
            self.held = near = False
        elif self.held or self._touched:
            self.held = self._take(body, ball, hips) or near
        if not self.held:
            self._place(body, ball, hips)
            self.held, self._before = near, None
        self._given = (ball.place.copy(), ball.velocity.copy()) if self.held else None
        return max(feet) if begins else 0.0

    def _is_moved_by_others(self, ball: SoccerBall) -> bool:
        """Whether a board, somebody's body, the opponent or a kick-off has moved the ball that the loop holds."""
        if self._given is None:
            return False
        place, velocity = self._given
        return not (np.array_equal(ball.place, place) and np.array_equal(ball.velocity, velocity))

    def _take(self, body: _Seen, ball: SoccerBall, hips: _Hips) -> bool:
        """Give place and velocity of the body to the ball; return whether a foot may still have pushed it."""
        before, self._before = self._before, body
        radius, (x, y, z) = ball.spec.radius, body.place
        at = hips.at + hips.ahead * complex(x, z)
        ball.place[:] = at.real, max(radius + y - self._height, radius), at.imag
        if before is None or body.t_ns <= before.t_ns:
            return True
        seconds = (body.t_ns - before.t_ns) * 1e-9  # of the loop; the hips move by the time of the frames
        was_x, was_y, was_z = before.place
        moves = hips.over_ground(complex(x - was_x, z - was_z) / seconds, complex(x, z))
        ball.velocity[:] = moves.real, max((y - was_y) / seconds, 0.0), moves.imag
        return body.touched or before.touched

    def _place(self, body: _Seen, ball: SoccerBall, hips: _Hips) -> None:
        """Place the body where the ball is, unless it is there."""
        now, moves = hips.place(ball.place), hips.velocity(ball.velocity, ball.place)
        up = self._height + float(ball.place[1]) - ball.spec.radius
        if abs(now) > _BEYOND:
            now, moves = complex(_PARKED), np.zeros(3)
        off = math.dist(body.place, (now.real, up, now.imag))
        if self._moves is not None and off < _OFF and float(np.abs(moves - self._moves).max()) < _OTHER:
            return
        self._moves = moves
        self._spawn += 1
        placed: dict[str, Numbers] = {
            "spawn": self._spawn,
            "position": (now.real, up, now.imag),
            "velocity": tuple(moves.tolist()),
        }
        self._orders = {HapticField(field, "bodies", self._body): numbers for field, numbers in placed.items()}


def _meet_soon(point: PointSnapshot, body: _Seen, moves: F8) -> bool:
    """Whether a foot and the body, which moves at a velocity [m/s], meet within some frames."""
    away = np.array(body.place) - point.hip_world
    away[2] = math.copysign(max(abs(away[2]) - _BROAD, 0.0), away[2])
    far = max(float(np.linalg.norm(away)), 1e-9)
    closing = float((point.v_world - moves) @ away) / far
    return far - _REACH < _NEAR + _SOON_S * max(closing, 0.0)
