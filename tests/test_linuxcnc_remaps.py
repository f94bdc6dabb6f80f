"""Codes that an INI file remaps to subroutines, as LinuxCNC's `rs274 -i` runs them."""

import random
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import aircut
import oracle
import oracle_linuxcnc
from aircut import dialects
from aircut.cli.main import cli
from aircut.diagnostics import Severity
from aircut.machine import MachineError, inifile

needs_oracle = pytest.mark.skipif(oracle.PROGRAM is None, reason="rs274 (linuxcnc-uspace) is not installed")
FILES = {
    "show": "(debug,1=#1 2=#2 p=#<p> q=#<q> x=#<x> level=#<_remap_level> calls=#<_call_level>)\no<show> endsub [5]",
    "move": "(debug,move x=#<x> y=#<y> z=#<z> p=#<p>)\nG0 X#<x>\no<move> endsub",
    "still": "(debug,x=#<x> y=#<y> mode=#<_motion_mode>)\no<still> endsub",
    "change": "(debug,level=#<_remap_level> selected=#<_selected_tool>)\nM6\n(debug,after)\no<change> endsub",
    "back": "o<back> return [-1]\no<back> endsub",
    "nest": "(debug,#<_remap_level>)\nM400 P7\no<nest> endsub",
    "self": "(debug,#<_remap_level>)\nM410\no<self> endsub",
    "fails": "G1 X1\no<fails> endsub",
    "rates": "(debug,f=#<f> s=#<s> feed=#<_feed> rpm=#<_rpm>)\no<rates> endsub",
    "stops": "(debug,e)\nM2\no<stops> endsub",
    "asks": "o100 if [exists[#<q>]]\n(debug,q)\no100 endif\no<asks> endsub",
    "line": "(debug,n=#<n>)\no<line> endsub",
    "local": "M70\nG91\no<local> endsub",
    "tool": "(debug,#<t> #<_selected_tool>)\nT#<t>\n(debug,after)\no<tool> endsub",
    "speed": "(debug,#<s> #<_rpm>)\nS[#<s>*2]\no<speed> endsub",
    "feed": "(debug,#<f> #<_feed>)\nF[#<f>*2]\no<feed> endsub",
    "pause": "(debug,pause)\nM0\no<pause> endsub",
    "output": "(debug,#<p>)\nM62 P#<p>\no<output> endsub",
    "bare": "M62\no<bare> endsub",
    "probe": "G38.3 Z-5 F10\n(debug,#5063 #5070)\nM66 P0 L0\no<probe> endsub [#5063]",
    "loop": "o1 while [#9 lt 3]\n#9=[#9+1]\nG1 X#9 F100\nM66 P0 L0\no1 endwhile\no<loop> endsub [#9]",
}
CODES = """M400 modalgroup=10 argspec=Pq ngc=show
M401 modalgroup=10 ngc=show
M402 modalgroup=10 argspec=@pq ngc=show
M403 ngc=back modalgroup=10
M404 ngc=nest
M405 modalgroup=5 ngc=show
M406 modalgroup=10 ngc=fails
M407 modalgroup=10 argspec=fs ngc=rates
M408 modalgroup=10 ngc=stops
M409 modalgroup=10 argspec=q ngc=asks
M410 modalgroup=10 ngc=self
M411 modalgroup=10 argspec=@qPx ngc=show
M412 argspec=> ngc=show
M413 argspec=^ ngc=show
M414 argspec=n ngc=line
M415 modalgroup=4 ngc=show
M416 modalgroup=6 ngc=show
M417 modalgroup=7 ngc=show
M418 modalgroup=8 ngc=show
M419 modalgroup=9 ngc=show
M420 argspec=P ngc=local
M421 ngc=probe
M422 ngc=loop
M999 NGC=show  # a comment
M0025 ngc=show bogus=1
G88.1 modalgroup=1 argspec=XYZp ngc=move
g88.2 argspec=xyzp ngc=move
G0.5 modalgroup=1 argspec=xyzp ngc=move
G88.3 modalgroup=1 argspec=xyzp ngc=still
M6 modalgroup=6 ngc=change
M61 modalgroup=6 argspec=Q ngc=show
M0 modalgroup=4 ngc=pause
M9 modalgroup=8 ngc=show
M62 modalgroup=5 argspec=P ngc=output
M63 modalgroup=5 ngc=bare"""
WORDS = """T argspec=T ngc=tool
S argspec=S ngc=speed
F argspec=F ngc=feed
M6 modalgroup=6 ngc=change"""
PROGRAMS = """M400 P3
M400
G0 / M400 P3 X1
M400 P3 Q4 X1
M401 / M401 P1 K5 H3 D2 E1
M402 P1 Q2 / M402 Q2 P1 / M402 Q2
M403 / (debug,a #<_value>)
M404 / M405 / M999 / M25 P1
M406
M407 F10 S20 / M407
M408 / (debug,x)
M409 / M409 Q1
M410 / (debug,z)
M411 P1 / M411 Q2
M412
F5 M412
M413
S5 M413
N55 M414 / M414
G20 M415 M8 M5 S1 F1 M49 G4 P1
G20 M416 M8 M5 S1 F1 M49 G4 P1 T1
G20 M417 M8 S1 F1 M49 G4 P1
G20 M417 M3
G20 M418 M5 S1 F1 M49 G4 P1
G20 M418 M8
G20 M419 M8 M5 S1 F1 G4 P1
M419 M48
M420 P1 / (debug,#<_absolute>)
M421 M8 G0 X2 / (debug,#<_value>)
M422 / M422 / o1 repeat [5] / M422 / G1 X5 / o1 endrepeat
G88.1 X1 Y2 Z3 / X4
G88.1 X1
G88.2 X1 / X5
G91 G20 / G88.1 X1 Y2 Z3 K5 A7
G0.5 X2
G88.3 X1 / X5
G0 X1 / G88.3 X1 / X5 / (debug,#<_motion_mode>)
g88.1 x1 y2 z3 m400 p5
T1 M6 / G0 X1
M6 / T2 M6 / M61 Q2
M0 / M0 G0 X1
M9 M8
M62 P1 G0 X3
M63
M400 P1 M401
M400 P1 G0 X5
G0 X5 M400 P1 F20 S3 M8 G20
M400 P2 (hello) / (debug,#<_value>)
o1 sub / M400 P#1 / o1 endsub / o1 call [3]
o1 sub / G88.1 X1 Y2 Z3 / G91 / o1 endsub / o1 call / X5
F10 G41.1 D2 G1 X3 Y3 / X10 / M400 P1 / X20 / G40 X30
G1 X1 F10 / M400 P2 X5
M300 / M2"""
WORDED = """T1
S5 M3
F10 G1 X1
F10 S5 T1 M6 M0 G1 X1
F10 G93 G1 X1
o1 while [#1 lt 3] / #1=[#1+1] / F[10*#1] G1 X#1 / o1 endwhile
F10 G1 X1 / X2 F20 / X3 / X4 F30 / X5 / X6 / X7
S-1
F-1
T-1
G81 X1 Z-1 R1 F10 / X3 F20
M6 T2"""


