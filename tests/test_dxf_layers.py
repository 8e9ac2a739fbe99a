"""What layer names mean, and what a user's own file changes about it."""

from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from satAOI_adapters.layers import BUILT_IN, is_like, layer_table
from satAOI_adapters.meanings import Certainty, Meaning
from satAOI_geo.errors import InputError
from satAOI_geo.plan import Kind
from tests.drawings import drawing, plan_of, rectangle, standing


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("FLOOR", Meaning.FLOOR),
        ("Slab", Meaning.FLOOR),
        ("WALL", Meaning.WALL),
        ("Walls", Meaning.WALL),
        ("COLUMNS", Meaning.COLUMN),
        ("column", Meaning.COLUMN),
        ("HOLES", Meaning.HOLE),
        ("EMBEDDED", Meaning.EMBEDDED),
        ("EQUIPMENT", Meaning.EQUIPMENT),
        ("A-WALL-FULL", Meaning.WALL),
        ("S-COLS", Meaning.COLUMN),
        ("A-FLOR-OPNG", Meaning.HOLE),
        ("A-GLAZ", Meaning.WINDOW),
        ("A-DOOR", Meaning.DOOR),
        ("A-WALL-PATT", Meaning.IGNORE),
        ("A-FURN", Meaning.IGNORE),
        ("OuterWall_2", Meaning.WALL),
        ("墙体", Meaning.WALL),
        ("柱", Meaning.COLUMN),
        ("楼板洞口", Meaning.HOLE),
        ("预埋件", Meaning.EMBEDDED),
        ("门窗", Meaning.WINDOW),
        ("Außenwand EG neu", Meaning.WALL),
        ("Wände", Meaning.WALL),
        ("Trémie", Meaning.HOLE),
        ("ARQ_MUROS", Meaning.WALL),
        ("Стены", Meaning.WALL),
        ("plan$0$A-WALL", Meaning.WALL),
        ("plan|S-COLS", Meaning.COLUMN),
        ("隔墙", Meaning.WALL),
        ("楼板开洞", Meaning.HOLE),
        ("管井", Meaning.HOLE),
        ("栏杆", Meaning.EQUIPMENT),
        ("間仕切", Meaning.WALL),
        ("サッシ", Meaning.WINDOW),
        ("바닥개구부", Meaning.HOLE),
        ("문자", Meaning.IGNORE),
        ("Betonstützen", Meaning.COLUMN),
        ("Schächte", Meaning.HOLE),
        ("Öffnungen_Decke", Meaning.HOLE),
        ("Trockenbau", Meaning.WALL),
        ("Bemaßung", Meaning.IGNORE),
        ("Maße", Meaning.IGNORE),
        ("Перегородка", Meaning.WALL),
        ("КЖ_Пилоны", Meaning.COLUMN),
        ("Приямки", Meaning.HOLE),
        ("Анкерные болты", Meaning.EMBEDDED),
        ("Лифты", Meaning.EQUIPMENT),
        ("Ścianki działowe", Meaning.WALL),
        ("Szachty", Meaning.HOLE),
        ("EST_COLUMNAS", Meaning.COLUMN),
        ("Tabiquería", Meaning.WALL),
        ("Gros-œuvre", Meaning.WALL),
        ("GROS OEUVRE", Meaning.WALL),
        ("Gaines techniques", Meaning.HOLE),
        ("Tramezzo", Meaning.WALL),
        ("Vedação", Meaning.WALL),
        ("Buitenmuur", Meaning.WALL),
        ("Innerväggar", Meaning.WALL),
        ("Válaszfal", Meaning.WALL),
        ("SHEAR-WALL", Meaning.WALL),
        ("A-WNDW", Meaning.WINDOW),
        ("S-SLAB-OPNG", Meaning.HOLE),
        ("FLOOR-OPENING", Meaning.HOLE),
        ("WALL-OPENING", Meaning.DOOR),
        ("DUCT-SHAFT", Meaning.HOLE),
        ("Structural - Bearing", Meaning.WALL),
        ("PUB_HATCH", Meaning.IGNORE),
        ("Menuiseries ext", Meaning.WINDOW),
        ("Türen und Fenster", Meaning.WINDOW),
        ("Окна и двери", Meaning.WINDOW),
        ("창문", Meaning.WINDOW),
        ("A-FLOR-HRAL", Meaning.EQUIPMENT),
        ("Möblierung", Meaning.IGNORE),
        ("A-WALL-HEAD", Meaning.IGNORE),
        ("A-WALL-ABOV", Meaning.IGNORE),
        ("Stürze", Meaning.IGNORE),
        ("Rolltor", Meaning.DOOR),
        ("Ворота", Meaning.DOOR),
        ("Portões", Meaning.DOOR),
        ("Entwässerungsrinne", Meaning.HOLE),
        ("FOSSES", Meaning.HOLE),
        ("Çukur", Meaning.HOLE),
        ("吊装孔", Meaning.HOLE),
        ("S-OPNG", Meaning.HOLE),
        ("S-SLAB-DEPR", Meaning.HOLE),
        ("EXTWALL", Meaning.WALL),
        ("地面标线", Meaning.IGNORE),
        ("Gevel", Meaning.WALL),
        ("TAMPONAMENTI", Meaning.WALL),
        ("FLOOR JOINTS", Meaning.IGNORE),
        ("伸缩缝", Meaning.IGNORE),
        ("独立基础", Meaning.IGNORE),
        ("设备基础", Meaning.EQUIPMENT),
        ("Gefälle", Meaning.IGNORE),
        ("Estanterías", Meaning.IGNORE),
        ("DWELLING", None),
        ("0", None),
    ],
)
def test_office_names_are_understood(name: str, meaning: Meaning | None) -> None:
    assert layer_table().of_layer(name).meaning is meaning


