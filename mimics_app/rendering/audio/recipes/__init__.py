"""Built-in sound recipes, in `RECIPES` of each module; those of installed packages are found by entry point."""

__all__: list[str] = []
