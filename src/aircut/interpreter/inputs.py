"""Inputs, outputs, calls to the PLC, axes requests.

Sources: 000 section 1.2; decisions AMB-COD-8 to AMB-COD-10, AMB-IO-1 to AMB-IO-8, AMB-IO-12.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.requests import Inputs, Output, Plc, Request, Wait, Waited
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words

GROUP = 20  # inputs of a group
ALARM = 10  # added to L: a time-out is an alarm
MODES = (0, 1, 2, 3, 4, 10, 11, 12, 13)


def numbered(w: Words, limit: int, what: str) -> int:
    """The P word: one of the machine's inputs or outputs. Raises Refusal."""
    number = whole(w, "p")
    if not 1 <= number <= limit:
        raise out_of_range(w, "p", f"the machine has {what} 1 to {limit}")
    return number


def switch(on: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """M62, M63 P: an output on, off."""
    number = numbered(w, m.machine.options.outputs, "outputs")
    m.out.event("SET_MOTION_OUTPUT_BIT" if on else "CLEAR_MOTION_OUTPUT_BIT", number)
    told(m, number, False, on)
    yield Output(number, float(on), False)


def told(m: State, number: int, analog: bool, on: bool) -> None:
    """Remember which outputs are on: the end of the program puts them off."""
    m.outputs_on = m.outputs_on | {(number, analog)} if on else m.outputs_on - {(number, analog)}


def all_off(m: State) -> None:
    """M2, M30: what is on goes off (AMB-IO-10)."""
    for number, analog in sorted(m.outputs_on):
        if analog:
            m.out.event("SET_AUX_OUTPUT_VALUE", number, 0.0)
        else:
            m.out.event("CLEAR_MOTION_OUTPUT_BIT", number)
        m.going_off.append(Output(number, 0.0, analog))
    m.outputs_on = frozenset()


def switched_off(m: State) -> Generator[Request, Any, None]:
    """Tell the world what `all_off` has put off."""
    while m.going_off:
        yield m.going_off.pop(0)


def analog_output(m: State, w: Words) -> Generator[Request, Any, None]:
    """M68 P Q: an analog output, percent."""
    number = numbered(w, m.machine.options.analog_outputs, "analog outputs")
    if not 0.0 <= w["q"] <= 100.0:
        raise out_of_range(w, "q", "0 to 100 percent")
    m.out.event("SET_AUX_OUTPUT_VALUE", number, w["q"])
    told(m, number, True, w["q"] != 0.0)
    yield Output(number, w["q"], True)


def wait(analog: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """M66, M67 P L Q: wait for an input, or read it. Raises Refusal for a time-out with alarm."""
    options = m.machine.options
    what, limit = ("analog inputs", options.analog_inputs) if analog else ("inputs", options.inputs)
    number = numbered(w, limit, what)
    mode = whole(w, "l")
    if mode not in MODES:
        raise out_of_range(w, "l", "0 to 4, or 10 to 13")
    if w.get("q", 0.0) < 0.0:
        raise out_of_range(w, "q", "seconds, not negative")
    m.out.event("WAIT_INPUT", number, mode, w.get("q", -1.0))
    reply: Waited | None = yield Wait(number, mode % ALARM, w.get("q"), analog)
    if reply is None:
        return
    m.waited = 0.0 if reply.success else 1.0
    if options.m66_read_back:
        m.input_value = reply.value
    if not reply.success and mode >= ALARM:
        raise Refusal(F.INPUT_TIMEOUT, what=what[:-1], number=number, seconds=w.get("q", 0.0))


def read_group(analog: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """M166, M167 P: twenty inputs into #5740 to #5759; inputs that the machine has not read as null."""
    group = whole(w, "p")
    limit = m.machine.options.analog_inputs if analog else m.machine.options.inputs
    if not 1 <= group <= -(-limit // GROUP):
        raise out_of_range(w, "p", f"input groups are 1 to {-(-limit // GROUP)}")
    first = GROUP * (group - 1) + 1
    here = min(GROUP, limit - first + 1)
    reply: tuple[float, ...] | None = yield Inputs(first, here, analog)
    if reply is not None:
        m.input_group = [*reply, *[None] * (GROUP - len(reply))]


def plc_call(m: State, w: Words) -> Generator[Request, Any, None]:
    """G100 P: a function of the PLC, by number, with its arguments."""
    m.out.event("PLC_CALL", dict(w))
    if w["p"] is None:
        raise Refusal(F.NULL_VALUE, "p", what="P", operation="it names the function")
    yield Plc(f"{w['p']:g}", {letter: value for letter, value in w.items() if letter != "p" and value is not None})


def axes_mask(event: str, m: State, w: Words) -> None:
    """G101, G102 P: axes by bits, X = 1, Y = 2, Z = 4 …"""
    mask = whole(w, "p")
    if not 0 <= mask <= 63:
        raise out_of_range(w, "p", "bits of the axes: 0 to 63")
    if event == "INTERPOLATED_AXES":
        m.interpolated = mask
    m.out.event(event, mask)


def traverse_rate(m: State, w: Words) -> None:
    """G103 V: highest speed of G0, mm/min in any units; 0: as fast as the axes can."""
    if w["v"] < 0.0:
        raise out_of_range(w, "v", "speeds are not negative")
    m.traverse_rate = w["v"]
    m.out.event("SET_TRAVERSE_RATE", w["v"])


def dynamics(m: State, w: Words) -> None:
    """G104 A D J: acceleration and deceleration along the path, jerk in percent."""
    if not any(letter in w for letter in "adj"):
        raise Refusal(F.MISSING_WORD, code="G104", word="A, D or J", meaning="")
    for letter in "ad":
        if w.get(letter, 0.0) < 0.0:
            raise out_of_range(w, letter, "accelerations are not negative")
    if not 0.0 <= w.get("j", 0.0) <= 100.0:
        raise out_of_range(w, "j", "0 to 100 percent")
    m.acceleration = w["a"] * m.unit if "a" in w else m.acceleration
    m.deceleration = w["d"] * m.unit if "d" in w else m.deceleration
    m.jerk = w.get("j", m.jerk)
    m.out.event("SET_DYNAMICS", m.acceleration, m.deceleration, m.jerk)


io = partial(Code, group=Group.IO, order=Order.IO, needs="p")
single = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)

CODES = (
    io("M62", "Output on", partial(switch, True), takes="p"),
    io("M63", "Output off", partial(switch, False), takes="p"),
    io("M66", "Wait for an input", partial(wait, False), takes="plq", needs="pl"),
    io("M67", "Wait for an analog input", partial(wait, True), takes="plq", needs="pl"),
    io("M68", "Analog output", analog_output, takes="pq", needs="pq"),
    io("M166", "Read a group of inputs", partial(read_group, False), takes="p"),
    io("M167", "Read a group of analog inputs", partial(read_group, True), takes="p"),
    single("G100", "Call a PLC function", plc_call, needs="p", sole=True),
    single("G101", "Axes to be interpolated", partial(axes_mask, "INTERPOLATED_AXES"), takes="p", needs="p"),
    single("G102", "Home axes", partial(axes_mask, "HOME_AXES"), takes="p", needs="p"),
    single("G103", "Traverse rate", traverse_rate, takes="v", needs="v"),
    single("G104", "Dynamics", dynamics, takes="adj"),
)
