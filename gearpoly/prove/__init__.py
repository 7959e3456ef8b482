"""The proof: concealed cases made, diagnosed in parallel, and scored against truths that only the scorer reads.

Of all of gearpoly only this package imports the bench, ``proving``.
"""

from __future__ import annotations
