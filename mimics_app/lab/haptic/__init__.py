"""Rival methods to render touch, with their cost and error. Importing a module registers its groups."""

__all__: list[str] = []
