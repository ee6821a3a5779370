"""The mixer that works in blocks of spectra: a whole response per voice and ear, exact between the ears."""

__all__: list[str] = []
