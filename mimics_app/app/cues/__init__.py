"""What a task and the haptic loop set off: sounds and effects of the scene."""

__all__: list[str] = []
