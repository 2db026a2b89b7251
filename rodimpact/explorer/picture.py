"""All that the page shows of a solution, from what is known of it: layout, curves, texts.

Plain Python, which the page has as JavaScript. Polygons cut at time t are the rods at time t, so
the page slices them and needs no physics.
"""

from typing import Any

from ..model.numbering import body_numbers, contact_names
from ..results.magnification import BLOCK, drifts, magnified, round_down
from ..storage.tables import clean
from ..units import TIMES, format_factor, format_si
from .known import apart_of, body_told, slowest_of
from .reason import reason_of
from .texts import capital, stated, written


def picture(system: Any, found: Any, paths: Any, records: Any, energy: Any) -> Any:
    """The scene of a solution.

    Parameters
    ----------
    system : System
    found : dict
        ``method``, ``notes``, and whether it is ``exact``; ``closed_form`` of e, or None;
        ``gauges``; ``outcome`` as of `outcome_shown`; ``tiling``: polygons, or grids with
        ``across`` cells in a row; ``contacts``, each with its curves of ``force`` and ``gap``, the
        gap None for a bond. Curves are tables of ``t``, s, and ``y``.
    paths : list
        Of bodies without inside, None of rods.
    records : list of dict
        Curves of gauges, each with the ``name`` of its gauge.
    energy : dict
        Times ``t``, and energies by their names.

    Returns
    -------
    dict
        JSON-ready, SI units but for strain in 1e-6; numbers that do not exist are None.
    """
    kinds = [body.kind for body in system.bodies]
    numbers, names = body_numbers(kinds), contact_names(kinds)
    known = {
        **found,
        "bodies": [
            body_told(body, numbers[i], paths[i])
            for i, body in enumerate(system.bodies)
        ],
        "contacts": [
            {
                "index": i,
                "name": names[i],
                "bonded": law.law == "bonded",
                "compliant": law.law not in ("rigid", "bonded"),
                **found["contacts"][i],
            }
            for i, law in enumerate(system.contacts)
        ],
    }
    e = restitution_of(known)
    return {
        **known,
        "outcome": None,
        "end": max(found["tiling"]["t"]),
        "plots": [
            {
                "key": "energy",
                "title": "Energy",
                "unit": "J",
                "series": [
                    {"name": name, "t": [*energy["t"]], "y": y}
                    for name, y in energy.items()
                    if name != "t"
                ],
            },
            {
                "key": "gauge",
                "title": "Strain, below 0 compressed",
                "unit": "µε",
                "series": [
                    {**record, "y": [1e6 * e for e in record["y"]]}
                    for record in records
                ],
            },
        ],
        "row": row_of_picture(system, known),
        "restitution": e,
        "ratio": ratio_of(known),
        "reason": reason_of(known, e["text"] if e["why"] == "" else ""),
        "results": results_of(known),
        "by_contact": contacts_told(known),
    }


def row_of_picture(system: Any, known: Any) -> Any:
    """How the row is laid out: X = left + x + magnification * (apart + displacement - frame t).

    ``block`` is the width of a mass; bodies lie side by side.
    """
    total = sum(piece["length"] for body in known["bodies"] for piece in body["pieces"])
    slowest = slowest_of(system, known["outcome"]["before"])
    apart = apart_of(system, known["tiling"])
    reach, relative = spread(known, apart, 0.0), spread(known, apart, slowest)
    strain = max([abs(e) for e in known["tiling"]["strain"]])
    magnification = magnified(total, reach, relative, strain)
    frame = slowest if drifts(reach, relative) else 0.0
    note = "true to scale"
    if magnification != 1:
        note = f"displacements {TIMES} {format_factor(magnification)}"
    if frame != 0:
        note = f"{note}, frame moving at {format_si(frame, 'm/s', 4)}"
    return {
        "block": round_down(BLOCK * total),
        "apart": apart,
        "magnification": magnification,
        "frame": frame,
        "note": note,
    }


