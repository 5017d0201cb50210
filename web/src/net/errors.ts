/** Errors between page and service, and one line for a person about each. */

/** The one shape of the service's errors. */
export interface Problem {
  readonly code: string;
  readonly detail: string;
  readonly path?: string | null;
  /** The single findings, where there are several. */
  readonly errors?: readonly { readonly path: string; readonly detail: string }[];
}

/** The service refused a request or failed, with a reason. */
export class ServiceError extends Error {
  readonly code: string;
  readonly path: string | null;
  /** The single findings, where there are several. */
  readonly findings: NonNullable<Problem["errors"]>;
  readonly status: number;
  /** Wait that the service asks for before another try, s; null where it asks for none. */
  readonly retryAfterS: number | null;

  constructor(problem: Problem, status: number, retryAfterS: number | null = null) {
    super(problem.detail);
    this.name = "ServiceError";
    this.code = problem.code;
    this.path = problem.path ?? null;
    this.findings = problem.errors ?? [];
    this.status = status;
    this.retryAfterS = retryAfterS;
  }

  /** What the single findings are about. */
  get subjects(): readonly string[] {
    return this.findings.map(({ path }) => path);
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

/**
 * Makes an error of what came back in place of a result.
 *
 * @param retryAfter the header `Retry-After`, in seconds.
 */
export function errorOf(status: number, body: unknown, retryAfter: string | null = null): ServiceError {
  const retryAfterS = retryAfter !== null && /^\d+$/.test(retryAfter) ? Number(retryAfter) : null;
  if (isProblem(body)) return new ServiceError(body, status, retryAfterS);
  const detail = `The service answered with status ${status.toString()}.`;
  return new ServiceError({ code: `http_${status.toString()}`, detail }, status, retryAfterS);
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
  /** What may help at once: the same again, or a key. */
  readonly remedy: "retry" | "signIn" | null;
}

export function complaintOf(error: unknown): Complaint {
  if (error instanceof ServiceError && error.status === 412) return CHANGED_MEANWHILE;
  if (error instanceof ServiceError && error.status === 401) return NOT_SIGNED_IN;
  if (error instanceof UnreachableError) {
    return { message: error.message, advice: "Check that “pullfocus serve” is running.", remedy: "retry" };
  }
  if (error instanceof ServiceError) {
    const remedy = error.status >= 500 || MAY_PASS.includes(error.status) ? "retry" : null;
    return { message: sentence(error.message), advice: adviceFor(error), remedy };
  }
  if (error instanceof HintError) return { message: error.message, advice: error.advice, remedy: null };
  return {
    message: error instanceof Error ? sentence(error.message) : "Something failed.",
    advice: "Reload the page.",
    remedy: null,
  };
}

/** Refusals that may be over soon: what is missing may come back, as by an undo of somebody else. */
const MAY_PASS = [404, 409, 429];

/** Another editor changed the same resource: the page was out of date, so nothing is changed. */
const CHANGED_MEANWHILE: Complaint = {
  message: "Somebody else changed this meanwhile.",
  advice: "It is shown as it is now, without your edit.",
  remedy: "retry",
};

/** The service's own sentence tells programs how to send a key. */
const NOT_SIGNED_IN: Complaint = {
  message: "You are not signed in.",
  advice: "What you did last was not done; sign in to go on.",
  remedy: "signIn",
};

function adviceFor(error: ServiceError): string {
  switch (error.status) {
    case 403:
      return "Nothing was changed. Whoever gave you the key can give you one that may.";
    case 404:
      return "Somebody may have removed it meanwhile.";
    case 413:
      return "Send a smaller file, or one that leaves out what the shot does not use.";
    case 415:
    case 422:
      return "Nothing was changed.";
    case 423:
      return "";
    case 429:
    case 503:
      return "Try again in a moment.";
    default:
      return error.status >= 500 ? "If it fails again, the service’s log says more." : "Nothing was changed.";
  }
}

/** With a capital at its head, unless that is a name, and a full stop at its end. */
export function sentence(text: string): string {
  const trimmed = text.trim();
  const headed = /^[a-z]+(\s|$)/.test(trimmed) ? trimmed.charAt(0).toUpperCase() + trimmed.slice(1) : trimmed;
  return /[.!?]$/.test(headed) ? headed : `${headed}.`;
}