VOCABULARY = {
    "English": {
        Meaning.WALL: "ExtWalls; STRUCT; WALLLINES; Plasterboard; Partitioning; Structural wall",
        Meaning.WINDOW: "A-WIN; Storefront; Curtain wall",
        Meaning.DOOR: "Doorway; doors-internal",
        Meaning.COLUMN: "Stanchions; STEEL COLUMN",
        Meaning.HOLE: "MANHOLES; Floor drain; Gully; Catch basin; HVAC SHAFT; ELEC PIT",
        Meaning.EQUIPMENT: "PUMP FOUNDATION; EQUIPMENT FOUNDATION; STEPS; Staircase",
        Meaning.IGNORE: "FF&E; smoke detectors; cable tray; GRIDLINES; Callouts; skylight",
    },
    "German": {
        Meaning.WALL: "AW; KS-Mauerwerk; Leichtbauwand neu; Wandkonstruktion; Poche",
        Meaning.DOOR: "Innentüren; Aussentueren; Schiebetür",
        Meaning.HOLE: "Aufzugsschacht; Elektroschacht; Kabelkanal Elektro",
        Meaning.EQUIPMENT: "Maschinenfundamente; Behälter; Treppenhaus",
        Meaning.IGNORE: "Beleuchtung; Vermaßung; Steckdosen; Heizkörper; Raumnamen; Dachüberstand",
        Meaning.ROOM: "Nutzflächen",
    },
    "French": {
        Meaning.WALL: "PLACO; Doublage; CLOISONNEMENT; Parpaings; Murs côté rue",
        Meaning.WINDOW: "Baies; baie vitrée; Châssis",
        Meaning.HOLE: "Réservations plomberie; Avaloir",
        Meaning.EQUIPMENT: "Massifs; Cuves; Garde-corps",
        Meaning.IGNORE: "Meubles; Éclairage; Plomberie; CHAUFFAGE; Cote; Étiquettes",
    },
    "Italian": {
        Meaning.WALL: "tramezzature; TRAMEZZE; SETTI; Cartongesso",
        Meaning.HOLE: "Vuoti; Cavedio impianti; Fori impianti",
        Meaning.EQUIPMENT: "Scale; Serbatoi; Ringhiera",
        Meaning.IGNORE: "ARREDAMENTO; IMPIANTI; Illuminazione; CAMPITURE; Quotature",
        Meaning.ROOM: "Superfici; Ambienti",
    },
    "Spanish": {
        Meaning.WALL: "Pladur; Muro medianera; Tablaroca",
        Meaning.WINDOW: "VENTANERÍA; Cancelería; VANOS",
        Meaning.COLUMN: "EST_CASTILLOS",
        Meaning.HOLE: "Registros; Hueco instalaciones",
        Meaning.EQUIPMENT: "BASES; Tanques; Maquinaria",
        Meaning.IGNORE: "ARQ_AMUEBLADO; Iluminación; ACOTADO; ALERO; Etiquetas",
        Meaning.ROOM: "Superficies; Habitaciones",
    },
    "Catalan": {
        Meaning.WALL: "Parets; Envans",
        Meaning.WINDOW: "Finestres; Fusteria",
        Meaning.HOLE: "Forats",
        Meaning.EQUIPMENT: "Escales; Ascensors",
        Meaning.IGNORE: "Mobles; Enllumenat",
    },
    "Portuguese": {
        Meaning.WALL: "ALVENARIAS; A-PAR; Tijolos; Divisórias móveis",
        Meaning.WINDOW: "Esquadrias; Caixilharia; Vãos",
        Meaning.COLUMN: "Colunas",
        Meaning.HOLE: "Vazios; Shaft elétrico; Caixa de esgoto",
        Meaning.EQUIPMENT: "Tanque; Equipamentos; Degraus",
        Meaning.IGNORE: "MÓVEIS; mobília; louça; Iluminação; Projeção; TELHADO",
    },
    "Polish": {
        Meaning.WALL: "konstrukcja; działowe; ŚCIANY",
        Meaning.WINDOW: "STOLARKA OKIENNA; stolarka; Stolarka okienno-drzwiowa",
        Meaning.DOOR: "STOLARKA DRZWIOWA",
        Meaning.COLUMN: "Słupy; SLUPY",
        Meaning.HOLE: "Szacht wentylacja; Studnie",
        Meaning.EQUIPMENT: "klatka schodowa; Zbiornik; FUNDAMENTY MASZYN; Dźwig",
        Meaning.IGNORE: "WYPOSAŻENIE; Oświetlenie; gniazda; elektryka; KRESKI; teksty",
        Meaning.ROOM: "Powierzchnie",
    },
    "Czech and Slovak": {
        Meaning.WALL: "priečky; Příčka; zdivo",
        Meaning.WINDOW: "okenní výplně",
        Meaning.HOLE: "šachty; Otvory; Vpusti",
        Meaning.EQUIPMENT: "schodiště; schodisko; výtah; Nádrže; Zábradlí",
        Meaning.IGNORE: "Zařizovací předměty; Osvětlení; kóty; popisy; Šrafura",
        Meaning.ROOM: "místnosti",
    },
    "Hungarian": {
        Meaning.WALL: "tartófalak; Falazat",
        Meaning.WINDOW: "Ablakok; nyílászárók",
        Meaning.COLUMN: "pillérek",
        Meaning.HOLE: "akna",
        Meaning.EQUIPMENT: "lépcső; Tartály; Gépek",
        Meaning.IGNORE: "Bútorozás; Világítás; méretek; szöveg; tengelyek",
        Meaning.ROOM: "helyiség",
    },
    "Romanian": {
        Meaning.WALL: "zidărie; Perete; Compartimentări",
        Meaning.WINDOW: "ferestre; Tâmplărie",
        Meaning.DOOR: "uși",
        Meaning.EQUIPMENT: "scări; Rezervoare; Utilaje",
        Meaning.IGNORE: "Iluminat; Prize; Hașură",
    },
    "Croatian, Serbian, Slovene": {
        Meaning.WALL: "pregradni zid; Stene; Zidovi",
        Meaning.WINDOW: "prozori; Stolarija",
        Meaning.DOOR: "Vrata",
        Meaning.COLUMN: "Stubovi; Stebri",
        Meaning.HOLE: "Šahtovi",
        Meaning.EQUIPMENT: "stepenice; stubište; Dizalo; Spremnik; Stroj",
        Meaning.IGNORE: "namještaj; Rasvjeta; kote; natpisi; osi",
        Meaning.ROOM: "Prostorije",
    },
    "Turkish": {
        Meaning.WALL: "BÖLME; TUĞLA; İç Duvarı; duvarları",
        Meaning.WINDOW: "DOĞRAMA; PENCERELER",
        Meaning.DOOR: "Kapı; İç kapı; KAPI; Kapılar; KAPISI",
        Meaning.HOLE: "ŞAFT; Galeri boşluğu; Tesisat şaftı",
        Meaning.EQUIPMENT: "MERDİVEN; merdiven; MERDIVENLER; Asansör; MAKİNE; Makine temeli",
        Meaning.IGNORE: "VİTRİFİYE; AYDINLATMA; tesisat; Yazı; YAZI; TARAMA; Isıtma",
        Meaning.ROOM: "Mahal",
    },
    "Russian and Ukrainian": {
        Meaning.WALL: "Кладка; Ограждающие конструкции; Контур стен; Цегла",
        Meaning.WINDOW: "Витражи; Оконные блоки; Вікна; Оконные проёмы",
        Meaning.DOOR: "Проемы; Дверные проёмы",
        Meaning.HOLE: "Вентшахты; Люки; Проемы в перекрытии",
        Meaning.EQUIPMENT: "Лестничная клетка; Резервуары; Постамент; Сходи",
        Meaning.IGNORE: "Сантех оборудование; Освещение; Отопление; Розетки; Тексты; Карниз",
        Meaning.ROOM: "Площади",
    },
    "Greek": {
        Meaning.WALL: "Τοίχος",
        Meaning.WINDOW: "ΠΑΡΑΘΥΡΑ",
        Meaning.DOOR: "Πόρτες",
        Meaning.COLUMN: "Κολώνες",
        Meaning.EQUIPMENT: "Σκάλες",
        Meaning.IGNORE: "Έπιπλα; Κείμενα",
    },
    "Scandinavian": {
        Meaning.WALL: "Skillevægge; Skillevaegge; Murværk; Mellanväggar; Lettvegger; YV",
        Meaning.DOOR: "Innerdörrar; Ytterdør; Døre",
        Meaning.COLUMN: "Søjler; Soejler; Pelar",
        Meaning.HOLE: "Golvbrunn; Gulvafløb; Sluk; Sjakt",
        Meaning.EQUIPMENT: "Trapper; Trappa; Hiss; Maskiner; Räcke",
        Meaning.IGNORE: "Inredning; Belysning; MÅL; Måttsättning; Tekster; MODULLINIER; VVS",
        Meaning.ROOM: "Rum; Utrymmen",
    },
    "Finnish": {
        Meaning.WALL: "Muuraus; Väliseinät",
        Meaning.WINDOW: "Ikkunat",
        Meaning.COLUMN: "Pylväät",
        Meaning.HOLE: "Kuilut; Lattiakaivot",
        Meaning.EQUIPMENT: "portaat; hissi; Säiliö; Kaiteet",
        Meaning.IGNORE: "Kalusteet; Valaistus; Mitat; tekstit; Sähkö",
        Meaning.ROOM: "Huoneet",
    },
    "Dutch": {
        Meaning.WALL: "Metselwerk",
        Meaning.WINDOW: "kozijnen; Deuren en ramen",
        Meaning.DOOR: "binnendeuren",
        Meaning.HOLE: "Vloerputten; Schachten; Vides",
        Meaning.EQUIPMENT: "Trappenhuis; Liften; Leuningen",
        Meaning.IGNORE: "inrichting; meubels; Sanitair; Verlichting; Maatlijnen; Teksten",
        Meaning.ROOM: "Ruimten",
    },
    "Chinese": {
        Meaning.WALL: "砌体",
        Meaning.HOLE: "电气管井; 雨水口; 井盖; 消防水池",
        Meaning.EQUIPMENT: "储罐; 水箱; 机械",
        Meaning.IGNORE: "插座; 弱电; 采暖; 洞口标注; 卫浴",
        Meaning.ROOM: "面积",
    },
    "Japanese": {
        Meaning.WINDOW: "カーテンウォール",
        Meaning.HOLE: "マンホール; 側溝; 電気ピット",
        Meaning.EQUIPMENT: "機械基礎; タンク; 手すり; スロープ",
        Meaning.IGNORE: "什器; 衛生器具; コンセント; 天井; 屋根",
    },
    "Korean": {
        Meaning.WALL: "조적; 칸막이",
        Meaning.WINDOW: "유리",
        Meaning.HOLE: "맨홀; 집수정; 전기피트",
        Meaning.EQUIPMENT: "엘리베이터; 난간; 기계기초; 탱크",
        Meaning.IGNORE: "조명; 전기; 배관; 천장; 소방",
    },
}


