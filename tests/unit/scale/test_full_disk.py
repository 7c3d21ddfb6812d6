"""A disk that is really full: a small one in memory, which gets larger after the job has stopped."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ulna import scale

zarr = pytest.importorskip("zarr")
pytest.importorskip("distributed")

_JOB = """
import subprocess, sys
import numpy as np
from pathlib import Path
from ulna import scale
from ulna.errors import JobStopped

if __name__ == "__main__":
    disk, workers = Path(sys.argv[1]), int(sys.argv[2])
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=512k", "tmpfs", str(disk)], check=True)

    def rows():
        options = {"to": disk / "rows.zarr", "chunk": 500, "workers": workers, "progress": False}
        return scale.data_set("panda", 10_000, ["q", "fk"], **options)

    try:
        rows()
    except JobStopped as error:
        print(error)
    else:
        raise AssertionError("1.8 MB cannot lie on that disk")
    subprocess.run(["mount", "-o", "remount,size=32m", str(disk)], check=True)
    group = rows()
    np.savez(sys.argv[3], q=group["q"][...], fk=group["fk"][...], checksums=group.attrs["checksums"])
"""


@pytest.mark.parametrize("workers", [0, 2])
def test_a_job_on_a_full_disk_stops_and_continues(tmp_path: Path, workers: int) -> None:
    inside = [
        "unshare",
        "--map-root-user",
        "--mount",
    ]  # mounts end with the process, and nobody else sees them
    if shutil.which("unshare") is None or subprocess.run([*inside, "true"], check=False).returncode:
        pytest.skip("this system gives no process mounts of its own")
    disk, script, found = tmp_path / "disk", tmp_path / "job.py", tmp_path / "found.npz"
    disk.mkdir()
    script.write_text(_JOB)
    words = [*inside, sys.executable, str(script), str(disk), str(workers), str(found)]
    done = subprocess.run(words, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "No space left on device" in done.stdout and "of 20 parts are in" in done.stdout
    options = {"to": tmp_path / "rows.zarr", "chunk": 500, "workers": 0, "progress": False}
    undisturbed = scale.data_set("panda", 10_000, ["q", "fk"], **options)
    with np.load(found) as got:
        for name in ("q", "fk"):
            np.testing.assert_array_equal(got[name], undisturbed[name][...])
        assert got["checksums"].tolist() == undisturbed.attrs["checksums"]
