"""A case as the page takes it: the tables of a case file, with its gauges."""

import math
import tomllib
from dataclasses import replace
from typing import Any

from .. import materials
from ..model import Rod
from ..model.frozen import InvalidModel
from ..storage.casefile import Case, GaugePlace, write_case

LIBRARY = {
    name: {key: v for key, v in m.to_dict().items() if key != "name" and v is not None}
    for name, m in materials.TABLE.items()
}
"""Materials that a case may name."""


def with_gauges(case: Case) -> Case:
    """A case; one without gauges gets one in the middle of its last rod."""
    rods = [i for i, body in enumerate(case.system.bodies) if isinstance(body, Rod)]
    if not rods:
        raise InvalidModel([("bodies", "needs at least one rod")])
    return replace(case, gauges=case.gauges or (GaugePlace(rods[-1], 0.5),))


def tables_of(case: Case) -> dict[str, Any]:
    """The ``case`` in the terms of a case file, with materials of the library by name; ``gauges``.

    Mistakes that the page finds then have the path of their field.
    """
    tables = tomllib.loads(write_case(case))
    tables.pop("output", None)
    own = {
        name: entry
        for name, entry in tables.pop("materials", {}).items()
        if entry != LIBRARY.get(name)
    }
    if own:
        tables["materials"] = own
    for rod in tables["bodies"]:  # the page knows round rods by their areas
        for piece in rod.get("segments", [rod]):
            if "diameter" in piece:
                piece["area"] = math.pi * piece["diameter"] * piece.pop("diameter") / 4
    return {"gauges": tables.pop("gauges", []), "case": tables}
