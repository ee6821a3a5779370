"""Shadows: shadow maps in an atlas, and shadow volumes."""

__all__: list[str] = []
