"""What mimics bench measures in processes of its own."""

__all__: list[str] = []
