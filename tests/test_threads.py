"""Threads change nothing but the time that work takes."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from pathlib import Path

import pytest

from gearpoly.__main__ import main
from gearpoly.threads import each
from tests.made_process import begun, read_until


def test_results_come_in_the_order_of_the_items() -> None:
    assert each(lambda n: n * n, range(50)) == [n * n for n in range(50)]


def test_work_within_work_does_not_wait_for_itself() -> None:
    # Every thread of the pool asks the pool for more: were it to wait, nobody would be left to work.
    assert each(lambda n: sum(each(lambda m: m, range(n))), range(40)) == [n * (n - 1) // 2 for n in range(40)]


def test_an_error_of_one_is_the_error_of_all() -> None:
    with pytest.raises(ZeroDivisionError):
        each(lambda n: 1 // n, [1, 0, 2])


def test_one_item_stays_where_it_is() -> None:
    assert each(lambda _: threading.current_thread(), [1]) == [threading.current_thread()]


BUSY = """
import os, time
from gearpoly import __main__, cli, threads
threads.threads = lambda: 2  # also where there is one core
def work(item):
    os.write(2, b"busy ")
    time.sleep(3600.0)
cli.app = lambda: threads.each(work, range(2))
__main__.command()
"""


@pytest.mark.skipif(os.name != "posix", reason="needs a terminal of its own")
def test_an_interrupt_waits_for_no_thread(tmp_path: Path) -> None:
    script = tmp_path / "busy.py"
    script.write_text(BUSY)
    ours, theirs = os.openpty()
    run = begun(script, stdout=subprocess.DEVNULL, stderr=theirs)
    os.close(theirs)
    read_until(ours, "busy busy", of=run)
    run.send_signal(signal.SIGINT)
    seen = read_until(ours, None, of=run, patience=60.0)  # it takes a moment; an hour if it waited
    os.close(ours)
    assert run.wait(60.0) == 130
    assert "gearpoly: interrupted" in seen


def _hidden() -> None:
    """What an interrupt leaves that arrives while a lock is being given back (``threading.Condition.wait``)."""
    try:
        raise KeyboardInterrupt
    except KeyboardInterrupt:
        raise RuntimeError("cannot release un-acquired lock") from None


def test_an_interrupt_behind_the_error_of_a_lock_is_an_interrupt(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["gearpoly"])
    monkeypatch.setattr("gearpoly.cli.app", _hidden)
    heeded = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(SystemExit) as end:
            main()
    finally:
        signal.signal(signal.SIGINT, heeded)
    assert end.value.code == 130
    assert capsys.readouterr().err == "gearpoly: interrupted; nothing half-written was left behind\n"
