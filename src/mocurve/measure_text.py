"""Tables of plain text, as reports print them."""

from __future__ import annotations


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """Lines of a table, its first column to the left, the others to the right; no rows, no lines."""
    if not rows:
        return []
    wide = [max(len(row[i]) for row in [head, *rows]) for i in range(len(head))]
    lines = []
    for first, *others in [head, *rows]:
        cells = "  ".join(f"{cell:>{w}}" for cell, w in zip(others, wide[1:], strict=True))
        lines.append(f"{first:<{wide[0]}}  {cells}")
    return ["", *lines]
