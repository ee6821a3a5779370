"""Render passes of a frame, in drawing order: shadow, opaque, sky, transparent, heads-up display."""

__all__: list[str] = []
