"""The command line of the launchers: `python -m fishplate.dask`, `python -m fishplate.ray`."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from . import Result
from .errors import Error

#: Bytes of what a command printed that are handed back.
SHOWN = 1 << 16


def main(engine: str, cluster: Callable[[str | None, Callable[..., Result]], Result], command: Callable[[str, list[str]], int]) -> int:
    parser = argparse.ArgumentParser(prog=f"python -m fishplate.{engine}")
    commands = parser.add_subparsers(dest="what", required=True)
    one = commands.add_parser("certify", help="evaluate a protocol on a campaign, in parts, and write the report")
    one.add_argument("campaign", nargs="+")
    one.add_argument("--protocol", "-p")
    one.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    one.add_argument("--out", "-o", required=True)
    one.add_argument("--scheduler", help="the address of a cluster; without it, one is started on this machine")
    one.add_argument("--shards", type=int)
    one.add_argument("--keep", help="folder for the values of the parts, so that a job that is started again makes the missing ones only")
    two = commands.add_parser("run", help="run one command on a worker and wait for it; used by `fishplate diagnose --launch`")
    two.add_argument("scheduler")
    two.add_argument("command", nargs=argparse.REMAINDER)
    given = parser.parse_args()
    if given.what == "run":
        return command(given.scheduler, given.command)
    parameters = dict(pair.partition("=")[::2] for pair in given.set)

    def work(certify: Any, *client: Any) -> Result:
        made = certify(*client, given.campaign, given.protocol, shards=given.shards, keep=given.keep, **parameters)
        assert isinstance(made, Result)
        return made

    try:
        result = cluster(given.scheduler, work)
        result.write(given.out)
    except Error as error:
        print(str(error).strip(), file=sys.stderr)
        return 2
    print(f"Verdict: {result.verdict}", *(f"  {reason}" for reason in result.reasons), f"written: {given.out}", sep="\n")
    return 0 if result.holds else 1


def here(words: list[str], folder: str, environment: dict[str, str]) -> tuple[int, bytes]:
    """On a worker: the exit code of a command, and the end of what it printed."""
    done = subprocess.run(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    return done.returncode, done.stdout[-SHOWN:]


def told(code: int, printed: bytes) -> int:
    sys.stderr.buffer.write(printed)
    return code if code >= 0 else 128 - code
