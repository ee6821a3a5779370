"""Compiled passes of animation: sampling, blending, palettes, inverse kinematics, gait."""

__all__: list[str] = []
