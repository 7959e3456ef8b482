"""Tables for notebooks, where pandas is there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gearpoly.errors import MissingExtraError

if TYPE_CHECKING:
    from pandas import DataFrame


def data_frame(columns: Mapping[str, Any]) -> DataFrame:
    """A table of ``columns`` of one length.

    Raises ``MissingExtraError`` where pandas is not installed.
    """
    try:
        import pandas
    except ImportError:
        raise MissingExtraError("tables need pandas: pip install 'gearpoly[pandas]'") from None
    return pandas.DataFrame(columns)
