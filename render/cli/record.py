"""`pullfocus record`: render frames of a shot to files, with usdrecord's arguments where it has them."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from render.cli.console import camel_case_keys, finite, print_json
from render.cli.options import burn_in as burn_in_options
from render.cli.options import camera as camera_options
from render.cli.options import (
    contact_sheet,
    flare,
    grade,
    long_exposure,
    movie,
    picture,
    progressive,
    scene,
    shared,
    stereo,
    usdrecord,
)
from render.cli.recording.files import check_files, make_folders
from render.cli.recording.frames import record_frames
from render.cli.recording.job import RecordJob
from render.errors import SettingsError
from render.film import GradeChoice
from render.film.stock import library_stock
from render.model.arrays import FloatArray
from render.model.burn_in import BurnIn
from render.model.frame_spec import every_frame, frame_file_names, parse_frames
from render.output import FrameMetadata, format_of
from render.pictures.contact_axes import Axis
from render.shot import Shot
from render.shot.lens.lens_choice import LensChoice
from render.shot.picture_height import picture_height
from render.shot.times import DEFAULT_TIME
from render.stage import Finding
from render.stage.render_products import Product


@dataclass(frozen=True)
class RecordOptions:
    """Options of `pullfocus record`, read and checked before the shot is opened.

    Attributes:
        frames: USD time codes, or `DEFAULT_TIME` alone; None takes the first frame, for a movie all.
        given: settings of each picture that the command line gives, which win over those of the stage's settings prim.
        width: of each picture; None for that of the settings prim where ``takes_resolution``, else the default.
        takes_resolution: the chosen settings prim gives width and height.
        stock: film of the library; None keeps the shot's.
        lens: to mount; None keeps the camera's.
        grade: replaces parts of the shot's grade.
        camera: settings of the camera.
        burn_in: facts in the corners of graded pictures; None for none.
        flare: strength of lens flare.
        axes: of a contact sheet.
        long_exposure: one picture over many frames.
        is_progressive: true to write pictures while they are refined.
        is_movie: true to write all frames to one movie.
    """

    frames: list[float] | None
    given: dict[str, Any]
    width: int | None
    takes_resolution: bool
    stock: str | None
    lens: LensChoice | None
    grade: GradeChoice | None
    camera: camera_options.CameraOptions
    burn_in: BurnIn | None
    flare: flare.FlareOptions
    axes: tuple[Axis, ...] | None
    long_exposure: long_exposure.LongExposureOptions | None
    is_progressive: bool
    is_movie: bool

    def draw_over(self, graded: FloatArray, metadata: FrameMetadata) -> FloatArray:
        """Draw guides and burn-ins over a graded picture; it is an `Overlay`.

        Args:
            graded: ``(height, width, 3)``.
            metadata: of the picture.
        """
        graded = self.camera.draw_guides(graded, metadata.camera)
        if self.burn_in is None:
            return graded
        from render.drawing.burn_in import draw_burn_in  # imports matplotlib, which takes a second

        return draw_burn_in(graded, self.burn_in, metadata)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    parser.add_argument(
        "out",
        metavar="OUT",
        help="file to write: .exr (scene-linear), .png or .jpg (graded), where a run of # is the frame number;"
        " .mp4, .mov or .webm, a movie of all frames (graded); with --products a folder",
    )
    add_options(parser)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options, without those of `shared.add_stage`."""
    shared.add_camera(parser)
    stereo.add_arguments(parser)
    shared.add_lens(parser)
    parser.add_argument(
        "--film",
        metavar="NAME",
        help="expose this stock of the library (pullfocus films); without it the shot's own",
    )
    times = parser.add_mutually_exclusive_group()
    shared.add_frames(times, "the shot's first frame; for a movie all")
    times.add_argument(
        "--defaultTime",
        "-d",
        action="store_true",
        help="record the values that hold without a time, not those of a frame",
    )
    scene.add_arguments(parser)
    usdrecord.add_arguments(parser)
    picture.add_arguments(parser)
    for module in (camera_options, grade, flare, long_exposure, contact_sheet, progressive):
        module.add_arguments(parser)
    burn_in_options.add_argument(parser)
    parser.add_argument("--json", action="store_true", help="print a list of the written files on standard output")


