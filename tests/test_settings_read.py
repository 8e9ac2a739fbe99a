"""Settings files in TOML: texts survive, and what is no settings file is told in one line."""

import tomllib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import BaseModel, ConfigDict

from satAOI_adapters.settings_read import read_settings, toml_string
from satAOI_geo.errors import InputError


class Tool(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)

    name: str
    length_mm: float


def tool_from(folder: Path, text: str) -> Tool:
    file = folder / "tool.toml"
    file.write_text(text, encoding="utf-8")
    return read_settings(
        file, Tool, what="tool file", complaint=lambda key, fault: f"{key}: {fault['type']}"
    )


@given(st.text(st.characters(exclude_categories=["Cs"])))
def test_any_text_written_and_read_again_is_the_same_text(text: str) -> None:
    assert tomllib.loads(f"text = {toml_string(text)}") == {"text": text}


def test_the_keys_of_a_file_become_a_model(tmp_path: Path) -> None:
    assert tool_from(tmp_path, 'name = "float"\nlength_mm = 900\n') == Tool(
        name="float", length_mm=900
    )


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ('name = "float"\n', "length_mm: missing"),
        ('name = "float"\nlength_cm = 90\n', "unknown key 'length_cm'; known are name, length_mm"),
        ("name = \n", "is not TOML"),
        (f"name = {'[' * 9999}", "is not TOML"),
    ],
    ids=["missing", "misspelt", "no value", "nested without end"],
)
def test_a_fault_is_one_line_that_names_the_file(text: str, complaint: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"tool file .*tool\.toml'") as caught:
        tool_from(tmp_path, text)
    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)
