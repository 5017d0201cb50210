/** Sends a file and tells how far it is: with XMLHttpRequest, since fetch tells nothing of what goes out. */

import { errorOf, UnreachableError } from "./errors";

/**
 * @param fields of the form, beside the file.
 * @param onProgress called with the part of the bytes that is sent, 0 to 1.
 * @returns the answer's JSON.
 * @throws ServiceError, UnreachableError, or an AbortError.
 */
export function sendFile(
  address: string,
  file: File,
  fields: Readonly<Record<string, string>>,
  onProgress: (fraction: number) => void,
  signal: AbortSignal,
): Promise<unknown> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const form = new FormData();
    form.append("file", file);
    for (const [name, value] of Object.entries(fields)) form.append(name, value);
    request.open("POST", address);
    request.responseType = "json";
    request.upload.onprogress = (event) => {
      if (event.lengthComputable) onProgress(event.loaded / event.total);
    };
    request.onload = () => {
      if (request.status >= 200 && request.status < 300) resolve(request.response);
      else reject(errorOf(request.status, request.response, request.getResponseHeader("Retry-After")));
    };
    request.onerror = () => {
      reject(new UnreachableError());
    };
    request.onabort = () => {
      reject(new DOMException("The upload was given up.", "AbortError"));
    };
    signal.addEventListener(
      "abort",
      () => {
        request.abort();
      },
      { once: true },
    );
    request.send(form);
  });
}