def run(arguments: argparse.Namespace) -> None:
    """Render the frames and write them.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the arguments are out of range or contradict each other.
        InputError: the shot or its camera cannot be used.
        GraphicsError: no OpenGL context.
        OutputError: a file cannot be written; those before it are whole.
    """
    options = read_options(arguments)
    with usdrecord.applied(arguments):
        _run(arguments, options)


def _run(arguments: argparse.Namespace, options: RecordOptions) -> None:
    shot = scene.open_shot(arguments)
    if arguments.products:
        _run_products(arguments, options, shot)
        return
    if arguments.stereo:
        _run_stereo(arguments, options, shot)
        return
    frames = options.frames or _frames_without_option(shot, options)
    names = [arguments.out] if options.is_movie else frame_file_names(arguments.out, frames)
    files = [Path(name) for name in names]
    check_files(shot, [*files, *([arguments.traceToFile] if arguments.traceToFile else [])])
    grade.warn_of_unapplied(arguments)
    with shared.printed_findings(shot, arguments.stage):
        job = make_job(shot, shared.choose_camera(shot, arguments.camera), options, frames[0])
        written = _record(job, options, frames, files)
    if arguments.json:
        print_json(
            {
                "stage": arguments.stage,
                "camera": job.camera_path,
                "settings": camel_case_keys(asdict(job.settings)),
                "frames": [finite(entry) for entry in written],
                "findings": [asdict(finding) for finding in shot.findings()],
            }
        )


def _frames_without_option(shot: Shot, options: RecordOptions) -> list[float]:
    if options.is_movie:
        return every_frame(shot.frame_range.start, shot.frame_range.end)
    return [shot.frame_range.start if options.long_exposure is None else options.long_exposure.begin]


def _run_stereo(arguments: argparse.Namespace, options: RecordOptions, shot: Shot) -> None:
    """Record both eyes of a stereo pair."""
    from render.cli.recording.stereo import record_stereo_frames

    frames = options.frames or [shot.frame_range.start]
    files = stereo.view_files(arguments.out, frames)
    traced = [arguments.traceToFile] if arguments.traceToFile else []
    make_folders([file for each in files for file in {*each.values()}])
    check_files(shot, [*(file for each in files for file in each.values()), *traced])
    grade.warn_of_unapplied(arguments)
    with shared.printed_findings(shot, arguments.stage):
        pair = stereo.choose_pair(shot, arguments.camera)
        _set_camera(shot, pair.right, options)
        job = make_job(shot, pair.left, options, frames[0])
        written = record_stereo_frames(job, pair, list(zip(frames, files, strict=True)))
    if arguments.json:
        print_json(
            {
                "stage": arguments.stage,
                "cameras": asdict(pair),
                "settings": camel_case_keys(asdict(job.settings)),
                "frames": [finite(entry) for entry in written],
                "findings": [asdict(finding) for finding in shot.findings()],
            }
        )


