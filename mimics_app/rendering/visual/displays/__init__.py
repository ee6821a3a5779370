"""Displays: from a camera or a tracked head to the views of the renderer."""

__all__: list[str] = []
