"""The page in a notebook, which gives its case back; it needs the extra `notebook`.

The extra is anywidget.

The page posts the case file of its sliders to the frame around it. There
`page/notebook.js` takes it and hands it to the kernel. The page still asks no network
for anything.
"""

from typing import Any

import anywidget
import traitlets

from .page_files import read


class PageWidget(anywidget.AnyWidget):
    """A page, and the case file of its sliders."""

    _esm = read("notebook.js")
    page: Any = traitlets.Unicode().tag(sync=True)
    """The page, HTML."""
    case: Any = traitlets.Unicode().tag(sync=True)
    """The text of the case file; empty as long as the page shows what it began with."""
