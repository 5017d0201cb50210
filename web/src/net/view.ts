/** The camera of a shot that the page looks through. */

/** A null camera is the shot's own choice. */
export interface View {
  readonly shot: string;
  readonly camera: string | null;
}

/** The camera as a parameter: left out, the service takes the shot's own. */
export function cameraOf(view: View): { camera?: string } {
  return view.camera === null ? {} : { camera: view.camera };
}
