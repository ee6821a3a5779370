"""Measurements of sound that the spatialisers share."""

__all__: list[str] = []
