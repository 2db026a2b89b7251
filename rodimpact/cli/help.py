"""Tell what a case file may hold, and which units are known."""

import argparse

from ..storage.case_reference import sections
from ..storage.tables import align
from ..units import UNITS, si_unit
from . import DONE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to tell."""
    parser.add_argument(
        "topic",
        nargs="?",
        choices=TOPICS,
        default="topics",
        help="; ".join(
            f"{topic}: {(tell.__doc__ or '').rstrip('.')}"
            for topic, tell in TOPICS.items()
        ),
    )


def run(given: argparse.Namespace) -> tuple[str, int]:
    """The text on this topic."""
    return TOPICS[given.topic](), DONE


def topics() -> str:
    """These topics."""
    rows = [
        (f"rodimpact help {topic}", tell.__doc__ or "")
        for topic, tell in TOPICS.items()
    ]
    return align([*rows, ("rodimpact --help", "All commands.")], left=(0, 1))


def case() -> str:
    """Every table of a case file, with keys, units, defaults and an example."""
    texts = []
    for table in sections():
        rows = [("key", "unit", "takes", "default"), *table.entries]
        keys = align(rows, left=(0, 1, 2, 3)) if table.entries else "(no more keys)"
        texts.append(f"{table.title}\n{table.meaning}\n\n{keys}\n\n{table.example}")
    profile = (
        "A profile is {values = [1.0, 0.0], at = [0.1]}, constant between jumps, or\n"
        "{samples = [...]}, at equal distances; in time, samples have a step between them.\n"
        "Units: rodimpact help units"
    )
    return "\n\n\n".join([*texts, profile])


def units() -> str:
    """Every unit that a number in a text may have."""
    rows = [
        ("quantity", "SI", "also"),
        *(
            (
                name,
                si_unit(name) or "1",
                ", ".join(unit for unit in known if unit != si_unit(name)),
            )
            for name, known in UNITS.items()
        ),
    ]
    return align(rows, left=(0, 1, 2)) + "\n\nA bare number is in SI units."


TOPICS = {"topics": topics, "case": case, "units": units}
