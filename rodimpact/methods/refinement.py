"""Halve a step until the outcome of a run stands still, and tell how still."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from ..frozen import InvalidModel
from .link_kernel import RIGID
from .plan import Array, Plan

MEASURES = ("impulse", "largest force", "time of 99.9 % of the impulse")


class TooLong(InvalidModel):
    """A run takes more steps than there is memory for."""


class Run(Protocol):
    """What is asked of a finished run."""

    @property
    def plan(self) -> Plan:
        """The row."""

    @property
    def step(self) -> float:
        """s."""

    @property
    def stopped_by(self) -> str:
        """Why it ended."""

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; of a contact that can open."""


R = TypeVar("R", bound=Run)


def refined(
    level: Callable[[int], R], measures: Callable[[R], dict[str, Array]], goal: float, last: int
) -> tuple[R, dict[str, float]]:
    """Halve the step until no measure changes by more than `goal`, or as far as it goes.

    Parameters
    ----------
    level : function
        Run with the step divided by a factor; raises `TooLong` where there is no room for it. One
        that met a cap on events goes no further.
    measures : function
        What is to stand still, of a run.
    goal : float
    last : int
        Largest factor, 4 at least.

    Returns
    -------
    run
        The finest.
    estimates : dict of str to float
        Relative change of each measure by the last halvings; inf where there were fewer than two.
    """
    found = level(1)
    reached = measures(found)
    estimates = dict.fromkeys(reached, math.inf)
    before: dict[str, float] = {}
    factor = 2
    while found.stopped_by != "max_events" and max(estimates.values()) > goal:
        if factor > max(4, last):
            break
        try:
            finer = level(factor)
        except TooLong:
            break
        if finer.stopped_by == "max_events":
            break
        then = measures(finer)
        changes = {
            name: float(np.max(np.abs(reached[name] - then[name]), initial=0.0))
            / (float(np.max(np.abs(then[name]), initial=0.0)) or 1.0)
            for name in then
        }
        if before:
            estimates = {name: max(v, before[name] / 2) for name, v in changes.items()}
        found, reached, before, factor = finer, then, changes, 2 * factor
    return found, estimates


def contact_measures(found: Run) -> dict[str, Array]:
    """Impulse, largest force, and time of 99.9 % of the impulse, by contact that can open.

    Restitution follows from the impulses.
    """
    plan = found.plan
    contacts = [k for k, i in enumerate(plan.contact_link) if i >= 0 and plan.laws[i] >= RIGID]
    forces = [found.contact(k)[0] for k in contacts]
    measured = (
        [float(np.sum(F)) * found.step for F in forces], [peak(F) for F in forces],
        [_most_of(F) * found.step for F in forces],
    )
    return {name: np.array(values) for name, values in zip(MEASURES, measured, strict=True)}


def _most_of(force: Array) -> float:
    """Steps in which 99.9 % of the impulse has passed."""
    passed = np.cumsum(force)
    if not len(passed) or passed[-1] <= 0:
        return 0.0
    goal = 0.999 * passed[-1]
    j = int(np.searchsorted(passed, goal))
    before = passed[j - 1] if j else 0.0
    return float(j + (goal - before) / (passed[j] - before))


def peak(force: Array) -> float:
    """Largest force behind step averages.

    At a jump half a step's change beyond the average next to it; at a smooth top that of the
    parabola with the averages of three steps.
    """
    if not len(force) or force.max() <= 0:
        return 0.0
    G = np.concatenate(([0.0, 0.0], force, [0.0, 0.0]))
    j = int(np.argmax(G))
    before, after = float(G[j] - G[j - 1]), float(G[j] - G[j + 1])
    if before > 4 * after:
        return float(G[j]) + (after / 2 if abs(after - (G[j + 1] - G[j + 2])) < after else 0.0)
    if after > 4 * before:
        return float(G[j]) + (before / 2 if abs(before - (G[j - 1] - G[j - 2])) < before else 0.0)
    both = before + after
    if both <= 0:
        return float(G[j])
    return float(G[j]) + both / 24 + (before - after) ** 2 / (8 * both)
