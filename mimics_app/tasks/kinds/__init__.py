"""Kinds of task, one module each, behind the protocol of `kind`."""

__all__: list[str] = []
