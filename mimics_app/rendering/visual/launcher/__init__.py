"""The page to choose a scenario from, drawn and steered in a window of its own."""

__all__: list[str] = []
