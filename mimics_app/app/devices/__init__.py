"""Devices by name: the conformance kit run against one, and emulated robots."""

__all__: list[str] = []
