"""A soccer ball: flight, bounces, sliding, rolling, and the kick of a foot.

The ball is a hollow sphere (moment of inertia 2/3 m r^2). On the ground it slides, with Coulomb friction, until its
lowest point is at rest, and then rolls, with rolling resistance; both decelerations are constant, so that these motions
are exact for any time step. So is a flight without drag, whose bounces are found from its parabola. With drag, steps of
a flight are those of the midpoint rule. A bounce has a coefficient of restitution; its friction acts as an impulse of
at most the friction coefficient times the normal one, and less where it brings the lowest point to rest.

Frame: x and z on the ground, y up; the centre of a ball at rest is at y = r.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mimics_app.contracts.arrays import F8

__all__ = ["BALL", "BallSpec", "SoccerBall"]

_GRAVITY = 9.81
_AIR = 1.2
"""Density of air [kg/m^3]."""
_HOLLOW = 2.0 / 3.0
"""Moment of inertia over m r^2."""
_RESTS = 0.12
"""Vertical speed after a bounce below which the ball stays on the ground [m/s]."""
_STILL = 1e-9
"""Speed that counts as none [m/s]."""
_AUDIBLE_SPEED = 0.4
"""Speed from which a bounce off a wall is heard [m/s]."""
_CONTACT_S = 0.010
"""Duration of the contact of a kick [s]."""
_PIECES = 40
"""Time steps of a kick's contact."""
_BROAD = 0.92
"""Share of the direction of a foot in that of its kick."""
_MOST_EVENTS = 64
"""Largest number of bounces and changes of motion in one time step."""


@dataclass(frozen=True, slots=True)
class BallSpec:
    """Properties of a ball and of what it meets.

    Attributes:
        radius: [m].
        mass: [kg].
        restitution: Of a bounce on the ground.
        friction: Coefficient of friction on the ground.
        rolling: Rolling resistance over the weight.
        drag: Drag coefficient; 0: no air.
        kick_restitution: Of a kick.
    """

    radius: float = 0.11
    mass: float = 0.43
    restitution: float = 0.65
    friction: float = 0.5
    rolling: float = 0.08
    drag: float = 0.25
    kick_restitution: float = 0.5


BALL = BallSpec()
"""A ball of size 5 (Laws of the Game: 68 to 70 cm round, 410 to 450 g); its other numbers are settings."""


