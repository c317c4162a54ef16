"""Files are there completely or not at all, and a refusal says why and what to do."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from nullbody import OutputError, Trajectory
from nullbody.export import check_target, write_csv, write_netcdf
from nullbody.export.target import replacement

BOTH = pytest.mark.parametrize(("write", "suffix"), [(write_csv, ".csv"), (write_netcdf, ".nc")])
Write = Callable[[Trajectory, Path], None]


@BOTH
def test_file_is_replaced(trajectory: Trajectory, folder: Path, write: Write, suffix: str) -> None:
    target = folder / f"run{suffix}"
    target.write_text("old")
    write(trajectory, target)
    assert target.stat().st_size > 1000
    assert list(folder.iterdir()) == [target]


@BOTH
def test_failed_write_leaves_what_was_there(
    trajectory: Trajectory, folder: Path, write: Write, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(draft: Path, target: Path) -> None:
        assert draft.exists()
        raise OSError(28, "No space left on device")

    target = folder / f"run{suffix}"
    target.write_text("old")
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(OutputError, match=r"run.* cannot be written: No space left on device\. Choose a folder"):
        write(trajectory, target)
    assert target.read_text() == "old"
    assert list(folder.iterdir()) == [target]


@BOTH
def test_wrong_suffix(trajectory: Trajectory, folder: Path, write: Write, suffix: str) -> None:
    with pytest.raises(OutputError, match=rf"run\.txt cannot be written: its name must end in \{suffix}"):
        write(trajectory, folder / "run.txt")
    assert list(folder.iterdir()) == []


def test_other_errors_pass_and_clean_up(folder: Path) -> None:
    with pytest.raises(KeyboardInterrupt), replacement(folder / "run.csv", ".csv") as draft:
        draft.write_text("half")
        raise KeyboardInterrupt
    assert list(folder.iterdir()) == []


def test_missing_folder(folder: Path) -> None:
    with pytest.raises(OutputError, match=r"the folder .*missing does not exist\. Make it first"):
        check_target(folder / "missing" / "run.csv", ".csv")
    (folder / "file").write_text("")
    with pytest.raises(OutputError, match="file is a file, not a folder"):
        check_target(folder / "file" / "run.csv", ".csv")


def test_path_is_a_folder(folder: Path) -> None:
    with pytest.raises(OutputError, match=r"it is a folder\. Name a file in it, .*run\.nc"):
        check_target(folder, ".nc", ".csv")


def test_folder_is_not_writable(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: not mode & os.W_OK)  # root may write everywhere
    with pytest.raises(OutputError, match=r"is not writable for you\. Choose a folder"):
        check_target(folder / "run.csv", ".csv")


@pytest.mark.skipif(os.name == "nt", reason="modes of files and links are those of POSIX")
def test_mode_and_link_are_kept_as_the_user_has_them(trajectory: Trajectory, folder: Path) -> None:
    (folder / "link.csv").symlink_to(folder / "run.csv")
    write_csv(trajectory, folder / "link.csv")
    (folder / "plain").write_text("")
    assert (folder / "link.csv").is_symlink()
    assert stat.S_IMODE((folder / "run.csv").stat().st_mode) == stat.S_IMODE((folder / "plain").stat().st_mode)


def test_a_name_that_is_too_long_is_refused(folder: Path) -> None:
    with (
        pytest.raises(OutputError, match="cannot be written: File name too long"),
        replacement(folder / f"{'a' * 300}.csv", ".csv") as draft,
    ):
        draft.write_text("x")
    assert not list(folder.iterdir())
