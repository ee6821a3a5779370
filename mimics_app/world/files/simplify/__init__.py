"""Mesh simplification by edge collapse, and levels of detail written into a model."""

__all__: list[str] = []
