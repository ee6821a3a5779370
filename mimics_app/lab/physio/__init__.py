"""Figures of the physiological loop: detectors, policies on simulated people. Import submodules by name."""

__all__: list[str] = []
