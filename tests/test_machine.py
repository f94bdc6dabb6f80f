"""A machine is what its machine.toml says, and programs read it by predefined names."""

import re
import tomllib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

import aircut
from aircut.interpreter.named import NAMED
from aircut.machine import Axis, MachineError, built_in, load
from aircut.machine.config import AXES, AXIS_TYPES, KINEMATICS, File, load_tools

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "machine.md"
ROW = {row.name: row for row in NAMED}


def read(folder: Path, toml: str, names: list[str], before: str = "") -> list[float | None]:
    """Values of predefined names as a program reads them on the machine that the text describes."""
    (folder / "machine.toml").write_text(toml, "utf-8")
    program = before + "".join(f"#{500 + i} = #<{name}>\n" for i, name in enumerate(names)) + "M2\n"
    result = aircut.loads(program).run(load(folder))
    assert result.diagnostics == []
    return [result.variables.get(500 + i) for i in range(len(names))]


def refusal(folder: Path, toml: str) -> str:
    """What is said of a machine.toml that cannot be used."""
    (folder / "machine.toml").write_text(toml, "utf-8")
    with pytest.raises(MachineError) as caught:
        load(folder)
    path, _, text = str(caught.value).partition(": ")
    assert path == str(folder / "machine.toml")
    return text


# --- values that programs read


@pytest.mark.parametrize("letter", "XYZABCUVW")
@pytest.mark.parametrize("units", ["G20", "G21"])
def test_axis_values_are_as_configured_in_any_units(tmp_path: Path, letter: str, units: str) -> None:
    """AMB-VAR-4, AMB-NAM-12: mm or degrees, whatever the units in force."""
    toml = f"""
        [axes.{letter}]
        type = "gantry_2"
        min = -12.5
        max = 0.25
        velocity = 3000
        acceleration = 750.5
    """
    names = [f"cnc.{letter.lower()}.{name}" for name in ("type", "min_lim", "max_lim", "max_vel", "acc")]
    assert read(tmp_path, toml, names, before=units + "\n") == [6.0, -12.5, 0.25, 3000.0, 750.5]


@pytest.mark.parametrize("letter", "abc")
def test_values_of_rotary_axes(tmp_path: Path, letter: str) -> None:
    toml = f"""
        [axes.{letter}]
        type = "rotary_head"
        min = -90
        max = 110
        motion_mode = "indexing"
        convention = "inverse"
        wrapped_rotary = true
        parallel_to = "Z"
        origin_mode = 7
        origin_x = 1.5
        origin_y = -2.5
        origin_z = 3.5
    """
    told = ("type", "min_lim", "max_lim", "motion_mode", "convention", "wrapped_rotary", "parallel_to",
            "origin_mode", "origin_x", "origin_y", "origin_z")  # fmt: skip
    values = read(tmp_path, toml, [f"cnc.{letter}.{name}" for name in told], before="G20\n")
    assert values == [3.0, -90.0, 110.0, 1.0, 1.0, 1.0, 2.0, 7.0, 1.5, -2.5, 3.5]


@pytest.mark.parametrize("letter", "abc")
def test_a_disabled_axis_reads_as_zeros_whatever_it_is_configured_as(tmp_path: Path, letter: str) -> None:
    """AMB-VAR-17."""
    toml = f"""
        [axes.{letter}]
        type = "disabled"
        max = 7
        motion_mode = "indexing"
        convention = "inverse"
        wrapped_rotary = true
        parallel_to = "Z"
        origin_mode = 2
        origin_x = 1
    """
    names = [name for name in ROW if name.startswith(f"cnc.{letter}.")]
    assert len(names) == 13
    assert read(tmp_path, toml, names) == [0.0] * 13


@pytest.mark.parametrize("kind", AXIS_TYPES)
def test_axis_types_equal_their_constants(tmp_path: Path, kind: str) -> None:
    kinds = read(tmp_path, f'[axes.B]\ntype = "{kind}"\n', ["cnc.b.type", f"axis.type.{kind}"])
    assert kinds[0] == kinds[1] is not None


@pytest.mark.parametrize("mode", range(1, 10))
def test_origin_modes_are_work_systems(tmp_path: Path, mode: int) -> None:
    assert read(tmp_path, f"[axes.C]\norigin_mode = {mode}\n", ["cnc.c.origin_mode"]) == [float(mode)]


