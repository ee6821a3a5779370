"""The haptic side of a session: objects, memory, parameters, and values that depend on the device."""

__all__: list[str] = []
