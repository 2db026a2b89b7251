"""From a system to a result: one collision, a family, a file."""
