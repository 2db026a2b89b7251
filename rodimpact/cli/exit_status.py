"""Exit statuses of the program, and what a command hands back."""

from collections.abc import Iterable

DONE = 0
FAULT = 1
MISTAKE = 2
INCOMPLETE = 3
UNVERIFIED = 4
INTERRUPTED = 130
STATUSES = {
    DONE: "done",
    FAULT: (
        "an output cannot be written, `rodimpact doctor --warm` cannot compile, or "
        "rodimpact has a bug"
    ),
    MISTAKE: (
        "the call or the case has a mistake, or a file exists and --force is missing"
    ),
    INCOMPLETE: (
        "a run stopped early, or a blow is not over, and the results so far are "
        "printed; or the verdict of `rodimpact reduce --strict` has a doubt"
    ),
    UNVERIFIED: "verification failed",
    INTERRUPTED: "interrupted by Ctrl-C",
}


class CommandResult:
    """Result of a command.

    It is a plain class since `typing`, which makes named tuples, would take a twelfth
    of the time of ``rodimpact --version``.

    Attributes
    ----------
    text : str or iterable of str
        For standard output: a text, or lines.
    status : int
        One of `STATUSES`.
    """

    def __init__(self, text: str | Iterable[str], status: int) -> None:
        """Take text and status as they are."""
        self.text = text
        self.status = status
