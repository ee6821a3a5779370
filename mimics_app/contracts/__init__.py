"""What every layer agrees on: messages, ports, shared memory, clocks, units, errors. Imports nothing above it."""

__all__: list[str] = []
