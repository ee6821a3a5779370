"""Worlds and measurements that groups of methods to render touch share."""

__all__: list[str] = []