def compare(folder: Path, remaps: str, program: str) -> str:
    """How the two differ."""
    for name, text in FILES.items():
        (folder / f"{name}.ngc").write_text(f"o<{name}> sub\n{text}\nM2\n")
    ini = folder / "machine.ini"
    lines = "".join(f"REMAP={line}\n" for line in remaps.splitlines())
    ini.write_text(f"[RS274NGC]\nSUBROUTINE_PATH={folder}\n{lines}")
    answer = oracle.answer(program, folder, ["-i", str(ini)])
    machine = dialects.machine(dialects.load("linuxcnc"))
    machine.ini = inifile.load(ini)
    machine.macros = (*machine.ini.folders, *machine.macros)
    result = aircut.loads(program, "linuxcnc").run(machine=machine)
    told = "".join(result.canon()).splitlines()
    difference = oracle.differ(told, [line for line in answer.listing if line != "executing"])
    if not difference and result.ok != answer.accepted:
        difference = f"{result.diagnostics} {answer.message}"
    return difference


@needs_oracle
@pytest.mark.parametrize(("remaps", "programs"), [(CODES, PROGRAMS), (WORDS, WORDED)])
def test_remapped_codes_run_as_in_the_oracle(remaps: str, programs: str, tmp_path: Path) -> None:
    for program in programs.splitlines():
        text = program.replace(" / ", "\n") + "\nM2\n"
        difference = compare(tmp_path, remaps, text)
        assert not difference, f"{text}{difference}"


