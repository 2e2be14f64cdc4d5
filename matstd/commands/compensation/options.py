"""Options that say which errors of a machine are meant, where and in what state."""

from matstd.options import EFFECTS, Options, Required

MODEL: Options = {
    "model MODEL.toml": "model of a diagnosis, or a machine file with --errors",
    "--errors ERRORS.toml": "errors of the machine, if MODEL.toml is a machine file",
}
"""The model, or a machine file with known errors."""

DATUM: Options = {
    "--datum AXIS=READING ...": "axis readings (mm, degrees) at which the preset is taken "
    "(default: 0)"
}

DRIVEN: Options = {
    "--after=0.0 MIN": "minutes since the machine was switched on",
    "--temperature SENSOR=DEGC ...": "sensor temperatures; effects with a time lag are taken as "
    "settled at them",
    "--value COLUMN=NUMBER ...": "values of further run columns that your own effects use",
    "--rpm:float": "spindle speed since the machine was switched on, 1/min",
    "--load=0.0 FX FY FZ": "force on the tool in the table frame, N (0 0 0)",
    "--add:list EFFECT=SIZE": "add an error, such as "
    "'beam(Z,cantilever,180x180,at:420,sense:-1,mass:80)=weight=1,load=1'",
}
"""State of the machine, and errors that are added to its model."""

STATE: Options = {
    **DATUM,
    "--tool-length:float MM": Required(
        "length of the datum tool, from the spindle gauge point to the tip"
    ),
    "--within AXIS=LOW:HIGH ...": "workspace for which the result is evaluated (mm, degrees; "
    "default: the whole travel)",
    **DRIVEN,
    "--switch WORD=FACTOR ...": "multiply errors by a factor (0: off), by symbol, effect, kind, "
    "class, axis or all",
    "--active:list FILE": "compensation table that is active on the control",
    **EFFECTS,
}
"""Datum, tool, workspace, state, switches."""

PROGRAM: Options = {
    "--tool TOOL=MM ...": "tool lengths by number or name (default: the length of the datum tool)",
    "--tool-radius TOOL=MM ...": "tool radii by number or name, for programs with radius "
    "compensation (RL, RR, G41, G42)",
    "--pass-m:int NUMBER ...": "M functions of this machine that neither move an axis nor change "
    "coordinates",
    "--tcp-m:int ON OFF": "M functions that switch tool centre point control in G-code (tables "
    "for LinuxCNC: 428 429)",
}
"""What a part program leaves open: its tools, M functions of the machine."""
