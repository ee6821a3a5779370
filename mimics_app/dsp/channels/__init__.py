"""Signals that are processed: a module each, named as the signal, with its `CHANNEL`."""

__all__: list[str] = []
