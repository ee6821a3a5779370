"""Kernels of drawing in software."""

__all__: list[str] = []
