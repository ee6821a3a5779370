"""Compiled inner loops of the signal processing: arrays in, arrays out."""

__all__: list[str] = []
