"""Shared definitions of all layers: messages, ports, shared memory, clocks, errors. Imports nothing above it."""

__all__: list[str] = []
