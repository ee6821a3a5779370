"""Input stage (D2.1 Figure 1): body signals, tracking, and the pointing device. Import submodules by name."""

__all__: list[str] = []
