"""The version of the package, which files, pages and commands state."""

__version__ = "0.1.0"
