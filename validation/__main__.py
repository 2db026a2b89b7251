"""Run cases of validation: all of them, or those that are named.

After all cases, README.md and all pages are written, unless a bound is broken. After
some cases no file is written. A line for each case tells its numbers and its time; all
cases take some ten minutes. The exit status is 1 if a bound is broken.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from textwrap import fill

from rodimpact.hints import nearest
from rodimpact.storage.writing import write_text

from .table import FOLDER, PAGES, Row, cases, page, run, verdicts


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the cases that `arguments` name, by default those of the command line.

    Without names all cases run, and then README.md and the pages are written.
    SystemExit is raised if a bound is broken, before anything is written, or if an
    argument is no case.
    """
    known = cases()
    chosen = _chosen_cases(arguments, known)
    rows_by_case: dict[str, list[Row]] = {}
    total = 0
    broken = 0
    for case in chosen:
        rows = _run_and_tell(case)
        rows_by_case[case] = rows
        total += len(rows)
        broken += sum(not row.holds for row in rows)
    if broken:
        sys.exit(f"{broken} of {total} numbers break their bounds; no page is changed")
    if chosen != known:
        print(f"{total} numbers within their bounds; pages are written after all cases")
        return
    write_text(FOLDER / "README.md", verdicts(rows_by_case), force=True)
    for case, rows in rows_by_case.items():
        write_text(PAGES / f"{case}.md", page(case, rows), force=True)
    print(f"{total} numbers within their bounds; the pages are written")


def _chosen_cases(arguments: Sequence[str] | None, known: list[str]) -> list[str]:
    """Cases that arguments name, each once, in the order of `known`; all without one.

    It ends by SystemExit after --help, or with a message if an argument is no case.
    """
    parser = argparse.ArgumentParser(
        prog="python -m validation",
        description=__doc__,
        epilog=fill(f"cases: {', '.join(known)}"),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "cases",
        metavar="CASE",
        nargs="*",
        help="a file of this folder, without .py; all cases if none is named",
    )
    names = parser.parse_args(arguments).cases
    for name in names:
        if name not in known:
            parser.error(f"there is no case {name!r}; {nearest(name, known)}")
    if not names:
        return known
    return [case for case in known if case in names]


def _run_and_tell(case: str) -> list[Row]:
    """Rows of a case; its time and each broken bound are printed on standard error."""
    start = time.perf_counter()
    rows = run(case)
    seconds = time.perf_counter() - start
    verdict = "pass"
    for row in rows:
        if not row.holds:
            verdict = "fail"
            message = (
                f"{row.case}: {row.quantity}: expected {row.expected}, got {row.got}, "
                f"{float(row.difference):.3g} apart, more than {row.bound:.3g}"
            )
            print(message, file=sys.stderr)
    line = f"{case}: {len(rows)} numbers, {verdict}, {seconds:.1f} s"
    print(line, file=sys.stderr, flush=True)
    return rows


if __name__ == "__main__":
    main()
