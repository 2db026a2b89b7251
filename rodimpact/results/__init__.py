"""Results of a run: fields, contacts, gauges, energy, outcome."""
