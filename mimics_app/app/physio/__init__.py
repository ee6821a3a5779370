"""Body signals without a scene: read, processed, shown, judged. Import submodules by name."""

__all__: list[str] = []
