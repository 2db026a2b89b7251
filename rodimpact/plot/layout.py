"""Layout of the row in a picture: position X of all points, displacements magnified.

Rods a metre long move by a tenth of a millimetre while they collide. Figures, films and
the page therefore magnify displacements and gaps, all by the same factor, so that
bodies that touch touch in the picture too:

    X = x in the row of unstrained rods without gaps
        + factor * (gaps to the left + displacement).

A row that drifts much farther than its bodies move against each other is drawn in a
moving frame. A rigid mass has no length; in pictures it is a block. A compliant contact
is a spring, drawn so long that magnified faces stay apart. The left end of the first
rod is at X = 0.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..methods.signals import Floats, Ints
from ..model import Bonded, Fixed, Moved, Rigid, RigidMass, Rod, Wall
from ..model.arguments import scalar
from ..results.contacts import ContactHistory
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..results.solution import Solution
from ..units import TIMES, format_factor
from .labels import break_label
from .sampling import middles, pieces, properties, rods_of
from .scales import Scale, largest_of, quantity_text

MAGNIFICATIONS = "[1e-12, 1e15]"
MIN_SPRING_LENGTH = 0.04  # length of a spring at its shortest, in lengths of the row
TIMES_OF_MOTION = 101  # instants at which the motion of the bodies is looked at
TIMES_OF_OVERLAP = 301  # instants at which the overlap of contacts is looked at
POINTS_OF_STRAIN = 33  # points of a rod at which its strain is looked at


class RowEnd(NamedTuple):
    """An end of a body."""

    body: int
    is_right: bool


class SpringPath(NamedTuple):
    """A contact with a spring, and the two ends of the spring over time."""

    contact: ContactHistory
    start: Floats  # X of the left end [time], m
    stop: Floats  # X of the right end


@dataclass(frozen=True)
class PictureLayout:
    """Layout of a row in a picture.

    Attributes
    ----------
    solution : Solution
    magnification : float
        Factor of displacements and gaps; with 0 every body is drawn where it is in the
        undeformed row.
    frame : float
        Velocity of the frame of the picture, m/s.
    left : array
        Left end of each body in the row of unstrained rods without gaps, m; that of the
        first rod is 0.
    widths : array
        Width of each body in the picture before it moves, m.
    initial_offsets : array
        Shift of the left end of each body by gaps and strain at t = 0, m.
    mass_width : float
        Width of a rigid mass in the picture, m; 0 if there is none.
    spring_lengths : array
        Length of the spring at each contact before it is pressed, m; 0 without one.
    """

    solution: Solution
    magnification: float
    frame: float
    left: Floats
    widths: Floats
    initial_offsets: Floats
    mass_width: float
    spring_lengths: Floats

    @property
    def row_length(self) -> float:
        """Length of all rods, blocks and springs together, m."""
        return float(self.left[-1] + self.widths[-1] - self.left[0])

    @property
    def scale(self) -> str:
        """How displacements are drawn, in words."""
        if self.magnification == 1:
            return "true to scale"
        return f"displacements {TIMES} {format_factor(self.magnification)}"

    def position(
        self, body: int | Ints, x: ArrayLike, t: ArrayLike, displacement: Any
    ) -> Floats:
        """Position X, m, in the picture of points of bodies.

        A point is x m from the left end of the unstrained body; at the time t, s, it is
        displaced by `displacement`, m. Its motion, with the initial offset of the body
        and minus that of the frame, is magnified. Arrays are broadcast.
        """
        moved = self.initial_offsets[body] + displacement - self.frame * np.asarray(t)
        X: Floats = self.left[body] + np.asarray(x) + self.magnification * moved
        return X

    def material_ends(self, body: int) -> tuple[float, float]:
        """Material coordinates x of both ends of a body, m; a mass has no length."""
        lengths = _lengths(self.solution)
        left = sum(lengths[:body])
        return left, left + lengths[body]

    def walls(self) -> list[RowEnd]:
        """Faces behind which a wall is drawn: faces of walls, and fixed ends.

        `is_right` says that the wall is drawn to the right of the face.
        """
        bodies = self.solution.system.bodies
        faces = []
        for i, body in enumerate(bodies):
            if isinstance(body, Wall):
                is_right = i > 0  # a wall is the first or the last body
                faces.append(RowEnd(i, is_right))
        left, right = self.solution.system.ends
        if isinstance(left, Fixed):
            faces.append(RowEnd(0, is_right=False))
        if isinstance(right, Fixed):
            faces.append(RowEnd(len(bodies) - 1, is_right=True))
        return faces

    def outer_ends(self) -> tuple[RowEnd, RowEnd]:
        """Left and right end of the row."""
        last = len(self.solution.system.bodies) - 1
        return RowEnd(0, is_right=False), RowEnd(last, is_right=True)

    def point(self, body: int, x: ArrayLike, t: ArrayLike) -> Floats:
        """Position X, m, of points of a body, x m from its left end, at t, s.

        Displacements are magnified and seen from the frame, see `position`. Before t =
        0 a body has the state of t = 0 and moves at its initial velocity. A rigid mass
        moves as one: `x` is then a position in its block.
        """
        velocity = self.solution.outcome.velocities_before[body]
        approach = np.minimum(t, 0.0) * velocity
        displaced_x = x
        if not isinstance(self.solution.system.bodies[body], Rod):
            displaced_x = np.zeros_like(x)  # a mass has the one displacement at x = 0
        displacement = self.solution.displacement(body, displaced_x, np.maximum(t, 0.0))
        return self.position(body, x, t, displacement + approach)

    def end(self, body: int, is_right: bool, t: ArrayLike) -> Floats:
        """Position X, m, of the left or right end of a body at t, s.

        That of a rigid mass is the side of its block.
        """
        x = 0.0
        if is_right:
            x = self.widths[body]
        return self.point(body, x, t)

    def middle(self, body: int, t: ArrayLike) -> Floats:
        """Position X, m, half-way between the ends of a body at t, s."""
        left = self.end(body, is_right=False, t=t)
        right = self.end(body, is_right=True, t=t)
        return (left + right) / 2

    def centre(self, body: int, t: Floats) -> Floats:
        """Position X [time], m, of the centre of mass of a rod at times t, s.

        It is the mean position of the pieces of the rod, weighted by their masses.
        """
        edges = pieces(self.solution, body)
        x = middles(edges)
        area, _, density = properties(self.solution, body, x)
        mass = density * area * np.diff(edges)
        share: Floats = mass / mass.sum()
        positions = self.point(body, x[:, None], t)  # [piece, time]
        return share @ positions

    def springs(self, times: Floats) -> list[SpringPath]:
        """Both ends of the spring of each contact over time.

        While a contact is open, its spring has its free length and stays at the left
        body. The spring of a joint always joins both bodies. Contacts without a spring
        are left out.
        """
        paths = []
        for i, contact in enumerate(self.solution.contacts):
            free_length = self.spring_lengths[i]
            if free_length == 0:
                continue
            left = self.end(i, is_right=True, t=times)
            right = self.end(i + 1, is_right=False, t=times)
            if contact.law.opens:
                right = np.minimum(right, left + free_length)
            paths.append(SpringPath(contact, left, right))
        return paths

    def label(self, x: Scale, room: float) -> str:
        """Label of the axis of x, broken into lines at most `room` points long.

        `x` is the scale of the axis. The label names what the picture does to the row:
        material coordinates or moving frame, widths of masses, long springs,
        magnification.
        """
        label = x.label
        if not self.magnification:
            name = x.name.replace("place", "material coordinate")
            label = x._replace(name=name).label
            label += ", rods laid end to end, gaps left out"
        elif self.frame:
            label += f" in a frame moving at {quantity_text(self.frame, 'm/s')}"
        if self.mass_width:
            width = f"{self.mass_width * x.factor:g} {x.unit}".rstrip()
            label += f", masses drawn {width} wide"
        if self.spring_lengths.any():
            label += ", springs drawn long"
        if self.magnification:
            label += f", {self.scale}"
        return break_label(label, room)


def choose_layout(
    solution: Solution,
    start: float,
    stop: float,
    magnification: float | None = None,
    still: bool = False,
) -> PictureLayout:
    """Layout of the row for an interval of time, with its frame and magnification.

    The magnification is 1, 2 or 5 times a power of ten, see `magnified`. The frame
    moves only if the row drifts much farther than its bodies move against each other.
    A row without rods has the length by which its masses move, or 1 m if none moves.

    Parameters
    ----------
    solution : Solution
    start, stop : float
        Interval of time, s.
    magnification : float, optional
        To be used instead of the automatic one.
    still : bool
        Whether bodies stay where they are in the undeformed row: the magnification is
        then 0.

    Raises
    ------
    ValueError
        If the magnification is not a positive number.
    """
    if magnification is not None:
        magnification = scalar("magnification", magnification, "", MAGNIFICATIONS)

    # What is measured: how far the bodies move, and how much they strain.
    lengths = _lengths(solution)
    material_starts = np.cumsum([0.0, *lengths[:-1]])
    initial_offsets = np.array(solution.fields.positions) - material_starts
    times = np.linspace(start, stop, TIMES_OF_MOTION)
    displacements = _motion_of_ends(solution, initial_offsets, times)
    reference_velocity = _reference_velocity(solution)
    # Range of all displacements, m, in the frame of the reference velocity and in that
    # at rest
    relative_reach = float(np.ptp(displacements - reference_velocity * times))
    reach = float(np.ptp(displacements))

    # How the picture is scaled.
    row_length = sum(lengths)
    if row_length == 0:  # the scale of masses alone is how far they move
        row_length = reach
    if row_length == 0:  # masses that do not move
        row_length = 1.0
    frame = 0.0
    if drifts(reach, relative_reach):
        frame = reference_velocity
    if still:
        magnification = 0.0
    elif magnification is None:
        strain = _largest_strain(solution, times)
        magnification = magnified(row_length, reach, relative_reach, strain)

    # Where the bodies stand.
    is_mass = np.array([isinstance(b, RigidMass) for b in solution.system.bodies])
    mass_width = 0.0
    if is_mass.any():
        mass_width = round_down(BLOCK * row_length)  # the axis label has a round number
    widths = np.where(is_mass, mass_width, lengths)
    masses_to_the_left = np.cumsum(is_mass) - is_mass  # of each body, without itself
    left = material_starts + mass_width * masses_to_the_left
    length_without_springs = left[-1] + widths[-1]
    shortest = MIN_SPRING_LENGTH * length_without_springs
    times = np.linspace(start, stop, TIMES_OF_OVERLAP)
    spring_lengths = _spring_lengths(solution, times, magnification, shortest)
    left = left + np.cumsum([0.0, *spring_lengths])  # springs to the left of each body
    rods = rods_of(solution.system)
    if rods:
        left = left - left[rods[0]]  # the first rod begins at X = 0
    return PictureLayout(
        solution=solution,
        magnification=magnification,
        frame=frame,
        left=left,
        widths=widths,
        initial_offsets=initial_offsets,
        mass_width=mass_width,
        spring_lengths=spring_lengths,
    )


def _lengths(solution: Solution) -> list[float]:
    """Length of each body, m; 0 for walls and masses."""
    lengths = []
    for body in solution.system.bodies:
        length = 0.0
        if isinstance(body, Rod):
            length = float(body.length)
        lengths.append(length)
    return lengths


def _motion_of_ends(
    solution: Solution, initial_offsets: Floats, times: Floats
) -> Floats:
    """Displacements [end, time] of both ends of each body, m, the left end first.

    They are displacements from the unstrained row without gaps.
    """
    moved = []
    for body, length in enumerate(_lengths(solution)):
        for x in (0.0, length):
            moved.append(initial_offsets[body] + solution.displacement(body, x, times))
    return np.array(moved)


def _reference_velocity(solution: Solution) -> float:
    """Velocity of smallest magnitude among walls and held ends, m/s.

    A held end, fixed or driven at a velocity, counts with the velocity 0. Without walls
    and held ends it is the initial velocity of smallest magnitude among the bodies.
    """
    velocities = []
    for body in solution.system.bodies:
        if isinstance(body, Wall):
            velocities.append(float(body.velocity))
    for end in solution.system.ends:
        if isinstance(end, Fixed | Moved):
            velocities.append(0.0)
    if not velocities:
        velocities = list(solution.outcome.velocities_before)
    return min(velocities, key=abs)


def _largest_strain(solution: Solution, times: Floats) -> float:
    """Largest absolute strain of the rods at the times, s; 0 without rods.

    Each rod is sampled at `POINTS_OF_STRAIN` points.
    """
    largest = 0.0
    for body, length in enumerate(_lengths(solution)):
        if length:
            x = np.linspace(0, length, POINTS_OF_STRAIN)
            strain = solution.strain(body, x[:, None], times)
            largest = max(largest, largest_of(strain))
    return largest


def _spring_lengths(
    solution: Solution, times: Floats, magnification: float, shortest: float
) -> Floats:
    """Free length in the picture of the spring at each contact, m.

    It is `shortest` plus the largest magnified overlap at the times, so that a pressed
    spring is never shorter than `shortest`. It is 0 where no spring is drawn: at rigid
    contacts and bonds, and everywhere if displacements are not magnified.
    """
    lengths = np.zeros(len(solution.contacts))
    if magnification <= 1:  # true to scale, or at rest: no spring is drawn
        return lengths
    for contact in solution.contacts:
        if not isinstance(contact.law, Rigid | Bonded):
            least_gap = float(np.min(contact.gap(times)))
            overlap = max(0.0, -least_gap)  # a negative gap is an overlap
            lengths[contact.index] = shortest + magnification * overlap
    return lengths
