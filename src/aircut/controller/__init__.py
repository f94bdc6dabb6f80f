"""A run against a world: probe and workpiece, inputs and outputs, an operator."""

from aircut.controller.simulation import Alarm, Simulation
from aircut.controller.world import World, WorldError, load

__all__ = ["Alarm", "Simulation", "World", "WorldError", "load"]
