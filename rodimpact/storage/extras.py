"""Optional packages, imported when they are needed."""

from importlib import import_module
from typing import Any


def optional(name: str, extra: str) -> Any:
    """Import a package and return it.

    If it is missing, ImportError names the extra of rodimpact that installs it.
    """
    try:
        return import_module(name)
    except ImportError:
        message = f"{name} is not installed; pip install 'rodimpact[{extra}]' adds it"
        raise ImportError(message) from None
