"""A solution as a document and arrays, for a file that holds all of it.

End signals or states are arrays, everything else stands in one JSON document.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import __version__
from ..methods.clock import PARTS, Clockwork
from ..methods.fronts.assembly import Assembly, assemble
from ..methods.grid.grid_kernel import States
from ..methods.grid.mesh import Mesh
from ..methods.grid.method import clockwork as grid_clockwork
from ..methods.plan import Plan
from ..methods.steps.method import clockwork
from ..model import System
from ..results.contacts import ContactTally
from ..results.fields import Fields
from ..results.grid_fields import GridFields, outer_forces
from ..results.outcome import Outcome
from ..results.records import FrontRecord, Record, StepRecord
from ..results.wave_fields import WaveFields
from ..storage.reading import FileFormatError, restored
from ..storage.writing import Arrays, PathLike, write_npz


def save_solution(solution: Any, path: PathLike, *, force: bool = False) -> None:
    """Write a solution to an NPZ file; this is `Solution.save`.

    Parameters
    ----------
    solution : Solution
    path : str or path
    force : bool
        Whether to replace an existing file.

    Raises
    ------
    FileExistsError, OSError
        As `write_bytes`.
    """
    document: dict[str, Any] = {
        "method": solution.method,
        "system": solution.system.to_dict(),
        "until": solution.until,
        "clock": _clock(solution.fields.assembly),
        "end": solution.fields.end,
        "outcome": solution.outcome.to_dict(),
        "stopped_by": solution.stopped_by,
        "status": solution.status,
        "t_end": solution.t_end,
        "t_final": solution.t_final,
        "events": solution.events,
        "accuracy": solution.accuracy,
    }
    fields, record = solution.fields, solution.record
    arrays: Arrays = {}
    if isinstance(fields, GridFields):
        document["cells"] = fields.mesh.counts
        arrays |= {f"state_{name}": x for name, x in fields.states._asdict().items()}
    else:
        assert isinstance(fields, WaveFields)
        waves = [s for s in fields.signals if s is not None]
        counts = [len(s.ticks) if s is not None else 0 for s in fields.signals]
        arrays["signal_values"] = np.concatenate([s.values for s in waves])
        longest = max((s.ticks for s in waves), key=len)
        arrays["before"] = longest[longest < 0]
        arrays["signal_counts"] = _whole(counts)
    if isinstance(record, FrontRecord):
        arrays |= {
            "signal_ticks": np.concatenate([s.ticks for s in waves]),
            "turn_ticks": _whole([tick for ticks, _ in record.turns for tick in ticks]),
            "turn_status": _whole([value for _, status in record.turns for value in status]),
            "turn_counts": _whole([len(ticks) for ticks, _ in record.turns]),
        }
    else:
        assert isinstance(record, StepRecord)
        arrays |= {f"force.{k}": force for k, force in enumerate(record.forces)}
        arrays |= {f"gap.{k}": gap for k, gap in enumerate(record.gaps)}
        arrays |= {f"path.{k}": path for k, path in enumerate(record.paths)}
        arrays |= {f"mass.{body}": V for body, V in fields.masses.items()}
        for side, end in enumerate(record.ends):
            if end is not None:
                arrays |= {f"push.{side}": end[1], f"speed.{side}": end[2]}
        arrays["edges"] = record.edges
        document["least"] = record.least
        document["ends"] = [end and end[0] for end in record.ends]
    write_npz(path, "solution", document, arrays, force=force)


def restore(document: dict[str, Any], arrays: Arrays) -> dict[str, Any]:
    """What `Solution` takes, from what `save_solution` wrote."""
    system, until, method = (
        System.from_dict(document["system"]), document["until"], document["method"]
    )
    read = {
        "fronts": _read_fronts, "characteristics": _read_steps, "finite-difference": _read_grid,
    }[method]
    fields, record = read(document, arrays, system)
    outcome = restored(document["outcome"])
    outcome["contacts"] = tuple(ContactTally(**tally) for tally in outcome["contacts"])
    return {
        "system": system, "fields": fields, "outcome": Outcome(**outcome), "record": record,
        "method": method, "until": until, "t_final": restored(document["t_final"]),
        "accuracy": restored(document["accuracy"]),
        **{name: document[name] for name in ("stopped_by", "status", "t_end", "events")},
    }


def _read_fronts(
    document: dict[str, Any], arrays: Arrays, system: System
) -> tuple[Fields, Record]:
    assembly = assemble(system, document["until"])
    _compare_clocks(document, assembly)
    lines, contacts = 2 * len(assembly.ticks) - 2, len(assembly.nodes)
    _check(arrays, "signal", {"ticks": np.int64, "values": np.float64}, lines)
    _check(arrays, "turn", {"ticks": np.int64, "status": np.int64}, contacts)
    signals = WaveFields.split(
        arrays["signal_ticks"], arrays["signal_values"], arrays["signal_counts"]
    )
    stops = np.cumsum(arrays["turn_counts"])[:-1]
    turn_ticks, turn_status = (
        [part.tolist() for part in np.split(arrays[name], stops)] if contacts else []
        for name in ("turn_ticks", "turn_status")
    )
    turns = list(zip(turn_ticks, turn_status, strict=True))
    return WaveFields(assembly, signals, document["end"]), FrontRecord(turns)


def _read_steps(
    document: dict[str, Any], arrays: Arrays, system: System
) -> tuple[Fields, Record]:
    clock, plan, edges = document["clock"], Plan(system), arrays["edges"]
    before = arrays["before"]
    work = clockwork(plan, clock["ticks"][1:-1], clock["tick"] * PARTS)
    _compare_clocks(document, work)
    lines = 2 * len(work.ticks) - 2
    _check(arrays, "signal", {"values": np.float64}, lines)
    stops = np.cumsum(arrays["signal_counts"])
    waves = [arrays["signal_values"][stops[i] - n : stops[i]]
             for i, n in enumerate(arrays["signal_counts"]) if i > 1]
    for i, w in enumerate(waves):
        begin = before[len(before) + len(edges) - 1 - len(w)]
        if not begin <= -work.ticks[i // 2 + 1] < begin + PARTS:
            raise ValueError("signals do not fill the time")
    fields = WaveFields.from_steps(work, waves, edges, before, _read_masses(arrays, plan))
    return fields, _read_record(document, arrays, system)


def _read_grid(
    document: dict[str, Any], arrays: Arrays, system: System
) -> tuple[Fields, Record]:
    mesh = Mesh(Plan(system), document["cells"])
    work = grid_clockwork(mesh, document["clock"]["tick"] * PARTS)
    _compare_clocks(document, work)
    states = States(*(arrays[f"state_{name}"] for name in States._fields))
    nodes, kept = len(mesh.mass), len(states.when)
    shapes = [x.shape for x in states[1:]]
    if shapes != [(kept, nodes), (kept, nodes + 1), (kept, len(mesh.starts)), (kept,)]:
        raise ValueError("states do not fit the cells")
    record = _read_record(document, arrays, system)
    fields = GridFields(
        work, mesh, states, document["end"], _read_masses(arrays, mesh.plan),
        outer_forces(mesh, record.forces, record.ends),
    )
    return fields, record


def _read_masses(arrays: Arrays, plan: Plan) -> dict[int, Any]:
    return {i: arrays[f"mass.{i}"] for i, m in enumerate(plan.mass_of) if m >= 0}


def _read_record(document: dict[str, Any], arrays: Arrays, system: System) -> StepRecord:
    ends = [
        kind and (kind, arrays[f"push.{side}"], arrays[f"speed.{side}"])
        for side, kind in enumerate(document["ends"])
    ]
    forces, gaps, paths = (
        [arrays[f"{name}.{k}"] for k in range(len(system.contacts))]
        for name in ("force", "gap", "path")
    )
    return StepRecord(arrays["edges"], forces, gaps, paths, ends, document["least"])


def _compare_clocks(document: dict[str, Any], clockwork: Clockwork) -> None:
    if _clock(clockwork) != document["clock"]:
        raise FileFormatError(
            f"was saved by rodimpact {document['rodimpact']} on another clock than rodimpact "
            f"{__version__} lays out for this system; solve the case again"
        )


def _clock(work: Clockwork) -> dict[str, Any]:
    """What the numbers in the arrays are counted in."""
    found = {"ticks": work.ticks, "tick": work.tick, "frame": work.frame}
    if isinstance(work, Assembly):
        found["tolerance"] = work.tolerance
    return found


def _check(arrays: Arrays, what: str, columns: dict[str, Any], parts: int) -> None:
    """Refuse columns that are not the concatenation of so many parts."""
    counts = arrays[f"{what}_counts"]
    if counts.shape != (parts,) or np.any(counts < 0):
        raise ValueError(f"{what}_counts are not {parts} counts")
    for name, dtype in columns.items():
        column = arrays[f"{what}_{name}"]
        if column.dtype != dtype or column.shape != (int(counts.sum()),):
            raise ValueError(f"{what}_{name} do not match {what}_counts")


def _whole(numbers: list[int]) -> Any:
    return np.array(numbers, dtype=np.int64)
