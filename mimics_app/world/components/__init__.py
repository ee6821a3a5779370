"""What an entity of a scene may have: types with their meaning, and the checks of it."""

__all__: list[str] = []
