"""Kinds of values in a file's models: bounded numbers, lists with one number per tooth, names."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from pydantic import AfterValidator, Discriminator, Field, Strict, Tag

from gearpoly.errors import shown

# Bounds catch a mistaken unit or digit; whether the gear can be cut is for the geometry to say.
Um = Annotated[float, Field(ge=-1e4, le=1e4)]
UmSize = Annotated[float, Field(ge=0.0, le=1e4)]
Length = Annotated[float, Field(gt=0.0, le=1e5)]

NAME_SHOWN = 120
"""Characters of a name: what fits the head of a page, a picture and a table."""

Name = Annotated[str, AfterValidator(partial(shown, width=NAME_SHOWN))]
"""A name as it may be printed and written into any result: one line without control characters, not too long."""

ONE_FAULT = Field(fail_fast=True)
"""A list is checked as far as its first bad value: one is told, and each takes a kilobyte."""

NUMBER, LIST = "@number", "@list"


def _number_or_list(value: object) -> str:
    return LIST if isinstance(value, list | tuple) else NUMBER


PerTooth = Annotated[
    Annotated[Um, Tag(NUMBER)] | Annotated[Annotated[tuple[Um, ...], Strict(False), ONE_FAULT], Tag(LIST)],
    Discriminator(_number_or_list),
]
"""One number for all teeth, or one per tooth in the order of meshing."""
