"""A match of two in a walled pitch: legs that kick, the ball, goals, kick-offs.

The pitch is in the plane of the ground about its middle; the person attacks towards -z, the opponent towards +z.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.messages.leg_motion import LegMotion
from mimics_app.tasks.kinds.soccer.ball import SoccerBall
from mimics_app.tasks.kinds.soccer.mind import Act, Mind, PlayerView
from mimics_app.tasks.walking.footfalls import ankle
from mimics_app.tasks.walking.legs import GAITS, Impairment
from mimics_app.tasks.walking.walker import HALF_STEP_WIDTH, Walker

__all__ = ["PACE", "Happening", "Match", "Pitch", "Player"]

_TIP = 0.17
"""Tip of the toes ahead of the ankle [m]."""
_TOE_RADIUS = 0.05
_FOOT_MASS = 1.2
"""Mass of foot and part of the shank in a kick [kg]."""
_SOFT_MASS = 0.25
"""The same of a foot that walks, with a slack ankle [kg]."""
_SWING = (-0.35, 0.65)
"""Reach of a kicking ankle behind and ahead of the hip [m]."""
_KICK_HEIGHT = 0.12
"""Height of the toes in a kick [m]."""
_PIECES = 4
"""Steps of the ball in a frame."""
_FAR = 2.0
"""Distance from which on a player cannot touch the ball [m]."""
_APART = 0.3
"""Distance of a player from a board [m]."""
_BODY = 0.20
"""Radius of a body that the ball bounces off [m]."""
_BODY_RESTITUTION, _BOARD_RESTITUTION = 0.25, 0.6
_STILL_S, _NEARER, _INWARDS = 5.0, 0.05, 0.6
"""Time after which a ball that lies is put nearer to the middle [s], unless the person comes nearer by so much [m], and
its distance from the middle over that of before."""
_AGAIN_S = 0.2
"""Time between two touches of a walking foot that are counted [s]."""
_OFF = 2.4
"""Where the players stand at a kick-off, from the middle [m]."""
_CHEERS_S, _REPLAY_S, _REPLAY_SPEED, _REPLAY_FROM_S = 1.2, 3.2, 0.75, 2.0
"""Time from a goal to its replay, duration of the replay [s], its speed, and how long before the goal it begins [s]."""
PACE, _LEAST_PACE = 1.5, 0.35
"""Largest speed of the opponent over the fastest that the person has been, and the least that this counts as [m/s]."""
_WEAK, _HARD = 0.7, 1.6
"""Speed of an opponent's kick over the person's, without skill and with skill 1."""
_CAUTIOUS, _SPRINTS = 0.6, 1.4
"""Speed of an opponent without skill, and how much faster one with skill 1 is [m/s]."""


@dataclass(frozen=True, slots=True)
class Pitch:
    """The pitch.

    Attributes:
        half_length, half_width: Distances of goal lines and boards from the middle [m].
        half_goal, bar: Half the width of a goal, and its height [m].
    """

    half_length: float = 8.0
    half_width: float = 3.2
    half_goal: float = 1.5
    bar: float = 1.9

    @property
    def bounds(self) -> complex:
        """Greatest distances of a player's place from the middle, x + i z [m]."""
        return complex(self.half_width - _APART, self.half_length - _APART)


@dataclass(frozen=True, slots=True)
class Happening:
    """Something that is heard or counted.

    Attributes:
        kind: "kick", "goal", "opponent_goal", "board", "bounce" or "whistle".
        place: Where [m].
        strength: 0 to 1.
    """

    kind: str
    place: tuple[float, float, float]
    strength: float = 1.0


