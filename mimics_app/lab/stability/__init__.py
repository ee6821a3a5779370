"""Experiments that show where methods fail: simulated with the loop's own functions, and computed exactly."""

__all__: list[str] = []
