"""Libraries put off by the command line: not loaded by a run, and as ever where they are used."""

from pathlib import Path

import pytest

from tests.command_line import drawn_room, printed

DRAWING = """
import ezdxf
document = ezdxf.new(setup=True)
space = document.modelspace()
for layer in "AAB":
    space.add_line((0, 0), (1, 1), dxfattribs={"layer": layer})
"""

IN_THREADS = """
from concurrent.futures import ThreadPoolExecutor
with ThreadPoolExecutor(8) as threads:
    parsers = set(threads.map(lambda _: ezdxf.query.EntityQueryParser.parse_string, range(8)))
import pyparsing
print(*(type(parser.__self__) is pyparsing.And for parser in parsers))
"""


def test_a_run_that_reads_and_writes_a_drawing_loads_none_of_them(tmp_path: Path) -> None:
    plan, output = drawn_room(tmp_path / "room.dxf"), tmp_path / "aoi.dxf"
    code = (
        "from satAOI_geo.program import main\n"
        f"main([{str(plan)!r}, '-o', {str(output)!r}, '--quiet'])\n"
        "parts = ('pyparsing.core', 'fontTools.ttLib.ttFont', 'xml.etree.ElementPath')\n"
        "print('ezdxf' in sys.modules, *(name for name in parts if name in sys.modules))\n"
        "own = {'ezdxf.tools.pattern': 'ISO_PATTERN', 'ezdxf.tools.text_size': 'mtext_size', "
        "'ezdxf.fonts.shapefile': 'readfile', 'numpy._core._add_newdocs': 'add_newdoc'}.items()\n"
        "print(*(name in vars(sys.modules[module]) for module, name in own))"
    )
    assert printed(code) == "True\nFalse False False False\n"


@pytest.mark.parametrize(
    "use",
    [
        pytest.param("print(len(space.query('LINE[layer==\"A\"]')))", id="a query"),
        pytest.param("space.query('LINE[[')", id="a query that is none"),
        pytest.param(
            "document.blocks.new('B'); document.blocks.delete_block('B')\n"
            "import pyparsing; print(ezdxf.sections.blocks.ParseException is "
            "pyparsing.ParseException, 'B' in document.blocks)",
            id="a block that is asked for",
        ),
        pytest.param(
            "from ezdxf.fonts.fonts import make_font\n"
            "print(make_font('DejaVuSans.ttf', 2.5).text_width('area of interest'))",
            id="the width of a text",
        ),
        pytest.param(
            "from pathlib import Path; from ezdxf.fonts import font_manager\n"
            f"font_manager.get_ttf_font_face(Path({__file__!r}))",
            id="a typeface that is none",
        ),
        pytest.param("from pyparsing import *; print(Word('a').parse_string('aab'))", id="names"),
        pytest.param("import pyparsing.results as r; print(r.ParseResults('a'))", id="a part"),
        pytest.param("from fontTools.ttLib import sfnt; print(sfnt.__name__)", id="another part"),
        pytest.param(
            "from importlib.util import find_spec; print(find_spec('pyparsing').origin)",
            id="where it lies",
        ),
        pytest.param(
            "hatch = space.add_hatch(); hatch.set_pattern_fill('ANSI31', scale=2.0)\n"
            "print(hatch.pattern.as_list(), len(ezdxf.pattern.ISO_PATTERN))",
            id="the pattern of a hatch",
        ),
        pytest.param(
            "text = space.add_mtext('area of interest', dxfattribs={'char_height': 2.5})\n"
            "from ezdxf.tools.text_size import mtext_size; print(mtext_size(text))",
            id="the size of a text",
        ),
        pytest.param(
            "builder = space.add_multileader_mtext('Standard'); builder.set_content('floor')\n"
            "builder.build(insert=ezdxf.math.Vec2(0, 0))\n"
            "from ezdxf.bbox import extents; print(extents([builder.multileader]))",
            id="a text with a leader",
        ),
        pytest.param(
            "from ezdxf.tools import pattern, text_size\n"
            "print(pattern.load(factor=2.0)['ANSI31'], text_size.__name__)",
            id="modules of ezdxf's own",
        ),
        pytest.param(
            "from ezdxf.fonts import shapefile, lff\n"
            "print(lff.loads('# Name: plain').name)\n"
            "print(shapefile.shp_load(b'*0,4,FONT\\n21,7,0,0\\n').name)",
            id="fonts of strokes",
        ),
        pytest.param(
            "from xml.etree import ElementTree; import xml.etree.ElementTree as other\n"
            "from xml.etree.ElementTree import ParseError\n"
            "print(ElementTree.fromstring('<a b=\"1\"/>').attrib)\n"
            "print(other.tostring(other.Element('c')), ParseError.__name__)\n"
            "data = space.new_geodata(); data.coordinate_system_definition = '<a'\n"
            "data.get_crs()",
            id="a place on the globe",
        ),
        pytest.param(
            "import numpy, numpy.ma, scipy.spatial; print(numpy.ma.masked_equal([1, 2], 2))",
            id="libraries on numpy",
        ),
        pytest.param(IN_THREADS, id="threads"),
    ],
)
def test_what_is_put_off_is_as_ever_where_it_is_used(use: str) -> None:
    put_off = "from satAOI_adapters import put_off; put_off.until_used()\n"
    assert printed(put_off + DRAWING + use) == printed(DRAWING + use) != ""


def test_what_is_loaded_already_is_not_put_off() -> None:
    code = (
        "import pyparsing; from satAOI_adapters import put_off; put_off.until_used()\n"
        "print(sys.modules['pyparsing'] is pyparsing)"
    )
    assert printed(code) == "True\n"
