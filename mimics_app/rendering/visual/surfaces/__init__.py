"""Surfaces: windows and offscreen contexts, driver capabilities, and read-back."""

__all__: list[str] = []
