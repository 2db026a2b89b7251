"""All data that the page shows of a solved collision: layout, curves and texts.

Begin with `page_data`. The page has these functions as JavaScript. Polygons cut at time
t are the rods at time t, so the page slices them and needs no physics.
"""

from typing import Any

from ..model.numbering import body_numbers, contact_names
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..storage.tables import without_round_off
from ..units import TIMES, format_factor, format_si
from .facts import facts_of_body, initial_offsets, slowest_velocity
from .reason import peak_of, reason_of
from .texts import as_sentence, error_text, format_quantity, with_error

NO_VALUE = "-"
"""Text of a number that does not exist."""
SMALLEST_RESTITUTION = 1e-9
"""A smaller e is taken for this one to decide whether its error is shown."""


def page_data(
    system: Any, solution: Any, paths: Any, records: Any, energies: Any
) -> Any:
    """Data of the page for a solved collision.

    Parameters
    ----------
    system : System
    solution : dict
        ``method``, ``notes``, and whether it is ``exact``; ``closed_form`` of e, or
        None; ``gauges``; ``outcome`` from `facts_of_outcome`; ``tiling``: polygons, or
        grids with ``across`` cells in a row, with the times ``t`` of their corners;
        ``contacts``, each with its curves of ``force`` and ``gap``, the gap None for a
        bond. Curves are tables of ``t``, s, and ``y``.
    paths : list
        Displacements over time of masses and walls, from `motion.path_of`; None for
        rods.
    records : list of dict
        Curves of gauges, each with the ``name`` of its gauge.
    energies : dict
        Times ``t``, and energies by their names.

    Returns
    -------
    dict
        JSON-ready, in SI units, but the strain of gauges in 1e-6. Numbers that do not
        exist are None.
    """
    kinds = [body.kind for body in system.bodies]
    facts = {
        "method": solution["method"],
        "notes": solution["notes"],
        "exact": solution["exact"],
        "closed_form": solution["closed_form"],
        "outcome": solution["outcome"],
        "tiling": solution["tiling"],
        "bodies": bodies_of_page(system, body_numbers(kinds), paths),
        "contacts": contacts_of_page(
            system, contact_names(kinds), solution["contacts"]
        ),
    }
    restitution = restitution_of(facts)
    e = ""
    if restitution["why"] == "":  # there is no reason why e does not exist
        e = restitution["text"]
    return {
        "method": facts["method"],
        "notes": facts["notes"],
        "exact": facts["exact"],
        "gauges": solution["gauges"],
        "tiling": facts["tiling"],
        "bodies": facts["bodies"],
        "contacts": facts["contacts"],
        "end": max(facts["tiling"]["t"]),
        "plots": [energy_plot(energies), gauge_plot(records)],
        "row": layout_of_row(system, facts),
        "restitution": restitution,
        "ratio": ratio_of(facts),
        "reason": reason_of(facts, e),
        "final": facts["outcome"]["final"],
        "velocities": velocities_after(facts),
        "results": results_of(facts),
        "by_contact": rows_by_contact(facts),
    }


def bodies_of_page(system: Any, numbers: list[str], paths: Any) -> list[Any]:
    """`facts_of_body` of each body, from left to right.

    `numbers` are texts by body, "wall" for a wall; `paths` are displacements over time
    of masses and walls, None for rods.
    """
    bodies = []
    for i, body in enumerate(system.bodies):
        bodies.append(facts_of_body(body, numbers[i], paths[i]))
    return bodies


def contacts_of_page(system: Any, names: list[str], curves: Any) -> list[Any]:
    """For each contact a dictionary with the facts that the page shows.

    They are its ``index`` and ``name``, whether it is ``bonded`` or ``compliant``, and
    its curves of ``force`` and ``gap``. A rigid contact is neither bonded nor
    compliant.
    """
    contacts = []
    for i, law in enumerate(system.contacts):
        contacts.append(
            {
                "index": i,
                "name": names[i],
                "bonded": law.law == "bonded",
                "compliant": law.law not in ("rigid", "bonded"),
                "force": curves[i]["force"],
                "gap": curves[i]["gap"],
            }
        )
    return contacts


