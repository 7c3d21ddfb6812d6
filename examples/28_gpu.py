"""A million configurations on an NVIDIA GPU, where there is one; and the same kernels as PTX, for which none is needed.

You should see the entry points of the exported code, and then either how long the GPU took or why there is none.
Experimental: this was never run on a GPU.
"""

import re
import tempfile
import time
from pathlib import Path

import ulna


def main() -> None:
    robot = ulna.load("panda")
    with tempfile.TemporaryDirectory() as place:
        folder = ulna.export(robot, ["fk", "jacobian"], to="ptx", path=Path(place) / "panda", dtype="float32")
        text = (folder / "panda.ptx").read_text()
        print("exported:", ", ".join(re.findall(r"\.entry (\w+)", text)), f"({len(text) // 1024} kB of PTX)")

    try:
        import torch
    except ImportError:
        print("for the rest, install PyTorch: pip install torch")
        return
    if not torch.cuda.is_available():
        print("PyTorch finds no NVIDIA GPU, so the kernels do not run here")
        return
    fk = robot.kernel("fk", device="cuda")
    q = robot.random_configuration(1_000_000, seed=1)
    on_gpu = torch.tensor(q).cuda().T.contiguous().T  # number after number: read fastest
    fk(on_gpu)  # compiled by the driver
    torch.cuda.synchronize()
    start = time.perf_counter()
    poses = fk(on_gpu)
    torch.cuda.synchronize()
    print(f"a million poses in {1e6 * (time.perf_counter() - start):.0f} us")
    assert abs(poses[:100].cpu().numpy() - robot.fk(q[:100])).max() < 1e-12


if __name__ == "__main__":
    main()
