"""Calls `simulate(parameters, inputs)` of a file, once for each line of standard input.

Fishplate starts this script with the path of the file. Both sides write JSON, one object on each line:

  worker     {"parameters": ["viscous", ...]}                  once, after the file was loaded
  Fishplate  {"section": "S01", "inputs": {...}, "parameters": {...}}
  worker     {"channels": {"torque": [...]}} or {"error": "..."}

`inputs` is sent once for each section, and null after that.
"""

import importlib.util
import json
import math
import os
import sys
import traceback

try:
    import numpy
except ImportError:
    numpy = None

# What the function prints must not mix with the answers.
answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


def answer(value):
    answers.write(json.dumps(value, allow_nan=False) + "\n")
    answers.flush()


def arrays(inputs):
    """Columns as arrays where NumPy is installed, otherwise as lists."""
    return {name: numpy.array(value) if numpy and isinstance(value, list) else value for name, value in inputs.items()}


def numbers(name, values):
    """A column of the answer as a list of finite numbers."""
    try:
        found = [float(value) for value in values]
    except TypeError:
        raise TypeError(f"`{name}` must be a list or an array of numbers, not {type(values).__name__}") from None
    bad = next((at for at, value in enumerate(found) if not math.isfinite(value)), None)
    if bad is not None:
        raise ValueError(f"`{name}` is {found[bad]} at sample {bad}")
    return found


def told():
    """The error with the lines of the user's file."""
    kind, error, trace = sys.exc_info()
    lines = traceback.extract_tb(trace)
    own = [line for line in lines if line.filename == path]
    where = "".join(f"{os.path.basename(line.filename)}:{line.lineno}: {line.line}\n" for line in own[-1:])
    return where + "".join(traceback.format_exception_only(kind, error)).strip()


path = os.path.abspath(sys.argv[1])
sys.path.insert(0, os.path.dirname(path))
try:
    spec = importlib.util.spec_from_file_location("simulator", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    simulate = module.simulate
    answer({"parameters": list(module.PARAMETERS)})
except BaseException:
    answer({"error": told()})
    sys.exit(1)

known = {}
for line in sys.stdin:
    asked = json.loads(line)
    if asked["inputs"] is not None:
        known[asked["section"]] = asked["inputs"]
    try:
        made = simulate(asked["parameters"], arrays(known[asked["section"]]))
        if not isinstance(made, dict):
            raise TypeError(f"`simulate` must return a dict of arrays, not {type(made).__name__}")
        answer({"channels": {str(name): numbers(name, values) for name, values in made.items()}})
    except Exception:
        answer({"error": told()})
