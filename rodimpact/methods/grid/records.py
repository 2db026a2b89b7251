"""The arrays and records on which the kernels of the grid work.

Loops over all nodes and cells run on plain arrays of numbers; everything else is stored
in records. Cell i lies between the nodes i - 1 and i. Cell 0, the cells between pieces
and the last cell are no parts of bodies: they have no mass and no stiffness.

Time is counted in steps h. Velocities are in m/s and forces in N, so a length is a
velocity times a number of steps, in m/s: a node of velocity v moves by v in a step and
by v/2 in half a step, and a spring of stiffness k changes its force by k v in a step.
Masses and stiffnesses are scaled to match: M/h, E A h/dx, and k h^p for a force k x^p;
the constant of a dashpot is not scaled. The radial strain is stored as q/h. Its inertia
is J/h, and its stiffnesses are G h, b h and s h.

In machine code a list of records is a structured array, in plain Python a list of
objects with the same fields, see `compiling`.
"""

from typing import Any, NamedTuple

import numpy as np

from .. import link
from ..record_lists import dtype_of

NONE = -1  # in place of the index of a link
INDEX_MASK = (1 << 40) - 1
"""Mask that changes no index: n & INDEX_MASK is n for every index n >= 0.

It tells the compiler that n >= 0, so that it vectorises the loop over the entries from
n on. Loops over few entries do not need it.
"""


class Run:
    """The state of a run."""

    steps_taken: int
    first_step: int  # steps taken when the present window of `StepHistory` began
    kept_states: int  # number of states stored in this window
    has_radial_strain: int  # 1: cells have radial strains
    is_implicit: int  # 1: there is damping, lateral inertia, soil or drag
    shaft_count: int  # number of rods with soil or drag along their shafts
    soil_changes_equations: int  # 1: the damping of soil depends on its resistance
    ground_velocity: float  # velocity of the ground at t = 0, m/s
    ground_acceleration: float  # change of this velocity in a step, m/s per step
    velocity_tolerance: float  # closing velocities below it count as 0


class Piece:
    """A piece of neighbouring nodes: one body, or bodies that are bonded together."""

    first_node: int
    displacement: float  # displacement of its first node


class Link(link.Link):
    """A contact or joint between two neighbouring pieces.

    Its fields `gap` and `yield_force` have the present values; the gap of a joint is
    its stretch.
    """

    next_knot: int  # index of the next knot of the hardening table
    left_node: int
    right_node: int
    leftmost_node: int  # first and last node whose velocity its force changes in a step
    rightmost_node: int
    chain_end: int  # last link of a chain, at its first link; NONE at other links
    # Decrease of the closing in a step by a unit of its own force, (m/s)/N: half of the
    # velocity changes of both nodes
    self_mobility: float
    # Increase of the closing in a step by a unit force of the link before it, (m/s)/N
    coupling_mobility: float

    force: float  # mean over the step, N
    closing: float  # mean closing velocity of the step
    is_closed: int  # 1 while a rigid contact is closed
    old_closing: float  # closing velocity before the step, as `Grid.old_velocity`
    force_free_closing: float  # closing in the step if no link had a force
    # Rigid contact or impact: the closing that its force, if it has one, leaves;
    # infinite for an impact that has not begun
    max_closing: float
    overlap: float  # overlap at the end of the step
    force_slope: float  # dF/d(closing); -1 if the closing is fixed
    force_before: float  # force before a Newton step
    upper: float  # factor of the elimination of a chain
    # Rigid contact that closed at t = 0, see `start.slow_down`: further force, N, the
    # mean over the first step, and the energy lost by it in the link, W times steps
    initial_force: float
    initial_loss: float


class Soil:
    """The soil, or the drag, at one node of a rod.

    Drag has a damping only; its stiffness and resistances are 0.
    """

    node: int
    shaft: int  # index of the rod in `soil.shaft_bodies`
    end_of_rod: int  # -1 and 1 at the left and right end of the rod, else 0
    is_smith: int  # 1: the damping is proportional to the static resistance
    stiffness: float  # R_u/quake
    ultimate: float  # ultimate resistance R_u, N
    resistance: float  # static resistance R in the middle of the last step, N
    damping_factor: float  # J, s/m
    damping: float  # c in the present step, N s/m


