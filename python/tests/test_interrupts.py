# SPDX-License-Identifier: Apache-2.0
"""Long calls: Ctrl-C, callbacks, and what other threads do meanwhile."""
import os
import signal
import threading
import time

import lucerna as lu
import numpy as np
import pytest


@pytest.fixture
def ctrl_c():
    """Presses Ctrl-C after some seconds."""
    timers = []

    def press(seconds):
        timers.append(threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)))
        timers[-1].start()

    yield press
    for timer in timers:
        timer.cancel()
        timer.join()


def test_a_trace_returns_what_is_there(lamp, ctrl_c):
    steps = []

    def after_the_first_piece(step):
        steps.append(step)
        if step.done > 2**24 and len(steps) < 10**6:
            steps.extend([step] * 10**6)
            os.kill(os.getpid(), signal.SIGINT)

    part = lamp.trace(rays=1e10, callback=after_the_first_piece)
    assert part.interrupted and part.end == "interrupted"
    first, last = part.rays
    assert first == 0 and last >= 2**20 and last % 2**20 == 0
    assert part["far"].flux.value > 0
    again = lamp.trace(rays=last + 1000, resume=part)
    assert again.rays == (0, last + 1000) and not again.interrupted


def test_what_has_no_result_raises(ctrl_c):
    rays = lu.make_source("filament", 3e6, seed=1)
    ctrl_c(0.3)
    with pytest.raises(KeyboardInterrupt):
        lu.compress(rays)


def test_callbacks_report_and_may_raise(lamp):
    times, steps = [], []

    def callback(step):
        times.append(time.monotonic())
        steps.append((step.phase, step.done, step.total))
        if len(steps) == 5:
            raise ZeroDivisionError("enough")

    with pytest.raises(ZeroDivisionError, match="enough"):
        lamp.trace(rays=1e10, callback=callback)
    assert len(steps) == 5
    assert min(np.diff(times)) > 0.09, "at most ten a second"
    assert all(phase == "trace" and total == 10**10 for phase, _, total in steps)
    assert [done for _, done, _ in steps] == sorted(done for _, done, _ in steps)


@pytest.mark.parametrize("count", [1000, 5_000_000])
def test_a_call_reports_its_end(lamp, count):
    """However long it was, and though it was reported before."""
    steps = []
    lamp.trace(rays=count, callback=steps.append)
    # A slow machine may report the last rays twice: when they are done, and at the end.
    assert [step.done for step in steps] == sorted(step.done for step in steps)
    assert steps[-1].done == steps[-1].total == count


def test_what_is_no_callback_raises(lamp):
    with pytest.raises(TypeError):
        lamp.trace(rays=1e10, callback=3)


def test_the_lock_is_released(lamp):
    """Another thread counts while this one traces."""
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    lamp.trace(rays=4e7)
    end = time.monotonic()
    done.set()
    thread.join()
    inside = [t for t in ticks if start < t < end]
    assert len(inside) > 5, (end - start, len(inside))


def test_a_thread_that_is_not_the_main_one_can_trace(lamp, traced):
    found = []
    thread = threading.Thread(target=lambda: found.append(lamp.trace(rays=traced.rays)))
    thread.start()
    thread.join()
    assert found[0] == traced


def test_what_is_pressed_at_the_end_of_a_call_is_not_lost():
    scene = lu.Scene([{"kind": "disk"}])
    for _ in range(5):  # the work is over before the callback is called
        with pytest.raises(KeyboardInterrupt):
            scene.trace(rays=10, callback=lambda step: signal.raise_signal(signal.SIGINT))
            for _ in range(1000):  # where Python looks at signals
                pass


def test_a_callback_may_press_it(lamp):
    def press(step):
        if step.done > 2**24:
            raise KeyboardInterrupt

    part = lamp.trace(rays=1e10, callback=press)
    assert part.interrupted
