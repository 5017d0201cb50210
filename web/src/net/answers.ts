/** Answers of openapi-fetch as data, or as the errors of the page. */

import { errorOf, isAbort, UnreachableError, type ServiceError } from "./errors";

/** Answer of openapi-fetch: either data or an error. */
export interface Answer<Data> {
  readonly data?: Data;
  readonly error?: unknown;
  readonly response: Response;
}

/** Statuses after which a request may be sent again as it is. */
export const REFUSED_FOR_NOW = [401, 429, 503];

export async function refusalIn(answer: Response): Promise<ServiceError> {
  const body: unknown = await answer.json().catch(() => null);
  return errorOf(answer.status, body, answer.headers.get("Retry-After"));
}

export async function result<Data>(answer: Promise<Answer<Data>>): Promise<Data> {
  const { data, error, response } = await reached(answer);
  if (!response.ok) throw errorOf(response.status, error, response.headers.get("Retry-After"));
  return data as Data;
}

export async function done(answer: Promise<Answer<unknown>>): Promise<void> {
  await result(answer);
}

/** Awaits an answer; the error of fetch without one becomes an `UnreachableError`. */
async function reached<Data>(answer: Promise<Answer<Data>>): Promise<Answer<Data>> {
  try {
    return await answer;
  } catch (error) {
    throw isAbort(error) || !(error instanceof TypeError) ? error : new UnreachableError();
  }
}
