"""Pointing and grasping: mouse, keyboard, gamepad, and the simulated person."""

__all__: list[str] = []
