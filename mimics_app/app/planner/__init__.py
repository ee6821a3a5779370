"""Choice of the methods of a scene: tolerances, uses, plan, and its explanation."""

__all__: list[str] = []
