"""Calibration of a person, as a kind of task."""

__all__: list[str] = []
