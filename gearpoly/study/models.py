"""The keys of a study file: which pair, what is varied, how many are drawn, what is kept of each, what is asked."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, NoReturn, Self

from pydantic import Field, Strict, model_validator
from pydantic_core import PydanticCustomError

from gearpoly.files.models import Section
from gearpoly.keys.kinds import ONE_FAULT, Name

Value = bool | int | float | str
Row = Annotated[tuple[Value, ...], Strict(False), ONE_FAULT]

DEFAULT_OUTPUTS = (
    "te_pp_um",
    "te_mean_um",
    "mesh_order_1_um",
    "mesh_order_2_um",
    "side_band_driving_1_um",
    "side_band_driven_1_um",
    "backlash_least_um",
    "backlash_mean_um",
    "F_i_driving_um",
    "f_i_driving_um",
    "F_i_driven_um",
    "f_i_driven_um",
)
"""What is kept unless the file says otherwise: everything that an unloaded pair has without counting contacts."""


def _field(description: str, default: Any = None, **bounds: Any) -> Any:
    return Field(default=default, description=description, **bounds)


def _broken(key: str, found: str, wish: str) -> NoReturn:
    raise PydanticCustomError("rule", "{key}: {found}; {wish}", {"key": key, "found": found, "wish": wish})


class Sweep(Section):
    """One thing that is varied: one key of the pair file, or several that move together."""

    name: Annotated[Name, Field(min_length=1)] | None = _field("what tables call it; default: from its keys")
    key: str | None = _field("dotted key of the pair file")
    keys: Annotated[tuple[str, ...], Strict(False), ONE_FAULT] | None = _field("dotted keys that move together")
    method: Literal["list", "grid", "sobol"] = Field(description='"list", "grid" or "sobol"')
    values: Annotated[tuple[Value | Row, ...], Strict(False), ONE_FAULT] | None = _field(
        "list: the values; with several keys also rows with one value per key"
    )
    start: float | None = Field(default=None, alias="from", description="grid and sobol: the first value")
    to: float | None = _field("grid and sobol: the last value")
    steps: int | None = _field("grid: number of values, 1 or more", ge=1, le=100_000)

    @property
    def all_keys(self) -> tuple[str, ...]:
        """The keys that this sweep sets."""
        return self.keys if self.keys is not None else (self.key or "",)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.key is None) == (self.keys is None):
            _broken("key", "neither" if self.key is None else "key and keys", "want key, or keys that move together")
        if not self.all_keys:
            _broken("keys", "an empty list", "want one dotted key or more")
        if self.method == "list":
            self._complete_list()
            return self
        if self.values is not None:
            _broken("values", f'values with method = "{self.method}"', 'want method = "list", or from and to')
        if self.start is None or self.to is None:
            _broken("from", "missing" if self.start is None else "no to", "want both ends, from and to")
        if self.method == "grid" and self.steps is None:
            _broken("steps", "missing", "want the number of values of the grid")
        if self.method == "sobol" and self.steps is not None:
            _broken("steps", f"{self.steps}", "want samples at the top of the file; a Sobol sweep has no steps")
        if self.method == "sobol" and not self.start < self.to:
            _broken("to", f"{self.to:g}, not above from = {self.start:g}", "want a range that is not empty")
        return self

    def _complete_list(self) -> None:
        if not self.values:
            _broken("values", "an empty sweep", "want one value or more")
        for row in self.values:
            if isinstance(row, tuple) and len(row) != len(self.all_keys):
                _broken("values", f"a row of {len(row)} values", f"want {len(self.all_keys)}, one per key")
        for name, value in (("from", self.start), ("to", self.to), ("steps", self.steps)):
            if value is not None:
                _broken(name, f"{value:g} beside a list", 'want method = "grid" for from, to and steps')


class OutputLimit(Section):
    """What a good pair keeps: a bound on one output, and the share of pairs that shall keep it."""

    output: str = Field(description="name of an output")
    at_most: float | None = _field("upper bound in the output's unit")
    at_least: float | None = _field("lower bound in the output's unit")
    share: float = _field("share of all pairs that shall keep it, above 0 and below 1", 0.99, gt=0.0, lt=1.0)

    @model_validator(mode="after")
    def _one_bound(self) -> Self:
        if (self.at_most is None) == (self.at_least is None):
            _broken("at_most", "no bound" if self.at_most is None else "two bounds", "want at_most or at_least")
        return self


class Until(Section):
    """When it is enough: a percentile known to a width, in every combination."""

    output: str = Field(description="name of an output")
    percentile: float = Field(gt=0.0, lt=100.0, description="percentile, above 0 and below 100")
    width: float = Field(gt=0.0, description="width of its confidence interval in the output's unit, above 0")
    confidence: float = _field("confidence of the interval, above 0 and below 1", 0.95, gt=0.0, lt=1.0)
    at_least: int = _field("pairs of each combination before the first look, 8 or more", 32, ge=8)


class StudyFile(Section):
    """Everything that a study is, as its file has it."""

    name: Name = _field("name of the study in quotes", "unnamed study")
    pair: str = Field(min_length=1, description="pair file, relative to the study file")
    pairs: int = _field("pairs drawn for each combination, 1 or more", 1, ge=1, le=10_000_000)
    seed: int = _field("seed of everything random, 0 or more", 0, ge=0, le=2**63 - 1)
    draws: Literal["shared", "own"] = _field(
        '"shared": every combination sees the same random numbers; "own": each its own', "shared"
    )
    flank: Literal["drive", "coast"] = _field('flank that carries, "drive" or "coast"', "drive")
    positions_per_mesh: int = _field("positions per pitch, 2 or more", 20, ge=2, le=10_000)
    turns: float | None = _field(
        "turns of the driven gear, above 0, to the end of a mesh; default: a whole hunting cycle", gt=0.0, le=1e4
    )
    samples: int | None = _field("Sobol points, a power of two", ge=2, le=2**20)
    sensitivity: bool = _field("true: Sobol points laid out for sensitivity indices", False)
    outputs: Annotated[tuple[str, ...], Strict(False), ONE_FAULT] = _field(
        "names of what is kept of each pair", DEFAULT_OUTPUTS
    )
    set: dict[str, Value | Row] = Field(default_factory=dict, description="dotted keys of the pair file, a table")
    sweep: Annotated[tuple[Sweep, ...], Strict(False), ONE_FAULT] = _field("what is varied, tables [[sweep]]", ())
    limit: Annotated[tuple[OutputLimit, ...], Strict(False), ONE_FAULT] = _field(
        "what a good pair keeps, tables [[limit]]", ()
    )
    until: Until | None = _field("when it is enough, a table")

    @model_validator(mode="after")
    def _keys_agree(self) -> Self:
        sobol = any(sweep.method == "sobol" for sweep in self.sweep)
        if sobol and self.samples is None:
            _broken("samples", "missing", 'want the number of Sobol points, since a sweep has method = "sobol"')
        if self.samples is not None and not sobol:
            _broken("samples", f"{self.samples}", 'want a [[sweep]] with method = "sobol", or no samples')
        if self.samples is not None and self.samples & (self.samples - 1):
            near = 2 ** round(math.log2(self.samples))
            _broken(
                "samples", f"{self.samples}", f"want a power of two, such as {near}, or the points are not balanced"
            )
        if self.sensitivity:
            self._fit_for_sensitivity(sobol)
        if not self.outputs:
            _broken("outputs", "an empty list", "want one output or more")
        seen: set[str] = set()
        for key in [*self.set, *(key for sweep in self.sweep for key in sweep.all_keys)]:
            if key in seen:
                _broken("sweep", f'"{key}" is set twice', "want each key in one place")
            seen.add(key)
        for where, output in (
            *(("limit", one.output) for one in self.limit),
            ("until", getattr(self.until, "output", None)),
        ):
            if output is not None and output not in self.outputs:
                _broken(where, f'output = "{output}"', f"want one of the study's outputs: {', '.join(self.outputs)}")
        return self

    def _fit_for_sensitivity(self, sobol: bool) -> None:
        if not sobol:
            _broken("sensitivity", "true", 'want a [[sweep]] with method = "sobol"; grids have their indices anyway')
        if any(sweep.method != "sobol" for sweep in self.sweep):
            _broken("sensitivity", "true beside a list or grid", 'want method = "sobol" in all sweeps')
        if self.pairs != 1 or self.draws != "shared" or self.until is not None:
            _broken(
                "sensitivity", "true with pairs, draws or until", "want none of them; samples is the number of points"
            )
