"""Names and units of the numbers of a family and of a solution.

They are the labels in figures and Datasets of names such as ``bodies.0.length`` or
``impulse.1``.
"""

import contextlib
from typing import Any, NamedTuple

from ..model import SIDES, System
from ..model.frozen import InvalidModel, QuantityField
from ..model.numbering import body_names, contact_names
from ..model.paths import FIELDS
from ..storage.case_writing import format_case
from ..storage.extras import optional
from ..version import __version__


class Quantity(NamedTuple):
    """Name of a number and its SI unit: "1" for counts and ratios, "" for strain."""

    name: str
    unit: str

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of a variable of xarray."""
        return {"long_name": self.name, "units": self.unit or "1"}


_RESULTS = {
    "restitution": Quantity("coefficient of restitution e", "1"),
    "vibration": Quantity("vibration energy", "J"),
    "dissipated": Quantity("energy lost in contacts", "J"),
    "final": Quantity("end of the collision", "1"),
    "status": Quantity("why the run ended", "1"),
    "impulse": Quantity("impulse", "N s"),
    "peak_force": Quantity("peak force", "N"),
    "duration": Quantity("force duration", "s"),
    "set": Quantity("permanent set", "m"),
    "episodes": Quantity("episodes of contact", "1"),
    "time": Quantity("time", "s"),
    "body": Quantity("body, counted from the left", "1"),
    "x": Quantity("distance from the left end of the body", "m"),
    "velocity": Quantity("velocity", "m/s"),
    "strain": Quantity("strain, positive in tension", ""),
    "stress": Quantity("stress, positive in tension", "Pa"),
    "axial_force": Quantity("axial force, positive in tension", "N"),
    "displacement": Quantity("displacement", "m"),
    "position": Quantity("place in the laboratory", "m"),
    "mean_velocity": Quantity("velocity of the centre of mass", "m/s"),
    "contact": Quantity("contact between a body and the next", "1"),
    "force": Quantity("contact force, positive in compression", "N"),
    "gap": Quantity("gap between the two bodies", "m"),
    "energy": Quantity("energy", "J"),
    "part": Quantity("entry of the energy ledger", "1"),
    "kind": Quantity("kind of body", "1"),
    "law": Quantity("contact law", "1"),
}
"""Quantities of results, fields and coordinates, by name in columns and Datasets."""


def quantity_of_parameter(system: System, path: str) -> Quantity:
    """Name and unit of the number of a system at a path.

    A path that is not known is its own name, with the unit "1".

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    >>> system = ri.System([rod, ri.Wall()])
    >>> quantity_of_parameter(system, "bodies.0.length")
    Quantity(name='length of rod 1', unit='m')
    >>> quantity_of_parameter(system, "contacts.0.gap").name
    'gap 1-wall'
    """
    try:
        return _of_path(system, path)
    except (LookupError, ValueError):  # no such part, or no index
        return Quantity(path, "1")


def _of_path(system: System, path: str) -> Quantity:
    """Name and unit of the number at a path, whose parts are divided by dots.

    A path that is not known is its own name, with the unit "1", or raises LookupError
    or ValueError. Indices in paths count from 0, in names of bodies and parts from 1.
    """
    match path.split("."):
        case ["gravity"]:
            return _quantity(path, FIELDS["gravity"])
        case ["bodies", body, "mass"]:
            return Quantity(_body(system, body), "kg")
        case ["contacts", contact, "gap"]:
            return Quantity(f"gap {_pair(system, contact)}", FIELDS["gap"].unit)
        case ["contacts", contact, field]:
            law = system.contacts[int(contact)]
            number = getattr(law, field, None)
            if number is None:  # the law has no such number
                return Quantity(path, "1")
            name, unit = _quantity(field, law.fields[field])
            return Quantity(f"{name} of contact {_pair(system, contact)}", unit)
        case ["ends", ("left" | "right") as side, "value", *within]:
            return _of_end(system, side, within)
        case ["materials", *name, field]:  # a name may have dots
            owner = f"material {'.'.join(name)}"
        # *_ stands for parts between, such as "material".
        case ["bodies", body, "segments", segment, *_, field]:
            owner = f"segment {int(segment) + 1} of {_body(system, body)}"
        case ["bodies", body, field, "values", number]:
            owner = f"piece {int(number) + 1} of {_body(system, body)}"
        case ["bodies", body, field, "at", number]:  # place of a jump of a profile
            label = _quantity(field, FIELDS[field]).name
            jump = f"jump {int(number) + 1} of {label}"
            return Quantity(f"place of {jump}, {_body(system, body)}", "m")
        case ["bodies", body, *_, field]:
            owner = _body(system, body)
        case _:
            return Quantity(path, "1")
    # A case that has not returned has set the field, and its owner.
    name, unit = _quantity(field, FIELDS[field])
    return Quantity(f"{name} of {owner}", unit)


def quantity_of_column(system: System, column: str) -> Quantity:
    """Name and unit of a column of results or of a field, such as ``"stress"``.

    A column such as ``impulse.1`` ends in the index of a body or of a contact. The
    label names this body, and the contact if the row has several. Any name that is no
    column is taken for the path of a number, see `quantity_of_parameter`.

    Examples
    --------
    >>> import rodimpact as ri
    >>> rod = ri.Rod(0.4, area=1e-4, material=ri.materials.steel)
    >>> quantity_of_column(ri.System([rod, rod, rod]), "impulse.1")
    Quantity(name='impulse at contact 2-3', unit='N s')
    """
    kind, _, index = column.partition(".")
    if kind == "velocity_after":
        return Quantity(f"velocity of {_body(system, index)} after", "m/s")
    if kind == "displacement" and index:
        return Quantity(f"displacement of {_body(system, index)} at the end", "m")
    if kind == "largest_stress":
        return Quantity(f"largest stress in {_body(system, index)}", "Pa")
    if kind not in _RESULTS:
        return quantity_of_parameter(system, column)
    name, unit = _RESULTS[kind]
    if index and len(system.contacts) > 1:  # the index is that of a contact
        name = f"{name} at contact {_pair(system, index)}"
    return Quantity(name, unit)


def dataset(
    system: System,
    variables: dict[str, Any],
    coordinates: dict[str, Any],
    **attributes: str,
) -> Any:
    """An xarray Dataset with labels of all its variables and coordinates.

    Variables and coordinates are (dimensions, values) by name. The Dataset has the
    given `attributes` and two more: ``version``, that of rodimpact, and ``case``, the
    text of the case file. For a family the latter is ``case_of_first_member``. The case
    is left out if a contact law is a function, which no file can hold.
    """
    xarray = optional("xarray", "xarray")
    attributes["version"] = __version__
    case_name = "case"
    member = system
    if system.shape:
        case_name = "case_of_first_member"
        first_index = (0,) * len(system.shape)
        member = system[first_index]
    with contextlib.suppress(InvalidModel):  # a law that is a function
        attributes[case_name] = format_case(member)
    labelled_variables = _labelled(system, variables)
    labelled_coordinates = _labelled(system, coordinates)
    return xarray.Dataset(labelled_variables, labelled_coordinates, attributes)


def _labelled(system: System, variables: dict[str, Any]) -> dict[str, Any]:
    """Variables or coordinates, (dimensions, values) by name, with their labels.

    A variable with labels is (dimensions, values, attributes), as xarray takes it.
    """
    labelled = {}
    for name, variable in variables.items():
        dimensions, values = variable
        attributes = quantity_of_column(system, name).attributes
        labelled[name] = (dimensions, values, attributes)
    return labelled


def _body(system: System, index: str) -> str:
    """Name of the body of that index, such as "rod 2"."""
    return body_names(system.kinds)[int(index)]


def _quantity(name: str, field: QuantityField) -> Quantity:
    """Label and unit of a number of that name, as its field declares them.

    A number without a label has its own name, with spaces for underscores. A number
    without a unit has the unit "1", and a strain "".
    """
    label = field.label
    if not label:
        label = name.replace("_", " ")
    unit = field.unit
    if not unit and name != "strain":
        unit = "1"
    return Quantity(label, unit)


def _of_end(system: System, side: str, path: list[str]) -> Quantity:
    """Name and unit of a number of the value that drives an end of the row.

    `side` is "left" or "right", and `path` the path within that value: ["values", "0"],
    ["at", "0"] or ["step"]. Any other path, such as the empty one, names the value.
    """
    end = system.ends[SIDES.index(side)]
    # The kind of the end declares its label: a force, a velocity or a strain.
    label, unit = _quantity("value", end.fields["value"])
    name = f"{label} of the {side} end"
    if label == "force":
        name = f"force on the {side} end"
    match path:
        case ["values", number]:
            name = f"piece {int(number) + 1} of {name}"
        case ["at", number]:
            name = f"time of jump {int(number) + 1} of {name}"
            unit = "s"
        case ["step"]:
            name = f"time between samples of {name}"
            unit = "s"
    return Quantity(name, unit)


def _pair(system: System, contact: str) -> str:
    """Name of the contact of that index by its two bodies, such as "2-3"."""
    return contact_names(system.kinds)[int(contact)]
