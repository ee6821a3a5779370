"""Emulated robots: the remote side of each device protocol, with faults on command."""

__all__: list[str] = []
