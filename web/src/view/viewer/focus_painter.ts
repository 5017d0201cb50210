/** Draws how sharp a picture is on a canvas, by WebGL. */

import type { FocusMap } from "../../model/focus_map";
import type { Look } from "../../model/sharpness";
import { FRAGMENTS, VERTICES } from "./focus_shader";

const LOOK_NUMBERS: Readonly<Record<Look, number>> = { none: 0, peaking: 1, falseColour: 2 };

/** A picture and how it is to be shown. */
export interface FocusPainting {
  readonly map: FocusMap;
  readonly bitmap: ImageBitmap;
  readonly look: Look;
  readonly lines: boolean;
  /** Largest circle of confusion that is sharp. */
  readonly limitMm: number;
  /** Size of the canvas, px. */
  readonly width: number;
  readonly height: number;
}

export class FocusPainter {
  readonly #canvas: HTMLCanvasElement;
  readonly #gl: WebGL2RenderingContext;
  readonly #program: WebGLProgram;
  readonly #circles: WebGLTexture;
  readonly #picture: WebGLTexture;
  /** What the textures hold. */
  #map: FocusMap | null = null;
  #bitmap: ImageBitmap | null = null;

  /** A painter; null where the browser has no WebGL 2. */
  static on(canvas: HTMLCanvasElement): FocusPainter | null {
    const gl = canvas.getContext("webgl2", { premultipliedAlpha: true, preserveDrawingBuffer: true, antialias: false });
    return gl && new FocusPainter(canvas, gl);
  }

  private constructor(canvas: HTMLCanvasElement, gl: WebGL2RenderingContext) {
    this.#canvas = canvas;
    this.#gl = gl;
    this.#program = linked(gl);
    this.#circles = texture(gl, gl.NEAREST);
    this.#picture = texture(gl, gl.LINEAR);
    gl.useProgram(this.#program);
    gl.uniform1i(this.#at("circles"), 0);
    gl.uniform1i(this.#at("picture"), 1);
  }

  paint({ map, bitmap, look, lines, limitMm, width, height }: FocusPainting): void {
    const gl = this.#gl;
    this.#upload(map, bitmap);
    if (this.#canvas.width !== width || this.#canvas.height !== height)
      [this.#canvas.width, this.#canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.uniform2f(this.#at("canvas"), width, height);
    gl.uniform1f(this.#at("limit"), limitMm / 2 / map.filmMmPerPx);
    gl.uniform1i(this.#at("look"), LOOK_NUMBERS[look]);
    gl.uniform1i(this.#at("lines"), Number(lines));
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  clear(): void {
    this.#gl.clear(this.#gl.COLOR_BUFFER_BIT);
  }

  /** Calls back when the browser takes the context away; what is returned ends that. */
  onLost(act: () => void): () => void {
    this.#canvas.addEventListener("webglcontextlost", act);
    return () => {
      this.#canvas.removeEventListener("webglcontextlost", act);
    };
  }

  /** Gives the memory back. The canvas cannot be drawn on any more. */
  release(): void {
    for (const held of [this.#circles, this.#picture]) this.#gl.deleteTexture(held);
    this.#gl.deleteProgram(this.#program);
    this.#gl.getExtension("WEBGL_lose_context")?.loseContext();
  }

  #at(name: string): WebGLUniformLocation | null {
    return this.#gl.getUniformLocation(this.#program, name);
  }

  #upload(map: FocusMap, bitmap: ImageBitmap): void {
    const gl = this.#gl;
    if (map !== this.#map) {
      gl.activeTexture(gl.TEXTURE0);
      gl.bindTexture(gl.TEXTURE_2D, this.#circles);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, map.width, map.height, 0, gl.RED, gl.FLOAT, map.cocPx);
      this.#map = map;
    }
    if (bitmap !== this.#bitmap) {
      gl.activeTexture(gl.TEXTURE1);
      gl.bindTexture(gl.TEXTURE_2D, this.#picture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
      this.#bitmap = bitmap;
    }
  }
}

function linked(gl: WebGL2RenderingContext): WebGLProgram {
  const program = gl.createProgram();
  for (const [kind, source] of [
    [gl.VERTEX_SHADER, VERTICES],
    [gl.FRAGMENT_SHADER, FRAGMENTS],
  ] as const) {
    const shader = gl.createShader(kind);
    if (!shader) continue; // the context is lost
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error(`The program that shows sharpness cannot be made: ${gl.getProgramInfoLog(program) ?? ""}`);
  return program;
}

function texture(gl: WebGL2RenderingContext, filter: number): WebGLTexture {
  const made = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, made);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return made;
}
