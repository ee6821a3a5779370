"""Trackers: devices that report poses, their emulators, and the hub that places them in the room's frame."""

__all__: list[str] = []
