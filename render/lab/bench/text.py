"""The lens bench for people: plain tables of fixed columns. Times are milliseconds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from render.lab.bench.results import LensBench, ReferenceTimes, Sweeps, Times

_NAME = 12


def report(bench: LensBench) -> str:
    """Everything that was found, as lines."""
    return "\n".join([*_head(bench), *_scenes(bench), *_sweeps(bench.sweeps), *_goals(bench)]) + "\n"


def _head(bench: LensBench) -> Iterator[str]:
    yield f"{bench.device}; {bench.width}x{bench.height}, {bench.rays} rays, layers supersampled by {bench.supersample:g}"
    yield "Milliseconds, medians of several runs where they are quick: by the wall's clock, and in brackets by the processor's,"
    yield "of all threads, which other work hardly touches. The reference is the accumulation buffer with the same rays."


def _scenes(bench: LensBench) -> Iterator[str]:
    yield ""
    yield _line(
        "scene", "triangles", *_STAGES, "reference", "ratio", "PSNR dB", "SSIM", "layers", "layers MB", "spared"
    )
    for row in bench.scenes:
        yield _line(
            row.name,
            f"{row.triangles:,}",
            *_costs(row),
            *_ratio(row),
            f"{row.psnr_db:.2f}",
            f"{row.ssim:.4f}",
            str(row.layers),
            f"{row.layers_mb:.0f}",
            f"{row.spared:.0%}",
        )
        yield _line("", "", *_in_brackets([*_costs(row.cpu), *_ratio(row.cpu)]))
    for row in bench.scenes:
        yield f"{row.name}: {len(row.ratios)} runs had ratios of {_spread(row.ratios)} ({_spread(row.cpu_ratios)})"
    yield "spared: share of the texels behind the first layer that are not drawn, since no ray reaches them"
    yield f"Four layers of 1024x768 and their N-buffers: {bench.layers_mb_1024x768:.1f} MB"


def _sweeps(sweeps: Sweeps) -> Iterator[str]:
    yield ""
    yield _line(f"{sweeps.scene}:", "rays", *_STAGES, "reference", "ratio")
    for rays in sweeps.rays:
        yield _line("", str(rays.rays), *_costs(rays), *_ratio(rays))
        yield _line("", "", *_in_brackets([*_costs(rays.cpu), *_ratio(rays.cpu)]))
    yield ""
    yield _line("", "layers", *_STAGES, "peeled", "PSNR dB", "SSIM")
    for layers in sweeps.layers:
        likeness = (str(layers.peeled), f"{layers.psnr_db:.2f}", f"{layers.ssim:.4f}")
        yield _line("", str(layers.layers), *_costs(layers), *likeness)
        yield _line("", "", *_in_brackets(_costs(layers.cpu)))
    yield ""
    yield _line("", "aperture", *_STAGES, "reference", "ratio", "blur px", "layers")
    for aperture in sweeps.aperture:
        blur = (f"{aperture.blur_px:.1f}", str(aperture.layers))
        yield _line("", f"f/{aperture.f_stop:g}", *_costs(aperture), *_ratio(aperture), *blur)
        yield _line("", "", *_in_brackets([*_costs(aperture.cpu), *_ratio(aperture.cpu)]))
    yield ""
    yield _line("lens", "surfaces", *_STAGES, "f-number", "colours", "thin trace", "over thin", "its table")
    for lens in sweeps.surfaces:
        glass = (f"f/{lens.f_stop:g}", "apart" if lens.disperses else "as one")
        beside = (f"{lens.thin_trace_ms:.0f}", f"{lens.trace_over_thin:.2f}", f"{lens.table_ms:.0f}")
        yield _line(lens.lens, str(lens.surfaces), *_costs(lens), *glass, *beside)
        yield _line("", "", *_in_brackets(_costs(lens.cpu)), "", "", "", f"({lens.cpu_trace_over_thin:.2f})")


def _goals(bench: LensBench) -> Iterator[str]:
    yield ""
    if not bench.goals:
        yield "The goals are set for pictures of 800x600 with 100 rays: at these settings there is nothing to hold."
    for goal in bench.goals:
        yield f"{'pass' if goal.holds else 'FAIL'}  {goal.goal} {goal.want:g}: {goal.got:.4g}"


_STAGES = ("peel", "+ N-buffers", "+ trace", "= total")


def _costs(row: Times) -> list[str]:
    return [
        f"{ms:.0f}" if ms >= 100 else f"{ms:.1f}" for ms in (row.peel_ms, row.nbuffer_ms, row.trace_ms, row.total_ms)
    ]


def _ratio(row: ReferenceTimes) -> list[str]:
    return [f"{row.reference_ms:.0f}", f"{row.ratio:.1f}"]


def _spread(ratios: list[float]) -> str:
    """Ratios from the least to the greatest, and how far these are apart relative to the middle."""
    apart = (max(ratios) - min(ratios)) / ratios[(len(ratios) - 1) // 2]
    return f"{min(ratios):.1f} to {max(ratios):.1f}, {apart:.0%} apart"


def _in_brackets(cells: Iterable[str]) -> list[str]:
    return [f"({cell})" for cell in cells]


def _line(name: str, *cells: str) -> str:
    return f"{name:<{_NAME}}{''.join(f'{cell:>{_NAME}}' for cell in cells)}".rstrip()
