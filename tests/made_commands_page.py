"""The page of all commands from their signatures: ``python -m tests.made_commands_page docs/reference/commands.md``."""

from __future__ import annotations

import inspect
import pkgutil
import sys
import types
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

from typer.models import ArgumentInfo, OptionInfo

from gearpoly import commands

HEAD = """# Commands

From the commands themselves (`python -m tests.made_commands_page docs/reference/commands.md`; a test compares).
`gearpoly COMMAND --help` prints the same. An option that writes a file takes `-` for standard output where the table
says so, and then nothing else goes there. Every command says on standard error which files it wrote.
Exit codes: [messages](messages.md).
"""

KINDS = {Path: "FILE", int: "N", float: "NUMBER", str: "NAME"}


def parameters(command: Any) -> Iterator[tuple[str, str]]:
    """Arguments and options of a command as they are typed, and their help."""
    hints = get_type_hints(command, include_extras=True)
    for name in inspect.signature(command).parameters:
        kind, info = get_args(hints[name])
        if get_origin(kind) in (Union, types.UnionType):
            (kind,) = (one for one in get_args(kind) if one is not type(None))
        several = get_origin(kind) is list
        kind = get_args(kind)[0] if several else kind
        if isinstance(info, ArgumentInfo):
            yield (info.metavar or name).upper() + (" ..." if several else ""), info.help or ""
        elif isinstance(info, OptionInfo):
            # Within Annotated the first own name of an option stands where a default would.
            own = [one for one in (info.default, *(info.param_decls or ())) if str(one).startswith("--")]
            given = own[-1] if own else "--" + name.replace("_", "-")
            choices = "|".join(str(one.value) for one in kind) if issubclass(kind, Enum) else ""
            value = "" if kind is bool else f" {info.metavar or choices or KINDS[kind]}"
            yield given + value, info.help or ""


def page() -> str:
    """All commands in the order of the help, with arguments and options as ``--help`` describes them."""
    found = [import_module(f"gearpoly.commands.{one.name}") for one in pkgutil.iter_modules(commands.__path__)]
    out = [HEAD]
    for module in sorted(found, key=lambda module: module.ORDER):
        name = module.__name__.rpartition(".")[2]
        command = getattr(module, name)
        doc = " ".join((command.__doc__ or "").split())
        out += [f"\n## {name.replace('_', '-')}\n", doc, "\n| argument or option | what |\n| --- | --- |"]
        for given, what in parameters(command):
            typed, said = (text.replace("|", "\\|") for text in (given, what))
            out.append(f"| `{typed}` | {said} |")
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8")
