"""Scenes as every command reads them, and which scenario plays which."""

__all__: list[str] = []
