"""Controllers of the loop: members found by file (`built_in`) and by entry point, each behind the controller port."""

__all__: list[str] = []
