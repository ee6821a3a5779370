"""Captured motion: files of joints and of markers, as clips of a skeleton."""

__all__: list[str] = []
