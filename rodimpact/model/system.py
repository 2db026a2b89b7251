"""The description of a collision: a row of bodies with its contacts and ends.

A `System` holds the bodies from left to right, and the gaps and contact laws between
neighbours. It is checked when it is made, and frozen. Any number may be an array: the
system is then a family of collisions whose `shape` is the NumPy broadcast of all
arrays.

Axis x points to the right; velocity is positive to the right, strain positive in
tension; SI units.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY
from typing import Any, ClassVar, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..hints import NamedItems, TupleOfParts, explain_missing
from ..units import shown
from . import frozen
from .arguments import demand
from .bodies import BODIES, LEFT_OUT, Body, Material, RigidMass, Rod, Segment, Wall
from .ends import END_OF_KIND, FREE, Absorbing, End, Free, Moved, Pushed
from .frozen import (
    FrozenDataclass,
    Number,
    Numeric,
    Problems,
    QuantityField,
    TypedAttribute,
    add_problem,
    json_ready,
    quantity,
)
from .laws import CONTACT_LAWS, RIGID, Bonded, ContactLaw, Joint, Law, Plastic, Rigid
from .profiles import Floats, flipped, negative, profile_from
from .shaft import mirrored, shaft_from

SIDES = ("left", "right")
"""Names of the ends of a row in paths."""
END_PATHS = {"ends.0": "ends.left", "ends.1": "ends.right"}
"""Paths of the ends in case files."""
GAP = QuantityField("m", "non-negative", "gap", default=0.0)
"""Gap of a contact that cannot begin pressed."""
GAP_OR_OVERLAP = QuantityField("m", label="gap")
"""Gap of a compliant contact: minus the overlap where it begins pressed."""
ELASTIC_RTOL = 1e-9
"""Relative round-off by which an initial overlap may exceed the overlap of yielding.

