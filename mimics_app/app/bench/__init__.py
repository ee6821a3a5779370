"""Measurements of `mimics bench`."""

__all__: list[str] = []
