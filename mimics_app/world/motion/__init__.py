"""What moves by itself: clips, layers of them, skins that follow joints, arms and legs that reach."""

__all__: list[str] = []
