"""Travelling a tunnel, as a kind of task."""

__all__: list[str] = []
