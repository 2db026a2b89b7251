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
    """A label broken after commas and before units, in lines of so many points.

    Parts that are longer are broken between words.
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
    """A text broken between words, in lines of so many points."""
    letters = max(1, int(room / (LETTER * size)))
    return "\n".join(wrap(text, letters, break_long_words=False))


def rod_labels(
    system: System, rods: Sequence[int], centres: Sequence[float], size: float
) -> list[str]:
    """Labels of rods in a row: names, else symbols of their lengths, "" without room.

    Parameters
    ----------
    system : System
    rods : sequence of int
        Bodies that are rods, from left to right.
    centres : sequence of float
        Of their labels, points.
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
    """Texts in a row, from left to right; "" in place of those too near to one before.

    Those that stay have a gap between them. All lengths are in one unit.
    """
    shown = []
    free_from = -np.inf
    for text, centre, width in zip(texts, centres, widths, strict=True):
        if centre - width / 2 >= free_from:
            shown.append(text)
            free_from = centre + width / 2 + gap
        else:
            shown.append("")
    return shown


def have_room(centres: Sequence[float], widths: Sequence[float], gap: float) -> bool:
    """Whether texts in a row, from left to right, keep a gap between neighbours."""
    for k in range(1, len(centres)):
        free = centres[k] - centres[k - 1] - (widths[k] + widths[k - 1]) / 2
        if free < gap:
            return False
    return True


def spread_apart(centres: Sequence[float], widths: Sequence[float]) -> list[float]:
    """Centres of texts in a row, moved as little as possible so that none overlap.

    The centres are in order. Texts that overlap form a group that touches; a group
    keeps the mean of its centres.
    """
    groups: list[list[int]] = []
    starts: list[float] = []  # left end of each group

    def left_end(group: list[int]) -> float:
        """Mean of the left ends that the group would need for each of its texts."""
        offset = 0.0
        ends = []
        for k in group:
            ends.append(centres[k] - widths[k] / 2 - offset)
            offset += widths[k]
        return float(np.mean(ends))

    for k in range(len(centres)):
        groups.append([k])
        starts.append(left_end([k]))
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
    """Name artists above an Axes in a legend, in as many columns as it has room for.

    Entries that are None are left out; without any there is no legend.
    """
    named = [each for each in artists if each is not None]
    if not named:
        return
    letters = [len(str(each.get_label())) for each in named]
    width = ax.get_window_extent().width * 72 / ax.figure.dpi
    room = LEGEND_OVERHANG * width / (LETTER * SMALL)  # letters
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
    """Largest number of columns of names that fit into so many letters."""
    for count in range(len(letters), 1, -1):
        width = 0
        for column in np.array_split(letters, count):
            width += max(column) + LEGEND_HANDLE
        if width < room:
            return count
    return 1
