"""A subject, an avatar in front of it in the same clothes, and a cord from the subject's stomach to the avatar's back.

The task (`tasks.kinds.avatar_cord`) sets the condition of a trial by named parameters. Trackers give the pose of the
subject's head and hands; without trackers the subject does not move.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mimics_app.contracts.arrays import F8
from mimics_app.contracts.clock import FRAME_NS, SECOND_NS
from mimics_app.contracts.errors import SceneError
from mimics_app.contracts.messages.orders import Feature, HapticField, HapticOrder, Shown
from mimics_app.contracts.messages.stage_messages import HapticSnapshot, TaskOrders
from mimics_app.contracts.ports.scenario_port import BodyPose
from mimics_app.maths import quat
from mimics_app.maths.mat import look_at
from mimics_app.scenarios.figures.walking_figure import OWN_HEAD
from mimics_app.scenarios.parts.touch_scene import TouchScene
from mimics_app.tasks.kinds.avatar_cord.features import (
    CORD_LENGTH,
    CORD_RADIUS,
    CORD_SHOWN,
    DELAY,
    DISTANCE,
    FEATURES,
    MIMICRY,
    OWN_BODY,
    PROBE,
    TAP,
    THREAT,
    VIEWPOINT,
    ShownTap,
)
from mimics_app.world.components.cord import CordComponent
from mimics_app.world.components.objects import ForceField
from mimics_app.world.content.cords import Cord
from mimics_app.world.content.world import World
from mimics_app.world.files.scene.scene import Scene

__all__ = ["SCENARIO", "AvatarCord", "ball_motion"]


_PARTS = ("head", "hand_left", "hand_right")
"""Tracked parts of the body."""
_UNTRACKED: Mapping[str, F8 | None] = dict.fromkeys(_PARTS)
_EYES = np.array([0.0, 1.70, 0.0])
"""Position of the subject's eyes without a tracker of the display [m]."""

_BALL = 0.022
"""Radius of the tapping ball [m]."""
_TAPPED_OVER = 0.06
"""Height of the tapped places of stomach and back above the cord's ends [m]."""
_CLEARANCE = 0.55
"""Lateral clearance of the ball's path around the avatar [m]."""
_RIPPLE_SHARE = 0.35
"""Amplitude of the ripple of a tap, as a share of the cord's radius [-]."""
_ASIDE, _AT = np.array([1.5, 0.25, 1.05]), 1.15
"""Third-person camera: place from the subject's eyes [m], where neither body hides the cord, and height of the place
half-way to the avatar that it looks at [m]."""
_THREAT_FROM, _THREAT_BALL, _G = 2.2, 0.16, 9.81
"""Threat: height above the avatar's head from which it falls [m], radius [m], gravity [m/s^2]."""
_TOUCH, _TOUCH_BALL = "cord_touch", 0.012
"""Entity whose force field renders the contact with the cord; radius of the ball at the HIP [m]."""
_TOUCH_AT, _TOUCH_FIELD = HapticField("position", "effects", _TOUCH), HapticField("parameters", "effects", _TOUCH)
_SWING_HZ, _SWING_DAMPING, _SWING_PER_M_S = 0.8, 1.1, 0.35
"""Swing of the cord as a damped pendulum: frequency [Hz], damping [1/s], angle per lateral speed [rad s/m]."""


_HOVER, _FALL_S = 0.09, 0.14
"""Height of the waiting ball above the surface [m], and duration of its descent or ascent [s]."""
_QUICK = 0.35
"""Largest share of the time between two touches spent on descent or ascent; the rest is for the path between them."""


