"""Displays: what turns a camera or a tracked head into the views the renderer draws."""

__all__: list[str] = []
