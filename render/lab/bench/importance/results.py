"""Results of the importance bench, as its table, plot and JSON hold them."""

from __future__ import annotations

from dataclasses import dataclass

from render.lab.bench.results import Goal


@dataclass(frozen=True)
class ExperimentRow:
    """An experiment at one size. Seconds are wall time, for all of its frames.

    Attributes:
        name: of the experiment.
        title: moving objects.
        size: pixels along each side.
        frames: of the animation.
        linear_frames: those that the linear method was measured on; its seconds are scaled from them.
        linear_s: the linear method.
        importance_s: importance ordering, all changes made.
        none_s: no depth of field: sending the picture to the device, which the other two do too.
        linear_cpu_s: the linear method by the processor's clock, of all threads.
        importance_cpu_s: importance ordering by it.
        speedup: of importance ordering over the linear method: by the processor's clock where it does the work, which then counts
            no other work of a busy machine; by the wall's where a graphics device does.
        speedup_without_first: the same of a frame after the first, which must be spread whole either way.
        changed: share of the pixels that change from frame to frame, on average.
        most_apart: largest difference of a pixel between the two methods, on the linear method's frames.
    """

    name: str
    title: str
    size: int
    frames: int
    linear_frames: int
    linear_s: float
    importance_s: float
    none_s: float
    linear_cpu_s: float
    importance_cpu_s: float
    speedup: float
    speedup_without_first: float
    changed: float
    most_apart: float


@dataclass(frozen=True)
class SizesRow:
    """One of the first two experiments at one size of the star and one width of the film, which Fearing does not tell.

    Attributes:
        name: of the experiment.
        star_radius_mm: distance of the star's points from its middle.
        film_mm: width of the film.
        star_share: width of the star as it begins, as a share of the picture's width.
        blur_px: largest radius of a circle of confusion.
        changed: share of the pixels that change from frame to frame, on average.
        speedup: of importance ordering over the linear method, as in `ExperimentRow`.
        goal: Fearing's speed-up.
    """

    name: str
    star_radius_mm: float
    film_mm: float
    star_share: float
    blur_px: float
    changed: float
    speedup: float
    goal: float

    @property
    def meets(self) -> bool:
        """Whether the speed-up is at least Fearing's."""
        return self.speedup >= self.goal


@dataclass(frozen=True)
class CutoffRow:
    """One share of the changes, over the animation with the focus pulled back.

    Attributes:
        m: the share, in percent.
        seconds: for all frames, the first of which is made whole.
        psnr_db: of the last frame against the linear method's; None where they are the same.
        worst_psnr_db: of the frame that is least like it.
    """

    m: float
    seconds: float
    psnr_db: float | None
    worst_psnr_db: float | None


@dataclass(frozen=True)
class ImportanceBench:
    """Results of the importance bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        step_px: step of the radius; a smaller change counts as none.
        experiments: Fearing's tables 1 and 2.
        sizes: his first two experiments over sizes of the star and the film.
        cutoff: his figure 4.
        goals: goals and whether they are met.
    """

    device: str
    step_px: float
    experiments: list[ExperimentRow]
    sizes: list[SizesRow]
    cutoff: list[CutoffRow]
    goals: list[Goal]
