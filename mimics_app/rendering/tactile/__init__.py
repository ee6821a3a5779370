"""Vibrators on the body: taps that are felt at their time."""

__all__: list[str] = []
