"""The passes of a frame, in the order they are drawn: shadow, opaque, sky, transparent, hud."""

__all__: list[str] = []
