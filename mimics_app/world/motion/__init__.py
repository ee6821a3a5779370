"""What moves on its own: clips, layers of them, skins that follow joints, arms and legs that reach."""

__all__: list[str] = []
