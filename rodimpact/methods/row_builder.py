"""The walk through a system, from left to right, which makes a `Row`.

The web page has this as JavaScript; there a system is a table of tables with the same
names.
"""

import copyreg
from typing import Any

from .link import Law, link_of, link_of_contact
from .row import Row

BOUNDARIES = {
    "free": "none",
    "fixed": "velocity",
    "moved": "velocity",
    "pushed": "force",
    "absorbing": "absorbing",
    "incoming": "absorbing",
}
"""Kinds of boundaries in `Row.boundaries`, by the kind of the end."""
DRIVEN = ["moved", "pushed", "incoming"]
"""Kinds of ends that have a value."""


def build_row(system: Any) -> Row:
    """Make the `Row` of a system, walking through it from left to right.

    Each block of bonded rigid bodies becomes a mass or, if it contains a wall, a
    boundary; each rod becomes its segments. The links are, from left to right: the left
    end, the contacts and the bonds between segments, and the right end. A side with a
    wall has no link of an end. `mass_of` also numbers masses bonded to a wall, see
    `number_bonded_masses`.
    """
    bodies = system.bodies
    nothing = ("none", 0.0)
    row = Row(
        system,
        [],  # segments
        [""],  # paths: segments are counted from 1
        [],  # spans
        [0],  # first_mass: no mass is left of node 0
        [],  # masses
        [],  # mass_velocity
        [],  # mass_of
        [],  # links
        [],  # contact_link
        [nothing, nothing],  # boundaries
    )
    blocks = rigid_blocks(system)
    for block in blocks:
        i = block[0]  # first body of the block; a rod is its only one
        body = bodies[i]
        if i > 0:  # the contact between the previous block and this one
            row.contact_link.append(len(row.links))
            link = link_of_contact(system.contacts[i - 1], system.gaps[i - 1])
            row.links.append(link)
        elif body.kind != "wall":
            add_end(row, 0, system.ends[0])
        if body.kind == "rod":
            add_rod(row, f"bodies.{i}", body)
        else:
            add_rigid(row, bodies, block)
    if bodies[-1].kind != "wall":
        add_end(row, 1, system.ends[1])
    row.first_mass.append(len(row.masses))  # entry after that of the last node
    number_bonded_masses(row, bodies, blocks[0])
    return row


copyreg.pickle(Row, lambda row: (build_row, (row.system,)))


def rigid_blocks(system: Any) -> list[list[int]]:
    """Split the bodies into blocks from left to right: lists of their numbers.

    Rigid bodies (masses and walls) that are bonded together are one block. Each rod is
    a block of its own.
    """
    bodies = system.bodies
    cuts = []  # whether there is a cut at each contact
    for k, contact in enumerate(system.contacts):
        has_rod = bodies[k].kind == "rod" or bodies[k + 1].kind == "rod"
        cuts.append(contact.law != "bonded" or has_rod)
    return split_at(cuts)


def split_at(cuts: list[bool]) -> list[list[int]]:
    """Split bodies into blocks from left to right: lists of their numbers, from 0.

    `cuts[k]` says whether to cut between the bodies k and k + 1. So there is one body
    more than entries; without entries the result is [[0]].
    """
    blocks = [[0]]
    for k, cut in enumerate(cuts):
        if cut:
            blocks.append([])
        blocks[-1].append(k + 1)
    return blocks


def add_rigid(row: Row, bodies: Any, block: list[int]) -> None:
    """Add a block of bonded rigid bodies to a row: as one mass, or as a boundary.

    `bodies` are all bodies of the system; `block` has the numbers of the bodies in the
    block, from left to right. A block without a wall becomes one mass, whose velocity
    is momentum over mass. A wall becomes the boundary on its side, with its velocity;
    masses bonded to it do not become masses of the row. In this case all bodies of the
    block get -1 in `mass_of`, which `number_bonded_masses` changes later for the
    masses.
    """
    # Contacts inside the block are no links, and its bodies have no segments.
    row.contact_link.extend([-1 for _ in block[1:]])
    row.spans.extend([(1, 0) for _ in block])
    walls = [i for i in block if bodies[i].kind == "wall"]
    if len(walls) > 0:
        mass_index = -1
    else:
        mass_index = len(row.masses)
    row.mass_of.extend([mass_index for _ in block])
    for i in walls:  # a wall is the first or the last body of the system
        if i == 0:
            side = 0
        else:
            side = 1
        row.boundaries[side] = ("velocity", bodies[i].velocity)
    if len(walls) > 0:  # the block is not a mass
        return
    mass = bodies[block[0]].mass
    velocity = bodies[block[0]].velocity
    for i in block[1:]:
        momentum = mass * velocity + bodies[i].mass * bodies[i].velocity
        mass = mass + bodies[i].mass
        velocity = momentum / mass
    row.masses.append(mass)
    row.mass_velocity.append(velocity)


def number_bonded_masses(row: Row, bodies: Any, first_block: list[int]) -> None:
    """Set `mass_of` of the masses bonded to a wall, once all masses are in the row.

    It becomes len(row.masses) for masses bonded to the left wall, and
    len(row.masses) + 1 for masses bonded to the right wall. Masses in `first_block` are
    bonded to the left wall, if there is one. `bodies` are all bodies of the system.
    """
    has_left_wall = bodies[0].kind == "wall"
    for i, body in enumerate(bodies):
        if row.mass_of[i] < 0 and body.kind == "mass":  # bonded to a wall
            is_at_left_wall = has_left_wall and i in first_block
            row.mass_of[i] = len(row.masses)
            if not is_at_left_wall:
                row.mass_of[i] += 1


def add_rod(row: Row, path: str, rod: Any) -> None:
    """Add a rod, whose path is `path`, to a row: its segments, bonded to each other.

    The lists of the row by segment, by body and by node grow, and a bond between every
    two neighbouring segments is appended to its links. The path of a single segment is
    that of the rod; others have a path such as ``"bodies.0.segments.1"``.
    """
    row.mass_of.append(-1)  # a rod is no rigid mass
    count = len(rod.segments)
    # First and last segment, both included; segments are counted from 1.
    row.spans.append((len(row.segments) + 1, len(row.segments) + count))
    for j, segment in enumerate(rod.segments):
        if j > 0:
            row.links.append(link_of(Law.BOND))
        row.segments.append(segment)
        if count > 1:
            segment_path = f"{path}.segments.{j}"
        else:
            segment_path = path
        row.paths.append(segment_path)
        # `first_mass` of the node at the right end of the segment: the number of masses
        # so far
        row.first_mass.append(len(row.masses))


def add_end(row: Row, side: int, end: Any) -> None:
    """Add the link at the left (side 0) or right (1) end of a row, and its boundary.

    The link of a free or pushed end is a push, the link of any other end a bond. The
    boundary gets the kind, see `BOUNDARIES`, and the value of the end, which is 0 for a
    free, fixed or absorbing end.
    """
    kind = BOUNDARIES[end.kind]
    if end.kind in DRIVEN:
        value = end.value
    else:
        value = 0.0
    row.boundaries[side] = (kind, value)
    is_push = kind in ("none", "force")  # a free end has the given force 0
    if not is_push:
        law = Law.BOND
    elif side == 0:
        law = Law.PUSH_LEFT
    else:
        law = Law.PUSH_RIGHT
    row.links.append(link_of(law))
