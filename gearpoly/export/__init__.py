"""Gears on their way out: drawings, solids and inspection files. ``write.export`` is the way in."""
