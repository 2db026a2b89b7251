"""Packages that rodimpact can do without, imported when they are asked for."""

from importlib import import_module
from typing import Any


def optional(name: str, extra: str) -> Any:
    """Import a package, and return it.

    If it is missing, ImportError says which extra of rodimpact brings it.
    """
    try:
        return import_module(name)
    except ImportError:
        message = f"{name} is not installed; pip install 'rodimpact[{extra}]' adds it"
        raise ImportError(message) from None
