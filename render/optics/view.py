"""A perspective picture of the world from one point: the affine map between metres and pixels.

Pixels follow the arrays: x to the right, y *down*, (0, 0) is the top left corner of the picture and the centre of its
first pixel is (0.5, 0.5). Camera space is USD's: +X right, +Y up, looking along -Z; depth ``z`` is ``-Z`` in metres.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.errors import CameraError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane
from render.model.limits import check_picture_size
from render.optics.prescription.mounting import breathing_ratio, has_surfaces


@dataclass(frozen=True)
class PinholeView:
    """Projection through one point ``eye`` of the entrance pupil.

    A world point with camera coordinates ``(X, Y, -z)`` lands at
    ``(cx + fx·(X - eye_x)/z,  cy - fy·(Y - eye_y)/z)``, but for the shear.

    Attributes:
        width: of the picture in pixels.
        height: of the picture in pixels.
        fx: focal length in pixels, horizontal.
        fy: focal length in pixels, vertical.
        cx: where the view axis through ``eye`` meets the picture, pixels.
        cy: the same, pixels from the top.
        near_m: nearest depth drawn.
        far_m: farthest depth drawn; may be infinite.
        camera_from_world: ``(4, 4)`` float64.
        eye_x_m: offset of the eye from the pupil's centre to the right.
        eye_y_m: likewise, up.
        shear: what slopes ``(X - eye_x, Y - eye_y)/z``, right and up, are multiplied by before they become pixels: ``(xx, xy, yx,
            yy)``; other than the identity for a view that keeps a tilted plane in place.
        clip_planes: as the camera's, in the space of ``camera_from_world``.
        base_w: inverse depth from which layers and focus count theirs, 1/m: 0, or for a camera that stands so far back that all
            it sees has nearly one inverse depth, that of a place behind it all. Rays are lines in w from any base.
        set_back_m: as the camera's.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    near_m: float
    far_m: float
    camera_from_world: DoubleArray
    eye_x_m: float = 0.0
    eye_y_m: float = 0.0
    shear: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 1.0)
    clip_planes: tuple[tuple[float, float, float, float], ...] = ()
    base_w: float = 0.0
    set_back_m: float = 0.0

    @classmethod
    def from_camera(cls, camera: Camera, width: int, height: int) -> PinholeView:
        """View from the centre of the camera's entrance pupil.

        Raises:
            SettingsError: the picture has no pixels or too many.
            CameraError: focal length, aperture or clipping range is not a positive finite number.
            InputError: the camera's lens breathes, and its prescription is not a lens.
        """
        check_picture_size(width, height)
        check_camera(camera)
        fx = camera.focal_length_mm / camera.horizontal_aperture_mm * width
        fy = camera.focal_length_mm / camera.vertical_aperture_mm * height
        if camera.breathing and camera.focus_distance_m > 0 and np.isfinite(camera.focus_distance_m):
            stretch = breathing_ratio(camera) if has_surfaces(camera) else _image_distance_ratio(camera)
            fx, fy = fx * stretch, fy * stretch
        return cls(
            width=width,
            height=height,
            fx=fx,
            fy=fy,
            cx=width * (0.5 - camera.horizontal_offset_mm / camera.horizontal_aperture_mm),
            cy=height * (0.5 + camera.vertical_offset_mm / camera.vertical_aperture_mm),
            near_m=camera.near_m,
            far_m=camera.far_m,
            camera_from_world=np.asarray(np.linalg.inv(camera.world_from_camera), np.float64),
            clip_planes=camera.clip_planes,
            base_w=_base_w(camera),
            set_back_m=camera.set_back_m,
        )

    @property
    def nearest_w(self) -> float:
        """Inverse depth of the near plane from `base_w`, 1/m."""
        return 1 / self.near_m - self.base_w

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.width, self.height

    @property
    def eye_in_world(self) -> DoubleArray:
        """``(3,)`` position of the eye in the world, metres."""
        return np.asarray((np.linalg.inv(self.camera_from_world) @ (self.eye_x_m, self.eye_y_m, 0.0, 1.0))[:3])

    @property
    def farthest_near_m(self) -> float:
        """Distance from the eye to the farthest point of the near plane that the picture shows, metres."""
        corners = ((x, y) for x in (0, self.width) for y in (0, self.height))
        return self.near_m * max(float(np.linalg.norm(self.ray(x, y)[1])) for x, y in corners)

    def resize(self, width: int, height: int) -> PinholeView:
        """The same view at another resolution."""
        x, y = width / self.width, height / self.height
        return replace(self, width=width, height=height, fx=self.fx * x, fy=self.fy * y, cx=self.cx * x, cy=self.cy * y)

    def widen(self, margin: int) -> PinholeView:
        """View with ``margin`` more pixels on each side."""
        width, height = self.width + 2 * margin, self.height + 2 * margin
        return replace(self, width=width, height=height, cx=self.cx + margin, cy=self.cy + margin)

    def matches(self, other: PinholeView) -> bool:
        """Whether both show the same of the world, pixel by pixel."""
        same_place = np.array_equal(self.camera_from_world, other.camera_from_world)
        return same_place and replace(self, camera_from_world=other.camera_from_world) == other

    def project(self, points_world: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """Picture position and depth of world points.

        Args:
            points_world: ``(n, 3)`` metres.

        Returns:
            ``(n, 2)`` pixels and ``(n,)`` depth in metres. A point at or behind the pupil has depth <= 0 and position NaN.
        """
        points = np.asarray(points_world, np.float64).reshape(-1, 3)
        x, y, z = (points @ self.camera_from_world[:3, :3].T + self.camera_from_world[:3, 3]).T
        depth = -z
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            slope_x, slope_y = (x - self.eye_x_m) / depth, (y - self.eye_y_m) / depth
            px = self.cx + self.fx * (self.shear[0] * slope_x + self.shear[1] * slope_y)
            py = self.cy - self.fy * (self.shear[2] * slope_x + self.shear[3] * slope_y)
        pixels = np.stack([px, py], axis=-1)
        pixels[depth <= 0] = np.nan
        return pixels, depth

    def ray(self, x: float, y: float) -> tuple[DoubleArray, DoubleArray]:
        """World ray of a picture position: origin ``(3,)`` and direction ``(3,)`` of unit depth (metres per metre of z)."""
        world_from_camera = np.linalg.inv(self.camera_from_world)
        slopes = np.linalg.solve(np.reshape(self.shear, (2, 2)), [(x - self.cx) / self.fx, -(y - self.cy) / self.fy])
        direction = np.array([*slopes, -1.0])
        origin = np.array([self.eye_x_m, self.eye_y_m, 0.0, 1.0])
        return (world_from_camera @ origin)[:3], world_from_camera[:3, :3] @ direction

    def through(
        self, x_m: float, y_m: float, plane: FocalPlane, jitter_px: tuple[float, float] = (0, 0)
    ) -> PinholeView:
        """View through another point of the pupil that keeps a plane of focus in place.

        It is the shear of Haeberli & Akeley 1990 (section 5): what stands in the plane lands where the central view has it. With
        ``e`` the point, ``s`` a slope from the centre and ``w_f = w0 + g·σ``, the picture shows at σ what lies at
        ``s = σ + e·(w - w_f)``, so that ``σ = (I - e gᵀ)⁻¹ (s - e·w + e·w0)``: a projection again.
        ``jitter_px`` moves the sensor's sampling point: the picture at ``p`` shows what the central view has at ``p + jitter``.
        """
        eye, slopes = np.array([x_m, y_m]), np.array([plane.slope_x, plane.slope_y])
        shear = np.linalg.inv(np.eye(2) - np.outer(eye, slopes))
        x, y = shear @ eye * plane.w0
        return replace(
            self,
            cx=self.cx + self.fx * float(x) - jitter_px[0],
            cy=self.cy - self.fy * float(y) - jitter_px[1],
            eye_x_m=x_m,
            eye_y_m=y_m,
            shear=(float(shear[0, 0]), float(shear[0, 1]), float(shear[1, 0]), float(shear[1, 1])),
        )

    def across(self, plane: FocalPlane) -> tuple[float, float, float]:
        """Inverse depth of a plane at the picture's top left corner, from `base_w`, 1/m, and its change per pixel right and
        down."""
        right, down = plane.slope_x / self.fx, -plane.slope_y / self.fy
        return plane.w0 - self.base_w - right * self.cx - down * self.cy, right, down

    def projection_matrix(self) -> DoubleArray:
        """Projection matrix ``(4, 4)``, clip from camera space, for OpenGL with a zero-to-one depth range.

        Row 0 of the picture is the first row of the framebuffer (y points down), and the depth is affine in inverse
        depth: 1 at ``near_m`` and 0 at ``far_m``, so a float depth buffer keeps its relative precision to infinity.
        """
        w_near, w_far = 1.0 / self.near_m, 0.0 if np.isinf(self.far_m) else 1.0 / self.far_m
        matrix = np.zeros((4, 4))
        xx, xy, yx, yy = self.shear
        across, down = 2 * self.fx / self.width, -2 * self.fy / self.height
        at_x, at_y = xx * self.eye_x_m + xy * self.eye_y_m, yx * self.eye_x_m + yy * self.eye_y_m
        matrix[0] = [across * xx, across * xy, 1 - 2 * self.cx / self.width, -across * at_x]
        matrix[1] = [down * yx, down * yy, 1 - 2 * self.cy / self.height, -down * at_y]
        matrix[2] = [0, 0, w_far / (w_near - w_far), 1 / (w_near - w_far)]
        matrix[3] = [0, 0, -1, 0]
        return matrix


def _base_w(camera: Camera) -> float:
    """`PinholeView.base_w` of a camera: where it stands far back, half as far behind what it sees as that is deep, in 1/m."""
    if camera.orthographic is None:
        return 0.0
    return 1.5 / camera.far_m - 0.5 / camera.near_m


def check_camera(camera: Camera) -> None:
    """Raise `CameraError` where a number of the camera makes no picture."""
    positive = {
        "focal length (mm)": camera.focal_length_mm,
        "horizontal aperture (mm)": camera.horizontal_aperture_mm,
        "vertical aperture (mm)": camera.vertical_aperture_mm,
        "near clipping distance (m)": camera.near_m,
    }
    for name, value in positive.items():
        if not (np.isfinite(value) and value > 0):
            raise CameraError(f"camera {camera.path}: {name} must be a positive number, got {value}", path=camera.path)
    if not camera.far_m > camera.near_m:
        raise CameraError(
            f"camera {camera.path}: far clipping distance ({camera.far_m} m) must exceed the near one ({camera.near_m} m)",
            path=camera.path,
        )
    if not (np.isfinite(camera.f_stop) and camera.f_stop >= 0):
        raise CameraError(
            f"camera {camera.path}: f-number must be 0 (pinhole) or more, got {camera.f_stop}", path=camera.path
        )
    if np.isnan(camera.focus_distance_m) or camera.focus_distance_m < 0:
        raise CameraError(
            f"camera {camera.path}: focus distance must be 0 (infinity) or more, got {camera.focus_distance_m} m",
            path=camera.path,
        )
    if not np.isfinite(camera.world_from_camera).all():
        raise CameraError(f"camera {camera.path}: its transform is not finite", path=camera.path)


def _image_distance_ratio(camera: Camera) -> float:
    """Image distance over focal length of a thin lens, ``d / (d - f)``."""
    focus_mm = camera.focus_distance_m * 1000
    if focus_mm <= camera.focal_length_mm:
        raise CameraError(
            f"camera {camera.path}: with breathing on, the focus distance ({focus_mm:g} mm) must exceed the focal length "
            f"({camera.focal_length_mm:g} mm)",
            path=camera.path,
        )
    return focus_mm / (focus_mm - camera.focal_length_mm)
