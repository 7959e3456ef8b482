"""Reading in a process of its own, for libraries that a damaged file can bring to crash, or to go round for ever.

HDF5 2.0 does both: of 10 000 files with a few bytes changed one ended in a segmentation fault and two never came back,
since links within the file led round in a circle. No exception comes of either, so the file is parsed where both can be
seen and ended. The process is kept for the next file; it gets the file's name and gives back numbers, or says where in
the file they lie as they are, and nothing is unpickled.

Run as a program this module is that process.
"""

from __future__ import annotations

import atexit
import contextlib
import importlib
import importlib.util
import io
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, cast

import numpy as np

from gearpoly.errors import InputFileError, MissingExtraError
from gearpoly.recording.reader import Reader, check_finite, memory_limit, optional
from gearpoly.recording.recording import COLUMNS
from gearpoly.recording.table import Channel, Table
from gearpoly.units import FloatArray

READING_LIMIT_S = 12.0
"""s for a small file, which takes 10 ms; with the start of the process, one that never ends is refused within 20 s."""

PATIENCE, BUSY_PROCESSOR_SHARE, IDLE_PROCESSOR_SHARE = 4, 0.7, 0.05
"""Times that a process gets its time where it had less than ``BUSY_PROCESSOR_SHARE`` of it on a processor and more than
``IDLE_PROCESSOR_SHARE``: on a machine with three times as many at work a table of 90 MB was refused as damaged."""

BYTES_PER_SECOND = 20e6
"""How fast a large file is read at least, from a slow disk and unpacked: ten times slower than measured."""

PIPE_BYTES = 2**20
"""Room of the pipe for numbers, where the system gives it: 64 kB would have two processes take turns 16 times as often.
It is what Linux allows everyone."""

LIBRARIES_BYTES = 2**29
"""Memory that the process may take beside the numbers, for buffers of the libraries."""

_lock = threading.Lock()
_kept: list[tuple[int, subprocess.Popen[bytes], str]] = []


def read_apart(reader: Reader, file: Path, *arguments: object) -> Table:
    """What ``reader`` finds in ``file``, read in another process; ``arguments`` of its own are such as JSON holds.

    Raises what the reader raises, and ``InputFileError`` where the process crashes or does not end.
    """
    if importlib.util.find_spec(reader.module) is None:
        optional(file, reader.module, extra=reader.extra)
    seconds = READING_LIMIT_S + file.stat().st_size / BYTES_PER_SECOND
    order = {"module": reader.read.__module__, "file": str(file), "memory": memory_limit(file), "more": arguments}
    with _lock:
        try:
            answer, columns = _within(seconds, order)
        except TimeoutError:
            raise _damaged(reader, file, f"reading it did not end within {seconds:.0f} s") from None
        except _CrashedError:
            try:  # the process may have been ended from outside, which is no fault of the file's
                answer, columns = _within(seconds, order)
            except (TimeoutError, _CrashedError):
                raise _damaged(reader, file, "its library crashed on it") from None
    if "missing" in answer:
        raise MissingExtraError(answer["missing"])
    if "refused" in answer:
        raise InputFileError(file, **answer["refused"])
    if "bug" in answer:
        raise RuntimeError(answer["bug"])
    for name, values in columns.items():
        if name in COLUMNS:
            check_finite(file, name, values)
    others = {
        path: Channel(values=columns.pop(f"{k} values"), unit=unit, time=columns.pop(f"{k} time", None), leaf=leaf)
        for k, (path, unit, leaf) in enumerate(answer["others"])
    }
    unread = tuple(answer["unread"]) if answer["unread"] else None
    said = {key: answer[key] for key in ("keys", "remarks", "paths")}
    return Table(columns=columns, others=others, unread=unread, **said)


class _CrashedError(Exception):
    """The process ended before it answered."""


def _damaged(reader: Reader, file: Path, reason: str) -> InputFileError:
    found = f"a damaged {reader.name} file ({reason})"
    return InputFileError(file, found=found, wish="want the whole file; copy or export it again")


