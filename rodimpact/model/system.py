"""The description of a collision: a row of bodies, the contacts between them, and its ends.

Everything here is frozen and checked when it is made; nothing here moves. A `System` is the
bodies from left to right with the gaps and contact laws between neighbours. Any number may be an
array: the system is then a family of collisions whose `shape` is the NumPy broadcast of them all.

Axis x points to the right; velocity is positive to the right, strain positive in tension; SI units.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY
from typing import Any, ClassVar, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..units import shown
from . import frozen
from .arguments import demand
from .bodies import BODIES, LEFT_OUT, Body, Material, RigidMass, Rod, Segment, Wall
from .ends import ENDS, FREE, Absorbing, End, Free, Moved, Pushed
from .frozen import (
    Declared,
    Field,
    Number,
    Numeric,
    Problems,
    Taken,
    note,
    plain,
    quantity,
)
from .laws import CONTACT_LAWS, RIGID, Bonded, ContactLaw, Joint, Law, Plastic, Rigid
from .profiles import Floats, flipped, negative, profile_from

SIDES = ("left", "right")
BY_SIDE = {f"ends.{i}": f"ends.{side}" for i, side in enumerate(SIDES)}
GAP, OVERLAP = Field("m", "non-negative", "gap", default=0.0), Field("m", label="gap")
_BODIES, _LAWS, _ENDS = get_args(Body), get_args(ContactLaw), get_args(End)


class System(Declared):
    """A row of bodies from left to right.

    Parameters
    ----------
    bodies : sequence of Rod, RigidMass or Wall
        At least one that is no wall; a wall may stand only at the ends of the row.
    gaps : sequence of numbers, optional
        Initial distance between each body and its right neighbour, m, walls counted; default 0. A
        compliant contact may begin pressed: its gap is minus the overlap.
    contacts : sequence of contact laws, optional
        What acts between each body and its right neighbour, walls counted; default `Rigid`.
        Between rigid bodies a plain `Rigid` decides nothing and is refused.
    gravity : float or array, optional
        Acceleration of free bodies, m/s^2, positive to the right.
    ends : (End, End), optional
        What happens at the left and at the right end of the row: `Free`, `Fixed`, `Absorbing`,
        `Pushed`, `Moved` or `Incoming`; default `Free`, as it must be where a wall stands. A mass
        takes `Free` and `Pushed` only.

    Raises
    ------
    InvalidModel
        Naming every field that is not what it should be.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel, velocity=[1.0, 2.0, 3.0])
    >>> ri.System([rod, ri.Wall()]).shape
    (3,)
    """

    bodies: Taken[tuple[Body, ...], Sequence[Body]]
    gaps: Taken[tuple[Number, ...], Sequence[ArrayLike] | None] = LEFT_OUT
    contacts: Taken[tuple[ContactLaw, ...], Sequence[ContactLaw] | None] = LEFT_OUT
    _: KW_ONLY
    gravity: Numeric = quantity("m/s^2", default=0.0)
    ends: Taken[tuple[End, End], Sequence[End] | None] = LEFT_OUT
    _shape: ClassVar[tuple[int, ...]] = ()

    def _check(self, problems: Problems) -> None:
        bodies: Any = self.bodies
        if not isinstance(bodies, list | tuple) or not bodies:
            message = (
                f"must be a list of at least one rod or rigid mass, got {shown(bodies)}"
            )
            raise frozen.refusal("bodies", message)
        for i, body in enumerate[Any](bodies):
            if type(body) not in _BODIES:
                note(
                    problems,
                    f"bodies.{i}",
                    "must be a Rod, a RigidMass or a Wall itself",
                    body,
                )
            elif isinstance(body, Wall) and 0 < i < len(bodies) - 1:
                message = "a wall may stand only at an end of the row; make two systems of this one"
                problems.append((f"bodies.{i}", message))
        pairs = len(bodies) - 1
        laws = _per_pair(problems, "contacts", self.contacts, RIGID, pairs)
        walls = sum(isinstance(body, Wall) for body in bodies)
        apart = sum(not isinstance(law, Bonded) for law in laws)
        if (
            not problems
            and walls > apart
            and not any(isinstance(body, Rod) for body in bodies)
        ):
            message = "needs a rod or a rigid mass that is not bonded to a wall"
            problems.append(("bodies", message))
        given = _per_pair(problems, "gaps", self.gaps, 0.0, pairs)
        widths = []
        for i, law, width in zip(range(pairs), laws, given, strict=False):
            known = type(law) in _LAWS
            # what is compliant may begin pressed; a joint has its stretch instead
            gap = (
                OVERLAP
                if known and not isinstance(law, Rigid | Bonded | Joint)
                else GAP
            )
            widths.append(gap.checked(problems, f"gaps.{i}", width))
            if not known:
                message = "must be a contact law itself, one of "
                message += ", ".join(kind.__name__ for kind in _LAWS)
                note(problems, f"contacts.{i}", message, law)
            elif not law.opens:
                message = "must be 0 where bodies are joined, got {0!r}; a Joint takes a stretch"
                frozen.require(
                    problems, np.equal(widths[i], 0), f"gaps.{i}", message, widths[i]
                )
            elif isinstance(law, Rigid):
                _check_rigid(problems, i, law, *bodies[i : i + 2])
        both: Any = (FREE, FREE) if self.ends is None else self.ends
        if not isinstance(both, list | tuple) or len(both) != 2:
            note(
                problems, "ends", "must be a pair, such as (Free(), Absorbing())", both
            )
        else:
            for side, end, body in zip(
                SIDES, both, (bodies[0], bodies[-1]), strict=True
            ):
                _check_end(problems, side, end, body)
        frozen.raise_noted(problems)
        self._set(
            bodies=tuple(bodies),
            gaps=tuple(widths),
            contacts=tuple(laws),
            ends=tuple(both),
        )
        if self._varies:
            self._set(_shape=frozen.family_shape(self._numbers()))
        _check_joined(self)

    @property
    def kinds(self) -> list[str]:
        """Kind of each body: "rod", "mass" or "wall"."""
        return [body.kind for body in self.bodies]

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the family; () for a single collision."""
        return self._shape

    @property
    def parameters(self) -> dict[str, Any]:
        """Numbers in which the members of a family differ, by the paths of a case file.

        Arrays as they were given: they broadcast to `shape`.
        """
        return {path: v for path, v in self._numbers() if isinstance(v, np.ndarray)}

    def _parts(self) -> Iterator[tuple[str, Any]]:
        for name, value in super()._parts():
            kind, _, place = name.partition(".")
            if kind == "gaps":
                name = f"contacts.{place}.gap"
            yield BY_SIDE.get(name, name), value

    def __getitem__(self, index: Any) -> System:
        """Member of a family, or a smaller family, by NumPy's rules of indexing."""

        def pick(array: Floats) -> Number:
            view = np.broadcast_to(array, self.shape)[index]
            # an array is kept along the axes along which it varies
            lean = tuple(slice(None) if stride else slice(1) for stride in view.strides)
            chosen = np.array(view[lean])
            chosen.flags.writeable = False
            return chosen if chosen.ndim else chosen.item()

        member = self._mapped(pick)
        member._set(_shape=np.broadcast_to(0.0, self.shape)[index].shape)
        return member

    def to_dict(self) -> dict[str, Any]:  # noqa: D102
        contacts = [
            {"gap": plain(gap), **law.to_dict()}
            for gap, law in zip(self.gaps, self.contacts, strict=True)
        ]
        described = {"bodies": plain(self.bodies), "contacts": contacts}
        if not isinstance(self.gravity, float) or self.gravity:
            described["gravity"] = plain(self.gravity)
        if self.ends != (FREE, FREE):
            described["ends"] = dict(zip(SIDES, plain(self.ends), strict=True))
        return described

    def check_file(self) -> None:
        """Raise InvalidModel where a law is a function, which no file keeps."""
        functions = [
            (
                f"contacts.{k}",
                "a law that is a Python function cannot be kept in a file; give its curve as "
                "Tabulated, or keep results by to_xarray",
            )
            for k, law in enumerate(self.contacts)
            if isinstance(law, Law)
        ]
        frozen.raise_noted(functions)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> System:
        """Make the system that `to_dict` described; InvalidModel if that is none."""
        try:
            contacts = [dict(contact) for contact in data["contacts"]]
            ends = data.get("ends")
            return cls(
                [restored(BODIES, "kind", body) for body in data["bodies"]],
                gaps=[contact.pop("gap") for contact in contacts],
                contacts=[
                    restored(CONTACT_LAWS, "law", contact) for contact in contacts
                ],
                gravity=data.get("gravity", 0.0),
                ends=ends and [restored(ENDS, "kind", ends[side]) for side in SIDES],
            )
        except frozen.InvalidModel:
            raise
        except (LookupError, TypeError, ValueError, AttributeError):
            message = f"must be what system.to_dict() gives, got {shown(data)}"
            raise frozen.refusal("data", message) from None

    def reversed(self) -> System:
        """Return the same state with every velocity turned round: the film run backwards.

        Raises
        ------
        InvalidModel
            If the motion has losses or is driven, so it cannot be reversed in time:
            damping, a restitution below 1, absorbing or driven ends.
        """
        lossless = {"viscosity": 0, "damping": 0, "restitution": 1}
        why = "; losses and driven ends cannot be reversed in time"
        frozen.raise_noted(
            [
                *(
                    (path, f"must be {kept}{why}")
                    for path, value in self._numbers()
                    if np.any(
                        value != (kept := lossless.get(path.rpartition(".")[2], value))
                    )
                ),
                *(
                    (f"contacts.{i}", f"must not yield{why}")
                    for i, law in enumerate(self.contacts)
                    if isinstance(law, Plastic)
                ),
                *(
                    (
                        f"ends.{side}",
                        f"must be Free() or Fixed(), not {type(end).__name__}{why}",
                    )
                    for side, end in zip(SIDES, self.ends, strict=True)
                    if isinstance(end, Absorbing | Pushed | Moved)
                ),
            ]
        )
        bodies = [
            body.replace(velocity=negative(body.velocity)) for body in self.bodies
        ]
        return self.replace(bodies=bodies)

    def mirrored(self) -> System:
        """Return the row seen in a mirror: right becomes left."""
        bodies = [
            body.replace(
                segments=[segment.mirrored() for segment in reversed(body.segments)],
                velocity=negative(flipped(body.velocity, body.length)),
                strain=flipped(body.strain, body.length),
            )
            if isinstance(body, Rod)
            else body.replace(velocity=-body.velocity)
            for body in reversed(self.bodies)
        ]
        ends = [
            Moved(negative(end.value)) if isinstance(end, Moved) else end
            for end in reversed(self.ends)
        ]
        return System(
            bodies,
            self.gaps[::-1],
            self.contacts[::-1],
            gravity=-self.gravity,
            ends=ends,
        )


