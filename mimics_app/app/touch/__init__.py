"""The haptic side of a scene: its memory, desk and loop, and the loop played without a session."""

__all__: list[str] = []
