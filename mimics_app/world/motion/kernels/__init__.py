"""Compiled passes over poses: keys to poses, poses to palettes, reaching limbs."""

__all__: list[str] = []