def restored(classes: Mapping[str, Any], tag: str, data: dict[str, Any]) -> Any:
    """Make the body, the contact law or the end that `to_dict` described."""
    return classes[data[tag]](
        **_entries({key: v for key, v in data.items() if key != tag})
    )


def _entries(data: dict[str, Any]) -> dict[str, Any]:
    """What the constructor of a described object takes."""
    entries = {key: profile_from(value) for key, value in data.items()}
    if "material" in data:
        entries["material"] = Material(**data["material"])
    if "segments" in data:
        entries["segments"] = [Segment(**_entries(piece)) for piece in data["segments"]]
    return entries


def _per_pair(
    problems: Problems, name: str, items: Any, default: Any, pairs: int
) -> Any:
    """What is given for each neighbouring pair; note what is not one thing for each."""
    each = (default,) * pairs if items is None else items
    listed = isinstance(each, list | tuple)
    if not listed or len(each) != pairs:
        message = (
            f"must be a list with one entry for each neighbouring pair, {pairs} in all"
        )
        note(problems, name, message, items)
    return each if listed else ()


def _check_rigid(problems: Problems, i: int, law: Rigid, *pair: Any) -> None:
    """Note a rigid contact that nothing decides, and one that two things would decide."""
    kinds = {type(body) for body in pair}
    if law.restitution is None and RigidMass in kinds and kinds <= {RigidMass, Wall}:
        message = "no wave decides this contact: give Rigid(restitution=...) or a compliant law"
        problems.append((f"contacts.{i}", f"{message} such as Hertz"))
    elif law.restitution is not None and Rod in kinds and kinds <= {*_BODIES}:
        message = "belongs between rigid bodies; the waves of a rod decide this contact: leave it"
        problems.append((f"contacts.{i}.restitution", f"{message} out"))