def _run_products(arguments: argparse.Namespace, options: RecordOptions, shot: Shot) -> None:
    """Record each product of the stage's render settings into the folder OUT."""
    from render.cli.recording.products import ProductRun, product_files, record_products

    frames, folder = options.frames or [shot.frame_range.start], Path(arguments.out)
    grade.warn_of_unapplied(arguments)
    with shared.printed_findings(shot, arguments.stage):
        runs, set_up = [], set()
        for product in shot.products():
            camera = shared.choose_camera(shot, product.camera_path)
            pair = stereo.pair_with(shot, camera) if arguments.stereo else None
            files = product_files(product, folder, frames, is_stereo=pair is not None)
            cameras = (camera,) if pair is None else (pair.left, pair.right)
            for each in cameras:
                if each not in set_up:
                    _set_camera(shot, each, options)
                    set_up.add(each)
            aovs = tuple(dict.fromkeys(("color", *(var.aov for var in product.vars))))
            if format_of(files[0][0].name) != "exr":
                _note_dropped(shot, product, aovs[1:])
                aovs = ("color",)
            given = {**picture.merge(product.own, options.given), "aovs": aovs}
            if product.is_deep:
                given |= {"deep": True, "connections": False}
            settings = picture.make_settings(given, width=product.width, height=product.height)
            if not product.has_motion or math.isnan(frames[0]):
                settings = replace(settings, motion=1)
            with shot.framed(product.framing):
                for each in cameras:  # errors come before anything is rendered
                    shot.camera_at(each, frames[0], product.width, product.height)
            job = RecordJob(shot, cameras[0], settings, options.stock, options.grade, options.draw_over)
            runs.append(ProductRun(product, job, files, pair))
        all_files = [file for run in runs for each in run.files for file in each]
        make_folders(all_files)
        check_files(shot, all_files)
        written = record_products(runs, frames)
    if arguments.json:
        findings = [asdict(finding) for finding in shot.findings()]
        print_json({"stage": arguments.stage, "frames": [finite(entry) for entry in written], "findings": findings})


def _note_dropped(shot: Shot, product: Product, aovs: Sequence[str]) -> None:
    """Note the AOVs that a product's file cannot hold."""
    if aovs:
        message = f"vars of product {product.path} are left out, since {product.file} is no EXR: {', '.join(aovs)}"
        shot.note_asked([Finding("dropped_vars", product.path, message)])


def read_options(arguments: argparse.Namespace) -> RecordOptions:
    """Read and check what can be checked before the shot is opened.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the arguments are out of range or contradict each other.
        InputError: a file that they name cannot be used.
    """
    is_movie = movie.is_movie(arguments)
    progressive.check_progressive(arguments)
    usdrecord.check_arguments(arguments)
    stereo.check_arguments(arguments)
    axes = contact_sheet.read_axes(arguments)
    if arguments.products:
        _check_products(arguments)
    elif (
        not is_movie
        and axes is None
        and format_of(arguments.out) != "exr"
        and shared.split_words(arguments.aov) != ("color",)
    ):
        raise SettingsError(f"--aov {arguments.aov} needs an EXR file to hold it, got {arguments.out}")
    frames = _read_frames(arguments)
    if arguments.film is not None:
        library_stock(arguments.film)
    return RecordOptions(
        frames=frames,
        given=picture.read_given(arguments),
        width=arguments.imageWidth,
        takes_resolution=arguments.imageWidth is None
        and (arguments.renderSettingsPrimPath or arguments.renderPassPrimPath) is not None,
        stock=arguments.film,
        grade=grade.read_grade_choice(arguments),
        camera=camera_options.read_camera_options(arguments),
        burn_in=burn_in_options.read_burn_in(arguments),
        flare=flare.read_flare_options(arguments),
        axes=axes,
        long_exposure=long_exposure.read_long_exposure(arguments),
        lens=shared.read_lens(arguments),
        is_progressive=arguments.progressive,
        is_movie=is_movie,
    )


def _check_products(arguments: argparse.Namespace) -> None:
    """Refuse options that each product has of its own, and other ways of recording."""
    own = {"--camera": arguments.camera, "--imageWidth": arguments.imageWidth, "--crop": arguments.crop}
    ways = {"--contact-sheet": arguments.contact_sheet, "--long-exposure": arguments.long_exposure}
    refused = {**own, **ways, "--progressive": arguments.progressive or None}
    refused["--aov"] = None if arguments.aov == "color" else arguments.aov
    given = [name for name, value in refused.items() if value is not None]
    if given:
        raise SettingsError(f"--products takes cameras, sizes and vars from the stage: leave out {', '.join(given)}")


