"""gearpoly: spur gears with their manufacturing errors as exact polygons, turned until they touch."""

__version__ = "0.1.0"
