"""Write README.md and the page of each case anew, unless a bound is broken."""

import sys

from rodimpact.storage.writing import write_text

from .table import FOLDER, PAGES, cases, page, run, verdicts

rows_by_case = {case: run(case) for case in cases()}
rows = [row for case in rows_by_case.values() for row in case]
broken = [row for row in rows if not row.holds]
for row in broken:
    print(
        f"{row.case}: {row.quantity}: expected {row.expected}, got {row.got}, "
        f"{float(row.difference):.3g} apart, more than {row.bound:.3g}",
        file=sys.stderr,
    )
if broken:
    sys.exit(
        f"{len(broken)} of {len(rows)} numbers break their bounds; no page is changed"
    )
write_text(FOLDER / "README.md", verdicts(rows_by_case), force=True)
for name, of_case in rows_by_case.items():
    write_text(PAGES / f"{name}.md", page(name, of_case), force=True)
print(f"{len(rows)} numbers within their bounds; the pages are written")
