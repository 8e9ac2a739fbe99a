"""The process that opens models: `python -m satAOI_adapters.ifc_read.worker`.

It reads one request, a line of JSON, and answers in lines of JSON. The geometry kernel is a large
C++ library; what it does to this process on a hostile model, it does to this process only.
"""

import os
import sys
from collections import Counter
from pathlib import Path
from typing import Final, TextIO

import ifcopenshell
from ifcopenshell import entity_instance

from satAOI_adapters.ifc_read.classes import chosen_classes
from satAOI_adapters.ifc_read.flaws import Flaws
from satAOI_adapters.ifc_read.model import (
    chosen_storey,
    handle_of,
    open_model,
    storeys_of,
    units_of,
)
from satAOI_adapters.ifc_read.names import respell_names
from satAOI_adapters.ifc_read.profiles import Units
from satAOI_adapters.ifc_read.records import (
    Begun,
    Failed,
    Inspected,
    ModelRecord,
    ObstacleRecord,
    Read,
    Record,
    Request,
    Storey,
    encoded_region,
)
from satAOI_adapters.ifc_read.site import Site
from satAOI_adapters.ifc_read.survey import survey
from satAOI_geo.errors import DrawingError, SatAoiError
from satAOI_geo.plan import Finding


class Worker:
    """Answers one request.

    Args:
        request: What to read.
        out: Where the answers go.
    """

    def __init__(self, request: Request, out: TextIO) -> None:
        self._request = request
        self._out = out
        self._n_begun = 0
        self._n_steps = 1

    def run(self) -> None:
        """Answer the request; errors of the program's own are an answer too."""
        try:
            self._say(self._answer())
        except DrawingError as error:
            self._say(
                Failed(
                    error=type(error).__name__,
                    message=str(error),
                    layer=error.layer,
                    handle=error.handle,
                )
            )
        except SatAoiError as error:
            self._say(Failed(error=type(error).__name__, message=str(error)))

    def _answer(self) -> Record:
        request, options = self._request, self._request.options
        opened = open_model(Path(request.path), Path(request.parsed))
        model = opened.model
        broken = dict.fromkeys(opened.dangling, "it refers to something that the file lacks")
        broken |= dict.fromkeys(request.bad_ids, "it holds a number that is none")
        flaws = Flaws.of(model, broken, request.skip)
        units, unit = units_of(model, options.units)
        choice = chosen_classes(
            model.schema_identifier, options.with_classes, options.without_classes
        )
        respelled = respell_names(model, raw=request.raw_names)
        storeys, odd_heights = storeys_of(model, units.mm, flaws.in_product)
        findings = [*opened.findings, *respelled, *odd_heights]
        described = _model_record(model, units, unit, storeys, findings)
        if request.only_inspect:
            return Inspected(model=described)
        by_height = options.floor_z is not None and options.storey is None
        storey = None if by_height else chosen_storey(storeys, options.storey)
        if storey is not None and options.storey is None and len(storeys) > 1:
            described.findings.append(_only_used(storey))
        # each element is begun twice: for its box and for its body
        self._n_steps = 2 * max(1, len(model.by_type("IfcElement")))
        site = Site.of(model, units, choice, flaws, self._begin)
        return self._read(site, storey, described)

    def _read(self, site: Site, storey: Storey | None, described: ModelRecord) -> Read:
        options = self._request.options
        asked_mm = None if options.floor_z is None else options.floor_z * site.units.mm
        read = survey(site, storey, asked_mm=asked_mm, band_mm=options.band_mm)
        return Read(
            model=described,
            storey="" if storey is None else storey.handle,
            origin_mm=read.origin_mm,
            floor=encoded_region(read.floor),
            floor_source=read.floor_source,
            height_mm=read.height_mm,
            obstacles=[ObstacleRecord.of(obstacle) for obstacle in read.obstacles],
            findings=list(read.findings),
        )

    def _begin(self, product: entity_instance) -> None:
        self._n_begun += 1
        self._say(
            Begun(
                handle=handle_of(product),
                layer=product.is_a(),
                share=min(1.0, self._n_begun / self._n_steps),
            )
        )

    def _say(self, record: Record) -> None:
        self._out.write(record.model_dump_json() + "\n")
        self._out.flush()


def _only_used(storey: Storey) -> Finding:
    return Finding(
        "storey-chosen",
        f"storey '{storey.name}' was read, the only one that holds anything",
        "choose another with --storey",
        layer="IfcBuildingStorey",
        handle=storey.handle,
    )


def _model_record(
    model: ifcopenshell.file,
    units: Units,
    unit: str,
    storeys: list[Storey],
    findings: list[Finding],
) -> ModelRecord:
    return ModelRecord(
        schema_name=model.schema_identifier,
        unit=unit,
        mm_per_unit=units.mm,
        storeys=storeys,
        classes=dict(sorted(Counter(p.is_a() for p in model.by_type("IfcProduct")).items())),
        findings=findings,
    )


def main() -> None:
    """Answer the request on standard input."""
    # the kernel may print: what it says must not mix with the answers
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    request = Request.model_validate_json(sys.stdin.readline())
    limit_memory(request.memory_mb)
    Worker(request, answers).run()


def limit_memory(memory_mb: int) -> None:
    """Let this process take no more address space, where the system can see to that."""
    if sys.platform != "win32":
        import resource

        most_bytes = memory_mb * BYTES_PER_MB
        resource.setrlimit(resource.RLIMIT_AS, (most_bytes, most_bytes))


BYTES_PER_MB: Final = 1_000_000


if __name__ == "__main__":
    main()
