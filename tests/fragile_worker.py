"""Stands in for the geometry process: elements whose GlobalId says so end it in their own way."""

import os
import signal
import sys
import time

from satAOI_adapters.ifc_read.records import Begun, Inspected, ModelRecord, Record, Request

DEADLY = {
    "crash": lambda: os.kill(os.getpid(), signal.SIGSEGV),
    "hang": lambda: time.sleep(60),
    "raise": lambda: sys.exit("MemoryError"),
}


def say(record: Record) -> None:
    sys.stdout.write(record.model_dump_json() + "\n")
    sys.stdout.flush()


def main() -> None:
    request = Request.model_validate_json(sys.stdin.readline())
    for handle in request.path.split():
        if handle not in request.skip:
            say(Begun(handle=handle, layer="IfcWall", share=0.5))
            DEADLY.get(handle.split("-")[0], lambda: None)()
    left_out = ModelRecord(
        schema_name=" ".join(sorted(request.skip)),
        unit="mm",
        mm_per_unit=1.0,
        storeys=[],
        classes={},
        findings=[],
    )
    say(Inspected(model=left_out))


if __name__ == "__main__":
    main()
