"""The cantilever with the coupling as the study prints it, to reproduce its numbers."""

from __future__ import annotations

from functools import partial

from gearpoly.mesh.compliance.cantilever import compliance
from gearpoly.mesh.compliance.law import ComplianceLaw

LAW = ComplianceLaw(
    name="cantilever_published",
    compliance=partial(compliance, form="published"),
    source="Eqs. 8-11 of the study in docs/explanation/paper.md, after Cornell (1981)",
)
