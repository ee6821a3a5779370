"""Presentation of the eyes' pictures: composed on the surface, submitted to a headset, or saved as files."""

__all__: list[str] = []
