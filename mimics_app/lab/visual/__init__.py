"""Worlds and measurements that groups of methods to draw share."""

__all__: list[str] = []
