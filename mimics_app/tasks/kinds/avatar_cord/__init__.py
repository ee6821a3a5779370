"""The experiment with the avatar and the cord, as a kind of task."""

__all__: list[str] = []
