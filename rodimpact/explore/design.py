"""What the controls of the page describe: a case with its gauges.

It travels as JSON in the terms of a case file, so that every mistake has the path of its field.
What it may ask for is bounded: an answer comes while a slider is being dragged.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, replace
from typing import Any

from .. import materials
from ..methods.registry import Options
from ..model import Rod, System
from ..model.bodies import CIRCULAR
from ..model.frozen import InvalidModel, Problems
from ..results.solution import Solution
from ..running.solving import solve
from ..storage.casefile import Case, GaugePlace, case_from, read_case, write_case
from ..units import format_si

MOST_BODIES = 12
MOST_SEGMENTS = 24  # of all rods together
MOST_GAUGES = 4
MOST_NUMBERS = 4096  # in the whole description
MOST_EVENTS = 20_000  # fronts that arrive at an end
MOST_STEPS = 30_000  # of contacts and ends, for the method "characteristics"
CELLS, MOST_CELLS = 64, 256  # of the longest transit, for the method "finite-difference"
MOST_UPDATES = 1_000_000  # of cells, for that method

LIBRARY = {
    name: {key: v for key, v in m.to_dict().items() if key != "name" and v is not None}
    for name, m in materials.TABLE.items()
}
"""Materials that a case may name."""


@dataclass(frozen=True)
class Design:
    """A case as the page asks for it.

    Attributes
    ----------
    case : Case
    """

    case: Case

    @classmethod
    def of(cls, case: Case) -> Design:
        """A case; one without gauges gets one in the middle of its last rod."""
        rods = [i for i, body in enumerate(case.system.bodies) if isinstance(body, Rod)]
        if not rods:
            raise InvalidModel([("bodies", "needs at least one rod")])
        return cls(replace(case, gauges=case.gauges or (GaugePlace(rods[-1], 0.5),)))

    @classmethod
    def read(cls, path: str) -> Design:
        """A case file, within the bounds of a page; InvalidModel with its mistakes."""
        return cls.parse(cls.of(read_case(path)).to_dict())

    @classmethod
    def parse(cls, data: Any) -> Design:
        """Read what the page sends.

        Parameters
        ----------
        data : dict
            With ``case``, the tables of a case file, and a list ``gauges`` of tables with ``body``
            and ``fraction``.

        Returns
        -------
        Design

        Raises
        ------
        InvalidModel
            With every mistake and the path of its field.
        """
        if not isinstance(data, dict) or not isinstance(data.get("case"), dict):
            raise InvalidModel([("case", "is missing; send {case: {...}, gauges: [...]}")])
        problems: Problems = [
            (str(key)[:80], "unknown key; use case and gauges")
            for key in data if key not in ("case", "gauges")
        ]
        gauges = data.get("gauges", [])
        if isinstance(gauges, list) and len(gauges) > MOST_GAUGES:
            problems.append(("gauges", f"must be at most {MOST_GAUGES} on this page"))
        _check_size(problems, data["case"])
        if problems:
            raise InvalidModel(problems)
        case = case_from({**data["case"], "gauges": gauges})
        _check_length(problems, case)
        if problems:
            raise InvalidModel(problems)
        return cls(replace(case, output={}, path=""))

    def of_system(self, system: System) -> Design:
        """The same run of another system."""
        return Design(replace(self.case, system=system, gauges=()))

    def to_dict(self) -> dict[str, Any]:
        """What `parse` reads; materials of the library go by their names."""
        case = tomllib.loads(write_case(self.case))
        own = {
            name: entry for name, entry in case.pop("materials", {}).items()
            if entry != LIBRARY.get(name)
        }
        if own:
            case["materials"] = own
        for rod in case["bodies"]:  # the page knows round rods by their areas
            for piece in rod.get("segments", [rod]):
                if "diameter" in piece:
                    piece["area"] = math.pi * piece["diameter"] * piece.pop("diameter") / 4
                    if "lateral_inertia" in piece:
                        piece["polar_moment"] = CIRCULAR
        return {"gauges": case.pop("gauges", []), "case": case}

    def solve(self) -> Solution:
        """Solve the case, with caps on events and steps.

        Raises
        ------
        InvalidModel
            Where no method can do it, or not within the caps.
        """
        system, asked = self.case.system, self.case.solve
        until, method = asked.get("until"), asked.get("method", "auto")
        chosen = Options(until, method).method_for(system)
        if chosen != "finite-difference":
            most = MOST_EVENTS if chosen == "fronts" else MOST_STEPS
            try:
                return solve(system, until, method, max_events=asked.get("max_events", most))
            except InvalidModel as error:
                raise InvalidModel([
                    ("solve.until" if path == "until" else path, message)
                    for path, message in error.problems
                ]) from None
        transits = [
            float(s.transit_time) for b in system.bodies if isinstance(b, Rod) for s in b.segments
        ]
        cells = min(MOST_CELLS, max(CELLS, math.ceil(4 * max(transits) / min(transits))))
        step = max(transits) / cells
        most = int(MOST_UPDATES * step / sum(transits))
        _check_end(until, step * most)
        ends = len(transits) + len(system.bodies) + 1
        return solve(system, until, method, max_events=most * ends, cells=cells)


def _check_end(until: float | None, longest: float) -> None:
    """Refuse a run that takes too long for a page."""
    if until is not None and until > longest:
        message = f"must not exceed {format_si(longest, 's', 3)} on this page, got {until!r} s"
        raise InvalidModel([("solve.until", f"{message}; rodimpact run goes on")])


def _check_size(problems: Problems, case: dict[str, Any]) -> None:
    """Note more bodies, segments or numbers than the page may ask for, before they are read."""
    numbers = 0
    pending: list[Any] = [case]
    while pending and numbers <= MOST_NUMBERS:
        item = pending.pop()
        inner = item.values() if isinstance(item, dict) else item
        numbers += len(inner)
        pending += [value for value in inner if isinstance(value, dict | list)]
    if numbers > MOST_NUMBERS:
        problems.append(("case", f"must not hold more than {MOST_NUMBERS} entries on this page"))
        return
    bodies = case.get("bodies")
    if not isinstance(bodies, list):
        return
    if len(bodies) > MOST_BODIES:
        message = f"must be at most {MOST_BODIES} on this page, got {len(bodies)}"
        problems.append(("bodies", f"{message}; rodimpact run takes any number"))
    segments = sum(
        len(body["segments"]) for body in bodies
        if isinstance(body, dict) and isinstance(body.get("segments"), list)
    )
    if segments > MOST_SEGMENTS:
        message = f"must have at most {MOST_SEGMENTS} segments on this page, got {segments}"
        problems.append(("bodies", message))


def _check_length(problems: Problems, case: Case) -> None:
    """Note more events than the page may ask for, and a run of no length."""
    events = case.solve.get("max_events", MOST_EVENTS)
    if events > MOST_EVENTS:
        message = f"must be at most {MOST_EVENTS} on this page, got {events}"
        problems.append(("solve.max_events", f"{message}; rodimpact run takes more"))
    if case.solve.get("until") == 0:
        problems.append(("solve.until", "must be above 0 for a picture, got 0"))
