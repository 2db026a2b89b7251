"""The event queue: a winner tree with the next tick of every node.

The root is entry 1, and the children of entry i are the entries 2 i and 2 i + 1. The
leaves are the second half of the entries: the leaf of node k is entry ``leaves + k``.
Every other entry is the smaller of its two children; entry 0 is not used. Reading the
earliest tick takes O(1), and setting a tick O(log n).
"""

from .records import Queue


def size_for(nodes: int) -> int:
    """Number of entries of the queue for this number of nodes.

    It is twice the number of leaves: the smallest power of two that is at least
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
        # The entries i and i ^ 1 are the two children of entry i // 2.
        earlier = min(queue[i], queue[i ^ 1])
        i //= 2
        queue[i] = earlier


def first_leaf(queue: Queue) -> int:
    """Index in the queue of the leaf with the earliest tick, the leftmost of several.

    The leaf of node k has the index ``leaves + k``, where `leaves` is half the number
    of entries.
    """
    leaves = len(queue) // 2
    earliest = queue[1]
    i = 1
    while i < leaves:
        # Go to the left child if it has the earliest tick, else to the right one. The
        # truth value is added as 0 or 1: a branch would be slower, as the processor
        # cannot predict it.
        is_right = queue[2 * i] != earliest
        i = 2 * i + is_right
    return i


def build_tree(queue: Queue) -> None:
    """Set all entries above the leaves, from the ticks in the leaves."""
    # The root comes last: each entry needs both of its children.
    for i in range(len(queue) // 2 - 1, 0, -1):
        queue[i] = min(queue[2 * i], queue[2 * i + 1])
