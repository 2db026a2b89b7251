"""Methods: each turns a system into end signals or snapshots, and knows nothing of solutions."""
