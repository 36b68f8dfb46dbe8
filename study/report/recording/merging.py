"""Join recordings of one case, written cell by cell, into one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rerun.chunk import Chunk, LazyChunkStream, RrdReader

from study.errors import StudyError
from study.report.recording.stream import APPLICATION


def merge(paths: Sequence[Path], out: Path) -> Path:
    """Write the data of several recordings of one case into one recording; the layout is not copied.

    Parameters
    ----------
    paths : sequence of Path
    out : Path

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    StudyError
        If there is nothing to merge, a file is no complete recording, the files belong to different cases, or `out`
        cannot be written.
    """
    if not paths:
        raise StudyError(f"merging into {out}: no recordings given")
    names: set[str] = set()
    chunks: list[Chunk] = []
    for path in paths:
        name, found = _read(path)
        names.add(name)
        chunks += found
    if len(names) != 1:
        raise StudyError(f"merging into {out}: the recordings belong to different cases: {', '.join(sorted(names))}")
    partial = out.with_name(f".{out.name}.partial")
    try:
        LazyChunkStream.from_iter(chunks).write_rrd(str(partial), application_id=APPLICATION, recording_id=names.pop())
        partial.replace(out)
    except (OSError, RuntimeError, ValueError) as error:
        raise StudyError(f"recording {out}: cannot be written: {error}") from None
    finally:
        partial.unlink(missing_ok=True)
    return out


def _read(path: Path) -> tuple[str, list[Chunk]]:
    try:
        reader = RrdReader(str(path))
        (entry,) = reader.recordings()
        return entry.recording_id, reader.stream().to_chunks()
    except (OSError, RuntimeError, ValueError) as error:
        raise StudyError(f"recording {path}: cannot be read as one complete recording: {error}") from None
