"""Progress of long tasks, compilations included, for open pages; see `ulna.system.progress`."""

from __future__ import annotations

from ulna.compiler.runtime import jit
from ulna.system import progress as tasks
from ulna.system.progress import Report, Watcher, progress, silent

__all__ = ["Report", "Watcher", "progress", "silent", "unwatch", "watch"]


def watch(watcher: Watcher) -> None:
    """Call a watcher with the progress of long tasks of this process from now on, compilations included."""
    tasks.watch(watcher)
    jit.watchers.append(watcher)


def unwatch(watcher: Watcher) -> None:
    """Do not call a watcher any more."""
    tasks.unwatch(watcher)
    if watcher in jit.watchers:
        jit.watchers.remove(watcher)
