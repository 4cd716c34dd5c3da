"""Problems of protocols and data, each with its place."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Span:
    """A place in a text: lines and columns from 1, columns in characters, the end exclusive."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    text: str
    label: str | None = None


@dataclass(frozen=True)
class Problem:
    """One problem. `text` is what a terminal shows, with the source lines underlined."""

    severity: str
    code: str
    message: str
    span: Span | None
    also: list[Span] = field(default_factory=list)
    help: str | None = None
    text: str = ""

    @property
    def file(self) -> str | None:
        return self.span.file if self.span else None

    @property
    def line(self) -> int | None:
        return self.span.line if self.span else None

    @property
    def column(self) -> int | None:
        return self.span.column if self.span else None

    def __str__(self) -> str:
        return self.text.rstrip("\n")


class Error(Exception):
    """A protocol, a campaign or an argument is wrong. `problems` has every problem; the attributes are those of the first error."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__(problems)
        self.problems = problems

    @property
    def _first(self) -> Problem | None:
        errors = [problem for problem in self.problems if problem.severity == "error"]
        return next(iter(errors or self.problems), None)

    @property
    def code(self) -> str | None:
        return self._first.code if self._first else None

    @property
    def message(self) -> str | None:
        return self._first.message if self._first else None

    @property
    def file(self) -> str | None:
        return self._first.file if self._first else None

    @property
    def line(self) -> int | None:
        return self._first.line if self._first else None

    @property
    def column(self) -> int | None:
        return self._first.column if self._first else None

    @property
    def help(self) -> str | None:
        return self._first.help if self._first else None

    def __str__(self) -> str:
        return "\n" + "\n\n".join(str(problem) for problem in self.problems)


class Warning(UserWarning):
    """What does not stop an evaluation."""


# Tracebacks and `help` show the public name.
for _one in (Span, Problem, Error, Warning):
    _one.__module__ = "fishplate"