class Player:
    """One of the two.

    Args:
        impairment: Of the legs.
        seed: Of the feet.
        kick_speed: Largest speed of the foot in a kick [m/s].

    Attributes:
        walker: Place, heading and legs.
        kick: Share of the present kick that is over, 0 to 1; -1: none.
        touched: Whether the present kick has met the ball.
    """

    def __init__(self, impairment: Impairment, seed: int, kick_speed: float) -> None:
        self.walker = Walker(impairment, seed)
        self.kick_speed = kick_speed
        self.kick = -1.0
        self.touched = False
        self._tips: F8 | None = None

    @property
    def at(self) -> complex:
        """Place as x + i z [m]."""
        return complex(self.walker.x, self.walker.z)

    def put(self, x: float, z: float, yaw: float) -> None:
        """Stand somewhere."""
        self.walker.put(x, z, yaw)
        self.kick, self._tips = -1.0, None

    def begin_kick(self) -> None:
        """Swing the right leg, unless it swings already."""
        if self.kick < 0.0:
            self.kick, self.touched = 0.0, False

    def kicking_ankle(self) -> float | None:
        """Return how far the kicking ankle is ahead of the hip [m]; None without a kick."""
        if self.kick < 0.0:
            return None
        back, front = _SWING
        return 0.5 * (back + front) - 0.5 * (front - back) * math.cos(math.pi * self.kick)

    def move(self, speed: float, turn: float, seconds: float, legs: LegMotion | None = None) -> tuple[F8, F8]:
        """Walk for a time, by legs in an orthosis if given; return the tips of both feet before and after, [2, 3]."""
        if self.kick >= 0.0:
            back, front = _SWING
            self.kick += 2.0 * self.kick_speed / (math.pi * (front - back)) * seconds
        if legs is None:
            self.walker.step(speed, turn, seconds)
        else:
            self.walker.step_by_legs(legs, turn, seconds)
        after = self._feet()
        before, self._tips = (after if self._tips is None else self._tips), after
        if self.kick >= 1.0:
            self.kick, self._tips = -1.0, None
        return before, after

    def _feet(self) -> F8:
        """Return the tips of both feet [m], [2, 3]."""
        walker = self.walker
        legs = walker.legs
        places = [ankle(legs.hip_left, legs.knee_left), ankle(legs.hip_right, legs.knee_right)]
        lowest = max(places[0][1], places[1][1])
        tips = []
        for side, (ahead, down) in zip((1.0, -1.0), places, strict=True):
            height = _TOE_RADIUS + max(lowest - down, 0.0)
            kicked = self.kicking_ankle()
            if side < 0.0 and kicked is not None:
                ahead, height = kicked, _KICK_HEIGHT
            aside, reach = side * HALF_STEP_WIDTH, ahead + _TIP
            if side < 0.0 and kicked is not None:
                aside = 0.0  # the leg swings before the body
            s, c = math.sin(walker.yaw), math.cos(walker.yaw)
            tips.append((walker.x + reach * s + aside * c, height, walker.z + reach * c - aside * s))
        return np.array(tips)


