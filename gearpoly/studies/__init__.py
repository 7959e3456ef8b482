"""Studies: many gears, many conditions, one question at a time."""
