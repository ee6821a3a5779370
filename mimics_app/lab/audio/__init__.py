"""Probes of sound: what the rival spatialisers cost and how far their output is from the reference."""

__all__: list[str] = []
