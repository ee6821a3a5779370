"""Learning system (D2.1 Figure 1): state of the person -> adaptation of the task. Import submodules by name."""

__all__: list[str] = []
