"""What people call the bodies of a row: rods and masses are numbered from the left, walls are not.

Paths of case files and `body=` count all bodies from 0 instead. Plain Python, which the page has as
JavaScript.
"""


def body_numbers(kinds: list[str]) -> list[str]:
    """Number of each body of these kinds, "wall" for a wall.

    Examples
    --------
    >>> body_numbers(["wall", "rod", "mass", "wall"])
    ['wall', '1', '2', 'wall']
    """
    found = [*kinds]
    for k, i in enumerate([i for i, kind in enumerate(kinds) if kind != "wall"]):
        found[i] = f"{k + 1}"
    return found


def body_names(kinds: list[str]) -> list[str]:
    """Name of each body of these kinds.

    Examples
    --------
    >>> body_names(["rod", "mass", "wall"])
    ['rod 1', 'mass 2', 'wall']
    """
    numbers = body_numbers(kinds)
    return [
        kind if kind == "wall" else f"{kind} {numbers[i]}"
        for i, kind in enumerate(kinds)
    ]


def contact_names(kinds: list[str]) -> list[str]:
    """Name of each contact of a row of bodies of these kinds.

    Examples
    --------
    >>> contact_names(["rod", "rod", "wall"])
    ['1-2', '2-wall']
    """
    numbers = body_numbers(kinds)
    return [f"{numbers[i]}-{numbers[i + 1]}" for i in range(len(numbers) - 1)]
