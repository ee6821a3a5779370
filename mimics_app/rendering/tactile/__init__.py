"""Tactile rendering: timed taps of vibrators on the body."""

__all__: list[str] = []
