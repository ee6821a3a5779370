"""Scenarios: a module each, with `SCENARIO`, named like its scene in `scenes/`; the folders hold their parts.

A scene there without a module is only looked at and says so: `"scenario": "none"`.
"""

__all__: list[str] = []
