"""Compiled passes over what is drawn: bounds, culling, order, occlusion, commands."""

__all__: list[str] = []
