"""Pictures of the world within its picture: what they are drawn into, and the views of mirrors."""

__all__: list[str] = []
