"""Modules of validation/, a folder beside the package that is not installed."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

FOLDER = Path(__file__).parent.parent / "validation"


def validation_module(name: str) -> ModuleType:
    """Import a module of validation/ by its name."""
    if "validation" not in sys.modules:
        path = FOLDER / "__init__.py"
        spec = importlib.util.spec_from_file_location("validation", path)
        sys.modules["validation"] = importlib.util.module_from_spec(spec)
    return importlib.import_module(f"validation.{name}")
