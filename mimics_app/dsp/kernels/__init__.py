"""Compiled inner loops of the signal processing."""

__all__: list[str] = []