class ShaftForce:
    """The mean force of the soil on a rod in a step, to the right, and its power."""

    force: float  # N
    power: float  # W
    first_node_force: float  # part of `force` that acts on the first node of the rod
    last_node_force: float  # part of `force` that acts on its last node


class End:
    """The outside that acts on the left or right end of the row."""

    kind: int  # `states.BoundaryKind`
    node: int
    impedance: float  # impedance of a semi-infinite bar, kg/s; 0 at any other end
    # Constant wave, m/s, that comes from this bar in addition to the prescribed one
    background_wave: float
    # Prescribed value in the present step: the force of a pushed end, N, the velocity
    # of a moved end, m/s, or the wave from a semi-infinite bar, m/s, which is added to
    # `background_wave`
    prescribed: float


class Signal:
    """Recorded values of a link in a step."""

    force: float  # mean over the step, N
    gap: float  # gap at the end of the step, m/s times steps
    closing: float  # mean closing velocity, m/s


RUN = dtype_of(Run)
PIECE = dtype_of(Piece)
LINK = dtype_of(Link)
SOIL = dtype_of(Soil)
SHAFT_FORCE = dtype_of(ShaftForce)
END = dtype_of(End)
SIGNAL = dtype_of(Signal)


class Grid(NamedTuple):
    """The state of a grid, and the constants of its equations."""

    run: Any  # one RUN
    velocity: Any  # [node]
    force: Any  # [cell] elastic tension in the middle of the last step
    # LU factors of the tridiagonal matrix of a step, [node], see `elimination_kernel`
    lower: Any  # 0 in explicit steps
    inverse_diagonal: Any  # 1/mass in explicit steps; 1 if the velocity is prescribed
    upper: Any  # 0 in explicit steps
    # [node] velocity change in a step by a unit force on the first or the last node of
    # the piece, (m/s)/N
    velocity_by_first: Any
    velocity_by_last: Any
    stiffness: Any  # [cell]
    pieces: Any  # [piece] PIECE
    viscous: Any  # [cell] eta A/dx
    lost: Any  # [cell] energy turned to heat
    old_velocity: Any  # [node] velocity before this step
    change: Any  # [node] change of velocity in an implicit step
    radial_strain: Any  # [cell] q in the middle of the last step
    radial_rate: Any  # [cell] rate of q
    inverse_radial_inertia: Any  # [cell] 1/J
    coupling: Any  # [cell] b
    radial_stiffness: Any  # [cell] G - b^2/k
    tension_share: Any  # [cell] b/k
    shear: Any  # [cell] s between it and the next cell
    links: Any  # [link] LINK, from left to right
    ends: Any  # two END
    soil: Any  # [node that soil holds] SOIL
    # Matrix of the equations of a step, for soil that changes them
    off_diagonal: Any  # [cell] entries with opposite sign
    diagonal: Any  # [node] without soil
    loaded_diagonal: Any  # [node] with soil
    is_prescribed: Any  # [node] 1 where the velocity is prescribed
    recorded_nodes: Any  # nodes whose velocities are recorded after each step
    recorded_cells: Any  # cells whose tensions are recorded in each step


class StepHistory(NamedTuple):
    """Records of each step, and states that are kept."""

    signals: Any  # [step, link] SIGNAL
    prescribed: Any  # [step, end] force, wave, or velocity at the end of a step
    velocities: Any  # [step, recorded node] velocity at the end of the step
    tensions: Any  # [step, recorded cell] elastic tension in the middle of the step
    shafts: Any  # [step, rod that soil holds] SHAFT_FORCE
    when: Any  # [state] number of steps taken when the state is stored
    lost: Any  # [state] energy turned to heat so far
    velocity: Any  # [state, node]
    force: Any  # [state, cell] tension
    displacement: Any  # [state, piece] displacement of its first node
    radial: Any  # [state, cell] radial strains; [state, 0] if no cell has one
    radial_rate: Any  # [state, cell]
    resistance: Any  # [state, node that soil holds] static resistance of the soil


STATE_FIELDS = StepHistory._fields[5:]
"""Fields of `StepHistory` that have an entry for each state."""


def filled(kind: np.dtype[Any], count: int, /, **columns: Any) -> Any:
    """Array of `count` records of the dtype `kind`.

    Each keyword argument names a field and gives its values, [count] or a single one.
    All other fields are 0.
    """
    records = np.zeros(count, kind)
    for name, values in columns.items():
        records[name] = values
    return records
