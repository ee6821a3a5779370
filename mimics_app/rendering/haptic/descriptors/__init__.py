"""Descriptors of the built-in devices, and the joint limits of a scene's robot."""

__all__: list[str] = []
