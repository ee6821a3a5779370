"""Sources of commands: keys and gamepad, and command files."""

__all__: list[str] = []
