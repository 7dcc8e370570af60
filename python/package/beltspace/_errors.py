"""What beltspace raises."""

from typing import NamedTuple


class Problem(NamedTuple):
    """One mistake in a study or a model."""

    file: str
    """The file, or what messages call the text."""
    line: int
    """Line, from 1."""
    column: int
    """Column in characters, from 1; in a CSV file the field."""
    message: str
    """What is wrong and what would be right."""


class BeltspaceError(Exception):
    """Whatever beltspace raises besides OSError, KeyboardInterrupt and what Python itself does."""


class RequestError(BeltspaceError, ValueError):
    """A wrong request; the text names the thing, the value, the limit and the remedy."""


class StudyError(RequestError):
    """All mistakes in a study or a model, in the order of the text."""

    problems: list[Problem]
    """The mistakes, at least one."""

    def __init__(self, text: str, problems: list[tuple[str, int, int, str]]) -> None:
        super().__init__(text)
        self.problems = [Problem(*it) for it in problems]

    def __reduce__(self) -> tuple[type["StudyError"], tuple[str, list[tuple[str, int, int, str]]]]:
        return type(self), (str(self), [(it.file, it.line, it.column, it.message) for it in self.problems])

    @property
    def line(self) -> int:
        """Line of the first mistake, from 1."""
        return self.problems[0].line

    @property
    def column(self) -> int:
        """Column of the first mistake, from 1."""
        return self.problems[0].column


class RunError(BeltspaceError, RuntimeError):
    """A failure while a study is swept, such as a front that does not fit into memory."""
