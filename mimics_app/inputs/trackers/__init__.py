"""Trackers: devices that report poses, their emulators, and the hub that brings them into the room."""

__all__: list[str] = []
