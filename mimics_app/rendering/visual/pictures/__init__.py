"""Pictures of the world within its picture: mirrors, screens, insets."""

__all__: list[str] = []
