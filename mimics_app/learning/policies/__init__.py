"""Built-in policies, by what they learn from: each module has `POLICIES`, builders by the policies' names."""

__all__: list[str] = []