def _check_joined(system: System) -> None:
    """Refuse rigid bodies that are bonded and yet move apart."""
    for i, law in enumerate(system.contacts):
        left, right = system.bodies[i : i + 2]
        if (
            isinstance(law, Bonded)
            and not isinstance(left, Rod)
            and not isinstance(right, Rod)
        ):
            v, w = left.velocity, right.velocity
            message = "must be {0!r}, that of the rigid body it is bonded to, got {1!r}"
            demand(np.equal(v, w), f"bodies.{i + 1}.velocity", message, v, w)


def _check_end(problems: Problems, side: str, end: Any, body: Any) -> None:
    """Note what is no end, and one that does not go with the body there."""
    path, name = f"ends.{side}", type(end).__name__
    if type(end) not in _ENDS:
        known = ", ".join(kind.__name__ for kind in ENDS.values())
        note(problems, path, f"must be an end itself, one of {known}", end)
    elif isinstance(body, Wall) and not isinstance(end, Free):
        message = f"{name} has no place beyond a wall; leave this end out, or the wall"
        problems.append((path, message))
    elif isinstance(body, RigidMass) and not isinstance(end, Free | Pushed):
        message = f"{name} needs a rod, and a mass is there; put a Rod there, or a bonded Wall"
        problems.append((path, message))
