"""Animation: clips, layers, state machines, skinning, inverse kinematics, gait and motion capture."""

__all__: list[str] = []
