"""Stages of a frame: each prepares its part for all passes and views, and draws it by passes."""

__all__: list[str] = []
