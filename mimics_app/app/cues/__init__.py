"""Sounds and effects of the scene, triggered by the task and the haptic loop."""

__all__: list[str] = []