@pytest.mark.parametrize(
    ("meaning", "names"),
    [
        pytest.param(meaning, names, id=f"{language}-{meaning}")
        for language, of_kind in VOCABULARY.items()
        for meaning, names in of_kind.items()
    ],
)
def test_each_language_has_its_words_for_each_kind(meaning: Meaning, names: str) -> None:
    table = layer_table()
    understood = {name: table.of_layer(name).meaning for name in names.split("; ")}
    assert understood == dict.fromkeys(understood, meaning)


@pytest.mark.parametrize(
    "name",
    [
        "MURO LINDERO",
        "Wand Straße",
        "Mur côté jardin",
        "Divisória móvel",
        "MOBILE PARTITION",
        "Muros corte",
        "Wand Schnitt",
        "FOUNDATION WALL",
        "Treppenhaus Wände",
        "Schachtwände",
    ],
)
def test_walls_are_walls_whatever_they_are_named_after(name: str) -> None:
    assert layer_table().of_layer(name).meaning is Meaning.WALL


@pytest.mark.parametrize(
    "name",
    ["Corte A-A", "Schnitt", "канализация", "FENCE", "USA", "Cuisine", "FOUNDATION", "Fundamente"],
)
def test_words_that_may_be_harmless_or_stop_the_robot_say_nothing(name: str) -> None:
    assert layer_table().of_layer(name).meaning is None


