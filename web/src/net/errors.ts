/** Errors between page and service, and one line for a person about each. */

/** The one shape of the service's errors. */
export interface Problem {
  readonly code: string;
  readonly detail: string;
  readonly path?: string | null;
}

/** The service refused a request or failed, with a reason. */
export class ServiceError extends Error {
  readonly code: string;
  readonly path: string | null;
  readonly status: number;

  constructor(problem: Problem, status: number) {
    super(problem.detail);
    this.name = "ServiceError";
    this.code = problem.code;
    this.path = problem.path ?? null;
    this.status = status;
  }
}

/** Nothing came back at all. */
export class UnreachableError extends Error {
  constructor() {
    super("The service does not answer.");
    this.name = "UnreachableError";
  }
}

/** Nothing failed, but the gesture has no effect. */
export class HintError extends Error {
  readonly advice: string;

  constructor(message: string, advice: string) {
    super(message);
    this.name = "HintError";
    this.advice = advice;
  }
}

/** Makes an error of what came back in place of a result. */
export function errorOf(status: number, body: unknown): ServiceError {
  if (isProblem(body)) return new ServiceError(body, status);
  return new ServiceError(
    { code: `http_${status.toString()}`, detail: `The service answered with status ${status.toString()}.` },
    status,
  );
}

function isProblem(body: unknown): body is Problem {
  return (
    typeof body === "object" && body !== null && "code" in body && "detail" in body && typeof body.detail === "string"
  );
}

/** Whether an error only says that its request was given up on purpose, here or by a newer one at the service. */
export function isAbort(error: unknown): boolean {
  if (error instanceof ServiceError) return error.code === "superseded";
  return error instanceof DOMException && error.name === "AbortError";
}

/** An error for a person: what happened, and what to do about it. */
export interface Complaint {
  readonly message: string;
  readonly advice: string;
  /** Whether asking again may help. */
  readonly passing: boolean;
}

export function complaintOf(error: unknown): Complaint {
  if (error instanceof ServiceError && error.status === 412) return CHANGED_MEANWHILE;
  if (error instanceof UnreachableError) {
    return { message: error.message, advice: "Check that “pullfocus serve” is running.", passing: true };
  }
  if (error instanceof ServiceError) {
    return { message: sentence(error.message), advice: adviceFor(error), passing: error.status >= 500 };
  }
  if (error instanceof HintError) return { message: error.message, advice: error.advice, passing: false };
  return {
    message: error instanceof Error ? sentence(error.message) : "Something failed.",
    advice: "Reload the page.",
    passing: false,
  };
}

/** Another editor changed the same resource: the page was out of date, so nothing is changed. */
const CHANGED_MEANWHILE: Complaint = {
  message: "Somebody else changed this meanwhile.",
  advice: "It is shown as it is now; repeat your edit if you still want it.",
  passing: false,
};

function adviceFor(error: ServiceError): string {
  switch (error.status) {
    case 404:
      return "It may have been removed: reload the page.";
    case 413:
      return "Send a smaller file, or one that leaves out what the shot does not use.";
    case 415:
    case 422:
      return "Nothing was changed.";
    case 503:
      return "Try again in a moment.";
    default:
      return error.status >= 500 ? "If it fails again, the service’s log says more." : "Nothing was changed.";
  }
}

/** With a capital at its head, unless that is a name, and a full stop at its end. */
function sentence(text: string): string {
  const trimmed = text.trim();
  const headed = /^[a-z]+(\s|$)/.test(trimmed) ? trimmed.charAt(0).toUpperCase() + trimmed.slice(1) : trimmed;
  return /[.!?]$/.test(headed) ? headed : `${headed}.`;
}
