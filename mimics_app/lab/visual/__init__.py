"""Rival methods to draw, with their cost and error. Importing a module registers its groups."""

__all__: list[str] = []
