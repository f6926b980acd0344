"""The one exception that means "the input is wrong"."""


class InputError(ValueError):
    """A file, a field or a value that a user gave cannot be used.

    The message names the file or the field, the value, and what would be right.
    Commands print it without a traceback and exit with code 2.

    Parameters
    ----------
    where : str
        The file or the configuration field, e.g. ``"planner.population"``.
    value : object
        What was found there.
    expected : str
        What would be right.
    """

    def __init__(self, where: object, value: object, expected: str) -> None:
        self.where, self.value, self.expected = str(where), value, expected
        super().__init__(f"{where}: got {value}, expected {expected}")

    def __reduce__(self) -> tuple[type["InputError"], tuple[str, object, str]]:
        return type(self), (self.where, self.value, self.expected)


def require(condition: bool, where: object, value: object, expected: str) -> None:
    """Raise `InputError` unless the condition holds.

    Parameters
    ----------
    condition : bool
        What must be true.
    where : object
        The file or the configuration field.
    value : object
        What was found there.
    expected : str
        What would be right.

    Raises
    ------
    InputError
        If the condition is false.
    """
    if not condition:
        raise InputError(where, value, expected)
