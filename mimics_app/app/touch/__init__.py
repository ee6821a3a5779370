"""The haptic side of a scene: its memory, store and loop, and the loop played without a session."""

__all__: list[str] = []
