"""Which method does what in a scene: tolerances, the choice, and the choice explained."""

__all__: list[str] = []
