"""Compiled functions of the tick: arrays and records in, arrays and records out, no allocation."""

__all__: list[str] = []
