"""Robots that are not there: processes that answer as the real ones would, and fail on command."""

__all__: list[str] = []
