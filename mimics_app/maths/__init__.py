"""Vectors, quaternions, matrices, frames and B-splines: functions for compiled code and for numpy."""

__all__: list[str] = []
