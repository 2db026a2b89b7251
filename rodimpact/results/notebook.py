"""What a notebook shows of a result; the package sets who draws it, for pictures lie above."""

from collections.abc import Callable
from typing import Any

html: Callable[[Any], str]