@needs_oracle
def test_random_programs_with_remapped_codes(tmp_path: Path) -> None:
    for seed in range(60):
        chance = random.Random(seed)
        topics = "straight,arc,mode,offset,auxiliary,tool,show,flow,call,saved,cycle"
        lines = oracle_linuxcnc.Writer(seed, topics).program(20).split("\n")
        for _ in range(4):
            extra = chance.choice(
                ("M400 P1", "M401", "M403", "M404", "G88.2 X1", "M407 F3", "M422", "M415 G0 X2", "M6 T1")
            )
            lines.insert(chance.randrange(2, len(lines)), extra)
        #: Without N: behind a remapped code the oracle's listing forgets the number of the line.
        program = re.sub(r"^N\d+ ", "", "\n".join(lines), flags=re.MULTILINE)
        difference = compare(tmp_path, CODES, program)
        assert not difference, f"seed {seed}\n{program}\n{difference}"


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("", ""),
        ("X1 ngc=show", "a code stands first"),
        ("M400", "ngc= names no subroutine"),
        ("M400 ngc=nowhere", "there is no file nowhere.ngc"),
        ("M400 ngc=", "ngc= is no option"),
        ("M400 ngc=show more", "more is no option"),
        ("M400 modalgroup=3 ngc=show", "modalgroup is 1 for G codes, 4 to 10 for M codes"),
        ("G88.1 modalgroup=2 ngc=show", "modalgroup is 1 for G codes"),
        ("T modalgroup=6 ngc=show", "T, S and F have no modal group"),
        ("M400 ngc=show argspec=P?", "argspec is made of letters"),
        ("M400 ngc=show\nREMAP=M0400 ngc=show", "M400 is remapped twice"),
    ],
)
def test_faults_of_remaps_are_told(value: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "show.ngc").write_text("o<show> sub\no<show> endsub\n")
    ini = tmp_path / "machine.ini"
    ini.write_text(f"[RS274NGC]\nSUBROUTINE_PATH={tmp_path}\nREMAP={value}\n")
    if not said:
        assert inifile.load(ini).remaps == ()
        return
    with pytest.raises(MachineError, match=re.escape(said)):
        inifile.load(ini)


def remapped(value: str, folder: Path) -> Path:
    (folder / "show.ngc").write_text("o<show> sub\no<show> endsub\n")
    ini = folder / "machine.ini"
    ini.write_text(f"[RS274NGC]\nSUBROUTINE_PATH={folder}\nREMAP={value}\n")
    return ini


@needs_oracle
@pytest.mark.parametrize("value", ["M3 modalgroup=7", "M8 modalgroup=8", "M101", "G1", "G70", "G80 modalgroup=1"])
def test_codes_that_no_remap_changes(value: str, tmp_path: Path) -> None:
    ini = remapped(f"{value} ngc=show", tmp_path)
    text = "S100\nG1 X1 F100\nG43\nM3 M8\nG0 X2\nG80\nM2\n"
    answer = oracle.answer(text, tmp_path, ["-i", str(ini)])
    machine = dialects.machine(dialects.load("linuxcnc"))
    machine.ini = inifile.load(ini)
    result = aircut.loads(text, "linuxcnc").run(machine=machine)
    assert answer.accepted
    assert not oracle.differ([line.rstrip("\n") for line in result.canon()], answer.listing)
    assert [(d.code, d.file) for d in result.diagnostics] == [("idle-remap", str(ini))]
    assert f"REMAP={value.partition(' ')[0]}" in result.diagnostics[0].message


@pytest.mark.parametrize("code", ["M3", "M30", "G43", "G4", "G90", "G54"])
def test_remaps_that_break_a_code_are_refused(code: str, tmp_path: Path) -> None:
    ini = remapped(f"{code} ngc=show", tmp_path)
    machine = dialects.machine(dialects.load("linuxcnc"))
    machine.ini = inifile.load(ini)
    with pytest.raises(MachineError, match=f"no remap of {code}"):
        aircut.loads("M2\n", "linuxcnc").run(machine=machine)
    (tmp_path / "part.ngc").write_text("M2\n")
    done = CliRunner().invoke(cli, ["run", str(tmp_path / "part.ngc"), "--dialect", "linuxcnc", "--ini", str(ini)])
    assert done.exit_code == 2
    assert f"no remap of {code}" in done.stderr


@pytest.mark.parametrize(
    ("value", "line"),
    [
        ("M400 python=show", "M400"),
        ("M6 modalgroup=6 prolog=a ngc=show epilog=b", "T1 M6"),
        ("T prolog=a ngc=show", "T1"),
        ("G88.6 modalgroup=1 argspec=XYZp py=g886", "G88.6 X1"),
    ],
)
def test_python_is_refused_where_it_would_run(value: str, line: str, tmp_path: Path) -> None:
    machine = dialects.machine(dialects.load("linuxcnc"))
    machine.ini = inifile.load(remapped(value, tmp_path))
    assert aircut.loads("G0 X1\nM3 S100\nM2\n", "linuxcnc").run(machine=machine).ok
    result = aircut.loads(f"G0 X1\n{line}\nM2\n", "linuxcnc").run(machine=machine)
    assert [(d.code, d.span.line) for d in result.diagnostics if d.severity is Severity.ERROR] == [("python-remap", 2)]
    assert value.partition(" ")[0] in result.diagnostics[0].message
