"""Input stage (D2.1 Figure 1): body signals, trackers and pointing devices. Import submodules by name."""

__all__: list[str] = []
