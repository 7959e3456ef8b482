"""The classes that real life has, one file each: what nobody built a bench for, and what owners really record."""

from __future__ import annotations
