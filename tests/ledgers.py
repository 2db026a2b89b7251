"""An outcome and the last line of its energy ledger, entry by entry."""

BOTH = ("dissipated", "damped", "numerical", "radiated", "wall_work", "drive_work", "gravity_work")


def entries_of(outcome):
    bodies = outcome.kinetic_after, sum(outcome.vibration_after), outcome.contact_energy
    return [*bodies, *(getattr(outcome, name) for name in BOTH)]


def last_of(ledger):
    return [getattr(ledger, name)[-1] for name in ("kinetic", "vibration", "contact", *BOTH)]
