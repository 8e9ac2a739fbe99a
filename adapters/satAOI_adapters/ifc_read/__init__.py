"""Floor plans out of IFC building models (IFC2X3, IFC4, IFC4X3_ADD2)."""

from satAOI_adapters.ifc_read.options import IfcOptions
from satAOI_adapters.ifc_read.reading import Inspection, inspect, read

__all__ = ["IfcOptions", "Inspection", "inspect", "read"]
