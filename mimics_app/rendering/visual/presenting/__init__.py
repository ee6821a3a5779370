"""From the eyes' pictures to what is shown: composed on the surface, handed to a headset, or kept as files."""

__all__: list[str] = []
