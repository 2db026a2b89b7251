"""Compliant contacts in a picture: springs, drawn so long that magnified faces stay apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ..methods.signals import Floats
from ..model import Bonded, Rigid
from ..results.contacts import ContactHistory
from ..results.magnification import ROUND_OFF
from .placing import Placing
from .style import colours

ROOM = 0.04  # of a spring at its shortest, in lengths of the row
TURNS = 8


def is_compliant(history: ContactHistory) -> bool:
    """Whether the faces of a contact come closer than touching."""
    return not isinstance(history.law, Rigid | Bonded)


def with_springs(plan: Placing, times: Floats) -> Placing:
    """The row with every body moved to the right by the springs on its left, as at these times.

    True to scale nothing is moved.
    """
    if plan.magnification <= 1:
        return plan
    left, least = plan.left.copy(), ROOM * plan.row
    for history in plan.solution.contacts:
        if is_compliant(history):
            deepest = max(0.0, -float(np.min(history.gap(times))))
            left[history.index + 1 :] += least + plan.magnification * deepest
    return replace(plan, left=left)


def length(plan: Placing, contact: int) -> float:
    """Length in the picture of the spring at a contact before it is pressed, m; 0 without one."""
    if not is_compliant(plan.solution.contacts[contact]):
        return 0.0
    free = float(plan.left[contact + 1] - plan.left[contact]) - plan.width(contact)
    return free if free > ROUND_OFF * plan.row else 0.0


def draw_springs(ax: Axes, plan: Placing, times: Floats, factor: float) -> list[Line2D]:
    """Zigzags in rows one below the other, each on the face to its left, as long as there is room.

    Places are drawn in a unit that is `factor` to the metre.
    """
    drawn = []
    up = np.concatenate([[0.0, 0.0], 0.12 * np.resize([1.0, -1.0], TURNS), [0.0, 0.0]])
    along = np.concatenate([[0.0], np.linspace(0.12, 0.88, TURNS + 2), [1.0]])
    for history in plan.solution.contacts:
        if not (free := length(plan, history.index)):
            continue
        left = plan.end(history.index, True, times)
        right = plan.end(history.index + 1, False, times)
        if history.law.opens:
            right = np.minimum(right, left + free)
        for row, (start, stop) in enumerate(zip(left, right, strict=True)):
            drawn += ax.plot((start + (stop - start) * along) * factor, up - row,
                             color=colours().ink, linewidth=0.9, zorder=3)
    return drawn
