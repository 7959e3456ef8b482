"""The contact debugger from Python."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from gearpoly import arguments
from gearpoly.api.readings import read_one
from gearpoly.api.words import told_in_python
from gearpoly.assemble import Assembled
from gearpoly.diagnose.compare_as_built import compare_as_built
from gearpoly.errors import OutOfRangeError, shown, shown_value
from gearpoly.files.models import PairFile
from gearpoly.files.output import write_text
from gearpoly.mesh.condition import Condition
from gearpoly.mesh.pair import Flank
from gearpoly.recording.recording import Recording
from gearpoly.units import DEG, NM

if TYPE_CHECKING:
    from gearpoly.view.scene import ViewScene


@dataclass(frozen=True, kw_only=True, eq=False)
class Viewed:
    """The contact debugger of one pair, ready to be written: what ``gearpoly view`` makes. ``scene`` has the rest."""

    scene: ViewScene

    def __repr__(self) -> str:
        many = self.scene.simulation.te.size
        return f'<Viewed "{shown(self.scene.name)}": {many} positions, opens at {self.scene.theta_2 / DEG:.4g} deg>'

    @property
    def remarks(self) -> tuple[str, ...]:
        """What had to be assumed."""
        return self.scene.remarks

    @cached_property
    def html(self) -> str:
        """The page; it loads nothing from anywhere."""
        from gearpoly.view.document import document
        from gearpoly.view.html import page_text

        return page_text(document(self.scene))

    @told_in_python()
    def to_html(self, target: Path | str) -> None:
        """Write the page. Raises ``OutOfRangeError`` for a name that is no page's."""
        from gearpoly.view.html import check_page

        arguments.check_file("target", target)
        check_page(Path(target))
        write_text(target, self.html)


def view_of(
    assembled: Assembled,
    file: PairFile,
    *,
    source: str,
    seed: int,
    theta_2: float,
    recording: Path | str | Recording | None,
    map: Path | str | None,
    flank: Flank | None,
) -> Viewed:
    """The contact debugger of the pair of a ``file``, or of the pair beside a recording; arguments are those of
    :meth:`gearpoly.Pair.view`."""
    from gearpoly.view.scene import scene_beside, scene_of

    arguments.ROTATION.check("theta_2", theta_2)
    if recording is not None:
        if flank is not None:
            raise OutOfRangeError(f"flank {shown_value(flank)}: the recording brings its flank; leave flank out")
        one = read_one(recording, map=map, worm=file.worm)
        comparison = compare_as_built(file, [one], path=source)
        return Viewed(scene=scene_beside(comparison, path=source, theta_2=theta_2, progress=_quiet))
    if map is not None:
        raise OutOfRangeError(f"map {shown_value(map)}: a map is of a recording; want recording beside it")
    scene = scene_of(
        assembled,
        name=file.name,
        path=source,
        condition=Condition(flank="drive" if flank is None else flank, torque=file.torque_nm * NM),
        theta_2=theta_2,
        seed=seed,
        progress=_quiet,
    )
    return Viewed(scene=scene)


def _quiet(done: int) -> None:
    """Nobody watches."""
