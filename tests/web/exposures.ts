/** A camera that exposes nothing by itself, for tests. */

import type { ExposureReadout, ExposureSettings } from "@/model/photography";
import { EXPOSURE_DEFAULTS } from "@/model/settings.gen";

export const EXPOSURE: ExposureSettings = {
  ...EXPOSURE_DEFAULTS,
  shutterEfficiency: [],
  meteringSpot: [0.5, 0.5],
  channelIndex: [0, 0, 0],
  shutterAngleDeg: 180,
  keys: {},
};
export const READOUT: ExposureReadout = {
  fStop: 1,
  effectiveTStop: 1,
  bellowsFactor: 1,
  ev100: 0,
  ndStops: 0,
  shutterTimeS: 1 / 48,
  greyNits: 0.18,
};
