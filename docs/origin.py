"""What made a picture that is not made again by the tests: said in the file itself."""

from pathlib import Path

from PIL import Image, PngImagePlugin

from rotorrig.rig import code_version

COLOURS = 256  # of a PNG: a palette is a third of the size
KEY = "Source"  # of the PNG's text


def origin(command: str, config_hash: str = "") -> str:
    """Return the command, the code and the config, if there is one, that a picture is made from."""
    return f"{command}; rotorrig {code_version()}{f'; config {config_hash}' if config_hash else ''}"


def save_png(picture: Image.Image, out: Path, *, origin: str) -> None:
    """Write a PNG with its origin as text in it."""
    said = PngImagePlugin.PngInfo()
    said.add_text(KEY, origin)
    picture.convert("RGB").quantize(COLOURS).save(out, optimize=True, pnginfo=said)
    print(f"{out}: {picture.width} x {picture.height}, {out.stat().st_size / 1000:.0f} kB")


def origin_of(picture: Path) -> str:
    """Return what a picture says of its origin, "" for nothing."""
    if picture.suffix == ".png":
        with Image.open(picture) as image:
            return str(image.info.get(KEY, ""))
    last = picture.read_text(encoding="utf-8").rstrip().rpartition("\n")[2]
    return last.removeprefix("<!-- ").removesuffix(" -->") if last.startswith("<!-- ") else ""
