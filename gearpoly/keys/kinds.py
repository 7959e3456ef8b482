"""What a file's models are made of: tables, bounded numbers, lists with one number per tooth, names."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, NoReturn

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Strict, Tag
from pydantic_core import PydanticCustomError

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

NUMBER_TAG, LIST_TAG = "@number", "@list"


def number_or_list(value: object) -> str:
    return LIST_TAG if isinstance(value, list | tuple) else NUMBER_TAG


PerTooth = Annotated[
    Annotated[Um, Tag(NUMBER_TAG)] | Annotated[Annotated[tuple[Um, ...], Strict(False), ONE_FAULT], Tag(LIST_TAG)],
    Discriminator(number_or_list),
]
"""One number for all teeth, or one per tooth in the order of meshing."""


def field(description: str, default: Any = None, **bounds: Any) -> Any:
    """A key with its ``description`` (meaning and unit; after "; default: " what a missing one means) and bounds."""
    return Field(default=default, description=description, **bounds)


def broken(key: str, found: str, wish: str) -> NoReturn:
    """Refuse values that are fine one by one but not together; ``key`` counts from the model that
    checks.
    """
    raise PydanticCustomError("rule", "{key}: {found}; {wish}", {"key": key, "found": found, "wish": wish})


class Section(BaseModel):
    """A table of a file: unknown keys, values of another kind and infinities are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)