class Match:
    """One match.

    Args:
        pitch: The pitch.
        person: Legs of the person.
        skill: Of the opponent; None: nobody.
        seed: Of all that is random.
        kick_speed: Speed of a foot in a kick [m/s].

    Attributes:
        pace: Largest speed of the opponent over the fastest that the person has been; it may change.
        person, opponent: The players.
        ball: The ball.
        mind: The opponent's.
        goals, opponent_goals, kicks: Counts.
        act: What the opponent does.
        rng: Source of all that is random.
        pause_s: Time until play resumes after a goal [s].
        felt: Whether the person's feet meet the ball elsewhere, in the haptic loop, and not here.
        held: Whether the ball is moved there in this frame.
    """

    def __init__(self, pitch: Pitch, person: Impairment, skill: float | None, seed: int, kick_speed: float) -> None:
        self.pitch = pitch
        self.person = Player(person, seed, kick_speed)
        self.rng = np.random.default_rng([seed, 333])
        self.mind = None if skill is None else Mind(skill, self.rng)
        self.opponent = Player(replace(GAITS["healthy"], fastest=2.0), seed + 1, kick_speed)
        self.ball = SoccerBall()
        self.goals = self.opponent_goals = self.kicks = 0
        self.act = Act.KEEP
        self.pace, self.pause_s = PACE, 0.0
        self.felt = self.held = False
        self._fastest = 0.0
        self._untouched_s, self._lain_s, self._nearest = 0.0, 0.0, math.inf
        self.kick_off()

    def kick_off(self) -> None:
        """Put the ball in the middle, and everybody before it."""
        self.ball.put(float(self.rng.uniform(-0.4, 0.4)), 0.0)
        self.person.put(0.0, _OFF, math.pi)
        self.opponent.put(0.3, -_OFF, 0.0)
        self._untouched_s, self._lain_s, self._nearest = 0.0, 0.0, math.inf

    @property
    def gap(self) -> float:
        """Distance of both players [m]."""
        return abs(self.person.at - self.opponent.at)

    @property
    def replay_s(self) -> float:
        """How long ago was what is shown again after a goal [s]; 0: nothing is."""
        since = _REPLAY_S - self.pause_s
        return _CHEERS_S + _REPLAY_FROM_S + (1.0 - _REPLAY_SPEED) * since if 0.0 <= since < _REPLAY_S else 0.0

    def view_of_person(self) -> PlayerView:
        """Return what the person sees."""
        return self._view(self.person, self.opponent, complex(0.0, -self.pitch.half_length))

    def step(
        self, speed: float, turn: float, kicks: bool, seconds: float, legs: LegMotion | None = None
    ) -> list[Happening]:
        """Play for a frame of the person's speed [m/s] or legs, turn to the left [rad/s] and kick."""
        happened: list[Happening] = []
        if self.pause_s > 0.0:
            return self._wait(seconds)
        if kicks:
            self.person.begin_kick()
        moves = [(self.person, self.person.move(self._before_boards(speed), turn, seconds, legs))]
        self._fastest = max(self._fastest, self.person.walker.speed)
        if self.mind is not None:
            moves.append((self.opponent, self._move_opponent(self.mind, seconds)))
        self._untouched_s += seconds
        for piece in range(_PIECES):
            happened += self._advance_ball(moves, (piece + 1.0) / _PIECES, seconds)
            if self.pause_s > 0.0:
                break
        for player, _ in moves:
            self._keep_inside(player)
        self._wait_for_person(seconds)
        if self._lain_s > _STILL_S:
            self.ball.put(_INWARDS * float(self.ball.place[0]), _INWARDS * float(self.ball.place[2]))
            self._nearest, self._lain_s = math.inf, 0.0
            happened.append(self._at("whistle", 1.0))
        return happened

    def _advance_ball(
        self, moves: Sequence[tuple[Player, tuple[F8, F8]]], share: float, seconds: float
    ) -> list[Happening]:
        """Let the ball meet the players at a share of the frame, move, and meet boards and goals."""
        happened: list[Happening] = []
        for player, (before, after) in moves:
            happened += self._touch(player, before, after, share, seconds)
        bounces = self.ball.bounces
        if not self.held:
            self.ball.step(seconds / _PIECES)
        if self.ball.bounces > bounces:
            happened.append(self._at("bounce", 0.5))
        return happened + self._bound()

    def note_touch(self, player: Player, met: float, *, swung: bool = False) -> list[Happening]:
        """Note a foot that met the ball at a speed [m/s]; return what is heard: each kick, and the first of touches."""
        first = swung or self._untouched_s > _AGAIN_S
        self._untouched_s = 0.0
        if not first:
            return []
        if player is self.person:
            self.kicks += 1
        return [self._at("kick", min(met / player.kick_speed, 1.0))]

    def _wait(self, seconds: float) -> list[Happening]:
        """Let the goal be cheered; the ball comes to rest in the net."""
        self.pause_s -= seconds
        self.ball.velocity = self.ball.velocity * 0.9
        self.ball.step(seconds)
        for player in (self.person, self.opponent):
            player.move(0.0, 0.0, seconds)
        if self.pause_s <= 0.0:
            self.kick_off()
            return [Happening("whistle", (0.0, 0.0, 0.0))]
        return []

    def _move_opponent(self, mind: Mind, seconds: float) -> tuple[F8, F8]:
        """Let the opponent play, not much faster than the person can."""
        deed = mind.decide(self._view(self.opponent, self.person, complex(0.0, self.pitch.half_length)))
        self.act = deed.act
        self.opponent.kick_speed = self.person.kick_speed * (_WEAK + (_HARD - _WEAK) * mind.skill)
        if deed.kicks:
            self.opponent.begin_kick()
        own = _CAUTIOUS + _SPRINTS * mind.skill
        pace = min(own, self.pace * max(self._fastest, _LEAST_PACE))
        return self.opponent.move(deed.speed * pace, deed.turn, seconds)

    def _view(self, me: Player, other: Player, goal: complex) -> PlayerView:
        ball, v = self.ball.place, self.ball.velocity
        return PlayerView(
            me.at,
            me.walker.yaw,
            other.at,
            complex(ball[0], ball[2]),
            complex(v[0], v[2]),
            goal,
            self.pitch.half_goal,
            self.pitch.bounds,
        )

    def _touch(self, player: Player, before: F8, after: F8, share: float, seconds: float) -> list[Happening]:
        """Let feet and body meet the ball, with the feet at a share of the frame."""
        happened: list[Happening] = []
        ball = self.ball
        met_elsewhere = self.felt and player is self.person
        if met_elsewhere or abs(complex(ball.place[0], ball.place[2]) - player.at) > _FAR:
            return happened
        place = before + share * (after - before)
        far = np.abs(place[:, ::2] - ball.place[::2]).sum(axis=1)
        yaw = player.walker.yaw
        facing = np.array([math.sin(yaw), 0.0, math.cos(yaw)])
        for foot in (0, 1):
            swung = player.kick >= 0.0 and foot == 1
            if far[foot] > 0.5 or (swung and player.touched):
                continue
            speed = (after[foot] - before[foot]) / seconds
            met = ball.touch(place[foot], speed, _FOOT_MASS if swung else _SOFT_MASS, _TOE_RADIUS, facing)
            if met > 0.0:
                if swung:
                    player.touched = True
                    self._lift(met)
                happened += self.note_touch(player, met, swung=swung)
        away = complex(ball.place[0], ball.place[2]) - player.at
        near = abs(away)
        if 1e-6 < near < _BODY and ball.place[1] < 1.8:
            normal = away / near
            out = player.at + _BODY * normal
            ball.place[0], ball.place[2] = out.real, out.imag
            closing = ball.velocity[0] * normal.real + ball.velocity[2] * normal.imag
            if closing < 0.0:
                back = (1.0 + _BODY_RESTITUTION) * closing
                ball.velocity = ball.velocity - back * np.array([normal.real, 0.0, normal.imag])
        return happened

    def _lift(self, met: float) -> None:
        """Let a full kick from below the middle lift the ball a little."""
        self.ball.velocity[1] += 0.18 * met

    def _bound(self) -> list[Happening]:
        """Let the ball bounce off the boards, or be a goal."""
        pitch, ball = self.pitch, self.ball
        happened = []
        if ball.reflect(0, math.copysign(pitch.half_width, ball.place[0]), _BOARD_RESTITUTION):
            happened.append(self._at("board", 0.5))
        end = math.copysign(pitch.half_length, ball.place[2])
        in_mouth = abs(ball.place[0]) < pitch.half_goal and ball.place[1] < pitch.bar
        if in_mouth:
            if abs(ball.place[2]) > pitch.half_length + ball.spec.radius:
                happened.append(self._count(end))
        elif ball.reflect(2, end, _BOARD_RESTITUTION):
            happened.append(self._at("board", 0.5))
        return happened

    def _count(self, end: float) -> Happening:
        """Count a goal at an end of the pitch."""
        self.pause_s = _CHEERS_S + _REPLAY_S
        if end < 0.0:
            self.goals += 1
            return self._at("goal", 1.0)
        self.opponent_goals += 1
        return self._at("opponent_goal", 1.0)

    def _before_boards(self, speed: float) -> float:
        """Return the speed that a board before the person leaves them [m/s]: the share along it."""
        walker, most = self.person.walker, self.pitch.bounds
        across, along = math.sin(walker.yaw), math.cos(walker.yaw)
        if abs(walker.x) >= most.real and walker.x * across > 0.0:
            speed *= abs(along)
        if abs(walker.z) >= most.imag and walker.z * along > 0.0:
            speed *= abs(across)
        return speed

    def _keep_inside(self, player: Player) -> None:
        """Keep a player between the boards, and off the other one."""
        walker = player.walker
        most = self.pitch.bounds
        walker.x = min(max(walker.x, -most.real), most.real)
        walker.z = min(max(walker.z, -most.imag), most.imag)
        other = self.opponent if player is self.person else self.person
        away = player.at - other.at
        if self.mind is not None and 1e-6 < abs(away) < 2.0 * _BODY:
            place = other.at + 2.0 * _BODY * away / abs(away)
            walker.x, walker.z = place.real, place.imag

    def _wait_for_person(self, seconds: float) -> None:
        """Count the time in which the ball lies and the person comes no nearer to it [s]."""
        near = abs(complex(self.ball.place[0], self.ball.place[2]) - self.person.at)
        if self.ball.velocity.any():
            self._nearest, self._lain_s = math.inf, 0.0
        elif near < self._nearest - _NEARER:
            self._nearest, self._lain_s = near, 0.0
        else:
            self._lain_s += seconds

    def _at(self, kind: str, strength: float) -> Happening:
        x, y, z = self.ball.place.tolist()
        return Happening(kind, (x, y, z), strength)
