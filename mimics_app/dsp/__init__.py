"""Digital signal processing (D2.1 Figure 1): body signals -> features. Import submodules by name."""

__all__: list[str] = []