class SoccerBall:
    """One ball.

    Args:
        spec: Its properties.

    Attributes:
        place: Centre [m], float64 [3].
        velocity: [m/s], float64 [3].
        spin: Angular velocity [rad/s], float64 [3].
        bounces: Number of bounces so far.
    """

    def __init__(self, spec: BallSpec = BALL) -> None:
        self.spec = spec
        self.bounces = 0
        self.put(0.0, 0.0)

    def put(self, x: float, z: float) -> None:
        """Lay the ball down at rest."""
        self.place: F8 = np.array([x, self.spec.radius, z])
        self.velocity: F8 = np.zeros(3)
        self.spin: F8 = np.zeros(3)

    @property
    def flies(self) -> bool:
        """Whether it is above the ground, or leaves it."""
        return bool(self.place[1] > self.spec.radius + 1e-9 or self.velocity[1] > _STILL)

    def step(self, seconds: float) -> None:
        """Advance by a time [s]."""
        if not self.flies and not self.velocity.any() and not self.spin.any():
            return
        left = seconds
        for _ in range(_MOST_EVENTS):
            if left <= 0.0:
                return
            left -= self._fly(left) if self.flies else self._roll(left)

    def touch(self, foot: F8, speed: F8, foot_mass: float, reach: float, facing: F8) -> float:
        """Let a foot that overlaps the ball kick it, by a spring and a damper over the time of contact.

        Args:
            foot: Centre of the foot's tip [m].
            speed: Its velocity [m/s].
            foot_mass: Mass of foot and shank that takes part [kg].
            reach: Radius of the tip [m].
            facing: Where the foot points, of length 1; a foot is broad, and sends the ball there rather than aside.

        Returns:
            Speed of approach of the foot [m/s]; 0 where it does not touch.
        """
        away = self.place - foot
        far = float(np.linalg.norm(away))
        if not 1e-9 < far < reach + self.spec.radius:
            return 0.0
        if float(away @ facing) <= 0.0:
            return 0.0
        normal = (1.0 - _BROAD) * away / far + _BROAD * facing
        if not self.flies:  # the ground does not give way
            normal[1] = max(normal[1], 0.0)
        normal = normal / np.linalg.norm(normal)
        approach = float((speed - self.velocity) @ normal)
        if approach <= 0.0:
            return 0.0
        self.velocity = self.velocity + self._gained(approach, foot_mass) * normal
        return approach

    def reflect(self, axis: int, wall: float, restitution: float) -> bool:
        """Bounce off a wall across a horizontal axis (0 or 2) at a coordinate [m]; return whether it is heard."""
        inside = wall - math.copysign(self.spec.radius, wall)
        beyond = self.place[axis] - inside
        if beyond * wall <= 0.0 or self.velocity[axis] * wall <= 0.0:
            return False
        self.place[axis] = inside
        audible = bool(abs(self.velocity[axis]) > _AUDIBLE_SPEED)
        self.velocity[axis] *= -restitution
        return audible

    def _gained(self, approach: float, foot_mass: float) -> float:
        """Return the speed that the ball gains in a contact: a linear spring and damper between two masses."""
        mass = self.spec.mass
        reduced = mass * foot_mass / (mass + foot_mass)
        log = math.log(self.spec.kick_restitution)
        damping = -log / math.hypot(math.pi, log)
        rate = math.pi / (_CONTACT_S * math.sqrt(1.0 - damping**2))
        stiffness, damper = reduced * rate**2, 2.0 * damping * reduced * rate
        # The spring's force on the relative motion of both, by the midpoint rule, until they part.
        deep, closing, step = 0.0, approach, _CONTACT_S / _PIECES
        impulse = 0.0
        for _ in range(_PIECES):
            half = closing - 0.5 * step * (stiffness * deep + damper * closing) / reduced
            force = stiffness * (deep + 0.5 * step * closing) + damper * half
            deep, closing, impulse = deep + step * half, closing - step * force / reduced, impulse + step * force
        return impulse / mass

    def _fly(self, seconds: float) -> float:
        """Fly for a time [s], or up to the ground; return the time that passed."""
        spec = self.spec
        height, up = float(self.place[1]) - spec.radius, float(self.velocity[1])
        acceleration = self._falls(self.velocity)
        if spec.drag > 0.0:
            acceleration = self._falls(self.velocity + 0.5 * seconds * acceleration)
        down = -float(acceleration[1])
        root = up * up + 2.0 * down * height
        lands = (up + math.sqrt(max(root, 0.0))) / down if down > 0.0 else math.inf
        passed = min(seconds, lands)
        self.place = self.place + passed * self.velocity + 0.5 * passed * passed * acceleration
        self.velocity = self.velocity + passed * acceleration
        if lands <= seconds:
            self.place[1] = spec.radius
            self._bounce()
        return passed

    def _falls(self, velocity: F8) -> F8:
        """Return the acceleration in the air [m/s^2]."""
        spec = self.spec
        pull = 0.5 * _AIR * spec.drag * math.pi * spec.radius**2 / spec.mass
        return np.array([0.0, -_GRAVITY, 0.0]) - pull * float(np.linalg.norm(velocity)) * velocity

    def _bounce(self) -> None:
        """Bounce on the ground."""
        spec, up = self.spec, -float(self.velocity[1])
        self.bounces += 1
        normal = (1.0 + spec.restitution) * up
        slip = self._slip()
        speed = float(np.linalg.norm(slip))
        if speed > _STILL:
            # An impulse per mass that would bring the lowest point to rest: its effective mass is m / (1 + 1 / (2/3)).
            change = min(spec.friction * normal, speed / (1.0 + 1.0 / _HOLLOW))
            self._apply_friction(-change / speed * slip)
        self.velocity[1] = spec.restitution * up
        if self.velocity[1] < _RESTS:
            self.velocity[1] = 0.0

    def _slip(self) -> F8:
        """Return the velocity of the lowest point over the ground [m/s], [3]."""
        r = self.spec.radius
        return np.array([self.velocity[0] + r * self.spin[2], 0.0, self.velocity[2] - r * self.spin[0]])

    def _apply_friction(self, change: F8) -> None:
        """Apply an impulse per mass of friction at the lowest point [m/s]."""
        r = self.spec.radius
        self.velocity = self.velocity + change
        self.spin = self.spin + np.array([-change[2], 0.0, change[0]]) / (_HOLLOW * r)

    def _roll(self, seconds: float) -> float:
        """Slide or roll for a time [s], or up to the change from one to the other; return the time that passed."""
        spec, slip = self.spec, self._slip()
        speed = float(np.linalg.norm(slip))
        if speed > 1e-7:
            rate = spec.friction * _GRAVITY * (1.0 + 1.0 / _HOLLOW)
            passed = min(seconds, speed / rate)
            slows = -spec.friction * _GRAVITY / speed * slip
            self.place = self.place + passed * self.velocity + 0.5 * passed * passed * slows
            self._apply_friction(passed * slows)
            return passed
        pace = math.hypot(self.velocity[0], self.velocity[2])
        if pace <= _STILL or spec.rolling == 0.0:
            self.place = self.place + seconds * self.velocity
            return seconds
        slower = spec.rolling * _GRAVITY
        passed = min(seconds, pace / slower)
        way = self.velocity / pace
        self.place = self.place + (passed * pace - 0.5 * slower * passed * passed) * way
        self.velocity = max(pace - slower * passed, 0.0) * way
        self.spin = np.array([self.velocity[2], 0.0, -self.velocity[0]]) / spec.radius
        return passed
