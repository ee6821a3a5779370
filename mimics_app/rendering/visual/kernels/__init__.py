"""Compiled passes over the draw items: bounds, culling, order, occlusion, commands."""

__all__: list[str] = []