The initial overlap is computed from a force, and that force from an overlap.
"""
LOSSLESS = {"viscosity": 0, "damping": 0, "restitution": 1}
"""Numbers of a motion without losses, which can be reversed in time."""
_BODIES = get_args(Body)
_LAWS = get_args(ContactLaw)
_ENDS = get_args(End)


@explain_missing("bodies", "contacts")
class System(FrozenDataclass):
    """A row of bodies from left to right.

    Parameters
    ----------
    bodies : sequence of Rod, RigidMass or Wall
        At least one rod or mass. Walls are only allowed at the ends of the row.
    gaps : sequence of numbers, optional
        Initial distance between each body and its right neighbour, m, including walls;
        default 0. A compliant contact may be pressed at the start: its gap is then
        minus the overlap. Contacts that close at the same time are solved as one
        collision. With a small gap, such as 1e-6 m, rigid bodies collide one after
        another.
    contacts : sequence of contact laws, optional
        Law of the contact between each body and its right neighbour, including walls;
        default `Rigid`. Between rigid bodies `Rigid` needs a restitution: without it
        the impact is undetermined.
    gravity : float or array, optional
        Acceleration of free bodies, m/s^2, positive to the right.
    ends : (End, End), optional
        Boundary conditions at the left and at the right end of the row: `Free`,
        `Fixed`, `Absorbing`, `Pushed`, `Moved` or `Incoming`; default `Free`, which a
        wall at the end requires. A mass takes `Free` and `Pushed` only.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> import rodimpact as ri
    >>> speeds = [1.0, 2.0, 3.0]
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=speeds)
    >>> ri.System([rod, ri.Wall()]).shape
    (3,)
    """

    bodies: TypedAttribute[tuple[Body, ...], Sequence[Body]]
    gaps: TypedAttribute[tuple[Number, ...], Sequence[ArrayLike] | None] = LEFT_OUT
    contacts: TypedAttribute[tuple[ContactLaw, ...], Sequence[ContactLaw] | None] = (
        LEFT_OUT
    )
    _: KW_ONLY
    gravity: Numeric = quantity("m/s^2", default=0.0)
    ends: TypedAttribute[tuple[End, End], Sequence[End] | None] = LEFT_OUT
    _shape: ClassVar[tuple[int, ...]] = ()

    def _check(self, problems: Problems) -> None:
        """Check bodies, laws, gaps and ends together; set them, as tuples.

        Contacts that are None become rigid, gaps 0, ends free. The shape of a family is
        set, too. InvalidModel names all mistakes, including those in `problems`.
        """
        bodies: Any = self.bodies
        _check_bodies(problems, bodies)
        n_pairs = len(bodies) - 1
        laws = _one_per_pair(problems, "contacts", self.contacts, RIGID, n_pairs)
        if not problems:
            _check_any_moves(problems, bodies, laws)
        given_gaps = _one_per_pair(problems, "gaps", self.gaps, 0.0, n_pairs)
        gaps = []
        # A list of the wrong length is a problem already. The pairs that have both a
        # law and a gap are checked all the same, so `strict` is False.
        for i, law, gap in zip(range(n_pairs), laws, given_gaps, strict=False):
            # An object that is no contact law is reported by `_check_contact`.
            is_law = type(law) in _LAWS
            is_compliant = is_law and not isinstance(law, Rigid | Bonded | Joint)
            field = GAP
            if is_compliant:  # it may begin with an overlap, a negative gap
                field = GAP_OR_OVERLAP
            checked_gap = field.checked(problems, f"gaps.{i}", gap)
            gaps.append(checked_gap)
            pair = bodies[i : i + 2]  # the two bodies of contact i
            _check_contact(problems, i, law, checked_gap, pair)
        ends = _checked_ends(problems, self.ends, bodies)
        frozen.raise_if_problems(problems)
        # Lists are kept as tuples, which do not change.
        self._set(
            bodies=TupleOfParts(bodies),
            gaps=tuple(gaps),
            contacts=TupleOfParts(laws),
            ends=tuple(ends),
        )
        if self._varies:
            self._set(_shape=frozen.family_shape(self._numbers()))
        _check_bonded_velocities(self)

    @property
    def kinds(self) -> list[str]:
        """Kind of each body: "rod", "mass" or "wall"."""
        return [body.kind for body in self.bodies]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the family; () for a single collision."""
        return self._shape

    @property
    def has_shaft(self) -> bool:
        """Whether soil or drag acts on a rod along its shaft."""
        rods = [body for body in self.bodies if isinstance(body, Rod)]
        return any(rod.shaft is not None for rod in rods)

    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers in which the members of a family differ, by the paths of a case file.

        The arrays are those that were given; they broadcast to `shape`.
        """
        numbers = self._numbers()
        varied = {path: x for path, x in numbers if isinstance(x, np.ndarray)}
        return NamedItems(varied)

    def _parts(self) -> Iterator[tuple[str, Any]]:
        """Yield path and value of every parameter, as `Frozen._parts` does.

        The items of tuples are yielded one by one. Paths are those of case files:
        "contacts.0.gap" for "gaps.0", and "ends.left" for "ends.0".
        """
        for path, value in super()._parts():
            name, _, index = path.partition(".")
            if name == "gaps":
                path = f"contacts.{index}.gap"
            yield END_PATHS.get(path, path), value

    def __getitem__(self, index: Any) -> System:
        """Member of a family, or a smaller family, by NumPy's rules of indexing.

        Parameters
        ----------
        index : object
            Index of an array of the `shape` of the family.

        Returns
        -------
        System
            Numbers of a single member are floats. An array that does not vary along an
            axis of the family has one entry along it.

        Raises
        ------
        IndexError
            If NumPy does not allow the index, or it lies outside the family's shape.

        Examples
        --------
        >>> import rodimpact as ri
        >>> mass = ri.RigidMass(0.4, velocity=[1.0, 2.0])
        >>> family = ri.System([mass, ri.Wall()], contacts=[ri.Hertz(1e9)])
        >>> family[1].bodies[0].velocity
        2.0
        """
        try:
            # NumPy itself gives the shape of the chosen members, or refuses the index.
            shape = np.broadcast_to(0.0, self.shape)[index].shape
        except (IndexError, TypeError, ValueError) as error:
            message = f"{shown(index)} is no index of the shape {self.shape}: {error}"
            if self.shape == ():
                message = (
                    "this system is a single collision, not a family of them; its "
                    "bodies are system.bodies"
                )
            raise IndexError(f"index: {message}") from None

        def pick(array: Floats) -> Number:
            """Numbers of the chosen members: a read-only array, or a float for one.

            The `array` of numbers broadcasts to the shape of the whole family.
            """
            view = np.broadcast_to(array, self.shape)[index]
            # After broadcasting, an axis along which the array does not vary has the
            # stride 0. Such an axis is reduced to one entry.
            first_only = [slice(None)] * view.ndim
            for axis, stride in enumerate(view.strides):
                if stride == 0:
                    first_only[axis] = slice(1)
            chosen = np.array(view[tuple(first_only)])
            chosen.flags.writeable = False
            if chosen.ndim:
                return chosen
            number: float = chosen.item()
            return number

        member = self._mapped(pick)
        member._set(_shape=shape)
        return member

    def to_dict(self) -> dict[str, Any]:
        """Return a JSON-ready description from which `from_dict` makes an equal system.

        Returns
        -------
        dict
            ``bodies``, ``contacts``, each with its gap and its law, and ``gravity`` and
            ``ends``, which are left out where they are 0 and free.
        """
        contacts = []
        for gap, law in zip(self.gaps, self.contacts, strict=True):
            contact = {"gap": json_ready(gap)}
            contact.update(law.to_dict())
            contacts.append(contact)
        description = {"bodies": json_ready(self.bodies), "contacts": contacts}
        is_array = not isinstance(self.gravity, float)
        if is_array or self.gravity != 0:
            description["gravity"] = json_ready(self.gravity)
        if self.ends != (FREE, FREE):
            left, right = self.ends
            description["ends"] = {"left": json_ready(left), "right": json_ready(right)}
        return description

    def check_file(self) -> None:
        """Raise InvalidModel if a contact law is a function, which no file can hold."""
        problems: Problems = []
        for i, law in enumerate(self.contacts):
            if isinstance(law, Law):
                message = (
                    "a law that is a Python function cannot be kept in a file; give "
                    "its curve as Tabulated, or keep results by to_xarray"
                )
                problems.append((f"contacts.{i}", message))
        frozen.raise_if_problems(problems)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> System:
        """Make the system that `to_dict` described.

        Parameters
        ----------
        data : dict
            Description of a system.

        Returns
        -------
        System

        Raises
        ------
        InvalidModel
            If the data describe no system, or one with mistakes.

        Examples
        --------
        >>> import rodimpact as ri
        >>> row = ri.System([ri.RigidMass(1.0, velocity=1.0), ri.RigidMass(2.0)],
        ...     contacts=[ri.Rigid(restitution=0.5)])
        >>> ri.System.from_dict(row.to_dict()) == row
        True
        """
        try:
            contacts = [dict(contact) for contact in data["contacts"]]
            bodies = [restored(BODIES, "kind", body) for body in data["bodies"]]
            gaps = [contact.pop("gap") for contact in contacts]
            laws = [restored(CONTACT_LAWS, "law", contact) for contact in contacts]
            gravity = data.get("gravity", 0.0)
            ends = data.get("ends")
            if ends:
                ends = [restored(END_OF_KIND, "kind", ends[side]) for side in SIDES]
            return cls(bodies, gaps, laws, gravity=gravity, ends=ends)
        except frozen.InvalidModel:
            raise
        except (LookupError, TypeError, ValueError, AttributeError):
            message = f"must be what system.to_dict() gives, got {shown(data)}"
            raise frozen.invalid_argument("data", message) from None

    def reversed(self) -> System:
        """Return the same state with reversed velocities: the motion runs backwards.

        Returns
        -------
        System
            All velocities have the other sign; strains, gaps and gravity are the same.

        Raises
        ------
        InvalidModel
            If the motion has losses or is driven, so it cannot be reversed in time:
            damping, a restitution below 1, a law that yields, soil or drag, absorbing
            or driven ends.

        Examples
        --------
        >>> import rodimpact as ri
        >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> ri.System([rod, ri.Wall()]).reversed().bodies[0].velocity
        -1.0
        """
        problems: Problems = []
        reason = "losses and driven ends cannot be reversed in time"
        for path, value in self._numbers():
            _, _, name = path.rpartition(".")
            # The value without losses of a damping is 0, that of a restitution 1.
            if name in LOSSLESS and np.any(value != LOSSLESS[name]):
                problems.append((path, f"must be {LOSSLESS[name]}; {reason}"))
        for i, body in enumerate(self.bodies):
            if isinstance(body, Rod) and body.shaft is not None:
                problems.append((f"bodies.{i}.shaft", f"must be None; {reason}"))
        for i, law in enumerate(self.contacts):
            if isinstance(law, Plastic):
                problems.append((f"contacts.{i}", f"must not yield; {reason}"))
        for side, end in zip(SIDES, self.ends, strict=True):
            if isinstance(end, Absorbing | Pushed | Moved):
                kind = type(end).__name__
                message = f"must be Free() or Fixed(), not {kind}; {reason}"
                problems.append((f"ends.{side}", message))
        frozen.raise_if_problems(problems)
        bodies = []
        for body in self.bodies:
            bodies.append(body.replace(velocity=negative(body.velocity)))
        return self.replace(bodies=bodies)

    def mirrored(self) -> System:
        """Return the row with left and right exchanged, as seen in a mirror.

        Velocities and gravity change their signs.

        Returns
        -------
        System
            Bodies, gaps, contacts and ends stand in the opposite order.

        Examples
        --------
        >>> import rodimpact as ri
        >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=1.0)
        >>> ri.System([rod, ri.Wall()]).mirrored().kinds
        ['wall', 'rod']
        """
        left, right = self.ends
        bodies = [_mirrored_body(body) for body in reversed(self.bodies)]
        return System(
            bodies,
            self.gaps[::-1],
            self.contacts[::-1],
            gravity=-self.gravity,
            ends=(_mirrored_end(right), _mirrored_end(left)),
        )


def _mirrored_body(body: Body) -> Body:
    """Body with left and right exchanged.

    Its velocity changes its sign, its strain does not.
    """
    if not isinstance(body, Rod):
        return body.replace(velocity=-body.velocity)
    shaft = body.shaft
    if shaft is not None:
        shaft = mirrored(shaft, body.length)
    return body.replace(
        segments=[segment.mirrored() for segment in reversed(body.segments)],
        velocity=negative(flipped(body.velocity, body.length)),
        strain=flipped(body.strain, body.length),
        shaft=shaft,
    )


def _mirrored_end(end: End) -> End:
    """End with left and right exchanged.

    The motion of a `Moved` end changes its sign. Any other end stays as it is: a push
    is inwards, and an incoming strain has the same sign, at both ends.
    """
    if isinstance(end, Moved) and end.position is not None:
        return Moved(position=negative(end.position))
    if isinstance(end, Moved):
        # `Moved` samples a function when it is made, so no duration is needed here.
        return Moved(negative(end.value))
    return end


def restored(classes: Mapping[str, Any], tag: str, data: dict[str, Any]) -> Any:
    """Make the body, the contact law or the end that `to_dict` described.

    The entry `tag` of the description, "kind" or "law", is the key of its class in
    `classes`.
    """
    description = dict(data)
    kind = description.pop(tag)
    return classes[kind](**_parameters_from(description))


def _parameters_from(description: dict[str, Any]) -> dict[str, Any]:
    """Parameters of the constructor of an object, from its `to_dict`.

    Descriptions of profiles, materials, segments and the shaft (soil or drag) become
    objects; all other entries are kept. The caller has removed the tag that names the
    class of the object.
    """
    parameters = {}
    for name, value in description.items():
        parameters[name] = profile_from(value)  # other values are returned unchanged
    if "material" in description:
        parameters["material"] = Material(**description["material"])
    if "segments" in description:
        segments = []
        for segment in description["segments"]:
            segments.append(Segment(**_parameters_from(segment)))
        parameters["segments"] = segments
    if "shaft" in description:
        # The tag of the shaft, its kind, is removed afterwards by `shaft_from`.
        parameters["shaft"] = shaft_from(_parameters_from(description["shaft"]))
    return parameters


def _one_per_pair(
    problems: Problems, name: str, items: Any, default: Any, n_pairs: int
) -> Any:
    """Items of the neighbouring pairs, as given; for None a `default` for each pair.

    A list of the wrong length is a problem, and is returned so that its items are
    checked too. Items that are no list or tuple are a problem, and () is returned.
    """
    if items is None:
        return (default,) * n_pairs
    message = (
        f"must be a list with one entry for each neighbouring pair, {n_pairs} in all"
    )
    if not isinstance(items, list | tuple):
        if name == "contacts" and isinstance(items, str):
            message += ", such as [Hertz(stiffness)]"
        add_problem(problems, name, message, items)
        return ()
    if len(items) != n_pairs:
        problems.append((name, f"{message}, got {len(items)}"))
    return items


def _check_bodies(problems: Problems, bodies: Any) -> None:
    """Add problems of objects that are no bodies, and of walls inside the row.

    InvalidModel if there is no list, or an empty one.
    """
    if not isinstance(bodies, list | tuple) or not bodies:
        message = "must be a list of at least one rod or rigid mass"
        raise frozen.invalid_argument("bodies", f"{message}, got {shown(bodies)}")
    for i, body in enumerate(bodies):
        if type(body) not in _BODIES:
            message = "must be a Rod, a RigidMass or a Wall itself"
            add_problem(problems, f"bodies.{i}", message, body)
        elif isinstance(body, Wall) and 0 < i < len(bodies) - 1:
            message = (
                "a wall may stand only at an end of the row; make two systems of this "
                "one"
            )
            problems.append((f"bodies.{i}", message))


def _check_any_moves(problems: Problems, bodies: Any, laws: Any) -> None:
    """Add a problem if nothing can move: no rod, and all masses are bonded to walls.

    The n contacts that are not bonded divide the row into n + 1 groups. Walls stand
    only at the ends of the row, so all groups have a wall if there are more than n.
    """
    n_walls = 0
    for body in bodies:
        if isinstance(body, Rod):
            return
        if isinstance(body, Wall):
            n_walls += 1
    n_not_bonded = 0
    for law in laws:
        if not isinstance(law, Bonded):
            n_not_bonded += 1
    if n_walls > n_not_bonded:
        message = "needs a rod or a rigid mass that is not bonded to a wall"
        problems.append(("bodies", message))


def _check_contact(
    problems: Problems, i: int, law: Any, gap: Number, pair: Any
) -> None:
    """Add a problem of contact i, between a pair of bodies, if its law is wrong.

    The object `law` may be no contact law at all. Each law has its own check: joined
    bodies must have the gap 0, `Rigid` must suit the two bodies, and `Plastic` must not
    begin with too deep an overlap. The number `gap` itself is checked elsewhere.
    """
    if type(law) not in _LAWS:
        message = f"must be a contact law itself, one of {_class_names(_LAWS)}"
        add_problem(problems, f"contacts.{i}", message, law)
    elif not law.opens:  # a Bonded contact or a Joint
        message = (
            "must be 0 where bodies are joined, got {0!r}; a Joint takes a stretch"
        )
        is_closed = np.equal(gap, 0)
        # {0!r} stands for the gap of the first member in which it is open.
        frozen.require(problems, is_closed, f"gaps.{i}", message, gap)
    elif isinstance(law, Rigid):
        _check_rigid(problems, i, law, pair)
    elif isinstance(law, Plastic):
        _check_elastic_overlap(problems, i, law, gap)


def _check_elastic_overlap(problems: Problems, i: int, law: Any, gap: Number) -> None:
    """Add a problem of contact i if its initial overlap exceeds the yield overlap.

    The law is `Plastic`. An initial overlap must be elastic, so the gap may not be less
    than -(yield force)/stiffness.
    """
    least_gap = -np.divide(law.yield_force, law.stiffness)
    # The gap is negative: the factor allows a slightly larger overlap.
    is_elastic = np.greater_equal(gap, least_gap * (1 + ELASTIC_RTOL))
    message = (
        "must be {0!r} m or more, minus the overlap at which the contact yields, got "
        "{1!r}; a contact that was pressed farther is law.hardened(force), with the "
        "gap -force/stiffness"
    )
    shown_gap = np.round(least_gap, 12) + 0.0  # 0.0 for a cushion, which yields at once
    frozen.require(problems, is_elastic, f"gaps.{i}", message, shown_gap, gap)


def _check_rigid(problems: Problems, i: int, law: Rigid, pair: Any) -> None:
    """Add a problem of rigid contact i that is undetermined, or determined twice.

    Between a rigid mass and a mass or wall a restitution must be given. Beside a rod it
    may not be given, since the waves of the rod decide.
    """
    kinds = set(map(type, pair))
    has_mass = RigidMass in kinds
    has_rod = Rod in kinds
    are_rigid = kinds <= {RigidMass, Wall}
    are_bodies = kinds <= set(_BODIES)
    # Two walls, and objects that are no bodies, have a problem of their own elsewhere.
    if law.restitution is None and has_mass and are_rigid:
        message = (
            "no wave decides this contact: give Rigid(restitution=...) or a compliant "
            "law such as Hertz"
        )
        problems.append((f"contacts.{i}", message))
    elif law.restitution is not None and has_rod and are_bodies:
        message = (
            "belongs between rigid bodies; the waves of a rod decide this contact: "
            "leave it out"
        )
        problems.append((f"contacts.{i}.restitution", message))


def _check_bonded_velocities(system: System) -> None:
    """Raise InvalidModel if rigid bodies that are bonded have different velocities.

    The error names the velocity of the right body of the first such pair.
    """
    for i, law in enumerate(system.contacts):
        left = system.bodies[i]
        right = system.bodies[i + 1]
        if not isinstance(law, Bonded):
            continue
        if isinstance(left, Rod) or isinstance(right, Rod):
            continue
        is_same = np.equal(left.velocity, right.velocity)
        message = "must be {0!r}, that of the rigid body it is bonded to, got {1!r}"
        path = f"bodies.{i + 1}.velocity"
        demand(is_same, path, message, left.velocity, right.velocity)


def _checked_ends(problems: Problems, ends: Any, bodies: Any) -> Any:
    """Ends as given, also if they are mistaken; two free ones for None.

    Mistakes are added to `problems`, also those of an end that does not go with the
    body there. The caller has checked the bodies.
    """
    if ends is None:
        ends = (FREE, FREE)
    if not isinstance(ends, list | tuple) or len(ends) != 2:
        message = "must be a pair, such as (Free(), Absorbing())"
        add_problem(problems, "ends", message, ends)
    else:
        _check_end(problems, "left", ends[0], bodies[0])
        _check_end(problems, "right", ends[1], bodies[-1])
    return ends


def _check_end(problems: Problems, side: str, end: Any, body: Any) -> None:
    """Add a problem if an end is no end, or does not go with the body there.

    At a wall an end must be free, at a rigid mass free or pushed.
    """
    path = f"ends.{side}"
    name = type(end).__name__
    if type(end) not in _ENDS:
        message = f"must be an end itself, one of {_class_names(_ENDS)}"
        add_problem(problems, path, message, end)
    elif isinstance(body, Wall) and not isinstance(end, Free):
        message = f"{name} has no place beyond a wall; leave this end out, or the wall"
        problems.append((path, message))
    elif isinstance(body, RigidMass) and not isinstance(end, Free | Pushed):
        message = (
            f"{name} needs a rod, and a mass is there; put a Rod there, or a bonded "
            "Wall"
        )
        problems.append((path, message))


def _class_names(classes: tuple[type, ...]) -> str:
    """Names of classes with commas between them."""
    return ", ".join(kind.__name__ for kind in classes)
