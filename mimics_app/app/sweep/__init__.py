"""`mimics sweep`: its experiments, and the job of a worker."""

__all__: list[str] = []
