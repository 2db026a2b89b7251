"""The one walk through a system, from left to right, which makes a `Row`.

The page has this as JavaScript, where a system is a table of tables with the same
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
"""Names in `Row.boundaries` of what acts on an end, by the kind of the end."""
DRIVEN = ["moved", "pushed", "incoming"]
"""Kinds of ends that have a value."""


def build_row(system: Any) -> Row:
    """Make the `Row` of a system, walking through it from left to right.

    Each block of rigid bodies becomes a mass or, with a wall in it, a boundary; each
    rod becomes its segments. Links are, from left to right, the left end, contacts and
    bonds of segments, and the right end; a wall stands in place of an end. Masses
    bonded to a wall get the number of the wall in `mass_of`.
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
        i = block[0]  # its first body; a rod is the only one of its block
        body = bodies[i]
        if i > 0:  # the contact between the block before and this one
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
    row.first_mass.append(len(row.masses))  # an entry behind the last node
    number_bonded_masses(row, bodies, blocks[0])
    return row


copyreg.pickle(Row, lambda row: (build_row, (row.system,)))


def rigid_blocks(system: Any) -> list[list[int]]:
    """Split the bodies into blocks from left to right: lists of their numbers.

    Rigid bodies, masses and walls, that are bonded together are one block; each rod is
    a block of its own.
    """
    bodies = system.bodies
    cuts = []
    for k, law in enumerate(system.contacts):
        has_rod = bodies[k].kind == "rod" or bodies[k + 1].kind == "rod"
        cuts.append(law.law != "bonded" or has_rod)
    return split_at(cuts)


def split_at(cuts: list[bool]) -> list[list[int]]:
    """Split bodies into blocks from left to right: lists of their numbers, from 0.

    `cuts[k]` says whether to cut between the bodies k and k + 1, so that there is one
    body more than cuts.
    """
    blocks = [[0]]
    for k, cut in enumerate(cuts):
        if cut:
            blocks.append([])
        blocks[-1].append(k + 1)
    return blocks


def add_rigid(row: Row, bodies: Any, block: list[int]) -> None:
    """Add a block of bonded rigid bodies to a row: as one mass, or as a boundary.

    `bodies` are all of the system, `block` has the numbers of those in the block, from
    left to right. Without a wall they are one mass; its velocity is momentum over mass.
    A wall becomes the boundary on its side, and the masses bonded to it are no masses
    of the row: here all bodies of the block get -1 in `mass_of`, until
    `number_bonded_masses` sets that of the masses.
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
    for i in walls:  # the first or the last body of the system
        if i == 0:
            side = 0
        else:
            side = 1
        row.boundaries[side] = ("velocity", bodies[i].velocity)
    if len(walls) > 0:  # the block is a boundary, and no mass
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

    It becomes len(row.masses) for those at the left wall, and one more for those at the
    right one. Masses of the first block are at the left wall if there is one; `bodies`
    are all of the system.
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

    Lists of the row by segment, by body and by node grow, and bonds are appended to its
    links. The path of a segment is that of the rod if it is the only one, else such as
    ``"bodies.0.segments.1"``.
    """
    row.mass_of.append(-1)  # it is no rigid mass
    count = len(rod.segments)
    # Segments are counted from 1.
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
        # Masses on the left of the segment are all before the node at its right end.
        row.first_mass.append(len(row.masses))


def add_end(row: Row, side: int, end: Any) -> None:
    """Add the link at the left (side 0) or right (1) end of a row, and what acts there.

    The link of a free or pushed end is a push, that of another end a bond. What acts is
    set in `boundaries`: its name and the value of the end, 0 for ends without a value.
    """
    kind = BOUNDARIES[end.kind]
    if end.kind in DRIVEN:
        value = end.value
    else:
        value = 0.0
    row.boundaries[side] = (kind, value)
    is_push = kind in ("none", "force")  # a given force, which is 0 at a free end
    if not is_push:
        law = Law.BOND
    elif side == 0:
        law = Law.PUSH_LEFT
    else:
        law = Law.PUSH_RIGHT
    row.links.append(link_of(law))
