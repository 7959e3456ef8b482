"""A reader whose format's library would run in a process of its own: channels under names of the owner's own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearpoly.recording.reader import Reader
from gearpoly.recording.table import Channel, Table


def read_table(file: Path) -> Table:
    """A column, and two channels of which one has times of its own."""
    return Table(
        columns={"torque_nm": np.full(3, 25.0)},
        keys={"flank": "coast"},
        remarks=[file.name],
        others={
            "rig/torque_nm": Channel(values=np.array([1.0, 2.0]), unit="N.m", time=np.array([0.0, 0.5])),
            "rig/Drehzahl Ø": Channel(values=np.arange(4.0)),
        },
    )


READER = Reader(name="made", endings=(), recognises=lambda head: False, read=read_table, module="json", apart=True)
