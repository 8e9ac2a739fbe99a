"""The keys of a layer file, for pydantic, which is slow to load and not needed without a file."""

from pydantic import BaseModel, ConfigDict

from satAOI_adapters.meanings import Meaning


class LayersFile(BaseModel):
    """A TOML file of layer patterns: kinds in order of precedence, each with its patterns."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False)

    replace: bool = False
    layers: dict[Meaning, list[str]] = {}
    blocks: dict[Meaning, list[str]] = {}
