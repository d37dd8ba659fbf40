"""The program that the package is compared with."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

PROJECT = Path(__file__).parents[2]
EXAMPLES = PROJECT / "examples"


class Program:
    """The program `husillo`, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.path = os.environ.get("HUSILLO", str(PROJECT / "target/release/husillo"))

    def prints(self, *words: str) -> str:
        """What a command prints. Its status is that of its findings."""
        done = subprocess.run(
            [self.path, *words], cwd=self.folder, capture_output=True, check=False
        )
        assert done.returncode in (0, 1), done.stderr
        return done.stdout.decode()

    def json(self, *words: str) -> Any:
        """The object that a command prints."""
        return json.loads(self.prints(*words, "--format", "json"))

    def file(self, name: str, text: str) -> str:
        """Writes a file into its folder."""
        (self.folder / name).write_text(text)
        return name


@pytest.fixture
def husillo_program(tmp_path: Path) -> Program:
    return Program(tmp_path)