class AvatarCord(TouchScene):
    """Scenario 1 of D2.1 3.4.1.

    Args:
        scene: Needs a `robot`, a `cord`, entities `tap_ball`, `threat` and `probe`, and entities `subject` and `avatar`
            with a humanoid model each.
        world: The world built from the scene.

    Raises:
        SceneError: The cord or an entity is missing, or a model is not humanoid.
    """

    def __init__(self, scene: Scene, world: World) -> None:
        from mimics_app.scenarios.figures.tracked_figure import TrackedFigure

        super().__init__(scene, world)
        cords = scene.components(CordComponent)
        if not cords:
            raise SceneError(scene.issue("/entities", "the scene has no cord", 'give an entity a "cord"'))
        self._spec = cords[0][1]
        self._cord: Cord = world.cords[cords[0][0]]
        missing = [name for name in ("tap_ball", "threat", "probe") if name not in world]
        if missing:
            what = f'the scene has no entity "{missing[0]}"'
            raise SceneError(scene.issue("/entities", what, "add it: the scenario moves it"))
        self._tap_ball, self._threat, self._probe = (world.find(name) for name in ("tap_ball", "threat", "probe"))
        self.subject, self.avatar = (
            TrackedFigure(scene, world, name, float(_EYES[1])) for name in ("subject", "avatar")
        )
        self._camera = world.cameras[0]
        self._seen_from = self._camera.near, np.array(self._camera.node.orientation)
        fields = {entity: field for entity, field, _ in scene.components(ForceField)}
        self._touch = fields.get(_TOUCH)
        self._real_body_seen = False
        self._settings = Shown(FEATURES)
        self._shown_ns = 0
        self._parts: dict[str, Mapping[str, F8 | None]] = {"subject": _UNTRACKED, "avatar": _UNTRACKED}
        self._last_tap = -1
        self._coming: ShownTap | None = None
        self._before: ShownTap | None = None
        self._swing = self._swing_speed = 0.0
        self._middle: F8 | None = None
        self._arrange()

    @property
    def facts(self) -> Mapping[str, Any]:
        return {**super().facts, "avatar_cord": {"length": self._spec.length, "radius": self._spec.radius}}

    def set_tracked_body(self, where: BodyPose, shown_ns: int) -> None:
        """Set the poses of the subject at the time of display, and those of the avatar by the mode of mimicry."""
        self._shown_ns = shown_ns
        delay_ns = round(self._settings[DELAY] * 1e6)
        self._parts["subject"] = _parts(where, shown_ns)
        mimicry = self._settings[MIMICRY]
        if mimicry == "none":
            self._parts["avatar"] = _UNTRACKED
        else:
            late = _parts(where, shown_ns - delay_ns) if delay_ns else self._parts["subject"]
            self._parts["avatar"] = _mirrored(late) if mimicry == "mirror" else late

    def apply(self, orders: TaskOrders, snapshot: HapticSnapshot) -> None:
        super().apply(orders, snapshot)
        self._settings.follow(orders.visual)
        self._arrange()

    @staticmethod
    def features(scene: Scene) -> Sequence[Feature[Any]]:
        return FEATURES

    def haptic_orders(self) -> HapticOrder:
        """Return the parameters of the cord's force field, which follows the cord and is off while that is hidden."""
        touch = self._touch
        if touch is None:
            return HapticOrder()
        curve, field = self._cord.curve, np.array([*touch.parameters, *[0.0] * (8 - len(touch.parameters))])
        flat = curve.along * [1.0, 0.0, 1.0]
        flat = flat / max(float(np.linalg.norm(flat)), 1e-9)
        field[:5] = (flat[0], flat[2], curve.a, curve.q, curve.length if self._cord.visible else 0.0)
        field[5] = self._cord.shown_radius + _TOUCH_BALL
        return HapticOrder({_TOUCH_AT: curve.start, _TOUCH_FIELD: field})

    def hide_own_avatar(self) -> None:
        self._real_body_seen = True
        # At once: the display may open after the first frame was arranged.
        self.subject.show(self._settings[VIEWPOINT] != "first")

    def _arrange(self) -> None:
        """Place all entities for this frame."""
        settings, shown_s = self._settings, self._shown_ns / SECOND_NS
        self._world.effects.time = max(self._world.effects.time, shown_s)
        front = np.eye(4)
        front[2, 3] = -settings[DISTANCE]
        first = settings[VIEWPOINT] == "first"
        self.subject.pose(np.eye(4), self._parts["subject"], self._shown_ns)
        self.subject.show(not first or (settings[OWN_BODY] and not self._real_body_seen))
        self.avatar.pose(front, self._parts["avatar"], self._shown_ns)
        self._place_camera(first, 0.5 * front[2, 3])
        self._hang_cord(shown_s)
        self._tap(settings[TAP])
        self._drop_threat(settings[THREAT])
        self._show_probe(settings[PROBE])

    def _place_camera(self, first: bool, middle: float) -> None:
        """Look from the subject's eyes, past its own head, or from aside at the place half-way to the avatar [m]."""
        near, orientation = self._seen_from
        node = self._camera.node
        node.set_position(_EYES if first else _EYES + _ASIDE)
        node.set_orientation(orientation if first else _facing(_EYES + _ASIDE, np.array([0.0, _AT, middle])))
        self._camera.near = max(near, OWN_HEAD * self.subject.scale) if first else near

    def _hang_cord(self, shown_s: float) -> None:
        cord, settings = self._cord, self._settings
        cord.ends[0], cord.ends[1] = self.subject.stomach, self.avatar.back
        # The length factor scales the slack of the scene's own cord, at any distance of the avatar.
        chord = float(np.linalg.norm(cord.ends[1] - cord.ends[0]))
        slack = max(self._spec.length - 1.0, 0.02)
        cord.length = chord * (1.0 + slack * (2.0 * settings[CORD_LENGTH] - 1.0))
        cord.length = max(cord.length, chord)
        cord.radius = self._spec.radius * settings[CORD_RADIUS]
        cord.visible = settings[CORD_SHOWN]
        cord.swing = self._step_swing()

    def _step_swing(self) -> float:
        """Advance the pendulum, driven by the lateral speed of the cord's ends, by a frame; return its angle [rad]."""
        middle = self._cord.ends.mean(axis=0)
        dt = FRAME_NS / SECOND_NS
        moved = 0.0 if self._middle is None else float(middle[0] - self._middle[0]) / dt
        self._middle = middle
        omega = 2.0 * math.pi * _SWING_HZ
        push = -_SWING_PER_M_S * moved * omega
        self._swing_speed += dt * (push - omega * omega * self._swing - 2.0 * _SWING_DAMPING * self._swing_speed)
        self._swing = min(max(self._swing + dt * self._swing_speed, -0.6), 0.6)
        return self._swing

    def _tap(self, tap: ShownTap | None) -> None:
        cord = self._cord
        self._tap_ball.visible = tap is not None and (tap[1] != "cord" or cord.visible)
        cord.ball[3] = 0.0
        coming, self._coming = self._coming, tap
        if coming is not None and (tap is None or tap[4] != coming[4]):
            self._ripple(coming)  # the task names the next tap in the frame of the touch
            self._before = coming
        self._ripple(tap)
        if tap is None:
            self._before, self._last_tap = None, -1
            return
        at = self._ball_at(tap)
        self._tap_ball.set_position(at)
        if self._tap_ball.visible:
            cord.ball[:3], cord.ball[3] = at, _BALL

    def _ball_at(self, tap: ShownTap) -> F8:
        """Return the centre of the tapping ball on its path from the previous touch to this one, world [m]."""
        before = self._before or tap
        since_s = math.inf if self._before is None else (self._shown_ns - before[0]) / SECOND_NS
        share, gap = ball_motion(since_s, (tap[0] - self._shown_ns) / SECOND_NS)
        if before[1] == tap[1] == "cord":
            along, around = (a + share * (b - a) for a, b in zip(before[2:4], tap[2:4], strict=True))
            return self._over(("cord", along, around), gap)
        start, end = (self._over(each[1:4], gap) for each in (before, tap))
        side = _CLEARANCE if (before[1] == "stomach") != (tap[1] == "stomach") else 0.0
        return start + share * (end - start) + [side * math.sin(math.pi * share), 0.0, 0.0]

    def _over(self, place: tuple[str, float, float], gap: float) -> F8:
        """Return the centre of the ball at a gap [m] above a place, world [m]."""
        name, along, around = place
        if name == "cord":
            return self._cord.place(along, around, gap + _BALL)[0]
        surface, out = (self.avatar.back, 1.0) if name == "back" else (self.avatar.stomach, -1.0)
        return surface + [0.0, _TAPPED_OVER, out * (gap + _BALL)]

    def _ripple(self, tap: ShownTap | None) -> None:
        """Start the ripple of a tap on the cord at the time of its touch, which may lie between two frames."""
        if tap is None or tap[1] != "cord" or tap[4] == self._last_tap or self._shown_ns + FRAME_NS // 2 < tap[0]:
            return
        due_ns, _, share, theta, self._last_tap = tap
        cord = self._cord
        cord.tap(share * cord.curve.length, theta, due_ns / SECOND_NS, _RIPPLE_SHARE * cord.shown_radius)

    def _drop_threat(self, due_ns: int | None) -> None:
        fallen_s = -1.0 if due_ns is None else (self._shown_ns - due_ns) / SECOND_NS
        self._threat.visible = 0.0 <= fallen_s < 3.0
        low = 0.12 + _THREAT_BALL
        height = max(low, _THREAT_FROM - 0.5 * _G * max(fallen_s, 0.0) ** 2)
        self._threat.set_position(self.avatar.head + [0.0, height, 0.09])

    def _show_probe(self, at_m: float | None) -> None:
        self._probe.visible = at_m is not None
        self._probe.set_position((0.0, 0.012, -float(at_m or 0.0)))


