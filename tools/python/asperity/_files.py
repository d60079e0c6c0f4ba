"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Callable


def write_whole(file: Path, write: Callable[[Path], None]) -> None:
    """Has `write` make the file beside its place, with its extension, and puts it there."""
    part = file.with_name(f".{file.stem}.{os.getpid()}.part{file.suffix}")
    try:
        write(part)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
