"""Reference of the joints at 1 kHz: curves over a cycle, ramps of phase, amplitude and guidance, their rows."""

__all__: list[str] = []