@pytest.mark.parametrize(
    ("name", "as_good_as"),
    [
        ("kapı", "KAPI"),
        ("MERDİVEN", "merdiven"),
        ("Słupy", "SLUPY"),
        ("Vægge", "VAEGGE"),
        ("SØJLER", "sojler"),
        ("Gros œuvre", "GROS OEUVRE"),
        ("Mobilie\u0301r", "Mobiliér"),
    ],
)
def test_letters_of_some_languages_are_as_good_as_plain_ones(name: str, as_good_as: str) -> None:
    table = layer_table()
    verdict = table.of_layer(name)
    assert verdict.meaning is not None
    assert verdict == table.of_layer(as_good_as)


@pytest.mark.parametrize(
    "name",
    [
        "FLOOR_MARKING",
        "FLOOR DRAINS",
        "A-FLOR-DRAN",
        "Floor Boxes",
        "Floor-Below",
        "SLAB_EDGE_BELOW",
        "Slab Joints",
        "FLOOR PLAN",
        "FLOOR LEVEL",
        "BODENPLATTE_FUGEN",
        "BODENPLATTE-BEWEHRUNG",
        "FUNDAMENTE_UNTER_BODENPLATTE",
        "Boden_Markierung",
        "PAVIMENTO_GIUNTI",
        "LOSA JUNTAS",
        "Posadzka_dylatacje",
        "VLOER_DILATATIE",
        "ZEMIN DERZ",
        "ПОЛ_УКЛОН",
        "Полы трапы",
        "地面标线",
        "地坪缝",
        "地面分格",
    ],
)
def test_what_is_drawn_on_a_floor_or_in_it_is_not_the_floor(name: str) -> None:
    assert layer_table().of_layer(name).meaning is not Meaning.FLOOR


