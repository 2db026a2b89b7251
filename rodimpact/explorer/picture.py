"""All data that the page shows of a solved collision: layout, curves and texts.

The page has these functions as JavaScript. Polygons cut at time t are the rods at time
t, so the page slices them and needs no physics.
"""

from typing import Any

from ..model.numbering import body_numbers, contact_names
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..storage.tables import clean
from ..units import TIMES, format_factor, format_si
from .known import body_told, initial_offsets, slowest_of
from .reason import peak_of, reason_of
from .texts import capital, stated, written

NO_VALUE = "-"
"""Text of a number that does not exist."""
SMALLEST_RESTITUTION = 1e-9
"""A smaller e has the digits of this one when its error is stated."""


def page_data(system: Any, solved: Any, paths: Any, records: Any, energy: Any) -> Any:
    """Data of the page for a solved collision.

    Parameters
    ----------
    system : System
    solved : dict
        ``method``, ``notes``, and whether it is ``exact``; ``closed_form`` of e, or
        None; ``gauges``; ``outcome`` from `outcome_shown`; ``tiling``: polygons, or
        grids with ``across`` cells in a row; ``contacts``, each with its curves of
        ``force`` and ``gap``, the gap None for a bond. Curves are tables of ``t``, s,
        and ``y``.
    paths : list
        Paths of bodies without inside, None for rods.
    records : list of dict
        Curves of gauges, each with the ``name`` of its gauge.
    energy : dict
        Times ``t``, and energies by their names.

    Returns
    -------
    dict
        JSON-ready, in SI units but for strain in 1e-6; numbers that do not exist are
        None.
    """
    kinds = [body.kind for body in system.bodies]
    facts = {
        **solved,
        "bodies": bodies_of_page(system, body_numbers(kinds), paths),
        "contacts": contacts_of_page(system, contact_names(kinds), solved["contacts"]),
    }
    restitution = restitution_of(facts)
    e = ""
    if restitution["why"] == "":
        e = restitution["text"]
    return {
        **facts,
        "outcome": None,
        "end": max(solved["tiling"]["t"]),
        "plots": [energy_plot(energy), gauge_plot(records)],
        "row": layout_of_row(system, facts),
        "restitution": restitution,
        "ratio": ratio_of(facts),
        "reason": reason_of(facts, e),
        "results": results_of(facts),
        "by_contact": rows_by_contact(facts),
    }


def bodies_of_page(system: Any, numbers: list[str], paths: Any) -> list[Any]:
    """Data of each body."""
    bodies = []
    for i, body in enumerate(system.bodies):
        bodies.append(body_told(body, numbers[i], paths[i]))
    return bodies


def contacts_of_page(system: Any, names: list[str], curves: Any) -> list[Any]:
    """Data of each contact, with its curves."""
    contacts = []
    for i, law in enumerate(system.contacts):
        contacts.append(
            {
                "index": i,
                "name": names[i],
                "bonded": law.law == "bonded",
                "compliant": law.law not in ("rigid", "bonded"),
                **curves[i],
            }
        )
    return contacts


def energy_plot(energy: Any) -> Any:
    """Curves of the energies over time."""
    series = []
    for name, values in energy.items():
        if name != "t":
            series.append({"name": name, "t": [*energy["t"]], "y": values})
    return {"key": "energy", "title": "Energy", "unit": "J", "series": series}


def gauge_plot(records: Any) -> Any:
    """Curves of the strain gauges over time, in 1e-6."""
    series = []
    for record in records:
        microstrain = [1e6 * strain for strain in record["y"]]
        series.append({**record, "y": microstrain})
    title = "Strain, below 0 compressed"
    return {"key": "gauge", "title": title, "unit": "µε", "series": series}


# Layout -------------------------------------------------------------------------------


def layout_of_row(system: Any, facts: Any) -> Any:
    """Layout of the row in the moving picture.

    A point is drawn at X = left + x + magnification * (apart + displacement - frame t).
    ``block`` is the width of a mass; bodies lie side by side.
    """
    length = 0.0
    for body in facts["bodies"]:
        for piece in body["pieces"]:
            length += piece["length"]
    slowest = slowest_of(system, facts["outcome"]["before"])
    offsets = initial_offsets(system, facts["tiling"])
    reach = spread(facts, offsets, 0.0)
    relative_reach = spread(facts, offsets, slowest)
    strain = peak_of(facts["tiling"]["strain"])
    magnification = magnified(length, reach, relative_reach, strain)
    frame = 0.0
    if drifts(reach, relative_reach):
        frame = slowest
    note = "true to scale"
    if magnification != 1:
        note = f"displacements {TIMES} {format_factor(magnification)}"
    if frame != 0:
        note = f"{note}, frame moving at {format_si(frame, 'm/s', 4)}"
    return {
        "block": round_down(BLOCK * length),
        "apart": offsets,
        "magnification": magnification,
        "frame": frame,
        "note": note,
    }


