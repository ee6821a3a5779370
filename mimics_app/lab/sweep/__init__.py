"""Sweeps: any experiment over a grid or a seeded sample of its parameters, in pieces that survive a crash."""

__all__: list[str] = []
