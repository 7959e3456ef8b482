"""The proof: concealed cases made, diagnosed in parallel, and scored against truths that only the scorer reads.

Of all of gearpoly only this package and its command import the bench, ``gearpoly.proving``.
"""

from __future__ import annotations
