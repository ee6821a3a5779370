"""Sound: contact events of the haptic loop and orders of the task become positional sound in a process of its own."""

__all__: list[str] = []
