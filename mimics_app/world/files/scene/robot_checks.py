"""Checks of the robot's components beyond their types: consistent limits, proper rotations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mimics_app.contracts.errors import Issue
from mimics_app.world.components.curves import check_curve
from mimics_app.world.components.registry import register_check
from mimics_app.world.components.robot import (
    Ball,
    JointPd,
    Patient,
    Robot,
    Safety,
    Tunnel,
    WorldPd,
)

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_tunnel_component"]

_ROTATION_TOLERANCE = 1e-6


def check_tunnel_component(tunnel: Tunnel, pointer: str, scene: Scene) -> list[Issue]:
    """Faults of the component itself; the haptic stage checks that the tunnel is passable."""
    issues = check_curve(tunnel, pointer, scene)
    if tunnel.radius == ():
        issues.append(scene.issue(f"{pointer}/radius", "an empty list", "give one number or more"))
    return issues


def _check_robot(robot: Robot, pointer: str, scene: Scene) -> list[Issue]:
    issues = []
    rotation = np.array(robot.robot_to_world.rotation)
    error = float(np.abs(rotation @ rotation.T - np.eye(3)).max())
    if error > _ROTATION_TOLERANCE or np.linalg.det(rotation) < 0.0:
        what = "is not a rotation: " + (
            f"its rows are off by {error:.3g}" if error > _ROTATION_TOLERANCE else "it mirrors"
        )
        issues.append(scene.issue(f"{pointer}/robot_to_world/rotation", what))
    issues += [
        scene.issue(f"{pointer}/masses/{i}", "a moving mass must be greater than 0")
        for i, mass in enumerate(robot.masses)
        if mass == 0.0
    ]
    return issues


def _check_patient(patient: Patient, pointer: str, scene: Scene) -> list[Issue]:
    visits = {f"{pointer}/visits/{i}": name for i, name in enumerate(patient.visits)}
    return scene.check_names(visits, "no entity", scene.by_id)


def _check_pd(gains: JointPd | WorldPd, pointer: str, scene: Scene) -> list[Issue]:
    return [
        scene.issue(f"{pointer}/kd/{i}", f"{kd:g} is unstable with a velocity servo (equation 5)", "stay below 1")
        for i, kd in enumerate(gains.kd)
        if kd >= 1.0
    ]


def _check_ball(ball: Ball, pointer: str, scene: Scene) -> list[Issue]:
    if ball.radius_min <= ball.radius_max:
        return []
    return [scene.issue(f"{pointer}/radius_min", f"{ball.radius_min:g} m is above radius_max, {ball.radius_max:g} m")]


def _check_safety(safety: Safety, pointer: str, scene: Scene) -> list[Issue]:
    ladders = [("late_hold_s", "late_damp_s"), ("late_damp_s", "late_stop_s"), ("stale_warn_s", "stale_stop_s")]
    return [
        scene.issue(f"{pointer}/{low}", f"{getattr(safety, low):g} s is not below {high}, {getattr(safety, high):g} s")
        for low, high in ladders
        if getattr(safety, low) >= getattr(safety, high)
    ]


register_check("tunnel", check_tunnel_component)
register_check("robot", _check_robot)
register_check("patient", _check_patient)
register_check("joint_pd", _check_pd)
register_check("world_pd", _check_pd)
register_check("ball", _check_ball)
register_check("safety", _check_safety)
