"""What a program amounts to: canonical commands, and the motion among them as columns."""

from aircut.canon.commands import COMMANDS, Command
from aircut.canon.record import CHUNK, Chunk, Event, Recorder, Recording
from aircut.canon.toolpath import (
    BY_HAND,
    COLUMNS,
    EXACT_PATH,
    EXACT_STOP,
    INVERSE_TIME,
    PART,
    ROW,
    TIP,
    TOLD,
    Kind,
    Toolpath,
)

__all__ = [
    "BY_HAND",
    "CHUNK",
    "COLUMNS",
    "COMMANDS",
    "EXACT_PATH",
    "EXACT_STOP",
    "INVERSE_TIME",
    "PART",
    "ROW",
    "TIP",
    "TOLD",
    "Chunk",
    "Command",
    "Event",
    "Kind",
    "Recorder",
    "Recording",
    "Toolpath",
]