def _within(seconds: float, order: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The answer to one order, or ``TimeoutError`` where it takes longer, and the process is ended."""
    process = _process()
    late, done = threading.Event(), threading.Event()
    begin = _worked(process.pid)

    def watch() -> None:
        """End the process once it had its time of a processor, or hardly works; where others hold the processors it
        waits for them, four times as long at most."""
        for _ in range(PATIENCE):
            if done.wait(seconds):
                return
            worked = _worked(process.pid) - begin
            if not IDLE_PROCESSOR_SHARE * seconds < worked < BUSY_PROCESSOR_SHARE * seconds:
                break
        late.set()
        process.kill()

    threading.Thread(target=watch, daemon=True).start()
    try:
        return _asked(process, order)
    except (OSError, EOFError, ValueError):
        _end()
        if late.is_set():
            raise TimeoutError from None
        raise _CrashedError from None
    finally:
        done.set()


def _worked(pid: int) -> float:
    """Seconds of a processor that a process had so far, where the system tells, else 0."""
    try:
        held = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
        return (int(held[11]) + int(held[12])) / os.sysconf("SC_CLK_TCK")
    except (OSError, ValueError, IndexError, AttributeError):
        return 0.0


def _process() -> subprocess.Popen[bytes]:
    """The process that reads, started where there is none that finds what this one does; a fork has no right to its
    parent's."""
    paths = os.pathsep.join(os.path.abspath(path) for path in sys.path)
    if _kept and _kept[0][0] == os.getpid():
        _, process, known = _kept[0]
        if process.poll() is None and known == paths:
            return process
        _end()
    process = subprocess.Popen(
        [sys.executable, "-m", __name__ if __name__ != "__main__" else "gearpoly.recording.apart"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "PYTHONPATH": paths},
    )
    if sys.platform == "linux" and process.stdout is not None:
        fcntl = importlib.import_module("fcntl")
        with contextlib.suppress(OSError):
            fcntl.fcntl(process.stdout, fcntl.F_SETPIPE_SZ, PIPE_BYTES)
    _kept[:] = [(os.getpid(), process, paths)]
    return process


@atexit.register
def _end() -> None:
    """End the process that reads; it ends by itself where nobody is left to ask."""
    while _kept:
        pid, process, _ = _kept.pop()
        if pid != os.getpid():
            continue
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with contextlib.suppress(OSError):
                    stream.close()
        process.kill()
        process.wait()


def _asked(process: subprocess.Popen[bytes], order: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The process's answer to one order, and the columns after it."""
    assert process.stdin is not None
    assert process.stdout is not None
    stream = cast("io.BufferedReader", process.stdout)
    process.stdin.write(json.dumps(order).encode("ascii") + b"\n")
    process.stdin.flush()
    line = process.stdout.readline()
    if not line.endswith(b"\n"):
        raise EOFError
    answer = json.loads(line)
    stated = answer.get("columns", [])
    columns = _room({name: size for name, size, _ in stated})
    with open(order["file"], "rb", buffering=0) if stated else contextlib.nullcontext(stream) as file:
        for name, _, offset in stated:
            if offset is not None:
                file.seek(offset)
            _fill(columns[name], stream if offset is None else file)
    return answer, columns


def _room(sizes: dict[str, int]) -> dict[str, FloatArray]:
    """An array for each of some columns; those of a recording lie in one piece of memory, which the system hands out in
    larger pages and so in half the time."""
    own = {name: size for name, size in sizes.items() if name in COLUMNS}
    parts = np.split(np.empty(sum(own.values())), np.cumsum(list(own.values()))[:-1])
    apart = {name: np.empty(size) for name, size in sizes.items() if name not in own}
    return {**dict(zip(own, parts, strict=False)), **apart}


def _fill(values: FloatArray, stream: io.RawIOBase | io.BufferedReader) -> None:
    """Read ``values`` (n,) from a stream; ``EOFError`` where it ends before."""
    into, at = values.data.cast("B") if values.size else memoryview(b""), 0
    while at < len(into):
        got = stream.readinto(into[at:])
        if not got:
            raise EOFError
        at += got


def _bound(memory: int) -> None:
    """Let the process take ``memory`` bytes more than it has, where the system can see to that."""
    if sys.platform != "linux":
        return
    resource = importlib.import_module("resource")
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = pages * resource.getpagesize() + memory + LIBRARIES_BYTES
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard < 0 else min(wanted, hard), hard))


def _answer(order: dict[str, Any]) -> tuple[dict[str, Any], Table | None]:
    try:
        _bound(order["memory"])
        table = importlib.import_module(order["module"]).READER.read(Path(order["file"]), *order["more"])
    except InputFileError as error:
        return {"refused": {"where": error.where, "found": error.found, "wish": error.wish}}, None
    except MissingExtraError as error:
        return {"missing": str(error)}, None
    except Exception as error:  # whatever it is goes back to the asking process, which tells it as a bug
        traceback = importlib.import_module("traceback")
        return {"bug": "".join(traceback.format_exception(error))}, None
    sizes = [(name, values.size, _offset(values)) for name, values in _series(table)]
    others = [(path, one.unit, one.leaf) for path, one in table.others.items()]
    found = {"columns": sizes, "keys": table.keys, "remarks": table.remarks, "others": others}
    found |= {"unread": table.unread, "paths": table.paths}
    return found, table


def _series(table: Table) -> Iterator[tuple[str, FloatArray]]:
    """All numbers of a table under names that tell them apart: columns, then values and times of the other channels,
    whose own names may be those of columns."""
    yield from table.columns.items()
    for k, one in enumerate(table.others.values()):
        yield f"{k} values", one.values
        if one.time is not None:
            yield f"{k} time", one.time


def _offset(values: FloatArray) -> int | None:
    """Where in the file the numbers (n,) lie, for those that are mapped from there whole; ``None`` for others."""
    owner: object = values
    while isinstance(owner, np.ndarray) and not isinstance(owner, np.memmap):
        owner = owner.base
    if isinstance(owner, np.memmap) and owner.size == values.size and values.dtype == np.dtype("=f8"):
        return int(owner.offset)
    return None


def serve(orders: BinaryIO, answers: BinaryIO) -> None:
    """Answer orders until there are none."""
    for line in orders:
        answer, table = _answer(json.loads(line))
        answers.write(json.dumps(answer).encode("ascii") + b"\n")
        for _, values in _series(table) if table is not None else ():
            if values.size and _offset(values) is None:
                answers.write(np.ascontiguousarray(values).data.cast("B"))
        answers.flush()
        del table


if __name__ == "__main__":
    # Whatever a library prints must not come between the answers.
    with os.fdopen(os.dup(1), "wb") as stream:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        with contextlib.suppress(KeyboardInterrupt, BrokenPipeError):
            serve(sys.stdin.buffer, stream)
