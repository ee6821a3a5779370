"""Built-in mixers, one module each with `MIXER`; those of installed packages are found by entry point."""

__all__: list[str] = []
