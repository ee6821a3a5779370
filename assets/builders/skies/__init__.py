"""Pictures of the sky for the examples of backdrops."""

__all__: list[str] = []
