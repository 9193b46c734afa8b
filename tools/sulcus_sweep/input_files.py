"""The files that runs read: the scene, and what it or a swept value names."""

import hashlib
import pathlib
import tomllib

_NAME_A_FILE = {"file", "labels", "recording"}  # keys, in whatever table of a scene


def hash_of(file):
    return hashlib.sha256(file.read_bytes()).hexdigest()


def hashes_of_named(scene, swept, options, started_in):
    """{path: SHA-256} of the files, and of all in the folders, that a scene names, its swept keys (plan's
    SweptKey) and the options of sulcus run. Paths of the scene are relative to it, others to `started_in`.
    Data apart from a volume's header is not among them."""
    try:
        named = [scene.parent / text for text in _texts(tomllib.loads(scene.read_text(encoding="utf-8")))]
    except ValueError:  # neither UTF-8 nor TOML: the program says more
        named = []
    values = [(key.name, value) for key in swept for value in key.to_check()]
    values += [word.partition("=")[::2] for word in options]
    named += [pathlib.Path(started_in) / text.strip().strip("\"'") for key, text in values
              if key.strip().rpartition(".")[2] in _NAME_A_FILE and text]
    hashes = {}
    for path in named:
        files = sorted(path.rglob("*")) if path.is_dir() else [path]
        hashes |= {str(file.resolve()): hash_of(file) for file in files if file.is_file()}
    return hashes


def _texts(value, key=""):
    """Of the keys that name a file."""
    if isinstance(value, dict):
        return [text for name, part in value.items() for text in _texts(part, name)]
    if isinstance(value, list):
        return [text for part in value for text in _texts(part, key)]
    return [value] if isinstance(value, str) and value and key in _NAME_A_FILE else []
