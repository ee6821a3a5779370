"""Haptic rendering: the 1 kHz loop, its controllers, its limits and its devices (D2.1 4.2)."""

__all__: list[str] = []
