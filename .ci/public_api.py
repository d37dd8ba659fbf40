#!/usr/bin/env python3
"""Compares the public API of each library with its recorded one in `docs/api`.

    .ci/public_api.py CRATE...            prints the lines that are gone and those that came
    .ci/public_api.py --write CRATE...    records the API

The API is that of the JSON of rustdoc, which needs nightly Rust, with all features. A line is an
item: its path, then its text in the source up to its body. Items that a macro makes have no text of
their own; they have only their names.
"""

from __future__ import annotations

import argparse
import difflib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
API = ROOT / "docs/api"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "api"
# One entry of the index of rustdoc's JSON.
Item = dict[str, Any]


class Crate:
    """The JSON of a crate."""

    def __init__(self, path: Path) -> None:
        whole = json.loads(path.read_text())
        self.index: dict[str, Item] = whole["index"]
        self.root = str(whole["root"])
        self.sources: dict[str, list[str]] = {}
        # Items that are being listed, so that a re-export of a parent ends.
        self.open: set[str] = set()

    def record(self) -> str:
        """The API, sorted, a line for each item."""
        return "".join(f"{line}\n" for line in sorted(set(self.listed(self.root, ""))))

    def text(self, item: Item) -> str:
        """The text of an item in its source, on one line. Empty: a macro made it."""
        span = item["span"]
        if span is None:
            return ""
        name = span["filename"]
        if name not in self.sources:
            path = ROOT / name
            self.sources[name] = path.read_text().splitlines() if path.exists() else []
        (first, left), (last, right) = span["begin"], span["end"]
        lines = self.sources[name][first - 1 : last]
        if not lines:
            return ""
        lines[-1] = lines[-1][: right - 1] if last > first else lines[-1][left - 1 : right - 1]
        if last > first:
            lines[0] = lines[0][left - 1 :]
        kept = [re.sub(r"(^|\s)//.*", "", line) for line in lines]
        return " ".join(" ".join(kept).split())

    def signature(self, item: Item, ends: str) -> str:
        """The text of an item up to one of these characters outside of brackets, or its name."""
        name = item["name"] or ""
        text = self.text(item)
        # The text of an item that a macro makes is the call of the macro, or has not the name. The
        # fields of a tuple have numbers for names, which are not in the text.
        is_call = re.match(r"[\w:]+!", text)
        if is_call or (not name.isdigit() and not re.search(rf"\b{re.escape(name)}\b", text)):
            return f"{name} (of a macro)"
        depth = 0
        for at, letter in enumerate(text):
            if depth == 0 and letter in ends:
                return text[:at].strip().rstrip(",")
            depth += (letter in "([{") - (letter in ")]}")
        return text.strip().rstrip(",")

    def listed(self, number: object, path: str) -> Iterator[str]:
        """The lines of an item and of what it contains."""
        key = str(number)
        item = self.index.get(key)
        if item is None or key in self.open:
            return
        self.open.add(key)
        ((kind, inner),) = item["inner"].items()
        yield from getattr(self, f"of_{kind}", self.of_other)(item, inner, path)
        self.open.discard(key)

    def all(self, numbers: list[object], path: str) -> Iterator[str]:
        """The lines of some items."""
        for number in numbers:
            yield from self.listed(number, path)

    def of_module(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        path = f"{path}::{item['name']}" if path else str(item["name"])
        yield f"{path}: mod"
        yield from self.all(inner["items"], path)

    def of_use(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        target = self.index.get(str(inner["id"]))
        if inner["is_glob"] and target and "module" in target["inner"]:
            yield from self.all(target["inner"]["module"]["items"], path)
        elif target and target["name"] == inner["name"]:
            yield from self.listed(inner["id"], path)
        else:
            yield f"{path}::{inner['name']}: use {inner['source']}"

    def of_struct(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        here = f"{path}::{item['name']}"
        yield f"{here}: {self.signature(item, '{(;')}"
        form = inner["kind"]
        if isinstance(form, dict) and "plain" in form:
            yield from self.all(form["plain"]["fields"], here)
            if form["plain"]["has_stripped_fields"]:
                yield f"{here}: has private fields"
        elif isinstance(form, dict):
            yield from self.all(form["tuple"], here)
            # A private field has no number.
            if None in form["tuple"]:
                yield f"{here}: has private fields"
        yield from self.impls(inner["impls"], here)

    def of_enum(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        here = f"{path}::{item['name']}"
        exhaustive = "non_exhaustive " if "non_exhaustive" in str(item["attrs"]) else ""
        yield f"{here}: {exhaustive}{self.signature(item, '{')}"
        yield from self.all(inner["variants"], here)
        yield from self.impls(inner["impls"], here)

    def of_trait(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        here = f"{path}::{item['name']}"
        yield f"{here}: {self.signature(item, '{')}"
        yield from self.all(inner["items"], here)

    def of_function(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        yield f"{path}::{item['name']}: {self.signature(item, '{;')}"

    def of_other(self, item: Item, inner: Item, path: str) -> Iterator[str]:
        yield f"{path}::{item['name']}: {self.signature(item, ';')}"

    def impls(self, numbers: list[object], path: str) -> Iterator[str]:
        """The methods of a type, and its traits. Blanket ones belong to the trait."""
        for number in numbers:
            item = self.index.get(str(number))
            inner = item["inner"]["impl"] if item else None
            if item is None or inner is None or inner["blanket_impl"]:
                continue
            trait = inner["trait"]
            if trait is None:
                yield from self.all(inner["items"], path)
                continue
            name = str(trait.get("path") or trait.get("name")).rsplit("::", 1)[-1]
            # Of the traits that the compiler gives to a type by itself, only a missing one is told.
            if inner["is_synthetic"]:
                if inner["is_negative"] and name in ("Send", "Sync", "Unpin"):
                    yield f"{path}: not {name}"
                continue
            text = self.text(item)
            head = text.split("{")[0].strip() if text.startswith("impl") else f"impl {name}"
            yield f"{path}: {head}"
            for number in inner["items"]:
                inside = self.index.get(str(number))
                if inside and "assoc_type" in inside["inner"]:
                    yield f"{path}: {head}: {self.signature(inside, ';')}"


def apis(names: list[str]) -> dict[str, str]:
    """The API of each crate."""
    flags = f"{os.environ.get('RUSTDOCFLAGS', '')} -Z unstable-options --output-format json"
    chosen = [word for name in names for word in ("-p", name)]
    command = ["cargo", "+nightly", "doc", "-q", "--no-deps", "--all-features", *chosen]
    done = subprocess.run(
        [*command, "--target-dir", str(TARGET)],
        cwd=ROOT,
        env={**os.environ, "RUSTDOCFLAGS": flags},
    )
    if done.returncode:
        raise SystemExit("rustdoc failed")
    found = {}
    for name in names:
        found[name] = Crate(TARGET / "doc" / f"{name.replace('-', '_')}.json").record()
    return found


def changes(before: str, after: str) -> list[str]:
    """The lines that are gone, with `- `, and those that came, with `+ `."""
    lines = difflib.ndiff(before.splitlines(), after.splitlines())
    return [line for line in lines if line.startswith(("- ", "+ "))]


def main() -> int:
    """Compares or writes. Returns the status."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("crates", nargs="+", metavar="CRATE")
    options.add_argument("--write", action="store_true", help="record the API")
    chosen = options.parse_args()
    status = 0
    for name, text in apis(chosen.crates).items():
        path = API / f"{name}.txt"
        if chosen.write:
            API.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        before = path.read_text() if path.exists() else ""
        found = changes(before, text)
        print(f"{name}: {len(text.splitlines())} items, {len(found)} changes")
        print(*found, sep="\n", end="\n" if found else "")
        status |= bool(found)
    if status:
        print("if the changes are meant, record them: .ci/run api, with API=--write")
    return status


if __name__ == "__main__":
    sys.exit(main())
