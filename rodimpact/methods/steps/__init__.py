"""The method "characteristics": end signals averaged over a common time step."""
