"""Scenarios: a module each, with `SCENARIO`, named like its scene in `scenes/`; the folders hold their parts."""

__all__: list[str] = []
