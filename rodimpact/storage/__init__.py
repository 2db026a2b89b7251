"""Files of cases, results and sweeps; tables for people and JSON for programs."""
