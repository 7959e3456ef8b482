"""Threads change nothing but the time that work takes."""

from __future__ import annotations

import threading

import pytest

from gearpoly.threads import each


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
