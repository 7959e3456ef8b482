"""The command line: every module of ``gearpoly.commands`` is a command, found without registration.

Heavy imports wait until a command runs, so that --help answers at once.
"""

from __future__ import annotations

import os
import pkgutil
from importlib import import_module
from typing import Annotated

import typer

from gearpoly import commands

# Threads share recordings here, and matrices are small: a second crew of threads would only wait for the first.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Pictures are files. Whatever stands here matplotlib reads as it is imported, and gives up at what it does not know.
os.environ["MPLBACKEND"] = "agg"

app = typer.Typer(
    name="gearpoly",
    help="Spur gears with their manufacturing errors as exact polygons, turned until they touch.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _version(wanted: bool) -> None:
    if wanted:
        from gearpoly import __version__

        print(f"gearpoly {__version__}")
        from gearpoly.plugins import installed

        for one in installed():
            print(f"with {one.package} {one.version}: {one.name} of {one.group}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Spur gears with their manufacturing errors as exact polygons, turned until they touch."""


def _find() -> None:
    """A module ``study_report`` holds the function ``study_report`` of the command ``study-report``; ``ORDER`` is its
    place in the help, ``COMMAND`` its class where it is none of typer's."""
    found = [import_module(f"gearpoly.commands.{one.name}") for one in pkgutil.iter_modules(commands.__path__)]
    for module in sorted(found, key=lambda module: module.ORDER):
        name = module.__name__.rpartition(".")[2]
        app.command(name=name.replace("_", "-"), cls=getattr(module, "COMMAND", None))(getattr(module, name))


_find()
