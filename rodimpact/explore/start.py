"""What the page needs before its first question."""

from __future__ import annotations

from typing import Any

from .. import __version__
from .design import LIBRARY, Design
from .presets import presets
from .tables import RULES


def start(design: Design) -> dict[str, Any]:
    """The design shown first, those to begin with, and what the page knows of the model."""
    return {
        "version": __version__,
        "design": design.to_dict(),
        "materials": LIBRARY,
        "rules": RULES,
        "presets": [
            {"key": p.key, "title": p.title, "remark": p.remark, "design": p.design.to_dict()}
            for p in presets()
        ],
    }
