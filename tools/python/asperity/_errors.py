"""What goes wrong, with asperity's own codes."""


class Error(Exception):
    """A fault that asperity names: what is wrong, where, and how to mend it.

    code: invalid_argument, io_failed, bad_format, unsupported, bad_mesh, bad_texture, limit_exceeded, cancelled or busy.
    """

    def __init__(self, code: str, message: str) -> None:
        super().__init__(code, message)
        self.code = code
        self.message = message

    def __str__(self) -> str:
        return self.message


class BakeRemark(UserWarning):
    """Something that a bake did differently from what was asked, or had to mend."""
