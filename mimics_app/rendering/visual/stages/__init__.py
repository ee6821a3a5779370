"""Stages of a frame: each prepares its part for all passes and views of it, and draws with the passes below."""

__all__: list[str] = []
