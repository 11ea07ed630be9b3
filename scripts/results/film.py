"""All steps of a run as GIF and MP4."""

import pathlib
import shutil
import subprocess
import tempfile

import matplotlib.pyplot as plt

DPI = 100
SHORTEST = 0.15  # seconds a step ...
LONGEST = 1.0  # ... so that a film of few steps ...
LENGTH = 6.0  # ... takes no longer than this many seconds


def make(painter, n_steps, stem):
    """Films STEM.gif and STEM.mp4 of what @p painter draws. @return the files that were written, and what to say."""
    seconds = min(LONGEST, max(SHORTEST, LENGTH / max(n_steps, 1)))
    with tempfile.TemporaryDirectory(prefix="slipstick-film-") as folder:
        frames = []
        for step in range(n_steps):
            figure = painter.draw(step)
            if figure is None:
                continue
            frames.append(pathlib.Path(folder) / f"{len(frames):06d}.png")
            figure.savefig(frames[-1], dpi=DPI)
            plt.close(figure)
        if not frames:
            return [], f"{stem.name}: no step to draw"
        ffmpeg = shutil.which("ffmpeg")
        if ffmpeg:
            return with_ffmpeg(ffmpeg, folder, seconds, stem)
        return with_pillow(frames, seconds, stem)


def with_ffmpeg(ffmpeg, folder, seconds, stem):
    read = [ffmpeg, "-y", "-loglevel", "error", "-framerate", f"{1 / seconds:.6g}", "-i", f"{folder}/%06d.png"]
    # H.264 wants even numbers of pixels; one palette for all frames
    subprocess.run(read + ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-r", "25",
                           str(stem.with_suffix(".mp4"))], check=True)
    subprocess.run(read + ["-vf", "split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse=dither=none", "-loop", "0",
                           str(stem.with_suffix(".gif"))], check=True)
    return [stem.with_suffix(".gif"), stem.with_suffix(".mp4")], ""


def with_pillow(frames, seconds, stem):
    from PIL import Image
    images = [Image.open(frame).convert("RGB") for frame in frames]
    images[0].save(stem.with_suffix(".gif"), save_all=True, append_images=images[1:], duration=int(1000 * seconds), loop=0)
    return [stem.with_suffix(".gif")], "no MP4 without ffmpeg: apt-get install ffmpeg"