def energy_plot(energies: Any) -> Any:
    """Plot of the energies over time: ``key``, ``title``, ``unit``, and ``series``.

    The series have a curve for each energy of `motion.energy_curves`.
    """
    series = []
    for name, values in energies.items():
        if name != "t":  # the times of all curves; each gets a copy
            series.append({"name": name, "t": [*energies["t"]], "y": values})
    return {"key": "energy", "title": "Energy", "unit": "J", "series": series}


def gauge_plot(records: Any) -> Any:
    """Plot of the strain gauges over time: ``key``, ``title``, ``unit``, ``series``.

    The series have a curve for each gauge, its strain in 1e-6.
    """
    series = []
    for record in records:
        microstrain = [1e6 * strain for strain in record["y"]]
        series.append({"name": record["name"], "t": record["t"], "y": microstrain})
    title = "Strain, below 0 compressed"
    return {"key": "gauge", "title": title, "unit": "µε", "series": series}


# Layout -------------------------------------------------------------------------------


def layout_of_row(system: Any, facts: Any) -> Any:
    """Layout of the row in the moving picture.

    A point is drawn at X = left + x + magnification (offset + displacement - frame t),
    where `left` is the left end of its body if all bodies lie side by side.

    Returns
    -------
    dict
        ``mass_width``, the width of a mass, m; ``offsets`` of the bodies, m;
        ``magnification``; the velocity ``frame``, m/s, that of the slowest body if the
        row drifts, else 0; and ``notes`` in words on these two, "true to scale" for the
        magnification 1.
    """
    length = 0.0  # of all rods, m
    for body in facts["bodies"]:
        for segment in body["segments"]:
            length += segment["length"]
    slowest = slowest_velocity(system, facts["outcome"]["before"])
    offsets = initial_offsets(system, facts["tiling"])
    # Range of all displacements, m, in the frame at rest and in that of the slowest
    # body
    reach = spread(facts, offsets, 0.0)
    relative_reach = spread(facts, offsets, slowest)
    strain = peak_of(facts["tiling"]["strain"])  # limits the magnification
    magnification = magnified(length, reach, relative_reach, strain)
    frame = 0.0
    if drifts(reach, relative_reach):
        frame = slowest
    notes = ["true to scale"]
    if magnification != 1:
        notes = [f"displacements {TIMES} {format_factor(magnification)}"]
    if frame != 0:
        notes.append(f"frame moving at {format_si(frame, 'm/s', 4)}")
    return {
        "mass_width": round_down(BLOCK * length),
        "offsets": offsets,
        "magnification": magnification,
        "frame": frame,
        "notes": notes,
    }


def spread(facts: Any, offsets: list[float], frame: float) -> float:
    """Largest minus smallest displacement of all bodies at all times, m.

    The initial offset of a body is part of its displacement. Displacements are seen
    from a frame that moves at the velocity `frame`, m/s.
    """
    tiling = facts["tiling"]
    displacements: list[float] = []
    for g, i in enumerate(tiling["body"]):  # grid or polygon g of body i
        for k in range(tiling["start"][g], tiling["start"][g + 1]):  # its points
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
    """Ratio l1/l2 of the lengths of two uniform rods; None for any other row.

    l1 is the length of the left rod: the ratio may be above 1.
    """
    bodies = facts["bodies"]
    if len(bodies) != 2:
        return None
    left = bodies[0]["segments"]
    right = bodies[1]["segments"]
    if len(left) != 1 or len(right) != 1:
        return None
    return left[0]["length"] / right[0]["length"]


