"""Names of bodies and contacts for people.

Rods and masses have numbers, walls have none. The numbers count rods and masses from
the left, from 1 on. Paths of case files and `body=` count all bodies from 0 instead.
The page has these functions as JavaScript.
"""


def body_numbers(kinds: list[str]) -> list[str]:
    """Number of each body of a row, "wall" for a wall.

    Parameters
    ----------
    kinds : list of str
        "rod", "mass" or "wall" for each body from left to right.

    Examples
    --------
    >>> body_numbers(["wall", "rod", "mass", "wall"])
    ['wall', '1', '2', 'wall']
    """
    numbers = []
    count = 0
    for kind in kinds:
        if kind == "wall":
            numbers.append("wall")
        else:
            count += 1
            numbers.append(f"{count}")
    return numbers


def body_names(kinds: list[str]) -> list[str]:
    """Name of each body of a row, from the kinds of its bodies.

    Examples
    --------
    >>> body_names(["rod", "mass", "wall"])
    ['rod 1', 'mass 2', 'wall']
    """
    numbers = body_numbers(kinds)
    names = []
    for i, kind in enumerate(kinds):
        if kind == "wall":
            names.append("wall")
        else:
            names.append(f"{kind} {numbers[i]}")
    return names


def contact_names(kinds: list[str]) -> list[str]:
    """Name of each contact of a row, from the kinds of its bodies.

    Examples
    --------
    >>> contact_names(["rod", "rod", "wall"])
    ['1-2', '2-wall']
    """
    numbers = body_numbers(kinds)
    return [f"{numbers[i]}-{numbers[i + 1]}" for i in range(len(numbers) - 1)]
