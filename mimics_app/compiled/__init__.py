"""Machinery of compiled functions: what numba does not offer. Knows nothing of the application."""

__all__: list[str] = []
