"""State estimation (D2.1 Figure 1): features -> arousal, valence, effort. Import submodules by name."""

__all__: list[str] = []
