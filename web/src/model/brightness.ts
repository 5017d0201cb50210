/** What sets the brightness of the picture, in words. */

import { agrees, formatStops, formatTime, type ExposureSettings, type Photography } from "./photography";
import { EXPOSURE_DEFAULTS } from "./settings.gen";
import { statedStop } from "./stops";

/** A value that counts, and the setting whose control sets it; null where the page has none. */
export interface Part {
  readonly text: string;
  readonly setting: string | null;
}

/**
 * What decides: the light meter; the settings of the camera; or nothing, so that the light of the scene is taken as it is, but for
 * what else is said.
 */
export interface Brightness {
  readonly by: "meter" | "camera" | "scene";
  readonly parts: readonly Part[];
}

/** Bellows from which anybody would see them, as a factor. */
const SEEN = 1.005;

export function brightnessOf({ exposure, film, readout }: Photography): Brightness {
  const after = film.process !== "none" && film.process !== "digital" && film.push !== 0 ? [pushed(film.push)] : [];
  if (exposure.meteringMode !== "manual") return { by: "meter", parts: [...byMeter(exposure), ...after] };
  const isPlain = PLAIN.every((name) => exposure[name] === EXPOSURE_DEFAULTS[name]);
  const stop = exposure.exposureStop === "iris" ? "fStop" : "exposureFStop";
  const time = agrees(exposure, readout)
    ? readout.shutterTimeS > 0 && `shutter ${Number(exposure.shutterAngleDeg.toFixed(1)).toString()}°`
    : false;
  const glass = exposure.transmittance < 1 && exposure.stopMarking === "f";
  const parts: readonly (Part | false)[] = [
    !isPlain && { text: time || `exposed ${formatTime(exposure.exposureTimeS)}`, setting: "shutterClose" },
    !isPlain && { text: `ISO ${Number(exposure.iso.toFixed(1)).toString()}`, setting: "iso" },
    !isPlain && { text: statedStop(readout.fStop, exposure.stopMarking, exposure.transmittance), setting: stop },
    isPlain && glass && { text: `glass ${stops(Math.log2(exposure.transmittance))}`, setting: "transmittance" },
    exposure.neutralDensity !== 0 && {
      text: `ND ${Number(exposure.neutralDensity.toFixed(2)).toString()}`,
      setting: "neutralDensity",
    },
    exposure.compensationStops !== 0 && { text: stops(exposure.compensationStops), setting: "compensationStops" },
    readout.bellowsFactor > SEEN && {
      text: `bellows ${stops(-Math.log2(readout.bellowsFactor))}`,
      setting: "breathing",
    },
    exposure.responsivity !== 1 && {
      text: `responsivity ${Number(exposure.responsivity.toFixed(3)).toString()}`,
      setting: null,
    },
  ];
  return { by: isPlain ? "scene" : "camera", parts: [...parts.filter((part) => part !== false), ...after] };
}

/** Settings that, as USD has them by default, leave the light as it is. */
const PLAIN = ["exposureStop", "exposureTimeS", "iso", "exposureFStop", "responsivity", "stopMarking"] as const;

const LOOKS_AT = { center: "centre", average: "average", spot: "spot" } as const;

function byMeter(exposure: ExposureSettings): Part[] {
  const { meteringMode, meteringFocusPoint, meteringCompensationStops } = exposure;
  if (meteringMode === "manual") return [];
  const isOnPoint = meteringMode === "spot" && meteringFocusPoint !== "";
  const at = isOnPoint ? `spot on ${meteringFocusPoint}` : LOOKS_AT[meteringMode];
  return [
    { text: at, setting: "meteringMode" },
    ...(meteringCompensationStops === 0
      ? []
      : [{ text: stops(meteringCompensationStops), setting: "meteringCompensationStops" }]),
  ];
}

function pushed(push: number): Part {
  return { text: `${push > 0 ? "pushed" : "pulled"} ${stops(Math.abs(push)).slice(1)}`, setting: "push" };
}

function stops(value: number): string {
  const said = formatStops(value);
  return `${said} ${said.slice(1) === "1" ? "stop" : "stops"}`;
}
