"""Photographs: used, or refused with a reason; never decoded on trust, never waited for."""

import os
import struct
import subprocess
import sys
import textwrap
import time
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from cvnotes.base import FileError
from cvnotes.base.writing import printable
from cvnotes.files import Photo, decoding, list_photos, open_photos, read_photo, read_photos
from cvnotes.files.photos import open_photo

posix = pytest.mark.skipif(os.name == "nt", reason="pipes and links of POSIX")

# A grey picture that no symmetry maps to itself: 12 wide, 8 high, and smooth enough for JPEG.
GREY = (np.arange(8)[:, None] * 12 + np.arange(12) * 5).astype(np.uint8)
RGB = np.stack([GREY, 200 - GREY, GREY // 2], -1)


def save(path, pixels, mode=None, **options):
    picture = Image.fromarray(pixels)
    (picture.convert(mode) if mode else picture).save(path, **options)
    return path


def exif(orientation):
    tags = Image.Exif()
    tags[274] = orientation
    return tags


# --- what is read ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "pixels", "options"),
    [
        ("grey.png", GREY, {}),
        ("colour.png", RGB, {}),
        ("GREY.BMP", GREY, {}),
        ("colour.tif", RGB, {"compression": "tiff_lzw"}),
        ("colour.webp", RGB, {"lossless": True}),
        ("grey.pgm", GREY, {}),
    ],
)
def test_lossless_formats_give_their_pixels(tmp_path, name, pixels, options):
    photo = read_photo(save(tmp_path / name, pixels, **options))
    assert np.array_equal(photo.image, pixels)
    assert photo.image.dtype == np.uint8
    assert photo.size == (12, 8)
    assert photo.note == ""


def test_the_pictures_of_telephones_are_read_where_there_is_who_reads_them(tmp_path, monkeypatch):
    def register_heif_opener():
        from PIL import PngImagePlugin

        class Heif(PngImagePlugin.PngImageFile):  # whose pixels are packed in another way
            format = "HEIF"

        Image.register_open("HEIF", Heif, lambda start: start[:8] == PngImagePlugin._MAGIC)

    save(tmp_path / "phone.heic", RGB, format="PNG")
    stand_in = SimpleNamespace(register_heif_opener=register_heif_opener)
    monkeypatch.setitem(sys.modules, "pillow_heif", stand_in)
    monkeypatch.setattr(decoding, "_FORMATS", ())  # nobody else reads it
    monkeypatch.setattr(Image, "OPEN", dict(Image.OPEN))
    decoding._reads_heif.cache_clear()
    assert np.array_equal(read_photo(tmp_path / "phone.heic").image, RGB)
    decoding._reads_heif.cache_clear()


@pytest.mark.parametrize("options", [{}, {"progressive": True}], ids=["baseline", "progressive"])
def test_jpeg_gives_its_pixels_nearly(tmp_path, options):
    photo = read_photo(save(tmp_path / "grey.JPG", GREY, quality=100, **options))
    assert np.abs(photo.image.astype(int) - GREY).max() <= 3


def test_alpha_is_dropped_palettes_and_cmyk_are_converted(tmp_path):
    alpha = np.full((8, 12, 1), 128, np.uint8)
    photo = read_photo(save(tmp_path / "rgba.png", np.concatenate([RGB, alpha], -1)))
    assert np.array_equal(photo.image, RGB)
    assert photo.note == "alpha dropped"
    photo = read_photo(save(tmp_path / "la.png", np.concatenate([GREY[..., None], alpha], -1)))
    assert np.array_equal(photo.image, GREY)
    photo = read_photo(save(tmp_path / "palette.png", GREY, "P"))
    assert np.array_equal(photo.image, np.stack([GREY] * 3, -1))
    photo = read_photo(save(tmp_path / "bits.png", (GREY > 60).astype(np.uint8) * 255, "1"))
    assert np.array_equal(photo.image, np.where(GREY > 60, 255, 0))
    photo = read_photo(save(tmp_path / "cmyk.tif", RGB, "CMYK"))
    assert np.abs(photo.image.astype(int) - RGB).max() <= 1


@pytest.mark.parametrize("name", ["deep.png", "deep.tif"])
def test_16_bit_is_kept_and_its_grey_uses_the_range_that_is_there(tmp_path, name):
    deep = GREY.astype(np.uint16) * 40  # a sensor of 12 bits: at most 5520 of 65535
    photo = read_photo(save(tmp_path / name, deep))
    assert np.array_equal(photo.image, deep)
    assert photo.note == "16 bit"
    assert photo.grey.dtype == np.uint8
    assert photo.grey.min() == 0
    assert photo.grey.max() == 255
    assert np.all(np.diff(photo.grey[0].astype(int)) > 0)


def test_grey_of_colour_is_the_usual_luminance():
    image = np.zeros((1, 3, 3), np.uint8)
    image[0, [0, 1, 2], [0, 1, 2]] = 200
    assert Photo(Path("a"), image).grey.tolist() == [[60, 117, 23]]  # 0.299, 0.587, 0.114


def test_of_several_pictures_the_first_is_read_and_that_is_said(tmp_path):
    for name in ("animated.gif", "pages.tif"):
        first, second = Image.fromarray(GREY), Image.fromarray(255 - GREY)
        first.save(tmp_path / name, save_all=True, append_images=[second])
        photo = read_photo(tmp_path / name)
        assert np.array_equal(photo.grey, GREY)
        assert photo.note == "the first of several pictures in the file"


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.webp"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_whatever_the_exif_rotation_pixels_stay_in_the_sensors_frame(tmp_path, name, orientation):
    options = {"lossless": True} if name.endswith("webp") else {}
    path = save(tmp_path / name, RGB, exif=exif(orientation), **options)
    photo = read_photo(path)
    assert np.array_equal(photo.image, RGB)
    assert photo.orientation == orientation
    said = f"EXIF orientation {orientation} not applied: sensor frame"
    assert photo.note == ("" if orientation == 1 else said)
    assert list_photos([path]) == ([path], [])


def test_portrait_and_landscape_of_one_sensor_are_calibrated_together(tmp_path):
    save(tmp_path / "1.jpg", RGB, exif=exif(1))
    save(tmp_path / "2.tif", 255 - RGB, exif=exif(6))
    save(tmp_path / "3.jpg", RGB // 2, exif=exif(8))
    photos, rejected = read_photos([tmp_path])
    assert [photo.size for photo in photos] == [(12, 8)] * 3
    assert rejected == []


def test_a_senseless_exif_rotation_is_ignored(tmp_path):
    assert read_photo(save(tmp_path / "a.png", GREY, exif=exif(77))).orientation == 1


# --- what is refused ------------------------------------------------------------------------


def jpeg(tmp_path):
    noise = np.random.default_rng(3).integers(0, 255, (64, 96), dtype=np.uint8)
    return save(tmp_path / "whole.jpg", noise, quality=90).read_bytes()


def png_header(width, height):
    def chunk(name, data):
        crc = struct.pack(">I", zlib.crc32(name + data))
        return struct.pack(">I", len(data)) + name + data + crc

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(bytes(10_000)))


def bad_files(tmp_path):
    whole = jpeg(tmp_path)
    png = save(tmp_path / "whole.png", RGB).read_bytes()
    middle = len(whole) // 2
    return {
        "empty.jpg": (b"", "the file is empty"),
        "text.jpg": (b"hello", "not a picture, or in a format that is not read"),
        "page.png": (b"<html></html>", "not a picture"),
        "half.jpg": (whole[:middle], "damaged or cut off"),
        "nearly.jpg": (whole[: len(whole) * 97 // 100], "damaged or cut off"),
        "header.jpg": (whole[:300], "damaged or cut off|not a picture"),
        "half.png": (png[: len(png) // 2], "damaged or cut off"),
        "middle.jpg": (
            whole[:middle] + b"\xff" * 1000 + whole[middle + 1000 :],
            "damaged or cut off",
        ),
        "middle.png": (png[:60] + bytes(40) + png[100:], "damaged or cut off"),
        "pipe.eps": (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n", "not a picture"),
        "bomb.png": (png_header(60_000, 60_000), "more than 80 million pixels by its header"),
        "large.png": (png_header(9_000, 9_000), "9000×9000: more than 80 million pixels"),
        "huge.png": (png_header(2**31 - 1, 2**31 - 1), "more than 80 million|damaged|not a pic"),
        "film.mp4": (b"x", "a video; name it by itself"),
        "phone.HEIC": (b"x", "HEIF is read where pillow-heif is installed"),
        "camera.NEF": (b"x", "a camera's raw format"),
        ".hidden.jpg": (whole, "a hidden file of the system"),
        "._left01.jpg": (b"\0\5\x16\7", "a hidden file of the system"),
        "Thumbs.db": (b"x", "a hidden file of the system"),
        "float.tif": (None, "pixels are floating-point numbers"),
        "wide.tif": (None, "pixels have more than 16 bits"),
    }


def write_bad(tmp_path):
    folder = tmp_path / "bad"
    folder.mkdir()
    reasons = {}
    for name, (content, reason) in bad_files(tmp_path).items():
        reasons[name] = reason
        if content is not None:
            (folder / name).write_bytes(content)
    save(folder / "float.tif", GREY.astype(np.float32))
    save(folder / "wide.tif", GREY.astype(np.int32) * 100_000)
    return folder, reasons


def test_each_bad_file_has_its_reason_and_no_good_one_is_lost(tmp_path):
    folder, reasons = write_bad(tmp_path)
    save(folder / "good.png", GREY)
    photos, rejected = read_photos([folder])
    assert [photo.path.name for photo in photos] == ["good.png"]
    assert sorted(Path(r.file).name for r in rejected) == sorted(reasons)
    for name, reason in reasons.items():
        with pytest.raises(FileError, match=reason):
            read_photo(folder / name)


def test_a_bomb_is_refused_from_its_header_quickly(tmp_path):
    (tmp_path / "bomb.png").write_bytes(png_header(60_000, 60_000))
    start = time.process_time()
    with pytest.raises(FileError, match="more than 80 million pixels by its header"):
        read_photo(tmp_path / "bomb.png")
    assert time.process_time() - start < 5  # to decode it takes minutes


def test_a_file_too_large_for_any_photograph_is_not_loaded(tmp_path):
    with (tmp_path / "large.jpg").open("wb") as stream:
        stream.truncate(600_000_000)  # sparse: takes no room
    with pytest.raises(FileError, match="600 MB is larger than any photograph"):
        read_photo(tmp_path / "large.jpg")


@posix
def test_pipes_links_and_folders_never_block(tmp_path):
    os.mkfifo(tmp_path / "pipe.jpg")
    (tmp_path / "folder.jpg").mkdir()
    (tmp_path / "broken.jpg").symlink_to("nowhere")
    (tmp_path / "loop.jpg").symlink_to("loop.jpg")
    photos, rejected = read_photos([tmp_path, tmp_path / "missing.jpg"])
    assert photos == []
    assert {Path(r.file).name: str(r.reason) for r in rejected} == {
        "pipe.jpg": "not a regular file",
        "folder.jpg": "a folder inside a folder; name it to have its photographs read",
        "broken.jpg": "a link that leads nowhere",
        "loop.jpg": "cannot be opened: Too many levels of symbolic links",
        "missing.jpg": "there is no such file",
    }


def test_an_unreadable_file_is_said(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise PermissionError(13, "Permission denied")

    path = save(tmp_path / "a.png", GREY)
    for name in ("open", "read_bytes"):  # for root every file is readable
        monkeypatch.setattr(Path, name, refuse)
    assert str(list_photos([path])[1][0].reason) == "cannot be opened: Permission denied"
    with pytest.raises(FileError, match=r"a\.png: cannot be opened: Permission denied"):
        read_photo(path)


# --- sets -----------------------------------------------------------------------------------


def test_folders_are_taken_in_natural_order_and_files_as_given(tmp_path):
    for name in ("left10.png", "left2.png", "Left1.png"):
        save(tmp_path / name, GREY + len(name))
    (tmp_path / "below").mkdir()
    save(tmp_path / "below" / "left3.png", GREY)
    assert [path.name for path in list_photos([tmp_path])[0]] == [
        "Left1.png", "left2.png", "left10.png"
    ]  # fmt: skip
    given = [tmp_path / "left10.png", tmp_path / "left2.png"]
    assert list_photos(given)[0] == given


def test_the_size_of_most_decides_and_the_others_are_told_why(tmp_path):
    for i in range(3):
        save(tmp_path / f"{i}.png", GREY + i)
    save(tmp_path / "odd.png", GREY[:4])
    save(tmp_path / "turned.png", GREY.T.copy())
    files, rejected = list_photos([tmp_path])
    assert [path.name for path in files] == ["0.png", "1.png", "2.png"]
    assert {Path(r.file).name: str(r.reason) for r in rejected} == {
        "odd.png": "12×4 pixels where most photographs have 12×8",
        "turned.png": "8×12 pixels where most photographs have 12×8; was it turned by an editor?",
    }


def test_a_copy_is_found_by_its_pixels_whatever_its_name_and_format(tmp_path):
    save(tmp_path / "a.png", GREY)
    save(tmp_path / "b.bmp", GREY)
    save(tmp_path / "c.png", GREY + 1)
    photos, rejected = read_photos([tmp_path, tmp_path / "a.png"])
    assert [photo.path.name for photo in photos] == ["a.png", "c.png"]
    assert [Path(r.file).name for r in rejected] == ["b.bmp"]
    assert str(rejected[0].reason) == f"the same picture as {tmp_path / 'a.png'}"


def test_photographs_are_opened_one_at_a_time(tmp_path):
    save(tmp_path / "a.png", GREY)
    some = open_photos([tmp_path / "a.png", tmp_path / "missing.png"])
    assert isinstance(next(some), Photo)
    assert str(next(some).reason) == "there is no such file"


def test_an_empty_folder_holds_no_photograph(tmp_path):
    assert read_photos([tmp_path]) == ([], [])


@posix
@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("with space.png", "with space.png"),
        ("日本語 ü.png", "日本語 ü.png"),
        ("two\nlines\x1b[31m.png", r"two\nlines\x1b[31m.png"),
        ("-rf %s$(reboot).png", "-rf %s$(reboot).png"),
        ("x" * 240 + ".png", "x" * 240 + ".png"),
        (os.fsdecode(b"latin-\xe9.png"), r"latin-\xe9.png"),
    ],
)
def test_any_name_works_and_is_printed_on_one_line(tmp_path, name, shown):
    path = tmp_path / name
    save(tmp_path / "a.png", GREY).rename(path)
    photos, rejected = read_photos([tmp_path])
    assert (len(photos), rejected) == (1, [])
    assert printable(path.name) == shown
    path.write_bytes(b"x")
    assert Path(read_photos([tmp_path])[1][0].file).name == shown


def test_sixteen_bits_become_eight_as_percentiles_say():
    rng = np.random.default_rng(3)
    image = rng.gamma(2.0, 900.0, (211, 307)).astype(np.uint16)
    low, high = np.percentile(image, (0.1, 99.9))
    expected = ((image - low) * (255 / (high - low))).round().clip(0, 255)
    assert np.array_equal(Photo(Path("a.png"), image).grey, expected.astype(np.uint8))


@pytest.mark.skipif(os.name == "nt", reason="limits of POSIX")
def test_a_large_picture_of_sixteen_bits_takes_no_memory_but_its_own(tmp_path):
    Image.fromarray(np.zeros((4000, 5000), np.uint16)).save(tmp_path / "large.png")
    code = """
        import resource, sys
        from PIL import Image
        from cvnotes.files import read_photo
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        read_photo(sys.argv[1]).grey
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
    """
    run = [sys.executable, "-c", textwrap.dedent(code), str(tmp_path / "large.png")]
    said = subprocess.run(run, check=True, capture_output=True, text=True).stdout
    unit = 1 if sys.platform == "darwin" else 1024
    assert int(said) * unit < 10 * 20_000_000  # bytes a pixel; in floating point it were 25


def test_of_a_jpeg_the_grey_levels_are_read_alone(tmp_path):
    v, u = np.indices((48, 64))
    colours = np.stack([60 + 2 * u, 200 - 3 * v, 90 + u + v], axis=-1).astype(np.uint8)
    for name in ("a.jpg", "a.png"):
        Image.fromarray(colours).save(tmp_path / name, quality=95)
    jpeg, png = (open_photo(tmp_path / name, grey=True) for name in ("a.jpg", "a.png"))
    assert jpeg.image.shape == (48, 64)
    assert np.array_equal(jpeg.grey, jpeg.image)
    expected = colours @ np.array([0.299, 0.587, 0.114])
    assert np.abs(jpeg.grey - expected).max() <= 4  # what the JPEG loses
    assert np.abs(png.grey - expected).max() <= 0.501
    assert open_photo(tmp_path / "a.jpg").image.shape == (48, 64, 3)
    assert str(open_photo(tmp_path / "none.jpg", grey=True).reason) == "there is no such file"