@pytest.mark.parametrize(
    "name", ["LEVEL 1 FLOOR", "Slab Outline", "S-SLAB-EDGE", "BODENPLATTE", "车间地面", "楼板边线"]
)
def test_the_floor_of_a_storey_and_its_edge_are_the_floor(name: str) -> None:
    assert layer_table().of_layer(name).meaning is Meaning.FLOOR


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("Tür_90", Meaning.DOOR),
        ("$DorLib2D$00000001", Meaning.DOOR),
        ("M_Single-Flush-0915 x 2134mm-1-Level 1", Meaning.DOOR),
        ("$WinLib2D$00000014", Meaning.WINDOW),
        ("DESK-01", Meaning.IGNORE),
        ("Stuhl 3", Meaning.IGNORE),
        ("马桶01", Meaning.IGNORE),
        ("M_Chair-Executive", Meaning.IGNORE),
        ("Pocket_Slider", Meaning.DOOR),
        ("Lift-Car", Meaning.EQUIPMENT),
        ("COL16", Meaning.COLUMN),
        ("Kapı 90", Meaning.DOOR),
        ("Dør 9M", Meaning.DOOR),
        ("Okno O1", Meaning.WINDOW),
        ("Słup 40x40", Meaning.COLUMN),
        ("MERDİVEN-1", Meaning.EQUIPMENT),
        ("*U12", None),
        ("A$C3F1", None),
    ],
)
def test_block_names_are_understood(name: str, meaning: Meaning | None) -> None:
    assert layer_table().of_block(name).meaning is meaning


