"""Task manager (D2.1 Figure 1): states, goals, triggers, trials and score of a scene. Import submodules by name."""

__all__: list[str] = []
