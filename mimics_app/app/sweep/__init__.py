"""`mimics sweep`: the experiments it can run, and what a worker does."""

__all__: list[str] = []
