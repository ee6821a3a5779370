"""Shadows: maps in an atlas, and volumes."""

__all__: list[str] = []
