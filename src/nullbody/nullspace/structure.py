"""Structure of a sparse square matrix: a perfect matching and the block-triangular form.

Matching by augmenting paths; strongly connected components by Tarjan's algorithm (1972), so that the diagonal
blocks come out in an order in which each block depends on later ones only.
"""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["block_triangular", "perfect_matching"]


def perfect_matching(columns_of: Sequence[Sequence[int]]) -> list[int] | None:
    """A row for every column such that each (row, column) is a non-zero entry, or None if there is none.

    Args:
        columns_of: for every row the columns of its non-zero entries.
    """
    row_of = [-1] * len(columns_of)
    return row_of if all(_augmented(columns_of, row_of, row) for row in range(len(columns_of))) else None


def _augmented(columns_of: Sequence[Sequence[int]], row_of: list[int], row: int) -> bool:
    """Give a row a column, moving others along a path that is searched without recursion; False if none can."""
    came_from: dict[int, tuple[int, int]] = {}  # row -> (row before it on the path, the column that it gives up)
    seen: set[int] = set()
    pending = [row]
    while pending:
        current = pending.pop()
        free = next((column for column in columns_of[current] if row_of[column] < 0), None)
        if free is None:
            for column in columns_of[current]:
                if column not in seen:
                    seen.add(column)
                    came_from[row_of[column]] = current, column
                    pending.append(row_of[column])
            continue
        row_of[free] = current
        while current != row:
            current, column = came_from[current]
            row_of[column] = current
        return True
    return False


def block_triangular(columns_of: Sequence[Sequence[int]]) -> list[tuple[list[int], list[int]]] | None:
    """Irreducible diagonal blocks (rows, columns), from the last equations to be solved to the first.

    Block i has non-zero entries in the columns of blocks i, i + 1, ... only. None if no matching exists:
    the matrix is then structurally singular.

    The blocks are the strong components of a graph of the unknowns. An edge j -> k: the equation that is solved for x_j
    contains x_k.
    """
    row_of = perfect_matching(columns_of)
    if row_of is None:
        return None
    successors = [list(columns_of[row_of[column]]) for column in range(len(row_of))]
    blocks = [sorted(component) for component in _components(successors)][::-1]
    return [(sorted(row_of[column] for column in block), block) for block in blocks]


def _components(successors: Sequence[Sequence[int]]) -> list[list[int]]:
    """Strongly connected components, each after all that it leads to (Tarjan, without recursion)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    components: list[list[int]] = []
    for root in range(len(successors)):
        if root in index:
            continue
        work = [(root, 0)]
        while work:
            node, step = work.pop()
            if step == 0:
                index[node] = low[node] = len(index)
                stack.append(node)
                on_stack.add(node)
            if step > 0:
                low[node] = min(low[node], low[successors[node][step - 1]])
            for position in range(step, len(successors[node])):
                child = successors[node][position]
                if child not in index:
                    work += [(node, position + 1), (child, 0)]
                    break
                if child in on_stack:
                    low[node] = min(low[node], index[child])
            else:
                if low[node] == index[node]:
                    component: list[int] = []
                    while not component or component[-1] != node:
                        component.append(stack.pop())
                        on_stack.remove(component[-1])
                    components.append(component)
    return components
