"""Kinds of task, one package each, behind the protocol of `kind`."""

__all__: list[str] = []
