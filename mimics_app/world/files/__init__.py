"""What is read from files: scenes, glTF models, captured motion; their checks."""

__all__: list[str] = []
