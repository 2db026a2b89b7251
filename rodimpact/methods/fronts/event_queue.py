"""The event queue: a winner tree with the next tick of every node.

Entry 1 is the root. The leaves stand in the second half, the leaf of node k at
``leaves + k``, and every entry above is the smaller of its two children. The earliest
tick is read in O(1), and setting one takes O(log n).
"""

from .records import Queue


def size_for(nodes: int) -> int:
    """Number of entries of the queue of so many nodes.

    It is twice the number of leaves, the smallest power of two that is no less than
    `nodes`.
    """
    size = 2
    while size < 2 * nodes:
        size *= 2
    return size


def schedule(queue: Queue, leaf: int, tick: int) -> None:
    """Set the entry `leaf` to a tick, and bring the entries above it up to date.

    Each entry above is the smaller of its two children, up to the root.
    """
    queue[leaf] = tick
    i = leaf
    while i > 1:
        # Entry i ^ 1 is the other child of the same entry
        earlier = min(queue[i], queue[i ^ 1])
        i //= 2
        queue[i] = earlier


def first_leaf(queue: Queue) -> int:
    """Index in the queue of the leaf with the earliest tick, the leftmost of several.

    The leaf of node k has the index ``leaves + k``, `leaves` half the entries.
    """
    leaves = len(queue) // 2
    earliest = queue[1]
    i = 1
    while i < leaves:
        # The left child is taken if it has that tick. The comparison counts 0 or 1: a
        # branch, which goes either way as often, takes longer.
        is_right = queue[2 * i] != earliest
        i = 2 * i + is_right
    return i


def build_tree(queue: Queue) -> None:
    """Set all entries above the leaves."""
    for i in range(len(queue) // 2 - 1, 0, -1):
        queue[i] = min(queue[2 * i], queue[2 * i + 1])
