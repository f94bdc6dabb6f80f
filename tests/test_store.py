"""What a machine remembers: always whole, never from a damaged file, protected by its password."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner

import aircut
from aircut.cli.main import cli
from aircut.machine import MachineError, Tool, load, store
from aircut.machine.memory import PERSISTENT

KILLS = 300


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text("")
    return tmp_path


def command(*words: object, status: int = 0, input: str | None = None) -> str:
    done = CliRunner().invoke(cli, [str(word) for word in words], input=input)
    assert done.exit_code == status, done.output
    return done.output


def program(folder: Path, text: str) -> Path:
    path = folder / "program.ngc"
    path.write_text(text)
    return path


# --- what is kept


def test_a_run_leaves_what_the_decisions_say(folder: Path) -> None:
    """Shared variables, offsets, home positions, G92, the active system, changed tools; nothing else."""
    (folder / "tools.toml").write_text("[[tools]]\nid = 1\nz = 50\n")
    text = """G21 #4000=1.5 #4999=-2 #500=7 #100=8 #1=9
G10 L2 P2 X5 Y6 Z7
#5161=11 #5183=12
G92 X3
G10 L1 P1 Z60
M2
"""
    command("run", program(folder, text), "--machine", folder)
    stored = store.recall(folder)
    assert stored.variables[4000] == 1.5 and stored.variables[4999] == -2.0
    assert [stored.variables[n] for n in (5241, 5242, 5243)] == [5.0, 6.0, 7.0]
    assert stored.variables[5161] == 11.0 and stored.variables[5183] == 12.0
    assert stored.variables[5211] == -3.0 or stored.variables[5211] == 3.0
    assert stored.tools[1].z == 60.0
    assert not {1, 100, 500} & stored.variables.keys()
    assert set(stored.variables) <= set(PERSISTENT)
    machine = load(folder)
    assert machine.tools[1].z == 60.0 and machine.library[1].z == 50.0
    result = aircut.loads("#500=#4000 #501=#5241 #502=#5161 #503=#5410\nM2\n").run(folder)
    assert [result.variables[n] for n in (500, 501, 502)] == [1.5, 5.0, 11.0]


@pytest.mark.parametrize("value", ["#0", "#<math.nan>"])
def test_null_and_nan_are_kept_as_null(folder: Path, value: str) -> None:
    command("machine", "set", folder, "4000=3", "4001=4")
    command("run", program(folder, f"#4000={value}\nM2\n"), "--machine", folder)
    assert 4000 not in store.recall(folder).variables and store.recall(folder).variables[4001] == 4.0
    text = "IF [#4000 EQ #0] THEN #500=1\nM2\n"
    assert aircut.loads(text).run(folder).variables[500] == 1.0


@pytest.mark.parametrize("value", ["1e-300", "0.1", "-5", "123456789.123456789", "1.7976931348623157e308"])
def test_values_are_kept_to_the_last_bit(folder: Path, value: str) -> None:
    command("machine", "set", folder, f"4000={value}")
    assert store.recall(folder).variables[4000].hex() == float(value).hex()
    command("run", program(folder, "M2\n"), "--machine", folder)
    assert store.recall(folder).variables[4000].hex() == float(value).hex()


def test_infinity_is_kept(folder: Path) -> None:
    command("run", program(folder, "#4000=#<math.infinity>\nM2\n"), "--machine", folder)
    assert store.recall(folder).variables[4000] == float("inf")


def test_after_an_error_too(folder: Path) -> None:
    command("run", program(folder, "#4000=5\nG0 K3\n#4000=6\nM2\n"), "--machine", folder, status=1)
    assert store.recall(folder).variables[4000] == 5.0
    command("run", program(folder, '#4000=7\nM109 P"no" Q-1\nM2\n'), "--machine", folder, status=1)
    assert store.recall(folder).variables[4000] == 7.0


def test_an_output_that_cannot_be_written_loses_nothing(folder: Path) -> None:
    out = folder / "none" / "out.json"
    path = program(folder, "#4000=5\nM2\n")
    command("run", path, "--machine", folder, "--format", "json", "-o", out, status=1)
    assert not out.exists()


def test_input_and_protected_tables_are_a_run_s_own_copies(folder: Path) -> None:
    command("machine", "password", folder, "--new", "secret")
    command("machine", "set", folder, "100=1", "6000=2", "--password", "secret")
    path = program(folder, "#500=[#100+#6000] #100=50\n#4000=#500\nM2\n")
    command("run", path, "--machine", folder)
    assert command("machine", "show", folder, "100", "4000", "6000-6999") == "100=1.0\n4000=3.0\n6000=2.0\n"


def test_programs_cannot_write_protected_variables(folder: Path) -> None:
    out = command("run", program(folder, "#6000=1\nM2\n"), "--machine", folder, status=1)
    assert "read-only" in out and "#6000 cannot be assigned: Protected variables" in out
    for text in ("#[6000]=1", "#1=6999\n##1=1"):
        (diagnostic,) = aircut.loads(f"{text}\nM2\n").run(folder).diagnostics
        assert diagnostic.code == "read-only"


# --- the password


def test_the_password(folder: Path) -> None:
    assert "none is set: aircut machine password" in command("machine", "set", folder, "6000=1", status=1)
    command("machine", "password", folder, input="first\nfirst\n")
    assert "wrong password" in command("machine", "set", folder, "6000=1", "--password", "second", status=1)
    assert "wrong password" in command("machine", "set", folder, "6000=1", input="nonsense\n", status=1)
    command("machine", "set", folder, "6000=1", input="first\n")
    command("machine", "set", folder, "4000=1")  # needs none
    assert "wrong password" in command("machine", "password", folder, "--new", "x", "--password", "x", status=1)
    command("machine", "password", folder, "--new", "second", "--password", "first")
    assert "wrong password" in command("machine", "set", folder, "6000=2", "--password", "first", status=1)
    assert store.recall(folder).variables[6000] == 1.0
    command("machine", "set", folder, "6000=null", "--password", "second")
    assert 6000 not in store.recall(folder).variables


def test_only_a_hash_of_the_password_is_kept(folder: Path) -> None:
    store.set_password(folder, "correct horse")
    data = (folder / store.FILE).read_bytes()
    assert b"correct" not in data
    first = store.recall(folder).password
    store.set_password(folder, "correct horse", "correct horse")
    second = store.recall(folder).password
    assert first and second and first.salt != second.salt and first.hash != second.hash


def test_a_run_keeps_the_password(folder: Path) -> None:
    store.set_password(folder, "secret")
    command("run", program(folder, "#4000=1\nM2\n"), "--machine", folder)
    with pytest.raises(MachineError, match="wrong password"):
        store.change(folder, {6000: 1.0}, "x")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["500=1"], "variable 500 does not outlive a run"),
        (["7000=1"], "variable 7000"),
        (["4000=inf"], "finite"),
        (["4000=nan"], "finite"),
        (["4000"], "NUMBER=VALUE"),
        (["4000="], "NUMBER=VALUE"),
        (["x=1"], "NUMBER=VALUE"),
        (["4000=1", "500=1"], "variable 500"),
    ],
)
def test_what_cannot_be_set(folder: Path, words: list[str], reason: str) -> None:
    done = CliRunner().invoke(cli, ["machine", "set", str(folder), *words])
    assert done.exit_code in (1, 2) and reason in done.output
    assert store.recall(folder).variables == {}


# --- killed at any moment


def state(number: int) -> tuple[dict[int, float], dict[int, Tool]]:
    """A whole state: all that it holds tells its number."""
    return {n: float(number) for n in PERSISTENT}, {i: Tool(i, z=float(number)) for i in range(1, 20)}


def number_of(folder: Path) -> int:
    """The number of the state that is stored; it must be a whole one."""
    stored = store.recall(folder)
    numbers = set(stored.variables.values()) | {tool.z for tool in stored.tools.values()}
    assert len(numbers) <= 1, "a half-written state"
    if not numbers:
        return 0
    assert len(stored.variables) == len(PERSISTENT) and len(stored.tools) == 19
    return int(numbers.pop())


def write_for_ever(folder: Path, first: int, done: int) -> None:
    while True:
        store.remember(folder, *state(first))
        os.write(done, b".")
        first += 1


def test_killing_the_process_leaves_a_whole_state(folder: Path) -> None:
    """Each child writes one state after another until it is killed; what is read is the last or the one after."""
    choose = random.Random(1)
    number = half_way = 0
    start = time.perf_counter()
    store.remember(folder, *state(0))
    once = time.perf_counter() - start
    for _ in range(KILLS):
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            try:
                write_for_ever(folder, number + 1, writing)
            finally:
                os._exit(1)
        os.close(writing)
        told = len(os.read(reading, 1))  # however busy the machine is, the child has begun
        time.sleep(choose.uniform(0.0, 2.5 * once))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        told += len(os.read(reading, 1 << 16))
        os.close(reading)
        half_way += (folder / "state.db-journal").exists()
        found = number_of(folder)
        assert number + told <= found <= number + told + 1
        number = found
    assert number > 0 and half_way > 0, "no child was killed while it wrote"


def test_killing_a_run_leaves_a_whole_state(folder: Path) -> None:
    lines = "".join(f"#{n}=[#{n}+1]\n" for n in range(4000, 4100))
    store.change(folder, dict.fromkeys(range(4000, 4100), 0.0))
    path = program(folder, f"{lines}M2\n")
    choose = random.Random(2)
    for _ in range(12):
        child = subprocess.Popen(
            [sys.executable, "-m", "aircut", "run", path, "--machine", folder],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        time.sleep(choose.uniform(0.1, 0.5))
        child.kill()
        child.wait()
        stored = store.recall(folder).variables
        assert len({stored[n] for n in range(4000, 4100)}) == 1


def test_two_processes_take_turns(folder: Path) -> None:
    children = []
    for first in (1, 2):
        child = os.fork()
        if child == 0:
            try:
                for n in range(25):
                    store.change(folder, {4000 + first: float(n)})
                os._exit(0)
            finally:
                os._exit(1)
        children.append(child)
    assert [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children] == [0, 0]
    assert store.recall(folder).variables == {4001: 24.0, 4002: 24.0}


# --- damage


def test_an_empty_file_is_an_empty_memory(folder: Path) -> None:
    (folder / store.FILE).write_bytes(b"")
    assert store.recall(folder) == store.Stored({}, {})
    store.change(folder, {4000: 1.0})
    assert store.recall(folder).variables == {4000: 1.0}


def refused(folder: Path) -> None:
    """No command reads or changes a damaged memory."""
    before = (folder / store.FILE).read_bytes()
    path = program(folder, "#4000=9\nM2\n")
    for words in (("run", path, "--machine", folder), ("check", path, "--machine", folder),
                  ("machine", "set", folder, "4000=9"), ("machine", "show", folder)):  # fmt: skip
        done = CliRunner().invoke(cli, [str(word) for word in words])
        assert done.exit_code in (1, 2) and store.FILE in done.output and "Traceback" not in done.output
    for write in (lambda: store.remember(folder, {4000: 9.0}, {}), lambda: store.change(folder, {4000: 9.0})):
        with pytest.raises(MachineError, match=r"state\.db"):
            write()
    assert (folder / store.FILE).read_bytes() == before


@pytest.mark.parametrize("damage", ["text", "head", "cut", "foreign", "newer", "value", "tool", "kind"])
def test_a_damaged_memory_is_told_and_left_alone(folder: Path, damage: str) -> None:
    import sqlite3

    store.remember(folder, *state(5))
    path = folder / store.FILE
    data = path.read_bytes()
    if damage == "text":
        path.write_text("what is this")
    elif damage == "head":
        path.write_bytes(b"X" + data[1:])
    elif damage == "cut":
        path.write_bytes(data[: len(data) // 2])
    else:
        if damage == "foreign":
            path.unlink()
        statements = {
            "foreign": "CREATE TABLE songs (name TEXT)",
            "newer": f"PRAGMA user_version = {store.VERSION + 1}",
            "value": "UPDATE variables SET value = 5.5 WHERE number = 4000",
            "tool": "UPDATE tools SET tool = '{' WHERE id = 3",
            "kind": "UPDATE variables SET value = 'x' WHERE number = 4000",
        }
        database = sqlite3.connect(path)
        database.execute(statements[damage])
        database.commit()
        database.close()
    refused(folder)


def test_any_damaged_byte_is_found(folder: Path) -> None:
    """A byte changed anywhere: the memory is refused, or it is read as it was."""
    store.remember(folder, *state(5))
    path = folder / store.FILE
    data = path.read_bytes()
    whole = store.recall(folder)
    choose = random.Random(3)
    refusals = 0
    for _ in range(300):
        at = choose.randrange(len(data))
        path.write_bytes(data[:at] + bytes([data[at] ^ (1 << choose.randrange(8))]) + data[at + 1 :])
        try:
            assert store.recall(folder) == whole
        except MachineError:
            refusals += 1
    assert refusals > 50


def test_a_memory_from_before_the_digest_is_read(folder: Path) -> None:
    import sqlite3

    database = sqlite3.connect(folder / store.FILE)
    database.execute("CREATE TABLE variables (number INTEGER PRIMARY KEY, value REAL NOT NULL)")
    database.execute("CREATE TABLE tools (id INTEGER PRIMARY KEY, tool TEXT NOT NULL)")
    database.execute("INSERT INTO variables VALUES (4000, 3.0)")
    database.execute("INSERT INTO tools VALUES (2, ?)", (msgspec.json.encode(Tool(2, z=4.0)).decode(),))
    database.commit()
    database.close()
    assert store.recall(folder).variables == {4000: 3.0} and store.recall(folder).tools[2].z == 4.0
    store.change(folder, {4001: 1.0})
    assert store.recall(folder).variables == {4000: 3.0, 4001: 1.0} and store.recall(folder).tools[2].z == 4.0