def test_whole_name_is_surer_than_a_part_of_it() -> None:
    table = layer_table()
    assert table.of_layer("WALL").certainty is Certainty.CERTAIN
    assert table.of_layer("A-WALL-FULL").certainty is Certainty.LIKELY
    assert table.of_layer("XYZ").certainty is Certainty.UNKNOWN


@given(st.text("ab*", max_size=8), st.text("ab", max_size=8))
def test_globs_mean_what_they_mean_elsewhere(pattern: str, name: str) -> None:
    assert is_like(name, pattern) == fnmatchcase(name, pattern)


@pytest.mark.parametrize(
    ("pattern", "name", "fits"),
    [
        ("A*B*", "AXB", True),
        ("A*A", "A", False),
        ("*AB*BC", "ABC", False),
        ("?-COLS", "S-COLS", True),
        ("K[12]*", "K2 new", True),
        ("K[12]*", "K3", False),
        ("S-COLS", "S-COLS", True),
    ],
)
def test_a_glob_fits_a_whole_name(pattern: str, name: str, *, fits: bool) -> None:
    assert is_like(name, pattern) is fits


def test_the_built_in_table_is_a_file_that_a_user_could_give() -> None:
    built_in, twice = layer_table(), layer_table(BUILT_IN)
    assert [replace(rule, given=False) for rule in twice.layers] == 2 * [*built_in.layers]
    assert [replace(rule, given=False) for rule in twice.blocks] == 2 * [*built_in.blocks]


def own(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "office.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_own_patterns_go_before_the_built_in_ones(tmp_path: Path) -> None:
    table = layer_table(own(tmp_path, '[layers]\nignore = ["A-WALL-DEMO"]\n'))
    assert table.of_layer("A-WALL-DEMO").meaning is Meaning.IGNORE
    assert table.of_layer("A-WALL-DEMO").certainty is Certainty.GIVEN
    assert table.of_layer("A-WALL").meaning is Meaning.WALL


def test_own_file_can_take_the_place_of_the_table(tmp_path: Path) -> None:
    table = layer_table(own(tmp_path, 'replace = true\n[layers]\nwall = ["L1"]\n'))
    assert table.of_layer("L1").meaning is Meaning.WALL
    assert table.of_layer("A-WALL").meaning is None


def test_glob_that_shuts_a_letter_out_fits_names_in_other_scripts(tmp_path: Path) -> None:
    table = layer_table(own(tmp_path, '[layers]\nwall = ["L?[!ж]"]\n'))
    assert table.of_layer("L-1").meaning is Meaning.WALL
    assert table.of_layer("L-ж").meaning is None


def test_exception_keeps_a_name_out_of_a_kind(tmp_path: Path) -> None:
    table = layer_table(own(tmp_path, '[layers]\ncolumn = ["K*", "!K9"]\n'))
    assert table.of_layer("K1").meaning is Meaning.COLUMN
    assert table.of_layer("K9").meaning is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[layers]\nwals = ["A"]\n', "unknown kind 'layers.wals'"),
        ('[layers]\nwall = "A"\n', "'layers.wall' is 'A'; give a list"),
        ("colour = 3\n", "unknown key 'colour'"),
        ("replace = 'perhaps'\n", "'replace' is 'perhaps'; give true or false"),
        ("[layers\n", "is not TOML"),
    ],
)
def test_faulty_file_is_refused_with_the_key_at_fault(
    text: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"office\.toml") as caught:
        layer_table(own(tmp_path, text))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.toml"):
        layer_table(tmp_path / "nowhere.toml")


def test_an_exact_name_that_no_layer_has_is_said(tmp_path: Path) -> None:
    document = drawing()
    rectangle(document.modelspace(), 1000, 1000, 2000, 2000, layer="Zeug")
    own = tmp_path / "own.toml"
    own.write_text('[layers]\nwall = ["=Zuge", "=Zeug", "NOBODY*"]\n', encoding="utf-8")
    plan = plan_of(document, tmp_path, layers=own)
    assert {obstacle.kind for obstacle in standing(plan, "Zeug")} == {Kind.WALL}
    (said,) = [finding for finding in plan.findings if finding.code == "layer-unknown"]
    # patterns are for many drawings, of which each has some of the layers
    assert said.message.endswith("a name that the layer file gives: 'Zuge'")
