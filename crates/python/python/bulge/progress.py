"""Progress of long calls: a callback, or a bar where tqdm is installed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Union

from bulge import _bulge

#: ``True``: a bar (tqdm, where it is installed); a function: called with the share that is done, 0 to 1, and what is going on.
Progress = Union[None, bool, Callable[[float, str], Any]]


@contextmanager
def callback(progress: Progress, about: str) -> Iterator[Callable[[float, str], Any] | None]:
    """What compiled code is to call, if anything. An exception that it raises stops the work and is raised by the call."""
    if progress is None or progress is False:
        yield None
        return
    if progress is not True:
        if not callable(progress):
            raise _bulge.InputError(f"progress: {progress!r} can't be called; give a function of (share, what), or True for a bar")
        yield progress
        return
    import warnings

    try:
        with warnings.catch_warnings():
            # Notebooks without widgets get a bar of text, which needs no apology.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(total=100.0, desc=about, bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed} {postfix}") as bar:

        def told(share: float, what: str) -> None:
            bar.set_postfix_str(what, refresh=False)
            bar.update(max(0.0, 100.0 * share - bar.n))

        yield told