def _read_frames(arguments: argparse.Namespace) -> list[float] | None:
    if not arguments.defaultTime:
        return None if arguments.frames is None else parse_frames(arguments.frames)
    if "#" in arguments.out and not arguments.products:
        raise SettingsError(f"--defaultTime has no frame number for the # in {arguments.out!r}")
    if arguments.long_exposure is not None or arguments.contact_sheet is not None:
        raise SettingsError("--defaultTime takes single pictures: leave out --long-exposure and --contact-sheet")
    return [DEFAULT_TIME]


def make_job(shot: Shot, camera_path: str | None, options: RecordOptions, time: float) -> RecordJob:
    """Set the shot's camera as the options say, and collect what recording takes.

    Args:
        shot: the shot.
        camera_path: prim path; None for a camera that frames the whole stage.
        options: as `read_options` returns them.
        time: USD time code at which the size of the picture is taken.

    Raises:
        SettingsError: a setting is out of range.
        InputError: the camera cannot be used.
    """
    _set_camera(shot, camera_path, options)
    width, height = _picture_size(shot, camera_path, options, time)
    merged = picture.merge(shot.own_settings(), options.given)
    if options.long_exposure is not None and "motion" not in options.given:
        merged.pop("motion", None)  # it chooses its own
    settings = picture.make_settings(merged, width=width, height=height)
    if math.isnan(time):
        settings = replace(settings, motion=1)  # nothing moves at the default time
    _note_only_for_products(shot, has_motion=settings.motion > 1)
    return RecordJob(
        shot=shot,
        camera_path=camera_path,
        settings=settings,
        stock=options.stock,
        grade=options.grade,
        overlay=options.draw_over,
    )


def _note_only_for_products(shot: Shot, *, has_motion: bool) -> None:
    """Note what the shot's render settings ask for and a picture that is no product does not obey, nor does usdrecord's."""
    settings = shot.render_settings
    names = settings.only_for_products(has_motion=has_motion) if settings is not None else []
    if settings is not None and names:
        message = f"{settings.path} authors {' and '.join(names)}, which only --products obeys"
        shot.note_asked([Finding("only_products", settings.path, message)])


def _set_camera(shot: Shot, camera_path: str | None, options: RecordOptions) -> None:
    """Set a camera of the shot as the options say, for this run alone."""
    shared.mount_lens(shot, camera_path, options.lens)
    options.camera.set_on(shot, camera_path)
    options.flare.set_on(shot, camera_path)


def _picture_size(shot: Shot, camera_path: str | None, options: RecordOptions, time: float) -> tuple[int, int]:
    """Width and height in pixels: the resolution of the chosen settings prim, else the height that the film gate has."""
    settings = shot.render_settings if options.takes_resolution else None
    if settings is not None and settings.resolution is not None:
        return settings.resolution
    width = picture.DEFAULT_WIDTH_PX if options.width is None else options.width
    return width, picture_height(shot, camera_path, time, width)


def _record(
    job: RecordJob, options: RecordOptions, frames: Sequence[float], files: Sequence[Path]
) -> list[dict[str, Any]]:
    """Record in the way that the options ask for. The rarer ways are imported here, since each takes a while."""
    time, file = frames[0], files[0]
    if options.is_movie:
        from render.cli.recording.movie import record_movie

        return record_movie(job, frames, file)
    if options.axes is not None:
        from render.cli.recording.contact_sheet import record_contact_sheet

        return record_contact_sheet(job, options.axes, time, file)
    if options.long_exposure is not None:
        from render.cli.recording.long_exposure import record_long_exposure

        return record_long_exposure(job, options.long_exposure, file)
    plan = list(zip(frames, files, strict=True))
    if options.is_progressive:
        from render.cli.recording.progressive import record_progressively

        return record_progressively(job, plan)
    return record_frames(job, plan)