def restitution_of(facts: Any) -> Any:
    """Coefficient of restitution with texts and closed form, or why there is none.

    Returns
    -------
    dict
        ``value``, a number or None; ``number``, its text, "-" for None; ``error``, the
        text of its stated error, "" if it is too small to be shown; ``text``, both
        together; ``why`` there is no value, a sentence, or ""; and the ``closed_form``
        of the facts.
    """
    outcome = facts["outcome"]
    why = outcome["why"]
    value = None
    number = NO_VALUE
    error = ""
    if why == "":
        value = outcome["restitution"]
        digits = 5
        if facts["method"] == "fronts":
            digits = 6
        number = f"{without_round_off(value, 1.0):.{digits}g}"
        size = max(value, SMALLEST_RESTITUTION)  # 0 has no last digit
        no_unit = ""
        error = error_text(size, digits, outcome["error"], no_unit)
    elif len(outcome["unilateral"]) > 1:
        count = len(outcome["unilateral"])
        why = (
            f"A coefficient e belongs to one contact; this row has {count}, see the "
            "velocities"
        )
    text = number
    if error != "":
        text = f"{number} ± {error}"
    return {
        "value": value,
        "text": text,
        "number": number,
        "error": error,
        "why": as_sentence(why),
        "closed_form": facts["closed_form"],
    }


def rows_of_contact(facts: Any, i: int) -> Any:
    """Pairs of name and text: impulse, peak force and force duration of contact i.

    A text has the unit and the stated error, if there is one. The peak force of an
    impact of rigid bodies is NaN, and its text "-".
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
    """Text of a quantity with five digits and its stated error; "-" for NaN."""
    is_nan = value != value  # only NaN differs from itself
    if is_nan:
        return NO_VALUE
    digits = 5
    text = format_quantity(value, unit, digits)
    return with_error(text, value, digits, error, unit)


def rows_by_contact(facts: Any) -> Any:
    """Rows of the table of contacts that can open: name, impulse, force, duration.

    There are no rows if at most one contact can open.
    """
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
    """Pairs of name and text of the results: velocities, the contact, energies.

    Numbers of a contact are there only if a single one can open; `rows_by_contact` has
    those of several. Numbers that do not exist are left out.
    """
    outcome = facts["outcome"]
    when = "at the end"
    if outcome["final"]:
        when = "after"
    rows = []
    for velocity in velocities_after(facts):
        rows.append((f"velocity of {velocity['name']} {when}", velocity["text"]))
    if len(outcome["unilateral"]) == 1:
        for name, text in rows_of_contact(facts, outcome["unilateral"][0]):
            if text != NO_VALUE:
                rows.append((name, text))
    energy_before = outcome["energy_before"]
    vibration = without_round_off(outcome["vibration_after"], energy_before)
    vibration_text = text_of(vibration, outcome["errors"].get("energy", 0.0), "J")
    rows.append(("energy before", format_quantity(energy_before, "J", 5)))
    rows.append((f"vibration energy {when}", vibration_text))
    return rows


def velocities_after(facts: Any) -> list[Any]:
    """Velocity of each rod and mass at the end, in texts; walls are left out.

    Returns
    -------
    list of dict
        ``number`` and ``name`` of the body, the ``value`` in m/s as a text, and the
        ``text`` with unit and stated error. Fronts have six digits, pieces four.
    """
    outcome = facts["outcome"]
    digits = 4
    if facts["method"] == "fronts":
        digits = 6
    error = outcome["errors"]["velocity"]
    fastest = peak_of([*outcome["before"], *outcome["after"]])
    velocities = []
    for i, body in enumerate(facts["bodies"]):
        if body["kind"] != "wall":
            v = without_round_off(outcome["after"][i], fastest)
            value = f"{v:.{digits}g}"
            velocities.append(
                {
                    "number": body["number"],
                    "name": body["name"],
                    "value": value,
                    "text": with_error(f"{value} m/s", v, digits, error, "m/s"),
                }
            )
    return velocities
