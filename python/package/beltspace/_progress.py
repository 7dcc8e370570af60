"""Progress of a sweep: a bar, or a function of one's own."""

import sys
import time
from collections.abc import Callable
from typing import Any, Protocol

Progress = Callable[[str, int, int], Any]
"""Told what is done, how much of it, and how much there is."""


class Follower(Protocol):
    """Who follows a sweep."""

    def __call__(self, what: str, done: int, total: int) -> None: ...
    def close(self) -> None: ...


class _Told:
    def __init__(self, function: Progress) -> None:
        self._function = function
        self._last: tuple[str, int, int] | None = None

    def __call__(self, what: str, done: int, total: int) -> None:
        if (what, done, total) != self._last:
            self._last = (what, done, total)
            self._function(what, done, total)

    def close(self) -> None:
        pass


class _Bar:
    """A bar of tqdm, in a notebook as a widget."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._bar: Any = None
        self._what = ""

    def __call__(self, what: str, done: int, total: int) -> None:
        if total <= 0:
            return
        if self._bar is None or what != self._what:
            self.close()
            self._what = what
            self._bar = self._tqdm(total=total, desc=what, unit_scale=True, leave=False)
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


class _Line:
    """A line on standard error, where there is no tqdm."""

    def __init__(self) -> None:
        self._shown = 0.0
        self._width = 0

    def __call__(self, what: str, done: int, total: int) -> None:
        now = time.monotonic()
        if total <= 0 or now - self._shown < 0.1:
            return
        self._shown = now
        text = f"{what}: {100 * done / total:.0f} %"
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def close(self) -> None:
        if self._width:
            sys.stderr.write("\r" + " " * self._width + "\r")
            sys.stderr.flush()


def follower(progress: Progress | bool | None) -> Follower | None:
    """Who is told of the progress: nobody, a bar, or a function."""
    if progress is None or progress is False:
        return None
    if progress is True:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            return _Line()
        return _Bar(tqdm)
    if not callable(progress):
        raise TypeError("progress is True, False or a function of (what, done, total)")
    return _Told(progress)
