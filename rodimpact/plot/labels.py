"""Labels: their width on paper, their lines, and which of them have room."""

import re
from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from matplotlib import artist
from matplotlib.axes import Axes

from ..model import System
from ..model.numbering import body_names, body_numbers
from .style import NORMAL, SMALL

LETTER = 0.57  # mean width of a letter, in heights of the font
DIGIT = 0.64  # width of a digit
LEGEND_HANDLE = 6  # letters that the mark before a name in a legend takes
LEGEND_OVERHANG = 1.1  # width of a legend in widths of its Axes, at most
NAME_GAP = 4.0  # points between names of rods
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def length_name(system: System, body: int) -> str:
    """Symbol of the length of a rod, with the number of the rod: ℓ₂."""
    number = body_numbers(system.kinds)[body]
    return "\N{SCRIPT SMALL L}" + number.translate(SUBSCRIPTS)


def text_width(text: str, size: float = NORMAL, letter: float = LETTER) -> float:
    """Estimated width of the longest line of a text, points.

    `size` is the height of the letters, points, `letter` their width in heights.
    """
    longest = max(len(line) for line in text.split("\n"))
    return letter * size * longest


def break_label(label: str, room: float) -> str:
    """A label broken into lines at most `room` points long.

    It is broken after commas and before units; a part that is still too long is broken
    between words.
    """
    first, *parts = re.split(r"(?<=,) | (?=\()", label)  # spaces after , and before (
    lines = [first]
    for part in parts:
        longer = f"{lines[-1]} {part}"
        if text_width(longer) > room:
            lines.append(part)
        else:
            lines[-1] = longer
    for k, line in enumerate(lines):
        if text_width(line) > room:
            lines[k] = wrap_words(line, room)
    return "\n".join(lines)


def wrap_words(text: str, room: float, size: float = NORMAL) -> str:
    """A text broken between words into lines at most `room` points long.

    A single longer word is not broken. `size` is the height of the letters, points.
    """
    letters = max(1, int(room / (LETTER * size)))
    return "\n".join(wrap(text, letters, break_long_words=False))


def rod_labels(
    system: System, rods: Sequence[int], centres: Sequence[float], size: float
) -> list[str]:
    """Labels of rods in a row: their names if all have room, else symbols of lengths.

    A symbol that has no room beside those to its left is replaced by "".

    Parameters
    ----------
    system : System
    rods : sequence of int
        Indices of the bodies that are rods, from left to right.
    centres : sequence of float
        Centres of the labels, points.
    size : float
        Height of the letters, points.
    """
    names = body_names(system.kinds)
    texts = [names[i] for i in rods]
    widths = [text_width(text, size) for text in texts]
    if have_room(centres, widths, NAME_GAP):
        return texts
    texts = [length_name(system, i) for i in rods]
    widths = [text_width(text, size) for text in texts]
    return with_room(texts, centres, widths, NAME_GAP)


def with_room(
    texts: Sequence[str], centres: Sequence[float], widths: Sequence[float], gap: float
) -> list[str]:
    """Texts in a row, from left to right, with "" in place of texts without room.

    The first text stays. A later one stays if at least `gap` is free between it and the
    text to its left that stays. All lengths are in one unit.
    """
    shown = []
    free_from = -np.inf  # the next text must begin here or farther to the right
    for text, centre, width in zip(texts, centres, widths, strict=True):
        if centre - width / 2 >= free_from:
            shown.append(text)
            free_from = centre + width / 2 + gap
        else:
            shown.append("")
    return shown


def have_room(centres: Sequence[float], widths: Sequence[float], gap: float) -> bool:
    """Whether at least `gap` is free between all neighbours of texts in a row.

    The texts are in order from left to right. A single text has room.
    """
    for k in range(1, len(centres)):
        distance = centres[k] - centres[k - 1]
        free = distance - (widths[k] + widths[k - 1]) / 2
        if free < gap:
            return False
    return True


def spread_apart(centres: Sequence[float], widths: Sequence[float]) -> list[float]:
    """New centres of texts in a row, moved as little as possible so that none overlap.

    The centres are given and returned in order. Texts that would overlap form a group
    in which neighbours touch; the mean of the centres in a group stays the same.
    """
    groups: list[list[int]] = []  # indices of texts
    starts: list[float] = []  # left end of each group

    def left_end(group: list[int]) -> float:
        """Left end of the group at which the mean of its centres stays the same."""
        offset = 0.0  # width of the texts before text k
        wanted_ends = []  # left end of the group at which text k would not move
        for k in group:
            wanted_ends.append(centres[k] - widths[k] / 2 - offset)
            offset += widths[k]
        return float(np.mean(wanted_ends))

    for k in range(len(centres)):
        groups.append([k])
        starts.append(left_end([k]))
        # The new group may overlap the one before it, and both together the next one.
        while len(groups) > 1:
            end_before = starts[-2] + sum(widths[i] for i in groups[-2])
            if end_before <= starts[-1]:
                break
            # The last two groups overlap: they become one.
            last = groups.pop()
            starts.pop()
            groups[-1].extend(last)
            starts[-1] = left_end(groups[-1])

    moved: list[float] = []
    for group, start in zip(groups, starts, strict=True):
        for k in group:
            moved.append(start + widths[k] / 2)
            start += widths[k]
    return moved


def legend_above(
    ax: Axes, artists: Sequence[artist.Artist | None], title: str | None = None
) -> None:
    """Draw a legend of artists above an Axes, in as many columns as have room.

    Artists that are None are left out; without any artist no legend is drawn.
    """
    named = [each for each in artists if each is not None]
    if not named:
        return
    letters = [len(str(each.get_label())) for each in named]
    width = ax.get_window_extent().width * 72 / ax.figure.dpi
    room = LEGEND_OVERHANG * width / (LETTER * SMALL)  # number of letters in a line
    ax.legend(
        handles=named,
        loc="lower left",
        bbox_to_anchor=(0, 1),
        borderaxespad=0.1,
        ncols=_legend_columns(letters, room),
        frameon=False,
        fontsize=SMALL,
        title=title,
        title_fontsize=SMALL,
        alignment="left",
        columnspacing=1.2,
        handlelength=1.6,
    )


def _legend_columns(letters: Sequence[int], room: float) -> int:
    """Largest number of columns in which a legend is less than `room` letters wide.

    `letters` has the number of letters of each name. It is 1 if no number fits.
    """
    for count in range(len(letters), 1, -1):
        width = 0  # of all columns, letters
        for column in np.array_split(letters, count):
            width += max(column) + LEGEND_HANDLE
        if width < room:
            return count
    return 1