def spread(facts: Any, offsets: list[float], frame: float) -> float:
    """Range of the displacements of all bodies in a moving frame, with gaps, m."""
    tiling = facts["tiling"]
    displacements: list[float] = []
    for g, i in enumerate(tiling["body"]):
        for k in range(tiling["start"][g], tiling["start"][g + 1]):
            u = offsets[i] + tiling["displacement"][k] - frame * tiling["t"][k]
            displacements.append(u)
    for i, body in enumerate(facts["bodies"]):
        path = body["path"]
        if path is not None:
            for k, t in enumerate(path["t"]):
                u = offsets[i] + path["displacement"][k] - frame * t
                displacements.append(u)
    return max(displacements) - min(displacements)


# Texts --------------------------------------------------------------------------------


def ratio_of(facts: Any) -> Any:
    """l1/l2 of two uniform rods; None for any other row."""
    bodies = facts["bodies"]
    if len(bodies) != 2:
        return None
    left = bodies[0]["pieces"]
    right = bodies[1]["pieces"]
    if len(left) != 1 or len(right) != 1:
        return None
    return left[0]["length"] / right[0]["length"]


def restitution_of(facts: Any) -> Any:
    """Coefficient of restitution with text and closed form, or why there is none."""
    outcome = facts["outcome"]
    why = outcome["why"]
    value = None
    text = NO_VALUE
    if why == "":
        value = outcome["restitution"]
        digits = 5
        if facts["method"] == "fronts":
            digits = 6
        number = f"{clean(value, 1.0):.{digits}g}"
        size = max(value, SMALLEST_RESTITUTION)
        text = stated(number, size, digits, outcome["error"], "")
    elif len(outcome["unilateral"]) > 1:
        count = len(outcome["unilateral"])
        why = (
            f"A coefficient e belongs to one contact; this row has {count}, see the "
            "velocities"
        )
    return {
        "value": value,
        "text": text,
        "why": capital(why),
        "closed_form": facts["closed_form"],
    }


def rows_of_contact(facts: Any, i: int) -> Any:
    """Name and text of impulse, peak force and force duration of a contact.

    An impact of rigid bodies has no peak force, and the text "-".
    """
    contact = facts["outcome"]["contacts"][i]
    errors = facts["outcome"]["errors"]
    impulse_error = errors.get("impulse", 0.0)
    force_error = errors.get("peak_force", 0.0)
    duration_error = errors.get("duration", 0.0)
    return [
        ("impulse", text_of(contact.impulse, impulse_error, "N s")),
        ("peak force", text_of(contact.peak_force, force_error, "N")),
        ("force duration", text_of(contact.duration, duration_error, "s")),
    ]


def text_of(value: float, error: float, unit: str) -> str:
    """Text of a quantity with its stated error; "-" for NaN."""
    is_number = value == value
    if not is_number:
        return NO_VALUE
    return stated(written(value, unit, 5), value, 5, error, unit)


def rows_by_contact(facts: Any) -> Any:
    """Rows of the table of several contacts: the name, and the texts of its numbers."""
    unilateral = facts["outcome"]["unilateral"]
    rows: list[Any] = []
    if len(unilateral) > 1:
        for i in unilateral:
            row = [facts["contacts"][i]["name"]]
            for _, text in rows_of_contact(facts, i):
                row.append(text)
            rows.append(row)
    return rows


def results_of(facts: Any) -> Any:
    """Name and text of each result; `rows_by_contact` has those of several contacts."""
    outcome = facts["outcome"]
    after = "at the end"
    if outcome["final"]:
        after = "after"
    rows = velocity_rows(facts, after)
    if len(outcome["unilateral"]) == 1:
        for name, text in rows_of_contact(facts, outcome["unilateral"][0]):
            if text != NO_VALUE:
                rows.append((name, text))
    energy_before = outcome["energy_before"]
    vibration = clean(outcome["vibration_after"], energy_before)
    vibration_text = text_of(vibration, outcome["errors"].get("energy", 0.0), "J")
    rows.append(("energy before", written(energy_before, "J", 5)))
    rows.append((f"vibration energy {after}", vibration_text))
    return rows


def velocity_rows(facts: Any, after: str) -> list[Any]:
    """Name and text of the velocity of each rod and mass at the end."""
    outcome = facts["outcome"]
    digits = 4
    if facts["method"] == "fronts":
        digits = 6
    error = outcome["errors"]["velocity"]
    fastest = peak_of([*outcome["before"], *outcome["after"]])
    rows = []
    for i, body in enumerate(facts["bodies"]):
        if body["kind"] != "wall":
            v = clean(outcome["after"][i], fastest)
            text = stated(f"{v:.{digits}g} m/s", v, digits, error, "m/s")
            rows.append((f"velocity of {body['name']} {after}", text))
    return rows
