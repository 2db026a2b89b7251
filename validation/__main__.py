"""Run every case, and write README.md and all pages unless a bound is broken."""

import sys

from rodimpact.storage.writing import write_text

from .table import FOLDER, PAGES, cases, page, run, verdicts


def main() -> None:
    """Run all cases; tell which bounds are broken, or write the pages."""
    rows_by_case = {case: run(case) for case in cases()}
    total = 0
    broken = []
    for rows in rows_by_case.values():
        total += len(rows)
        for row in rows:
            if not row.holds:
                broken.append(row)
    for row in broken:
        message = (
            f"{row.case}: {row.quantity}: expected {row.expected}, got {row.got}, "
            f"{float(row.difference):.3g} apart, more than {row.bound:.3g}"
        )
        print(message, file=sys.stderr)
    if broken:
        sys.exit(
            f"{len(broken)} of {total} numbers break their bounds; no page is changed"
        )
    write_text(FOLDER / "README.md", verdicts(rows_by_case), force=True)
    for case, rows in rows_by_case.items():
        write_text(PAGES / f"{case}.md", page(case, rows), force=True)
    print(f"{total} numbers within their bounds; the pages are written")


if __name__ == "__main__":
    main()
