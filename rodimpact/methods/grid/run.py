"""A finished run on a grid: its row and its clock, and what passed in each step."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..clock import Clock
from ..laws import RIGID
from ..row import Array, Row
from .driver import Driver
from .measures import largest_force
from .mesh import STEP_TICKS, Mesh
from .scheme import GAP_RESOLUTION

RINGING = 8  # steps in which waves beside a jump swing about their mean


@dataclass(frozen=True, kw_only=True)
class GridRun:
    """A finished run of this method.

    Attributes
    ----------
    clock : Clock
        Its tick is the step's `STEP_TICKS`-th part.
    driver : Driver
        With the arrays of the kernels, at the end.
    finality_time : int
        Step at whose end the collision was proved final, -1 without proof.
    stopped_by : str
        ``"final"``, ``"until"`` or ``"max_events"``.
    estimates : dict of str to float
        Error of each measure of the outcome, relative to its largest value, as `refined` finds it;
        empty where the step was given.
    rtol : float
        What they were to come to.
    peak_change : float
        Relative change of the peak force from a mesh at most half as fine; nan without one.
    """

    clock: Clock
    driver: Driver
    finality_time: int
    stopped_by: str
    estimates: dict[str, float] = field(default_factory=dict)
    rtol: float = 0.0
    peak_change: float = math.nan

    @property
    def mesh(self) -> Mesh:
        """On which it ran."""
        return self.driver.mesh

    @property
    def row(self) -> Row:
        """What was run."""
        return self.driver.row

    @property
    def step(self) -> float:
        """The time step, s."""
        return self.driver.step

    @property
    def steps(self) -> int:
        """Taken, between which signals are averages."""
        return self.driver.taken

    @property
    def resolved(self) -> float:
        """Gap that counts as an opening, m."""
        return GAP_RESOLUTION * float(self.row.scale) * self.step

    @property
    def edges(self) -> Array:
        """Ticks [steps + 1] from 0 on, between which signals are averages."""
        return STEP_TICKS * np.arange(self.steps + 1)

    @property
    def times(self) -> Array:
        """`edges` in s."""
        return np.asarray(self.edges * self.clock.tick)

    def contact(self, contact: int) -> tuple[Array, Array]:
        """Mean force in each step, N, and gap at its end, m; not of a bonded contact."""
        place = self.place(contact)
        return self._of("signal", place, "force"), self._of("signal", place, "gap") * self.step

    def _of(self, name: str, place: int, field: str = "") -> Array:
        """What was entered of one thing in each step."""
        entered = getattr(self.driver.track, name)[: self.steps, place]
        return np.ascontiguousarray(entered[field] if field else entered)

    @property
    def largest_strain(self) -> float:
        """Largest strain of the states that were kept."""
        inside = self.mesh.stiffness > 0
        yielding = self.mesh.stiffness[inside] * self.mesh.width[inside]
        force = self.driver.states["force"]
        if self.mesh.swells:
            with np.errstate(under="ignore"):  # ahead of the waves strains are next to nothing
                force = force - self.mesh.cells.coupling * self.driver.states["radial"] * self.step
        largest = np.maximum(force.max(axis=0), -force.min(axis=0))[inside]
        return float((largest / yielding).max())

    @property
    def overshoot(self) -> float:
        """How much less the peak force of rigid contacts is over a few steps; relative.

        Beside a jump waves on a grid overshoot by a share that no finer mesh makes less; averages
        over a few steps do not.
        """
        peaks, less, times = [0.0], [0.0], self.times
        for contact, link in self.row.opening.items():
            if self.row.laws[link] == RIGID:
                force = self.contact(contact)[0]
                passed = np.concatenate((np.zeros(RINGING), np.cumsum(force)))
                means = (passed[RINGING:] - passed[:-RINGING]) / RINGING
                peaks.append(largest_force(times, force))
                less.append(peaks[-1] - float(means.max(initial=0.0)))
        return max(less) / (max(peaks) or 1.0)

    @property
    def peak_error(self) -> float:
        """Error of the peak force that no finer mesh makes less; relative."""
        steep = self.mesh.viscous.any() or self.mesh.lateral.any() or self.mesh.swells
        if steep and RIGID in self.row.laws:
            return math.inf  # of flat ends that meet, any finer mesh finds a larger force
        return 2 * float(self.overshoot)

    def path(self, contact: int) -> Array:
        """How far a contact that is not bonded closes in each step, m."""
        return self._of("signal", self.place(contact), "closing") * self.step

    def place(self, contact: int) -> int:
        """Which of the kernel's links a contact is that is not bonded."""
        return list(self.mesh.touching).index(self.row.contact_link[contact])

    def bond(self, link: int) -> Array:
        """Mean force in a bonded link in each step, N."""
        return self._of("bonded", list(self.mesh.interfaces).index(link))

    def outer(self, side: int) -> tuple[Array, Array]:
        """Force of what is outside the left or right end on the row, and its velocity, by steps.

        N and m/s, in the laboratory; positive to the inside, and to the right.
        """
        link = (0, len(self.row.laws) - 1)[side]
        if link in self.mesh.touching:
            force = self._of("signal", list(self.mesh.touching).index(link), "force")
        elif self.row.outside[side][0] == "velocity":
            force = self.bond(link)
        else:
            force = self._of("outer", side, "push")
        fall = self.row.gravity * self.step * (np.arange(self.steps) + 0.5)
        return force, self._of("outer", side, "speed") + self.row.frame + fall

    def speed(self, mass: int) -> Array:
        """Velocity of a mass at the ends of the steps, the first at t = 0, in the frame."""
        side = mass - len(self.row.masses)
        if side >= 0:
            wall = float(self.row.outside[side][1]) - self.row.frame
            return np.asarray(wall - self.row.gravity * self.times)
        initial = self.driver.states["velocity"][0, self.mesh.node_of_mass[mass]]
        return np.concatenate(([initial], self._of("speed", mass)))
