"""The contact debugger: one pair, or one pair beside its recording, as a page that needs nothing but a browser."""
