"""Records of the 1 kHz loop: fields with units, rows of haptic objects, limits, signatures of its plug-ins."""

__all__: list[str] = []
