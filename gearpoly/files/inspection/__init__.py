"""Inspections as owners have them: sheets of measuring machines and tables, turned into keys of a pair file."""