def _parts(where: BodyPose, at_ns: int) -> Mapping[str, F8 | None]:
    """Return head and hands at a time, None where unknown."""
    return {role: where(role, at_ns) for role in _PARTS}


def _facing(eye: F8, target: F8) -> F8:
    """Return the orientation of a camera that looks from one place at another, xyzw."""
    turn = np.empty(4)
    quat.from_matrix(look_at(eye, target)[:3, :3], turn)
    return turn


def _mirrored(parts: Mapping[str, F8 | None]) -> Mapping[str, F8 | None]:
    """Return the parts with left and right exchanged, as in a mirror in front of the person."""
    flip = np.diag([-1.0, 1.0, 1.0, 1.0])
    other = {"hand_left": "hand_right", "hand_right": "hand_left"}
    swapped = {role: parts[other.get(role, role)] for role in parts}
    return {role: None if pose is None else flip @ pose @ flip for role, pose in swapped.items()}


def ball_motion(since_s: float, until_s: float) -> tuple[float, float]:
    """Return the position of the tapping ball between two touches, continuous in position and velocity.

    Args:
        since_s: Since the touch before [s]; infinite where there was none.
        until_s: Until the coming touch [s]; negative after it.

    Returns:
        Share of the path from one place to the other, and how far the ball is over either [m]: 0 at a touch.
    """
    whole = max(since_s + until_s, 1e-9)
    fall_s = min(_FALL_S, _QUICK * whole)
    gap = _HOVER * _smoothed(min(abs(since_s), abs(until_s)) / fall_s)
    if math.isinf(since_s):
        return 1.0, gap
    return _smoothed((since_s - fall_s) / (whole - 2.0 * fall_s)), gap


def _smoothed(share: float) -> float:
    """Return a smooth step from 0 to 1, with zero slope at both ends."""
    share = min(max(share, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


SCENARIO = AvatarCord
