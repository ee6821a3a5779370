"""Haptic objects in the tick: signals, touch, effects, grip, collisions, motion."""

__all__: list[str] = []