@pytest.mark.parametrize(("axis", "number"), [("X", 0.0), ("Y", 1.0), ("Z", 2.0)])
def test_a_rotary_axis_is_parallel_to_a_linear_one(tmp_path: Path, axis: str, number: float) -> None:
    assert read(tmp_path, f'[axes.B]\nparallel_to = "{axis}"\n', ["cnc.b.parallel_to"]) == [number]


@pytest.mark.parametrize(("number", "model"), list(enumerate(KINEMATICS)))
def test_kinematics_models_equal_their_constants(tmp_path: Path, number: int, model: str) -> None:
    """Source: 004 section 2.2.3, numbers 0 to 5."""
    toml = f'kinematics = "{model}"\n[axes.A]\n[axes.B]\n[axes.C]\n'
    values = read(tmp_path, toml, ["cnc.kinematics_model", f"kinematics.model.{model}"])
    assert values == [number, number]


def test_machine_spindle_and_offsets(tmp_path: Path) -> None:
    toml = """
        type = "mill"
        [spindle]
        max_speed = 18000
        [rotary_table]
        d_x = 1.5
        d_y = -2.5
        d_z = 3.5
        [tilting_spindle]
        h_x = 4.5
        h_y = -5.5
        h_z = 6.5
        j_x = 7.5
        j_y = -8.5
        j_z = 9.5
    """
    names = ["machine_type", "spindle.max_speed", *(f"rotary_table.d_{a}" for a in "xyz")]
    names += [f"tilting_spindle.{arm}_{a}" for arm in "hj" for a in "xyz"]
    values = read(tmp_path, toml, [f"cnc.{name}" for name in names], before="G20\n")
    assert values == [0.0, 18000.0, 1.5, -2.5, 3.5, 4.5, -5.5, 6.5, 7.5, -8.5, 9.5]


def test_what_the_controller_says_of_itself(tmp_path: Path) -> None:
    """The older document's controller: 0.3.6.17, interface level 8 (AMB-NAM-13)."""
    toml = "[system]\nversion = [0, 3, 6, 17]\ncustomer = 4\ninterface_level = 8\n[options]\nunits = 20\n"
    names = [f"sys.version.{part}" for part in ("major", "minor", "release", "build")]
    names += ["sys.customer_id", "sys.interface_level", "sys.ui.units_mode"]
    assert read(tmp_path, toml, names) == [0.0, 3.0, 6.0, 17.0, 4.0, 8.0, 20.0]


def test_a_run_compiles_the_program(tmp_path: Path) -> None:
    names = ["cnc.compile.mode", "compile.mode_program", "cnc.compile.line"]
    assert read(tmp_path, "", names) == [2.0, 2.0, 0.0]


def test_compile_mode_and_line_are_the_state_s() -> None:
    state: Any = SimpleNamespace(compile_mode=5, compile_line=17)
    assert ROW["cnc.compile.mode"].read(state) == 5.0
    assert ROW["cnc.compile.line"].read(state) == 17.0


def test_predefined_names_stand_once_and_read_as_numbers() -> None:
    assert len(ROW) == len(NAMED)
    result = aircut.loads("M2\n").run(built_in("XYZABC"))
    values = [row.read(result._interpreter.state) for row in NAMED]
    assert all(value is None or type(value) is float for value in values)


# --- the machine


