"""The project's own people: bodies after published proportions, faces, hands, hair, clothes, skeletons, motions."""

__all__: list[str] = []
