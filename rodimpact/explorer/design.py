"""Tables of a case for the page: those of its case file, with its gauges."""

import math
import tomllib
from dataclasses import replace
from typing import Any

from .. import materials
from ..model import Rod
from ..model.frozen import InvalidModel
from ..storage.casefile import Case, GaugePlace, format_case


def _library() -> dict[str, dict[str, Any]]:
    """Tables of the materials of this package, by name.

    Tables lack the name of the material and entries that are None.
    """
    library = {}
    for name, material in materials.TABLE.items():
        table = material.to_dict()
        del table["name"]
        library[name] = {
            key: value for key, value in table.items() if value is not None
        }
    return library


LIBRARY = _library()
"""Materials that a case may name."""


def with_gauges(case: Case) -> Case:
    """The case itself if it has gauges, else a copy with one gauge.

    The gauge is in the middle of the last rod. InvalidModel is raised for a case
    without rods, also if it has gauges.
    """
    rods = [i for i, body in enumerate(case.system.bodies) if isinstance(body, Rod)]
    if not rods:
        file = case.path or "CASE.toml"  # a system that was given has no path
        message = (
            "needs at least one rod, whose waves the page shows; for rigid masses "
            f"`rodimpact run {file} --plot FILE.png` draws the "
            "contacts and the energy, as rodimpact.plot.overview does"
        )
        raise InvalidModel([("bodies", message)])
    if case.gauges:
        return case
    middle = GaugePlace(rods[-1], fraction=0.5)
    return replace(case, gauges=(middle,))


def tables_of(case: Case) -> dict[str, Any]:
    """Tables of the case file that `format_case` writes, split in two.

    Output options and the materials of the library are left out; diameters become
    areas. Mistakes on the page have the paths of fields in these tables.

    Returns
    -------
    dict
        The tables of the ``case``, which name materials of the library, and the
        ``gauges``.
    """
    tables = tomllib.loads(format_case(case))
    tables.pop("output", None)
    all_materials = tables.pop("materials", {})
    own_materials = {
        name: material
        for name, material in all_materials.items()
        if material != LIBRARY.get(name)
    }
    if own_materials:
        tables["materials"] = own_materials
    for body in tables["bodies"]:
        for segment in body.get("segments", [body]):
            if "diameter" in segment:  # the page has round rods by their areas
                diameter = segment.pop("diameter")
                segment["area"] = math.pi * diameter * diameter / 4
    gauges = tables.pop("gauges", [])
    return {"gauges": gauges, "case": tables}