def test_without_a_word_it_is_the_machine_of_the_reference_page(tmp_path: Path) -> None:
    """The page's defaults are the defaults, and the page tells every field."""
    block = re.search(r"```toml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert block is not None
    told = tomllib.loads(block[1])
    (tmp_path / "machine.toml").write_text("[axes.X]\n[axes.A]\n")
    machine = load(tmp_path)
    x, a = (msgspec.to_builtins(machine.axes[letter]) for letter in "xa")
    assert told["axes"]["X"].items() <= x.items() and told["axes"]["A"].items() <= a.items()
    assert told["axes"]["X"].keys() | told["axes"]["A"].keys() == x.keys() == a.keys()
    plain = {name: value for name, value in told.items() if name != "axes"}
    assert msgspec.convert(plain, File) == File()
    every = msgspec.to_builtins(File())
    assert told.keys() == every.keys()
    for name, value in plain.items():
        assert not isinstance(value, dict) or value.keys() == every[name].keys()


def test_an_empty_file_is_the_built_in_machine(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text("")
    machine, built = load(tmp_path), built_in()
    assert machine.axes == built.axes and machine.letters == "xyz"
    assert machine.options == built.options


def test_axes_left_open_follow_from_their_letter(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text("[axes.x]\n[axes.A]\n[axes.B]\n[axes.C]\n")
    machine, built = load(tmp_path), built_in("XABC")
    assert machine.axes == built.axes
    assert [machine.axes[a].parallel_to for a in "abc"] == ["X", "Y", "Z"]
    assert [machine.axes[a].rotary for a in "xabc"] == [False, True, True, True]
    assert machine.axes["a"].max == 1e9


def test_u_v_and_w_are_no_programmable_axes(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text("[axes.U]\n[axes.V]\n[axes.W]\n")
    machine = load(tmp_path)
    assert machine.letters == "xyz" and set(machine.axes) <= set(AXES)
    assert set(machine.auxiliary) == set("uvw")


def test_disabled_axes_have_no_letter(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text('[axes.X]\n[axes.Y]\ntype = "disabled"\n[axes.Z]\n')
    assert load(tmp_path).letters == "xz"


def test_options_are_read(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text("""
        [options]
        tool_change = "macro"
        pallet_shuttle = true
        m66_read_back = false
        inputs = 4
        outputs = 5
        analog_inputs = 0
        analog_outputs = 1
        peck_retract = 0.5
        entry = "easy"
    """)
    options = load(tmp_path).options
    assert (options.tool_change, options.pallet_shuttle, options.m66_read_back) == ("macro", True, False)
    assert (options.inputs, options.outputs, options.analog_inputs, options.analog_outputs) == (4, 5, 0, 1)
    assert (options.peck_retract, options.entry) == (0.5, "easy")


# --- what is refused

REFUSED = {
    "color = 3": "unknown field `color`",
    "[axes.X]\nspeed = 3": "axes.X: Object contains unknown field `speed`",
    "[options]\nentri = 'nist'": "options: Object contains unknown field `entri`",
    "[spindle]\nmin_speed = 3": "spindle: Object contains unknown field `min_speed`",
    "[rotary_table]\nh_x = 3": "rotary_table: Object contains unknown field `h_x`",
    "[system]\nname = 3": "system: Object contains unknown field `name`",
    "axes = 3": "axes: write a table for each axis",
    "[axes]\nX = 3": "axes.X: write a table",
    "[axes.Q]": "axes.Q: axes are X, Y, Z, A, B, C, U, V, W",
    "[axes.XY]": "axes.XY: axes are",
    "[axes.x]\n[axes.X]": "axes.X: the axis stands twice",
    "[axes.X]\nmin = 5": None,
    "[axes.X]\nmin = 5\nmax = 5": "axes.X: min must be less than max, not 5 and 5",
    "[axes.X]\nmin = 5\nmax = -5": "axes.X: min must be less than max, not 5 and -5",
    "[axes.B]\nmax = -1e9": "axes.B: min must be less than max",
    "[axes.X]\nmin = nan": "axes.X.min: Expected a finite number",
    "[axes.X]\nmax = inf": "axes.X.max: Expected a finite number",
    "[axes.X]\nmin = -inf": "axes.X.min: Expected a finite number",
    "[axes.X]\nmin = true": "axes.X.min: Expected `float`, got `bool`",
    f"[axes.X]\nmax = 1{'0' * 400}": "axes.X.max: Number out of range",
    "[axes.X]\nvelocity = 0": "axes.X.velocity: Expected `float` > 0.0",
    "[axes.X]\nvelocity = -1": "axes.X.velocity: Expected `float` > 0.0",
    "[axes.X]\nvelocity = inf": "axes.X.velocity: Expected a finite number",
    "[axes.X]\nvelocity = nan": "axes.X.velocity: Expected `float` > 0.0",
    "[axes.X]\nacceleration = 0": "axes.X.acceleration: Expected `float` > 0.0",
    "[axes.X]\njerk = 0": None,
    "[axes.X]\njerk = -1": "axes.X.jerk: Expected `float` >= 0.0",
    "[axes.X]\ntype = 'rotary'": "axes.X.type: 'rotary' is not one of disabled, linear, rotary_free",
    "[axes.X]\ntype = 3": "axes.X.type: Expected `str`, got `int`",
    "[axes.Z]\ntype = 'rotary_free'": "axes.Z.type cannot be rotary_free: X, Y and Z are linear",
    "[axes.U]\ntype = 'rotary_free'": None,
    "[axes.A]\ntype = 'linear'": None,
    "[axes.A]\nmotion_mode = 'indexer'": "axes.A.motion_mode: 'indexer' is not one of continuous, indexing",
    "[axes.A]\nconvention = 1": "axes.A.convention: Expected `str`, got `int`",
    "[axes.A]\nwrapped_rotary = 1": "axes.A.wrapped_rotary: Expected `bool`, got `int`",
    "[axes.A]\nparallel_to = 'A'": "axes.A.parallel_to: 'A' is not one of X, Y, Z",
    "[axes.A]\norigin_mode = 0": "axes.A.origin_mode: 0 is not one of custom, 1, 2, 3, 4, 5, 6, 7, 8, 9",
    "[axes.A]\norigin_mode = 10": "axes.A.origin_mode: 10 is not one of custom, 1",
    "[axes.A]\norigin_mode = 'G54'": "axes.A.origin_mode: 'G54' is not one of custom, 1",
    "[axes.A]\norigin_z = nan": "axes.A.origin_z: Expected a finite number",
    "type = 'lathe'": "type: 'lathe' is not one of mill",
    "kinematics = 'puma'": "kinematics: 'puma' is not one of trivial, independent_rot_axes",
    "kinematics = 'rotary_table_ac'": "kinematics: rotary_table_ac needs rotary axes A and C",
    "kinematics = 'rotary_table_bc'\n[axes.A]\n[axes.C]": "kinematics: rotary_table_bc needs rotary axes B and C",
    "kinematics = 'tilting_spindle_ca'\n[axes.A]\ntype = 'linear'\n[axes.C]": "needs rotary axes C and A",
    "kinematics = 'tilting_spindle_ab'\n[axes.A]\n[axes.B]": None,
    "kinematics = 'independent_rot_axes'": None,
    "[spindle]\nmax_speed = 0": "spindle.max_speed: Expected `float` > 0.0",
    "[spindle]\nmax_speed = inf": "spindle.max_speed: Expected a finite number",
    "[rotary_table]\nd_y = inf": "rotary_table.d_y: Expected a finite number",
    "[tilting_spindle]\nj_x = nan": "tilting_spindle.j_x: Expected a finite number",
    "options = 3": "options: Expected `object`, got `int`",
    "[options]\nunits = 22": "options.units: 22 is not one of 20, 21",
    "[options]\ndefault_feed = 0": "options.default_feed: Expected `float` > 0.0",
    "[options]\nentry = 'auto'": "options.entry: 'auto' is not one of nist, easy, normal",
    "[options]\ntool_change = 'manual'": "options.tool_change: 'manual' is not one of internal, macro",
    "[options]\npallet_shuttle = 'yes'": "options.pallet_shuttle: Expected `bool`, got `str`",
    "[options]\ninputs = -1": "options.inputs: Expected `int` >= 0",
    "[options]\noutputs = 2.5": "options.outputs: Expected `int`, got `float`",
    "[options]\nanalog_inputs = 0": None,
    "[options]\npeck_retract = 0": "options.peck_retract: Expected `float` > 0.0",
    "[system]\nversion = [1, 2]": "system.version: Expected `array` of length 4, got 2",
    "[system]\nversion = [1, 2, 3, -4]": "system.version[3]: Expected `int` >= 0",
    "name = ": "Invalid value (at end of document)",
}


@pytest.mark.parametrize("toml", REFUSED, ids=lambda toml: toml[:50].replace("\n", " "))
def test_values_that_do_not_fit_are_refused_by_name(tmp_path: Path, toml: str) -> None:
    reason = REFUSED[toml]
    if reason is None:
        (tmp_path / "machine.toml").write_text(toml)
        load(tmp_path)
    else:
        assert reason in refusal(tmp_path, toml)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_bytes(b"name = '\xff'\n")
    with pytest.raises(MachineError, match=r"machine\.toml"):
        load(tmp_path)


def test_a_folder_without_a_machine_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MachineError, match=r"machine\.toml: No such file"):
        load(tmp_path)


@pytest.mark.parametrize("axes", ["", "XX", "XU", "Q"])
def test_axes_of_the_built_in_machine_are_programmable_ones(axes: str) -> None:
    with pytest.raises(MachineError, match="give some of XYZABC"):
        built_in(axes)


def test_an_axis_made_by_hand_is_checked_too() -> None:
    with pytest.raises(ValueError, match="min must be less than max"):
        Axis(min=1.0, max=0.0)


@pytest.mark.parametrize("field", ["x", "z", "diameter", "p3"])
@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
def test_tools_are_finite(tmp_path: Path, field: str, value: str) -> None:
    path = tmp_path / "tools.toml"
    path.write_text(f"[[tools]]\nid = 3\n{field} = {value}\n")
    with pytest.raises(MachineError, match=rf"tools\.toml: tool 3: {field} must be a finite number"):
        load_tools(path)
