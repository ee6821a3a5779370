"""Closed form of a kick: a foot meets a resting ball centrally, by momentum and restitution."""

from __future__ import annotations

from mimics_app.tasks.kinds.soccer.ball import BALL

__all__ = ["impact_speed"]


def impact_speed(foot_mass: float, foot_speed: float) -> float:
    """Return the speed [m/s] of the ball after the impact of a foot with a mass [kg] and a speed [m/s]."""
    return foot_speed * (1.0 + BALL.kick_restitution) * foot_mass / (foot_mass + BALL.mass)
