"""The arrays and records on which the kernels of the grid work.

Loops over all nodes and cells run on plain arrays of numbers, all else is records. Cell
i lies between the nodes i - 1 and i. Cell 0, the cells between pieces and the last cell
stand for nothing.

Time is counted in steps h. Velocities stay in m/s and forces in N, so a length is a
velocity times steps: in a step of velocity v something moves by v, in half a step by
v/2, and what resists with a stiffness k changes its force by k v. Masses and
stiffnesses are scaled to match: M/h, E A h/dx, k h^p for a force k x^p, the constant of
a dashpot as it is. With a radial strain q/h, its inertia is J/h and its stiffnesses are
G h, b h and s h.

In machine code a list of records is a structured array, in plain Python a list of
objects with the same fields, see `compiling`.
"""

from typing import Any, NamedTuple

import numpy as np

from .. import link
from ..record_lists import dtype_of

NONE = -1  # no link
INDEX_MASK = (1 << 40) - 1
"""Mask that changes no index: n & INDEX_MASK is n for every index, which is 0 or more.

It tells the compiler that n >= 0, so that it vectorises the loop over entries from n
on. Loops over a few entries do without.
"""


class Run:
    """The state of a run."""

    step: int  # steps taken
    first_step: int  # steps taken when the present window of `StepHistory` began
    kept_states: int  # states stored in this window
    has_radial_strain: int  # 1: cells have radial strains
    is_implicit: int  # 1: there is damping, lateral inertia or soil
    shafts: int  # number of rods that soil holds
    soil_changes_equations: int  # 1: the damping of soil depends on its resistance
    ground_velocity: float  # velocity of the ground at t = 0
    ground_acceleration: float  # change of this velocity in a step
    velocity_tolerance: float  # contacts graze, and impacts rest, below this velocity


class Piece:
    """A piece of neighbouring nodes: bodies that are bonded together."""

    first_node: int
    displacement: float  # displacement of its first node


class Link(link.Link):
    """A contact or joint between two neighbouring pieces.

    The gap and the yield force are those at present, and the gap is the stretch of a
    joint.
    """

    next_knot: int  # index of the knot at which the hardening changes next
    left_node: int
    right_node: int
    leftmost_node: int  # first and last node whose velocity its force changes in a step
    rightmost_node: int
    chain_end: int  # last link of a chain, at its first; NONE at other links
    # Closing per force over a step
    self_mobility: float  # half of the velocity change of both ends by the own force
    coupling_mobility: float  # half of that by the force of the link before it

    force: float  # mean over the step
    closing: float  # mean closing velocity of the step
    is_closed: int  # 1 while a rigid contact is closed
    initial_closing: float  # closing velocity at the start of the step
    force_free_closing: float  # closing in the step without any force
    max_closing: float  # largest closing of a rigid contact or impact under force
    overlap: float  # overlap at the end of the step
    force_slope: float  # dF/d(closing); -1 where the closing is fixed
    force_before: float  # force before a Newton step
    upper: float  # factor of the elimination of a chain
    # Mean force over the first step, and energy lost, as a contact closed at t = 0
    initial_force: float
    initial_loss: float


class Soil:
    """The soil, or the drag, at one node of a rod.

    Drag has a damping, and no resistance.
    """

    node: int
    shaft: int  # number of the rod among those that soil holds
    end_of_rod: int  # -1 and 1 at the left and right end of the rod, else 0
    is_smith: int  # 1: the damping is in proportion to the static resistance
    stiffness: float  # R_u/q
    ultimate: float  # R_u
    resistance: float  # static resistance R in the middle of the last step
    damping_factor: float  # J
    damping: float  # c, force per velocity in the present step


class ShaftForce:
    """The mean force of the soil on a rod in a step, to the right, and its power."""

    force: float
    power: float
    first_node_force: float  # part of the force on the first node of the rod
    last_node_force: float


class End:
    """The outside that acts on the left or right end of the row."""

    kind: int  # `states.BoundaryKind`
    node: int
    impedance: float  # impedance of a semi-infinite bar
    background_wave: float  # wave that comes from this bar in addition to the given one
    # What is given in the present step: of a pushed end the force, N; of a moved one
    # the velocity, m/s; of an endless bar the wave that comes in beside
    # `background_wave`, m/s
    prescribed: float


class Signal:
    """State of a link in a step."""

    force: float  # mean over the step
    gap: float  # gap at the end of the step
    closing: float  # mean closing velocity


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
    lower: Any  # 0 where nothing is implicit
    inverse_diagonal: Any  # 1/mass where nothing is implicit; 1 if prescribed
    upper: Any
    velocity_by_first: Any  # [node] by a unit force on the first node of its piece
    velocity_by_last: Any  # [node] by a unit force on the last node of its piece
    stiffness: Any  # [cell]
    pieces: Any  # [piece] PIECE
    viscous: Any  # [cell] eta A/dx
    lost: Any  # [cell] energy turned to heat
    old_velocity: Any  # [node] velocity before this step
    change: Any  # [node] change of velocity in this step, where it is implicit
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
    # The equations of a step without soil, for soil that changes them
    off_diagonal: Any  # [cell] entries with opposite sign
    diagonal: Any  # [node]
    loaded_diagonal: Any  # [node] the same with soil
    is_prescribed: Any  # [node] 1 where the velocity is prescribed
    watched: Any  # nodes whose velocities are recorded after each step
    pulled: Any  # cells whose tensions are recorded in each step


class StepHistory(NamedTuple):
    """Records of each step, and states that are kept."""

    signals: Any  # [step, link] SIGNAL
    prescribed: Any  # [step, end] force, wave, or velocity at the end of a step
    velocities: Any  # [step, watched node] velocity at the end of the step
    tensions: Any  # [step, pulled cell] elastic tension in the middle of the step
    shafts: Any  # [step, rod that soil holds] SHAFT_FORCE
    when: Any  # [state] steps taken when it is stored
    lost: Any  # [state] energy turned to heat
    velocity: Any  # [state, node]
    force: Any  # [state, cell] tension
    displacement: Any  # [state, piece] displacement of its first node
    radial: Any  # [state, cell] radial strains; [state, 0] where no cell has its own
    radial_rate: Any  # [state, cell]
    resistance: Any  # [state, node that soil holds] static resistance of the soil


STATE_FIELDS = StepHistory._fields[5:]
"""Fields of `StepHistory` that have an entry for each state."""


def filled(kind: np.dtype[Any], count: int, /, **columns: Any) -> Any:
    """Array of `count` records of a kind, with fields from `columns`.

    All other fields are 0.
    """
    records = np.zeros(count, kind)
    for name, values in columns.items():
        records[name] = values
    return records