def spread(known: Any, apart: list[float], frame: float) -> float:
    """How far bodies get from where they would be, m, in a moving frame."""
    tiling = known["tiling"]
    moved: list[float] = []
    for g, i in enumerate(tiling["body"]):
        moved.extend(
            [
                apart[i] + tiling["displacement"][k] - frame * tiling["t"][k]
                for k in range(tiling["start"][g], tiling["start"][g + 1])
            ]
        )
    for i, body in enumerate(known["bodies"]):
        if body["path"] is not None:
            moved.extend(
                [
                    apart[i] + u - frame * t
                    for t, u in zip(
                        body["path"]["t"], body["path"]["displacement"], strict=True
                    )
                ]
            )
    return max(moved) - min(moved)


# Texts --------------------------------------------------------------------------------------------


def ratio_of(known: Any) -> Any:
    """l1/l2 of two uniform rods; None for any other row."""
    pieces = [body["pieces"] for body in known["bodies"]]
    if len(pieces) != 2 or any(len(one) != 1 for one in pieces):
        return None
    return pieces[0][0]["length"] / pieces[1][0]["length"]


def restitution_of(known: Any) -> Any:
    """e beside its closed form."""
    outcome, why, value, text = known["outcome"], known["outcome"]["why"], None, "-"
    if why == "":
        value, digits = outcome["restitution"], 6 if known["method"] == "fronts" else 5
        text = stated(
            f"{clean(value, 1.0):.{digits}g}",
            max(value, 1e-9),
            digits,
            outcome["error"],
            "",
        )
    elif len(outcome["able"]) > 1:
        count = len(outcome["able"])
        why = f"A coefficient e belongs to one contact; this row has {count}, see the velocities"
    return {
        "value": value,
        "text": text,
        "why": capital(why),
        "closed_form": known["closed_form"],
    }


def contact_told(known: Any, i: int) -> Any:
    """Name and text of each number of a contact; a blow of rigid bodies has the peak force "-"."""
    contact, errors = known["outcome"]["contacts"][i], known["outcome"]["errors"]
    rows = []
    for what, key, value, unit in (
        ("impulse", "impulse", contact.impulse, "N s"),
        ("peak force", "peak_force", contact.peak_force, "N"),
        ("force duration", "duration", contact.duration, "s"),
    ):
        text = "-"
        if value == value:  # no peak force is nan
            text = written(value, unit, 5)
            text = stated(text, value, 5, errors.get(key, 0.0), unit)
        rows.append((what, text))
    return rows


def contacts_told(known: Any) -> Any:
    """Rows of the table of several contacts: the name, and the numbers of `contact_told`."""
    able = known["outcome"]["able"]
    rows: list[Any] = []
    for i in able:
        if len(able) > 1:
            texts = [text for _, text in contact_told(known, i)]
            rows.append([known["contacts"][i]["name"], *texts])
    return rows


def results_of(known: Any) -> Any:
    """What the collision did, in words and numbers; several contacts are in `contacts_told`."""
    o, digits = known["outcome"], 6 if known["method"] == "fronts" else 4
    errors, rows = o["errors"], []
    fastest = max([abs(v) for v in [*o["before"], *o["after"]]])
    after = "after" if o["final"] else "at the end"
    for i, body in enumerate(known["bodies"]):
        if body["kind"] != "wall":
            v = clean(o["after"][i], fastest)
            text = stated(f"{v:.{digits}g} m/s", v, digits, errors["velocity"], "m/s")
            rows.append((f"velocity of {body['name']} {after}", text))
    if len(o["able"]) == 1:
        for what, text in contact_told(known, o["able"][0]):
            if text != "-":
                rows.append((what, text))
    vibration = clean(o["vibration_after"], o["energy_before"])
    text = stated(
        written(vibration, "J", 5), vibration, 5, errors.get("energy", 0.0), "J"
    )
    return [
        *rows,
        ("energy before", written(o["energy_before"], "J", 5)),
        (f"vibration energy {after}", text),
    ]
