"""Probes of sound: cost and error of the rival spatialisers."""

__all__: list[str] = []
